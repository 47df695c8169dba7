//! What the controller promises, seen from outside. One binary; one module per kind of evidence:
//! `invariants` hold for any input and any settings, `mechanisms` and `distribution` tell what each mechanism of chapter 6 does
//! in a small story, `reference` compares with floating point, `settings` goes along every bound, `names` reads what is shown,
//! `fixed_config` fixes mechanisms, `state` saves and restores, `golden` freezes the bits.

mod distribution;
mod fixed_config;
mod golden;
mod invariants;
mod mechanisms;
mod names;
mod reference;
mod settings;
mod state;
mod support;
