//! Prints the goals of the closed loop in a vehicle, and what the thesis' controller, the recommended one and the
//! model-based pulses reach.
//!
//! `cargo run --release -p hil-harness --example goals [-- RIGS-OF-A-KIND]`

use std::process::ExitCode;

use hil_harness::controller_file;
use hil_harness::goals::{Extent, Goal, reached};

/// With 16 kinds of rig and 30 steps on each rig, 42 rigs of a kind make 20 160 steps; an unoptimized build runs one.
const RIGS_OF_A_KIND: u32 = if cfg!(debug_assertions) { 1 } else { 42 };
/// Number of rigs of the rows that have one kind of rig.
const RIGS: u32 = if cfg!(debug_assertions) { 1 } else { 40 };
/// Seed of the rigs; no controller was tuned on it.
const SEED: u64 = 2027;

fn main() -> ExitCode {
    let rigs_of_a_kind = match std::env::args().nth(1).map(|text| text.parse()) {
        None => RIGS_OF_A_KIND,
        Some(Ok(rigs)) if rigs > 0 => rigs,
        Some(_) => {
            eprintln!("the number of rigs is a whole number from 1 on, such as {RIGS_OF_A_KIND}");
            return ExitCode::from(2);
        }
    };
    let extent = Extent {
        rigs_of_a_kind,
        rigs: RIGS,
        seed: SEED,
    };
    println!(
        "Vehicles: 50 to 125 cm³, 1.3 and 1.9 mm, 18 to 32 V, -40 to 120 °C, {rigs_of_a_kind} rigs of each kind; \
         {RIGS} rigs in the other rows; seed {SEED}.\n"
    );
    let controllers = [
        controller_file::thesis(),
        controller_file::recommended(),
        controller_file::pulses_1_9_mm(),
    ];
    let columns: Result<Vec<Vec<Goal>>, _> = controllers
        .into_iter()
        .map(|settings| reached(settings, &extent))
        .collect();
    let columns = match columns {
        Ok(columns) => columns,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    println!("| goal | bound | thesis | recommended | pulses |\n|---|---|---|---|---|");
    for (index, goal) in columns[0].iter().enumerate() {
        let cells: Vec<String> = columns
            .iter()
            .map(|goals| goals[index].to_string())
            .collect();
        println!("| {} | {} | {} |", goal.name, goal.bound, cells.join(" | "));
    }
    ExitCode::SUCCESS
}
