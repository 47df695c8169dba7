//! Requirements on the controller, tested from outside. One binary; one module per kind of evidence: `invariants`
//! checks any input and any settings, `mechanisms` and `distribution` check each mechanism of chapter 6 in a small
//! scenario, `reference` compares with floating point, `settings` checks every bound, `names` checks displayed names,
//! `fixed_config` checks mechanisms fixed at compile time, `state` saves and restores the state, `golden` compares
//! digests of the outputs, `table` sets and reads every row of the table of settings, `pulses` runs the
//! model-based pulses on a chamber.

mod distribution;
mod fixed_config;
mod golden;
mod invariants;
mod mechanisms;
mod names;
mod pulses;
mod reference;
mod settings;
mod state;
mod support;
mod table;
