//! One binary for two machines. Compiled for the ECU (`target_os = "none"`) it is the image that a board starts at
//! reset. Compiled for the host it is a program that runs the image's self-test and prints the same lines, so that the
//! two can be compared bit for bit.
//!
//! On the ECU every end of the run leads to the safe state ([`ecu::safe_outputs`]). The panic handler, the fault
//! handler and the watchdog's interrupt switch the coils off, store the reason in RAM that a warm reset does not
//! change, and reset the machine. It then starts with the coils off and reads the reason.

#![cfg_attr(target_os = "none", no_std, no_main)]

mod boards;
#[cfg(target_os = "none")]
mod build_number;
#[cfg(target_os = "none")]
mod handlers;
#[cfg(target_os = "none")]
mod log;
#[cfg(target_os = "none")]
mod retained_ram;
#[cfg(all(target_os = "none", feature = "board-mps2-an386"))]
mod stack;

#[cfg(not(target_os = "none"))]
fn main() -> std::process::ExitCode {
    boards::host::run()
}
