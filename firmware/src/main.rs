//! How does the controller live on an ECU?
//!
//! One binary, two lives. Compiled for the ECU (`target_os = "none"`) it is the image that a board starts at reset; compiled
//! for the host the same files are a program that does and prints the same, so that the two can be compared bit for bit.
//!
//! The image runs its [`self_test`] with the coils off and ends. It ends in the safe state on every way out: after the test,
//! in the panic handler and in the fault handler ([`board::Board::coils_off`]).

#![cfg_attr(target_os = "none", no_std, no_main)]

mod board;
mod boards;
mod self_test;

use board::{Board, Verdict};

/// From reset to the end of the run. `flip` is the self-test's own alarm test and zero everywhere on an ECU.
fn live(board: &mut impl Board, flip: impl Fn(&str, u32) -> u32) -> ! {
    board.coils_off();
    let verdict = match self_test::run(board, flip) {
        Ok(()) => Verdict::Passed,
        Err(_) => Verdict::Failed,
    };
    board.coils_off();
    board.end(verdict)
}

#[cfg(not(target_os = "none"))]
fn main() {
    boards::host::start()
}
