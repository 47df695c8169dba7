//! Usual value at an instant: the errors at the most similar instants, by commands, pressure and history.
//!
//! Missing physics that depends on the commands causes similar errors at similar instants. A spectral line of the supply, or a valve that
//! stuck once, does not.

use nalgebra::{SMatrix, SVector};
use plant_sim::plant::{FILL, VENT};
use rayon::prelude::*;

use super::trace::in_force;
use crate::diagnosis::evidence::log::Log;
use crate::diagnosis::fit::vector::median;

/// Number of instants that are compared.
const LIKE: usize = 12;
/// Distance in time (s) within which rows are correlated with the row itself.
const APART_S: f64 = 0.25;
/// Largest number of instants that one is compared with, chosen at equal distances.
const COMPARED: usize = 3000;
/// Differences that count as one unit: duty (%), pressure (bar), logarithm of the time since a valve moved.
const DUTY_PCT: f64 = 10.0;
const PRESSURE_BAR: f64 = 0.5;
const TIME_RATIO: f64 = 0.5;
/// Squared distance beyond which two instants are not similar: one unit of each feature.
const FARTHEST: f64 = FEATURES as f64;
/// Number of previous rows whose commands count.
const REMEMBERED: usize = 4;

const FEATURES: usize = 2 * REMEMBERED + 3;

/// Features of an instant.
type Place = [f64; FEATURES];

/// Values at similar instants.
#[derive(Debug, Clone, Copy)]
pub(super) struct Usual {
    pub(super) mean: f64,
    pub(super) median: f64,
    /// Median magnitude of the deviation, as a standard deviation.
    pub(super) scatter: f64,
    /// Whether all of them are similar enough.
    pub(super) is_near: bool,
}

/// Returns for each row of `asked` the `values` at the most similar instants of `known`; none where there are too few.
pub(super) fn usual(
    log: &Log,
    values: &[f64],
    known: &[usize],
    asked: &[usize],
) -> Vec<Option<Usual>> {
    let places = places(log);
    let stride = known.len().div_ceil(COMPARED).max(1);
    let known: Vec<usize> = known.iter().copied().step_by(stride).collect();
    let times_s = &log.commands.times_s;
    asked
        .par_iter()
        .map(|&row| {
            let mut nearest: Vec<(f64, f64)> = known
                .iter()
                .filter(|&&other| (times_s[other] - times_s[row]).abs() > APART_S)
                .map(|&other| (distance(&places[row], &places[other]), values[other]))
                .collect();
            if nearest.len() < 2 * LIKE {
                return None;
            }
            nearest.select_nth_unstable_by(LIKE - 1, |a, b| a.0.total_cmp(&b.0));
            let is_near = nearest[LIKE - 1].0 < FARTHEST;
            let mut like: Vec<f64> = nearest[..LIKE].iter().map(|(_, value)| *value).collect();
            let mean = like.iter().sum::<f64>() / LIKE as f64;
            let middle = median(&mut like)?;
            let mut deviations: Vec<f64> =
                like.iter().map(|value| (value - middle).abs()).collect();
            // A normal magnitude has its median at 0.6745 standard deviations.
            let scatter = median(&mut deviations)? / 0.6745;
            Some(Usual {
                mean,
                median: middle,
                scatter,
                is_near,
            })
        })
        .collect()
}

fn distance(a: &Place, b: &Place) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum()
}

/// Subtracts from `values` at `rows` the part that a smooth law of commands, pressure and time since the valves moved explains.
pub(super) fn without_smooth_law(log: &Log, rows: &[usize], values: &mut [f64], weights: &[f64]) {
    let places = places(log);
    let basis: Vec<[f64; 8]> = rows
        .iter()
        .map(|&row| {
            let place = &places[row];
            let pressure = place[FEATURES - 1];
            let [duty_fill, duty_vent] = [place[0], place[REMEMBERED]];
            let [since_fill, since_vent] = [place[2 * REMEMBERED], place[2 * REMEMBERED + 1]];
            [
                1.0,
                pressure,
                pressure.powi(2),
                pressure.powi(3),
                duty_fill,
                duty_vent,
                since_fill,
                since_vent,
            ]
        })
        .collect();
    let mut normal = SMatrix::<f64, 8, 8>::identity() * 1e-9;
    let mut right = SVector::<f64, 8>::zeros();
    for ((basis, value), weight) in basis.iter().zip(values.iter()).zip(weights) {
        let basis = SVector::from(*basis);
        normal += basis * basis.transpose() * *weight;
        right += basis * (weight * value);
    }
    let Some(cholesky) = normal.cholesky() else {
        return;
    };
    let law = cholesky.solve(&right);
    for (value, basis) in values.iter_mut().zip(&basis) {
        *value -= law.dot(&SVector::from(*basis));
    }
}

fn places(log: &Log) -> Vec<Place> {
    let commands = &log.commands;
    let in_force = in_force(commands);
    let pressures = log.pressure().map_or(&[][..], |channel| &channel.values);
    let mut moved_s = [f64::NEG_INFINITY; 2];
    let mut pressure = 0.0;
    (0..commands.len())
        .map(|row| {
            let mut place = [0.0; FEATURES];
            for valve in [FILL, VENT] {
                if in_force[row].is_some_and(|row| commands.opens(valve, row)) {
                    moved_s[valve] = commands.times_s[row];
                }
                for back in 0..REMEMBERED {
                    let commanded = in_force[row.saturating_sub(back)];
                    let duty = commanded.map_or(0.0, |row| commands.duty_pct[valve][row]);
                    place[valve * REMEMBERED + back] = duty / DUTY_PCT;
                }
                let since_s = (commands.times_s[row] - moved_s[valve]).min(60.0);
                place[2 * REMEMBERED + valve] = (since_s + 0.02).ln() / TIME_RATIO;
            }
            // The row's own reading would hide its error.
            if let Some(before) = row.checked_sub(1).and_then(|row| pressures.get(row)) {
                pressure = if before.is_finite() {
                    *before
                } else {
                    pressure
                };
            }
            place[FEATURES - 1] = pressure / PRESSURE_BAR;
            place
        })
        .collect()
}
