#![no_main]

use hil_harness::controller_file;

// Any text is read or refused with a message. Settings that were read are the same after they are written and read
// again.
libfuzzer_sys::fuzz_target!(|text: &str| {
    match controller_file::read(text, "fuzz.toml") {
        Ok(settings) => {
            let again = controller_file::read(&controller_file::write(&settings), "again.toml");
            assert_eq!(again.expect("written settings are read"), settings);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
