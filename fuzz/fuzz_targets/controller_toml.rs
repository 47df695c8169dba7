#![no_main]

use hil_harness::controller_file;

// Any text is refused with a message or read; what is read is written and read again to the same settings.
libfuzzer_sys::fuzz_target!(|text: &str| {
    match controller_file::read(text, "fuzz.toml") {
        Ok(settings) => {
            let again = controller_file::read(&controller_file::write(&settings), "again.toml");
            assert_eq!(again.expect("written settings are read"), settings);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
