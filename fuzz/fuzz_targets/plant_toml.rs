#![no_main]

use plant_sim::PlantParameters;

// Any text is read or refused with a message. Values that were read are the same after they are written and read again.
libfuzzer_sys::fuzz_target!(|text: &str| {
    match PlantParameters::from_toml(text, "fuzz.toml") {
        Ok(plant) => {
            let again = PlantParameters::from_toml(&plant.to_toml(), "again.toml");
            assert_eq!(again.expect("a written plant file is read"), plant);
        }
        Err(error) => assert!(!error.to_string().is_empty()),
    }
});
