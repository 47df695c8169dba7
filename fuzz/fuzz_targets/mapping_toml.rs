#![no_main]

#[path = "../../recording/tests/promise/mod.rs"]
#[allow(dead_code, reason = "each target holds one of the promises")]
mod promise;

libfuzzer_sys::fuzz_target!(|text: &str| promise::mapping_toml(text));
