#![no_main]

#[path = "../../model-lab/tests/promise/mod.rs"]
#[allow(dead_code, reason = "each target tests one of the promises")]
mod chain;
#[path = "../../recording/tests/promise/mod.rs"]
#[allow(dead_code, reason = "each target tests one of the promises")]
mod promise;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    promise::csv_reader(bytes);
    chain::csv_to_comparison(bytes);
});
