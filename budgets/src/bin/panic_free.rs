//! The project's controller in an image that cannot panic: its panic handler calls a function that nobody defines, so it
//! links only if no panic is left in it, with overflow checks on. With the feature `panic-canary` it must fail to link.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This image proves something by being linked: run `cargo xtask budgets`.");
}

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use core::panic::PanicInfo;

    use budgets::ours::{self, Traced};
    use budgets::trace::{RECOMMENDED, THESIS};
    use controller::State;
    use cortex_m_rt::entry;

    #[entry]
    fn main() -> ! {
        let mut state = State::at_rest();
        let mut traced = Traced::at_rest();
        loop {
            let [reference, pressure] = black_box([0, 0]);
            let config = black_box(&THESIS);
            black_box(ours::full_step(config, &mut state, reference, pressure));
            black_box(ours::full_step_constant(
                &(),
                &mut state,
                reference,
                pressure,
            ));
            let config = black_box(&RECOMMENDED);
            black_box(ours::traced_step(config, &mut traced, reference, pressure));
            #[cfg(feature = "panic-canary")]
            black_box(reference + pressure);
        }
    }

    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        unsafe extern "C" {
            fn this_image_can_panic() -> !;
        }
        // SAFETY: there is no such function; an image in which this call is left does not link.
        unsafe { this_image_can_panic() }
    }
}
