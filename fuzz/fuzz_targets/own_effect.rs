#![no_main]

use plant_sim::own_effects::{Definition, OwnParameter};
use plant_sim::{PlantParameters, Simulator};

// The text is the expression of an own effect. It is read or refused with a reason, a plant with the effect is the same
// after it is written and read again, and a simulation with it ends.
libfuzzer_sys::fuzz_target!(|text: &str| {
    let definition = Definition {
        name: "law".to_owned(),
        sentence: "A law.".to_owned(),
        acts_on: "leak_flow".to_owned(),
        expression: text.to_owned(),
        parameters: vec![OwnParameter {
            key: "k".to_owned(),
            typical: 1e-10,
            range: (1e-12, 1e-8),
            ..OwnParameter::default()
        }],
        ..Definition::default()
    };
    match definition.effect() {
        Ok(effect) => {
            let mut plant = PlantParameters::nominal();
            plant.own.add(effect);
            plant
                .set("effects.own.law.k", 1e-10, "drawn")
                .expect("a value in its range");
            let again = PlantParameters::from_toml(&plant.to_toml(), "again.toml");
            assert_eq!(again.expect("a written plant file is read"), plant);
            let mut simulator = Simulator::new(&plant);
            simulator.set_work_limit(100_000);
            simulator.advance_to_ns(10_000_000);
        }
        Err(faults) => {
            let missing = text.is_empty() && faults.is_empty();
            assert!(
                missing
                    || faults
                        .iter()
                        .all(|fault| !fault.reason.to_string().is_empty())
            );
        }
    }
});
