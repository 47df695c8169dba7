#![no_main]

#[path = "../../model-lab/tests/properties/mod.rs"]
#[allow(dead_code, reason = "each target checks one of the properties")]
mod chain;
#[path = "../../recording/tests/properties/mod.rs"]
#[allow(dead_code, reason = "each target checks one of the properties")]
mod properties;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    properties::mf4_reader(bytes);
    chain::mf4_to_comparison(bytes);
});
