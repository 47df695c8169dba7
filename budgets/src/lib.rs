//! What does a sample cost, beside its peers?
//!
//! An image for a Cortex-M4F that never leaves the emulator. It calls each candidate, the project's controller and what
//! others write or use in its place, with the inputs of one closed [`trace`], counts the instructions of every call, and
//! prints a line for each. `cargo xtask budgets` builds and runs it, proves from the linked code what no trace can show, and
//! holds both against the budgets.

#![cfg_attr(not(test), no_std)]

pub mod ecu_samples;
pub mod ours;
pub mod plant;
pub mod trace;
