//! Runs the operating range with the thesis' controller, the recommended one and the model-based pulses, with orifices of
//! both prototypes, under every supply voltage and temperature. With `all`, the pulses also run with each effect of the
//! library, which they do not know.
//!
//! `cargo run --release -p hil-harness --example controllers [-- RIGS [all]]`

use std::process::ExitCode;

use controller::Settings;
use hil_harness::condition_table::{Condition, NEVER_SAMPLES, TABLE_HEAD};
use hil_harness::scenario::{FIGURE_ORIFICE_M, REQUIRED_ORIFICE_M, with_orifices};
use hil_harness::{Requirement, Scenario, controller_file};

/// The documents show 40 rigs; an unoptimized build runs four, to show that the example works.
const RIGS: u32 = if cfg!(debug_assertions) { 4 } else { 40 };
/// Seed of the rigs; the recommended controller was tuned on those of seed 1, the pulses on those of seeds 1 and 77.
const SEED: u64 = 2026;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let rigs = match arguments.next().map(|text| text.parse()) {
        None => RIGS,
        Some(Ok(rigs)) if rigs > 0 => rigs,
        Some(_) => {
            eprintln!("the number of rigs is a whole number from 1 on, such as {RIGS}");
            return ExitCode::from(2);
        }
    };
    let with_effects = arguments.next().is_some_and(|word| word == "all");
    let Some(scenario) = Scenario::built_in("operating-range") else {
        unreachable!("the scenario is built in")
    };
    println!(
        "{rigs} rigs, seed {SEED}; a step that never settles counts as {NEVER_SAMPLES} samples."
    );
    let controllers: [(&str, Settings); 3] = [
        ("thesis", controller_file::thesis()),
        ("recommended", controller_file::recommended()),
        ("pulses", controller_file::pulses_1_9_mm()),
    ];
    for (name, settings) in controllers {
        for orifice_m in [REQUIRED_ORIFICE_M, FIGURE_ORIFICE_M] {
            println!("\n{name}, {:.1} mm\n\n{TABLE_HEAD}", 1e3 * orifice_m);
            let plant = with_orifices(scenario.plant.clone(), orifice_m);
            let scenario = scenario
                .clone()
                .controlled_by(settings)
                .seeded(SEED)
                .on(plant);
            let wants_effects = with_effects && settings.pulses.is_some();
            let conditions = Condition::all(&scenario.plant);
            for condition in conditions
                .iter()
                .filter(|condition| wants_effects || condition.effect.is_none())
            {
                match condition.row(&scenario, &Requirement::THESIS, rigs) {
                    Ok(row) => println!("{row}"),
                    Err(error) => {
                        eprintln!("{error}");
                        return ExitCode::from(2);
                    }
                }
            }
        }
    }
    ExitCode::SUCCESS
}
