#![no_main]

#[path = "../../hil-protocol/tests/properties/mod.rs"]
mod properties;
#[path = "../../hil-protocol/tests/suite/stepper.rs"]
#[allow(dead_code, reason = "its tests read more of it")]
mod stepper;

libfuzzer_sys::fuzz_target!(|script: &[u8]| properties::sessions(script));
