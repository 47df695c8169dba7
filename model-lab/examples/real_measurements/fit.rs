//! Fit of plant parameters to a log by least squares (Levenberg and Marquardt).
//!
//! Two or three parameters within bounds and without prior need no evidence of several logs, as the diagnosis' own fit does. The public
//! crates for this method have no bounds.

use nalgebra::{DMatrix, DVector};
use plant_sim::parameters::Scale;
use plant_sim::replay::{CurrentSampling, ROW_SIGNALS, Replay, initial_pressure, inputs, signals};
use plant_sim::{PlantParameters, Tolerance};
use recording::Recording;

/// Step of the differences, in units of a fitted unknown.
const STEP: f64 = 1e-3;
/// Longest step of an unknown in one iteration.
const LONGEST_STEP: f64 = 0.7;
/// Relative decrease of the sum of squares below which the fit ends.
const SMALL_GAIN: f64 = 1e-6;

/// Signal of the log in the unit of the model, with the size of the error that counts as 1.
#[derive(Debug)]
pub(crate) struct Measured {
    /// Name, such as `p_ch`.
    pub(crate) name: &'static str,
    /// Index in a row.
    place: usize,
    /// Values, NaN where missing.
    pub(crate) values: Vec<f64>,
    weight: f64,
}

/// Returns the signals of `log` that the plant has, with a weight for each: an error of that size counts as 1.
pub(crate) fn measured(
    plant: &PlantParameters,
    log: &Recording,
    weights: &[(&'static str, f64)],
) -> Vec<Measured> {
    let one = |&(name, weight): &(&'static str, f64)| {
        let place = ROW_SIGNALS.iter().position(|signal| signal.0 == name)?;
        let (_, unit) = signals(plant).find(|signal| signal.0 == name)?;
        let ambient = plant.gas.ambient_pressure_pa;
        let values = log.signal(name)?.values_at_ambient(unit, ambient).ok()?;
        Some(Measured {
            name,
            place,
            values,
            weight,
        })
    };
    weights.iter().filter_map(one).collect()
}

/// Returns the trace of each measured signal at the instants of the log. The sensor shows the first logged pressure at the start.
pub(crate) fn simulate(
    plant: &PlantParameters,
    log: &Recording,
    measured: &[Measured],
) -> Vec<Vec<f64>> {
    let (base, inputs) = inputs(plant, log).expect("a bundled log drives its plant");
    let interval_s = base.sampling().median_step_s.unwrap_or(f64::INFINITY);
    let sampling = CurrentSampling::of_interval(interval_s, plant);
    let mut replay = Replay::new(plant, sampling, Tolerance::scaled(0.1));
    if let Some(pressure) = initial_pressure(plant, log).expect("`p_ch` is a pressure") {
        replay.begin_showing(pressure);
    }
    let mut traces = vec![Vec::with_capacity(inputs.len()); measured.len()];
    for input in inputs {
        let row = replay.row(input);
        for (trace, signal) in traces.iter_mut().zip(measured) {
            trace.push(row[signal.place]);
        }
    }
    traces
}

/// Returns the root mean square of measured minus modelled, missing samples left out.
pub(crate) fn rms(measured: &Measured, trace: &[f64]) -> f64 {
    let errors = measured.values.iter().zip(trace).map(|(a, b)| a - b);
    let squares: Vec<f64> = errors.filter(|e| !e.is_nan()).map(|e| e * e).collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

/// Returns the plant with the parameters `names` fitted to the log.
pub(crate) fn fit(
    start: &PlantParameters,
    log: &Recording,
    measured: &[Measured],
    names: &[&str],
) -> PlantParameters {
    let residuals = |unknowns: &[f64]| -> Vec<f64> {
        let plant = with(start, names, unknowns);
        let traces = simulate(&plant, log, measured);
        let pairs = measured.iter().zip(&traces);
        pairs
            .flat_map(|(signal, trace)| {
                let errors = signal.values.iter().zip(trace);
                errors.map(|(a, b)| (a - b) / signal.weight)
            })
            .filter(|error| !error.is_nan())
            .collect()
    };
    let limits: Vec<[f64; 2]> = names.iter().map(|name| limits(start, name)).collect();
    let mut unknowns: Vec<f64> = names.iter().map(|name| unknown_of(start, name)).collect();
    let mut errors = residuals(&unknowns);
    let mut damping = 1e-2;
    for _ in 0..40 {
        let columns: Vec<Vec<f64>> = (0..names.len())
            .map(|k| {
                let mut moved = unknowns.clone();
                // At the end of the range, the step goes inwards.
                let step = if moved[k] + STEP > limits[k][1] {
                    -STEP
                } else {
                    STEP
                };
                moved[k] += step;
                let moved = residuals(&moved);
                moved
                    .iter()
                    .zip(&errors)
                    .map(|(a, b)| (a - b) / step)
                    .collect()
            })
            .collect();
        let before = square(&errors);
        let better = (0..10).find_map(|_| {
            let step = step(&columns, &errors, damping);
            let moved: Vec<f64> = (0..names.len())
                .map(|k| (unknowns[k] + step[k]).clamp(limits[k][0], limits[k][1]))
                .collect();
            let found = residuals(&moved);
            let is_better = square(&found) < before;
            damping *= if is_better { 0.3 } else { 4.0 };
            is_better.then_some((moved, found))
        });
        let Some((moved, found)) = better else { break };
        (unknowns, errors) = (moved, found);
        if before - square(&errors) < SMALL_GAIN * before {
            break;
        }
    }
    let mut plant = with(start, names, &unknowns);
    let origin = format!("fitted to {}", log.provenance().source);
    for name in names {
        let value = plant.get(name).expect("the plant has what is fitted");
        let rounded = format!("{value:.3e}")
            .parse()
            .expect("a printed number is read");
        plant
            .set(name, rounded, &origin)
            .expect("a value within its range");
    }
    plant
}

/// Returns the unknown of a parameter: its logarithm, or the value itself for parameters on a linear scale.
fn unknown_of(plant: &PlantParameters, name: &str) -> f64 {
    let value = plant.get(name).expect("the plant has what is fitted");
    if is_linear(plant, name) {
        value
    } else {
        value.ln()
    }
}

/// Returns the range of an unknown.
fn limits(plant: &PlantParameters, name: &str) -> [f64; 2] {
    let spec = plant.specs().find(|spec| spec.name() == name);
    let (least, most) = spec.expect("the plant has what is fitted").range;
    [least, most].map(|value| {
        if is_linear(plant, name) {
            value
        } else {
            value.ln()
        }
    })
}

fn with(plant: &PlantParameters, names: &[&str], unknowns: &[f64]) -> PlantParameters {
    let mut plant = plant.clone();
    for (name, &unknown) in names.iter().zip(unknowns) {
        let value = if is_linear(&plant, name) {
            unknown
        } else {
            unknown.exp()
        };
        let spec = plant.specs().find(|spec| spec.name() == *name);
        let (least, most) = spec.expect("the plant has what is fitted").range;
        // A logarithm and its inverse may leave the range by rounding.
        plant
            .set(name, value.clamp(least, most), "being fitted")
            .expect("a value within its range");
    }
    plant
}

fn is_linear(plant: &PlantParameters, name: &str) -> bool {
    let spec = plant.specs().find(|spec| spec.name() == name);
    spec.and_then(|spec| spec.size)
        .is_some_and(|size| size.scale == Scale::Linear)
}

fn square(errors: &[f64]) -> f64 {
    errors.iter().map(|error| error * error).sum()
}

/// Returns the damped step of the linearised errors: (JᵀJ + λ diag JᵀJ) step = -Jᵀ errors.
fn step(columns: &[Vec<f64>], errors: &[f64], damping: f64) -> Vec<f64> {
    let n = columns.len();
    let jacobian = DMatrix::from_iterator(errors.len(), n, columns.iter().flatten().copied());
    let descent = -jacobian.tr_mul(&DVector::from_column_slice(errors));
    let mut normal = jacobian.tr_mul(&jacobian);
    for i in 0..n {
        normal[(i, i)] = normal[(i, i)] * (1.0 + damping) + f64::MIN_POSITIVE;
    }
    let step = normal.cholesky().map(|factors| factors.solve(&descent));
    let step = step.unwrap_or_else(|| DVector::zeros(n));
    step.iter()
        .map(|wanted| wanted.clamp(-LONGEST_STEP, LONGEST_STEP))
        .collect()
}
