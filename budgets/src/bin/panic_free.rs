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

    use budgets::ours::{self, Recommended, Thesis, Traced};
    use controller::{FixedConfig, State};
    use cortex_m_rt::entry;

    const THESIS: FixedConfig<Thesis> = ours::fixed();
    const RECOMMENDED: FixedConfig<Recommended> = ours::fixed();

    #[entry]
    fn main() -> ! {
        let (thesis, recommended) = black_box((&THESIS, &RECOMMENDED));
        let mut state = State::at_rest();
        let mut traced = Traced::at_rest();
        loop {
            let [reference, pressure] = black_box([0, 0]);
            let (fixed, any) = (thesis, thesis.config());
            black_box(ours::full_step(fixed, &mut state, reference, pressure));
            black_box(ours::full_step_any(any, &mut state, reference, pressure));
            let (fixed, any) = (recommended, recommended.config());
            black_box(ours::traced_step(fixed, &mut traced, reference, pressure));
            black_box(ours::traced_step_any(any, &mut traced, reference, pressure));
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
