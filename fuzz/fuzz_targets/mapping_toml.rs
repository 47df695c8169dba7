#![no_main]

#[path = "../../model-lab/tests/properties/mod.rs"]
#[allow(dead_code, reason = "each target checks one of the properties")]
mod chain;
#[path = "../../recording/tests/properties/mod.rs"]
#[allow(dead_code, reason = "each target checks one of the properties")]
mod properties;

libfuzzer_sys::fuzz_target!(|text: &str| {
    properties::mapping_toml(text);
    chain::mapping_to_comparison(text);
});
