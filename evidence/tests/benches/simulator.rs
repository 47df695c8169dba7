//! Comparison of the simulator with a general stiff solver: speed, accuracy, steps per PWM period.
//!
//! The log is `practice-00-id` (60 s at 100 Hz). The reference is the simulator with a tolerance a million times
//! smaller. Speeds are the best of several runs, compared as ratios.

use std::time::Instant;

use plant_sim::effects::{Effect, EffectSetting, LIBRARY};
use plant_sim::replay::{CurrentSampling, Replay, ReplayInput};
use plant_sim::{PlantParameters, Tolerance};
use retarder_tests::{bench_log, stiff_solver};

const LOG: &str = "practice-00-id";

struct Run {
    pressure: Vec<f64>,
    seconds: f64,
    steps: u64,
}

fn event_driven(parameters: &PlantParameters, inputs: &[ReplayInput], tolerance: Tolerance) -> Run {
    let start = Instant::now();
    let mut replay = Replay::new(parameters, CurrentSampling::MeanOfInterval, tolerance);
    let pressure = inputs
        .iter()
        .map(|input| {
            replay.row(*input);
            replay.simulator().state().pressure
        })
        .collect();
    Run {
        pressure,
        seconds: start.elapsed().as_secs_f64(),
        steps: replay.simulator().statistics().steps,
    }
}

/// Prints the simulation time with each effect, relative to the plain plant.
fn print_costs_of_effects(seconds: impl Fn(&PlantParameters) -> f64, plain: &PlantParameters) {
    let of_plain = seconds(plain);
    let cost = |effect: &'static dyn Effect| {
        let plant = plain.with_effect(EffectSetting::typical(effect));
        (seconds(&plant) / of_plain, effect.about().id)
    };
    let mut costs: Vec<_> = LIBRARY.into_iter().map(cost).collect();
    costs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let ((median, _), (worst, id)) = (costs[costs.len() / 2], costs[costs.len() - 1]);
    println!(
        "one effect over the plain plant: median {median:.1}, worst {worst:.1} times the time ({id})"
    );
}

fn general(parameters: &PlantParameters, inputs: &[ReplayInput], tolerance: f64) -> Run {
    let start = Instant::now();
    let trajectory =
        stiff_solver::simulate(parameters, inputs, tolerance).expect("the solver goes through");
    Run {
        pressure: trajectory.pressure,
        seconds: start.elapsed().as_secs_f64(),
        steps: trajectory.steps as u64,
    }
}

/// Returns the rms and the largest deviation (mbar).
fn deviation_mbar(run: &[f64], reference: &[f64]) -> (f64, f64) {
    let error = || run.iter().zip(reference).map(|(a, b)| (a - b) / 100.0);
    let mean_square = error().map(|e| e * e).sum::<f64>() / run.len() as f64;
    (
        mean_square.sqrt(),
        error().fold(0.0, |worst, e| worst.max(e.abs())),
    )
}

fn main() {
    let parameters = PlantParameters::nominal();
    let inputs = bench_log::commands(LOG);
    let log_seconds = inputs
        .last()
        .map_or(0.0, |input| input.time_ns as f64 * 1e-9);
    let periods = log_seconds * parameters.ecu.pwm_frequency_hz;
    let converged = |plant| event_driven(plant, &inputs, Tolerance::scaled(1e-6)).pressure;
    let reference = converged(&parameters);

    println!(
        "log {LOG}, {log_seconds:.0} s, {:.0} Hz PWM",
        parameters.ecu.pwm_frequency_hz
    );
    println!(
        "{:<34} {:>11} {:>11} {:>13} {:>13}",
        "solver", "rms mbar", "worst mbar", "x real time", "steps/period"
    );
    let report_beside = |reference: &[f64], name: &str, run: &Run| {
        let (rms, worst) = deviation_mbar(&run.pressure, reference);
        println!(
            "{name:<34} {rms:>11.4} {worst:>11.3} {:>13.0} {:>13.2}",
            log_seconds / run.seconds,
            run.steps as f64 / periods
        );
        (rms, log_seconds / run.seconds)
    };
    let report = |name: &str, run: &Run| report_beside(&reference, name, run);

    let best_of = |plant: &PlantParameters, tolerance: Tolerance| {
        (0..20)
            .map(|_| event_driven(plant, &inputs, tolerance))
            .min_by(|a, b| a.seconds.total_cmp(&b.seconds))
            .expect("runs")
    };
    let best = |tolerance| best_of(&parameters, tolerance);
    let (our_rms, our_speed) = report(
        "event-driven, default tolerance",
        &best(Tolerance::default()),
    );
    for factor in [10.0, 0.1, 0.01] {
        report(
            &format!("event-driven, tolerance x {factor}"),
            &best(Tolerance::scaled(factor)),
        );
    }
    let all_effects = LIBRARY
        .into_iter()
        .fold(parameters.clone(), |plant, effect| {
            plant.with_effect(EffectSetting::typical(effect))
        });
    report_beside(
        &converged(&all_effects),
        "event-driven, all effects",
        &best_of(&all_effects, Tolerance::default()),
    );
    print_costs_of_effects(
        |plant| best_of(plant, Tolerance::default()).seconds,
        &parameters,
    );
    let mut equal: Option<f64> = None;
    for tolerance in [1e-4, 1e-5, 1e-6, 1e-7, 1e-8] {
        let run = general(&parameters, &inputs, tolerance);
        let (rms, speed) = report(&format!("diffsol BDF, tolerance {tolerance:.0e}"), &run);
        if rms <= our_rms.max(0.2) {
            equal = Some(equal.map_or(speed, |fastest| fastest.max(speed)));
        }
    }
    match equal {
        Some(speed) => println!(
            "event-driven over diffsol BDF at equal accuracy (rms at most 0.2 mbar): {:.0} times as fast",
            our_speed / speed
        ),
        None => println!("diffsol BDF did not reach 0.2 mbar rms at any tolerance"),
    }
}
