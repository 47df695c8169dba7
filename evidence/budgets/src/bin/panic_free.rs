//! Image of the project's controller that cannot panic: its panic handler calls an undefined function, so it links only
//! if no panic is left in it, with overflow checks on. With the feature `panic-canary` it must fail to link.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This image proves something by being linked: run `cargo xtask budgets`.");
}

#[cfg(target_os = "none")]
mod image {
    use core::cell::Cell;
    use core::hint::black_box;
    use core::panic::PanicInfo;

    use budgets::ecu_samples::{self, Checked};
    use budgets::ours::{self, Recommended, Thesis, Traced};
    use controller::{FixedConfig, State};
    use cortex_m_rt::entry;
    use ecu::Inputs;

    const THESIS: FixedConfig<Thesis> = ours::fixed();
    const RECOMMENDED: FixedConfig<Recommended> = ours::fixed();

    const NOTHING: Inputs = Inputs {
        elapsed_us: 0,
        reference: None,
        pressure: None,
        current_fill_ma: None,
        current_vent_ma: None,
        battery_mv: None,
    };

    #[entry]
    fn main() -> ! {
        let (thesis, recommended) = black_box((&THESIS, &RECOMMENDED));
        let mut state = State::at_rest();
        let mut traced = Traced::at_rest();
        let bench = black_box(&ecu_samples::CHECKED);
        let mut checked = Checked::NEW;
        let mut ecu = ecu_samples::bench_ecu();
        let inputs = Cell::new(NOTHING);
        loop {
            let [reference, pressure] = black_box([0, 0]);
            let (fixed, any) = (thesis, thesis.config());
            black_box(ours::full_step(fixed, &mut state, reference, pressure));
            black_box(ours::full_step_any(any, &mut state, reference, pressure));
            let config = recommended;
            black_box(ours::traced_step(config, &mut traced, reference, pressure));
            let (config, checked) = (bench, &mut checked);
            black_box(ecu_samples::checked_loop(
                config, checked, reference, pressure,
            ));
            inputs.set(black_box(inputs.get()));
            black_box(ecu_samples::ecu_sample(&inputs, &mut ecu, 0, 0));
            #[cfg(feature = "panic-canary")]
            black_box(reference + pressure);
        }
    }

    #[panic_handler]
    fn panic(_: &PanicInfo<'_>) -> ! {
        unsafe extern "C" {
            fn this_image_can_panic() -> !;
        }
        // SAFETY: no such function exists; an image in which this call is left does not link.
        unsafe { this_image_can_panic() }
    }
}
