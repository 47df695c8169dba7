#![no_main]

#[path = "../../recording/tests/promise/mod.rs"]
#[allow(dead_code, reason = "each target holds one of the promises")]
mod promise;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| promise::mf4_reader(bytes));
