//! One binary, two lives. Compiled for the ECU (`target_os = "none"`) it is the image that a board starts at reset; compiled
//! for the host it is a program that runs the image's self-test and prints the same, so that the two can be compared bit
//! for bit.
//!
//! On the ECU every way out ends in the safe state ([`ecu::safe_outputs`]): the panic handler, the fault handler and the
//! watchdog's interrupt switch the coils off, say why in RAM that a warm reset leaves alone, and reset the machine, which
//! starts with the coils off and finds the reason.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod boards;
#[cfg(target_os = "none")]
mod build_number;
#[cfg(target_os = "none")]
mod handlers;
#[cfg(target_os = "none")]
mod kept;
#[cfg(target_os = "none")]
mod log;
#[cfg(all(target_os = "none", feature = "board-mps2-an386"))]
mod stack;

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    boards::host::run()
}
