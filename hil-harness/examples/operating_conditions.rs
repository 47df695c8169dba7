//! Runs the operating range under every supply voltage, temperature and effect, and prints one row for each. Voltages and
//! temperatures have a second row for rigs with a normally open vent valve, and a third one for the same controller without
//! compensation.
//!
//! `cargo run --release -p hil-harness --example operating_conditions [-- RIGS]`

use std::process::ExitCode;

use controller::Settings;
use hil_harness::condition_table::{Condition, NEVER_SAMPLES, TABLE_HEAD};
use hil_harness::scenario::with_normally_open_vent;
use hil_harness::{Requirement, Scenario, controller_file};

/// The documents show 40 rigs; an unoptimized build runs four, to show that the example works.
const RIGS: u32 = if cfg!(debug_assertions) { 4 } else { 40 };
/// Seed of the rigs; the recommended controller was tuned on those of seed 1.
const SEED: u64 = 2026;

fn main() -> ExitCode {
    let rigs = match std::env::args().nth(1).map(|text| text.parse()) {
        None => RIGS,
        Some(Ok(rigs)) if rigs > 0 => rigs,
        Some(_) => {
            eprintln!("the number of rigs is a whole number from 1 on, such as {RIGS}");
            return ExitCode::from(2);
        }
    };
    let Some(scenario) = Scenario::built_in("operating-range") else {
        unreachable!("the scenario is built in")
    };
    let scenario = scenario
        .controlled_by(controller_file::recommended())
        .seeded(SEED);
    println!(
        "Recommended controller, {} mm orifices, {rigs} rigs, seed {SEED}; a step that never settles counts as \
         {NEVER_SAMPLES} samples.\n",
        1e3 * scenario.plant.flow.orifice_fill_m
    );
    println!("{TABLE_HEAD}");
    let constant = scenario.clone().controlled_by(Settings {
        compensation: None,
        ..scenario.controller
    });
    let conditions = Condition::all(&scenario.plant);
    let normally_open = with_normally_open_vent(scenario.plant.clone());
    let normally_open = scenario.clone().on(normally_open);
    let plain = |name: &'static str| {
        let plain = conditions.iter().filter(|one| one.effect.is_none());
        plain.map(move |condition| Condition {
            name: format!("{}, {name}", condition.name),
            ..condition.clone()
        })
    };
    let rows = [
        (conditions.clone(), &scenario),
        (plain("normally open vent").collect(), &normally_open),
        (plain("no compensation").collect(), &constant),
    ];
    let rows = rows
        .into_iter()
        .flat_map(|(conditions, scenario)| conditions.into_iter().map(move |one| (one, scenario)));
    for (condition, scenario) in rows {
        match condition.row(scenario, &Requirement::THESIS, rigs) {
            Ok(row) => println!("{row}"),
            Err(error) => {
                eprintln!("{error}");
                return ExitCode::from(2);
            }
        }
    }
    ExitCode::SUCCESS
}
