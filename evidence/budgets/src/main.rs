//! Bench: every candidate over the whole trace, one line each. On the host it cannot count instructions, and prints
//! this.

#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(all(target_os = "none", feature = "c-baselines"))]
mod baselines;
#[cfg(target_os = "none")]
mod bench;
#[cfg(target_os = "none")]
mod callee;
#[cfg(target_os = "none")]
mod counter;
#[cfg(target_os = "none")]
mod peers;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("This bench counts instructions of a Cortex-M4F: run `cargo xtask budgets`.");
}

#[cfg(target_os = "none")]
mod image {
    use core::fmt::Write;
    use core::panic::PanicInfo;

    use cortex_m_rt::entry;
    use cortex_m_semihosting::{debug, hio};

    #[entry]
    fn main() -> ! {
        // Only semihosting can end the run: without it no report is possible, and the deadline of `cargo xtask` ends
        // the run.
        debug::exit(match crate::bench::run() {
            Ok(()) => debug::EXIT_SUCCESS,
            Err(_) => debug::EXIT_FAILURE,
        });
        loop {
            core::hint::spin_loop();
        }
    }

    #[panic_handler]
    fn panic(info: &PanicInfo<'_>) -> ! {
        // The result of this output does not matter any more.
        let _ = hio::hstdout().map(|mut out| writeln!(out, "{info}"));
        debug::exit(debug::EXIT_FAILURE);
        loop {
            core::hint::spin_loop();
        }
    }
}
