#![no_main]

#[path = "../../hil-protocol/tests/promise/mod.rs"]
mod promise;
#[path = "../../hil-protocol/tests/suite/stepper.rs"]
#[allow(dead_code, reason = "its tests read more of it")]
mod stepper;

libfuzzer_sys::fuzz_target!(|script: &[u8]| promise::sessions(script));
