//! Runs every built-in scenario on many scattered rigs and prints the results.
//!
//! `cargo run -p hil-harness --example rigs --release [-- RIGS]`

use std::process::ExitCode;

use hil_harness::checks::{CheckId, Verdict};
use hil_harness::requirement::Requirement;
use hil_harness::scenario::{
    BUILT_IN, FIGURE_ORIFICE_M, REQUIRED_ORIFICE_M, Scenario, with_orifices,
};
use hil_harness::{controller_file, rigs};

const RIGS: u32 = 200;
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
    let controllers = [
        ("thesis", controller_file::thesis()),
        ("recommended", controller_file::recommended()),
    ];
    for (controller_name, controller) in controllers {
        for (orifice, diameter_m) in [("1.9 mm", REQUIRED_ORIFICE_M), ("1.3 mm", FIGURE_ORIFICE_M)]
        {
            println!("\n{controller_name}, {orifice}, {rigs} rigs");
            for built_in in BUILT_IN {
                let scenario = built_in.scenario().controlled_by(controller).seeded(SEED);
                let plant = with_orifices(scenario.plant.clone(), diameter_m);
                if let Err(error) = print_distribution(&scenario.on(plant), rigs) {
                    eprintln!("{error}");
                    return ExitCode::from(2);
                }
            }
        }
    }
    ExitCode::SUCCESS
}

fn print_distribution(scenario: &Scenario, count: u32) -> Result<(), rigs::RigError> {
    let requirement = Requirement::THESIS;
    let verdicts: Vec<Verdict> = rigs::verdicts(scenario, &requirement, count)
        .map(|rig| rig.map(|rig| rig.verdict))
        .collect::<Result<_, _>>()?;
    let hold = verdicts.iter().filter(|verdict| verdict.holds).count();
    let in_range = || {
        verdicts
            .iter()
            .flat_map(|verdict| &verdict.steps)
            .filter(|step| step.in_operating_range)
    };
    let t_req = requirement.t_req_samples;
    let in_time = in_range()
        .filter(|step| step.settled_samples.is_some_and(|n| n <= t_req))
        .count();
    let per_s: f64 = verdicts
        .iter()
        .filter_map(|v| v.actuations)
        .map(|a| a.per_s)
        .sum::<f64>()
        / f64::from(count);
    println!(
        "  {:18} {hold:4} rigs hold; {in_time} of {} steps in time; {per_s:.1} actuations/s",
        scenario.name,
        in_range().count()
    );
    for id in CheckId::ALL {
        let mut reached: Vec<f64> = verdicts
            .iter()
            .filter_map(|verdict| verdict.check(id))
            .map(|check| check.reached.unwrap_or(f64::INFINITY))
            .collect();
        reached.sort_by(f64::total_cmp);
        let Some(last) = reached.len().checked_sub(1) else {
            continue;
        };
        let quantile = |share: f64| reached[(share * last as f64).round() as usize];
        let holding = verdicts
            .iter()
            .filter_map(|verdict| verdict.check(id))
            .filter(|check| check.holds)
            .count();
        println!(
            "    {:36} worst per rig: median {:7.2}, 90 % {:7.2}, all {:7.2}; {holding} hold",
            id.name(),
            quantile(0.5),
            quantile(0.9),
            quantile(1.0)
        );
    }
    Ok(())
}
