//! Cost of a sample, compared with other controllers.
//!
//! This image for a Cortex-M4F runs only in the emulator. It calls each candidate, the project's controller and its
//! alternatives, with the inputs of one closed [`trace`], counts the instructions of every call, and prints a line for
//! each. `cargo xtask budgets` builds and runs it, derives bounds for any input from the linked code, and compares both
//! with the budgets.

#![cfg_attr(not(test), no_std)]

pub mod ecu_samples;
pub mod ours;
pub mod plant;
pub mod trace;
