//! Simulator compared with a general stiff solver on the same equations.

use plant_sim::replay::{CurrentSampling, Replay};
use plant_sim::{PlantParameters, Tolerance};
use retarder_tests::{bench_log, stiff_solver};

fn rms_and_worst_mbar(a: &[f64], b: &[f64]) -> (f64, f64) {
    let error = || a.iter().zip(b).map(|(a, b)| (a - b) / 100.0);
    let mean_square = error().map(|e| e * e).sum::<f64>() / a.len() as f64;
    (
        mean_square.sqrt(),
        error().fold(0.0, |worst, e| worst.max(e.abs())),
    )
}

/// Twelve seconds of a bench log: the required accuracy of the default tolerance, 0.2 mbar rms and 8 mbar at worst,
/// compared with a solver that shares only the right-hand side, at a much smaller tolerance.
#[test]
fn the_default_tolerance_meets_its_requirement_compared_with_another_solver() {
    let parameters = PlantParameters::nominal();
    let inputs = &bench_log::commands("practice-00-id")[..1200];
    let other = stiff_solver::simulate(&parameters, inputs, 1e-8).expect("the solver goes through");
    let run = |tolerance: Tolerance| -> Vec<f64> {
        let mut replay = Replay::new(&parameters, CurrentSampling::MeanOfInterval, tolerance);
        inputs
            .iter()
            .map(|input| {
                replay.row(*input);
                replay.simulator().state().pressure
            })
            .collect()
    };
    let (rms, worst) = rms_and_worst_mbar(&run(Tolerance::default()), &other.pressure);
    assert!(
        rms < 0.2 && worst < 8.0,
        "{rms} mbar rms, {worst} mbar at worst"
    );
    let (rms, worst) = rms_and_worst_mbar(&run(Tolerance::scaled(1e-4)), &other.pressure);
    assert!(
        rms < 0.02 && worst < 0.2,
        "converged: {rms} mbar rms, {worst} mbar at worst"
    );
}
