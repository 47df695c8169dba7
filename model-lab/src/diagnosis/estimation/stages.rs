//! Stages of the estimation, each with the parameters that its data can determine.
//!
//! Currents come first: they determine the coils, the delay and the clocks of the loggers whatever the rest of the plant is. Then all
//! parameters are fitted with a robust loss, since a first plant file may be 30 % wrong; where more than the noise remains, also from
//! several other starts. Least squares come last, unless they leave more than the noise: then physics is missing, and its errors would
//! distort the parameters, so the robust estimate is kept.

use plant_sim::PlantParameters;
use plant_sim::parameters::Part;
use plant_sim::replay::CurrentSampling;
use rayon::prelude::*;

use super::rounds::{
    OUTLIER, ROUNDS, ROUNDS_OF_SLOW_LOGS, Start, assigned_anew, begin_at_delay, forgiving,
    forgiving_fitter, in_rounds, show_error, with_clocks_anew, with_clocks_chosen_again,
    with_commands_settled,
};
use super::unknowns_of;
use super::weak_directions::{measure_weak_directions, settled};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::errors::Errors;
use crate::diagnosis::evidence::log::Log;
use crate::diagnosis::evidence::unknowns::{Unknown, Unknowns};
use crate::diagnosis::fit::logger_time::{best_delay_s, find_conditions};
use crate::diagnosis::fit::split::Split;
use crate::diagnosis::fit::{Descent, Difference, Fit, Fitter, Loss, Scope};
use crate::diagnosis::search::{Watch, report};
use crate::result::Horizon;

/// Difference steps in the last stage over the usual ones: a parameter may be known to a hundredth of its range.
const FINE: f64 = 0.05;
/// Share of the cost below which a decrease ends the last stage: parameters with little influence on the cost are wanted as well.
const CONVERGED_SHARE: f64 = 1e-6;
/// Distance of the delays from which the coils are fitted (s), and their largest number.
const DELAY_STEP_S: f64 = 1.5e-3;
const DELAYS_MAX: f64 = 16.0;
/// Number of other starts that are begun, ...
const STARTS: usize = 8;
/// ... largest distance of a start from the middle of a parameter's range, over half the range, ...
const START_REACH: f64 = 0.7;
/// ... number of starts that are fitted to the end, ...
const FINISHED: usize = 2;
/// ... and the share of the cost that one has to save to count as another valley.
const BETTER_VALLEY: f64 = 0.01;

/// A few steps from one of several starts, each with a new Jacobian.
const BEGUN: Descent = Descent::Begun {
    renews_below: f64::INFINITY,
};

/// Fit of the ordinary parameters.
pub(super) struct Fitted {
    /// Coordinates of the fit.
    pub(super) unknowns: Unknowns,
    pub(super) fit: Fit,
    /// The same point, simulated accurately, with a Jacobian that keeps undetermined directions undetermined.
    pub(super) sharp: Fit,
    /// Whether a further step gains little, or only the noise is left.
    pub(super) is_converged: bool,
}

/// Whether intervals are measured in directions that the logs leave undetermined, which may take hundreds of simulations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Intervals {
    Always,
    /// Only if the model leaves no more than the noise.
    OfAdequateModel,
}

/// Fits the ordinary parameters of `plant`, the parameters of its effects and the clocks of the loggers.
pub(super) fn fit(
    plant: &PlantParameters,
    split: &mut Split,
    intervals: Intervals,
    watch: Watch,
) -> Result<Fitted, DiagnoseError> {
    let mut start = Start::of(unknowns_of(plant, &split.fitting));
    begin_at_delay(&mut start, best_delay_s(plant, &split.fitting));
    let has_current = split.fitting.logs.iter().any(Log::has_current);
    if has_current {
        report(watch, "estimating the coils from their currents", 0.0)?;
        start.z = fit_coils(split, &start.unknowns, &start.z)?;
    }
    let is_slow = split.fitting.logs.iter().any(Log::is_slow);
    let rounds = if is_slow { ROUNDS_OF_SLOW_LOGS } else { ROUNDS };
    start = in_rounds(plant, split, start, rounds, watch)?;
    if leaves_more_than_noise(split, &start)? {
        if is_slow {
            start = with_clocks_anew(plant, split, start, watch)?;
        } else if !Part::DelayedOutput.is_in(plant) {
            // With a command delay, each clock was tried with every delay.
            start = with_clocks_chosen_again(plant, split, start, watch)?;
        }
    }
    start = with_commands_settled(plant, split, start)?;
    if leaves_more_than_noise(split, &start)? {
        report(watch, "estimating, from other starts", 0.0)?;
        if let Some(other) = from_other_starts(&split.fitting, &start, has_current) {
            start = assigned_anew(plant, split, &start.unknowns, &other.z);
            start = with_commands_settled(plant, split, start)?;
        }
    }
    const LAST: &str = "estimating, least squares";
    report(watch, LAST, 0.0)?;
    let show = |fit: &Fit| show_error(watch, LAST, 0.0, &split.fitting, fit);
    let Start { unknowns, z } = start;
    let mut fitter = Fitter::new(&split.fitting, &unknowns);
    fitter.on_step = Some(&show);
    fitter.step_scale = FINE;
    fitter.converged_share = CONVERGED_SHARE;
    let start = fitter.at(z).ok_or_else(|| split.not_simulated())?;
    let mut kept = fitter.descend(start.clone(), Descent::Whole);
    let is_material = |fit: &Fit| {
        Errors::new(&split.fitting, &fit.residuals, Horizon::OneStepAhead).is_material()
    };
    if kept.as_ref().is_none_or(is_material) {
        fitter.loss = Loss::Forgiving(OUTLIER);
        kept = fitter.descend(start, Descent::Whole);
    }
    let mut kept = kept.ok_or_else(|| split.not_simulated())?;
    report(watch, "intervals", 0.0)?;
    let accurate = Fitter::accurate(&split.fitting, &unknowns);
    let sharp = accurate.at(kept.z.clone()).and_then(|mut sharp| {
        accurate.differentiate(&mut sharp, 0, Difference::Fine)?;
        Some(sharp)
    });
    let mut sharp = sharp.ok_or_else(|| split.not_simulated())?;
    let mut as_fitted = Fitter::accurate(&split.fitting, &unknowns);
    as_fitted.loss = fitter.loss;
    let is_converged = !is_material(&kept) || as_fitted.is_converged(&sharp);
    if intervals == Intervals::Always || !is_material(&kept) {
        measure_weak_directions(&accurate, &mut sharp);
    }
    if !is_material(&kept)
        && let Some(fit) = settled(&accurate, &sharp)
    {
        (kept, sharp) = (fit.clone(), fit);
    }
    split.fitting.take_conditions(&unknowns, &kept.z);
    let drifts_ppm = split.fitting.drifts_ppm();
    find_conditions(&unknowns.plant(&kept.z), &mut split.checking, &drifts_ppm);
    Ok(Fitted {
        unknowns,
        fit: kept,
        sharp,
        is_converged,
    })
}

fn leaves_more_than_noise(split: &Split, start: &Start) -> Result<bool, DiagnoseError> {
    let there = Fitter::new(&split.fitting, &start.unknowns).at(start.z.clone());
    let there = there.ok_or_else(|| split.not_simulated())?;
    Ok(Errors::new(&split.fitting, &there.residuals, Horizon::OneStepAhead).is_material())
}

/// Fits the parameters that the currents determine, from every possible delay: a delay that is two milliseconds wrong is in another valley.
/// If the currents may be either instantaneous values or means, all logs take the choice with the lower cost.
fn fit_coils(split: &mut Split, unknowns: &Unknowns, z: &[f64]) -> Result<Vec<f64>, DiagnoseError> {
    let coils = |evidence: &Evidence, z: Vec<f64>, descent: Descent| {
        let mut fitter = forgiving_fitter(evidence, unknowns);
        fitter.scope = Scope::Coils;
        fitter.descend(fitter.at(z)?, descent)
    };
    let plant = unknowns.plant(z);
    let mut begun = Vec::new();
    for sampling in [CurrentSampling::MeanOfInterval, CurrentSampling::Instant] {
        let is_open = split.take_sampling(&plant, sampling);
        let fits = delays_all_over(unknowns, z).into_par_iter();
        let fits = fits.filter_map(|z| coils(&split.fitting, z, BEGUN));
        let best = fits.min_by(|a, b| a.cost.total_cmp(&b.cost));
        begun.extend(best.map(|fit| (sampling, split.fitting.conditions(), fit)));
        if !is_open {
            break;
        }
    }
    let best = begun
        .into_iter()
        .min_by(|a, b| a.2.cost.total_cmp(&b.2.cost));
    let (sampling, conditions, fit) = best.ok_or_else(|| split.not_simulated())?;
    split.take_sampling(&plant, sampling);
    split.fitting.set_conditions(&conditions, &plant);
    let fit = coils(&split.fitting, fit.z, Descent::Whole);
    Ok(fit.ok_or_else(|| split.not_simulated())?.z)
}

/// Returns copies of the coordinates `z` with delays over the whole possible range.
fn delays_all_over(unknowns: &Unknowns, z: &[f64]) -> Vec<Vec<f64>> {
    let Some(delay) = unknowns.list().iter().position(Unknown::is_delay) else {
        return vec![z.to_vec()];
    };
    let unknown = &unknowns.list()[delay];
    let (least, most) = unknown.bounds();
    let span_s = unknown.value(most) - unknown.value(least);
    let parts = (span_s / DELAY_STEP_S).ceil().clamp(1.0, DELAYS_MAX);
    let place = |part: usize| least + (part as f64 + 0.5) / parts * (most - least);
    let with_delay = |part: usize| {
        let mut z = z.to_vec();
        z[delay] = place(part);
        z
    };
    (0..parts as usize).map(with_delay).collect()
}

/// Returns the best fit from starts over the whole ranges of the parameters, if it is another valley than that of `start`. Parameters that
/// currents determine stay unchanged with `show_coils`.
fn from_other_starts(evidence: &Evidence, start: &Start, show_coils: bool) -> Option<Fit> {
    let Start { unknowns, z } = start;
    let here = forgiving_fitter(evidence, unknowns).at(z.to_vec())?;
    let starts = (1..=STARTS).into_par_iter();
    let begun = starts.filter_map(|n| {
        let start = all_over(unknowns, z, show_coils, n);
        forgiving(evidence, unknowns, start, BEGUN)
    });
    let mut begun: Vec<Fit> = begun.collect();
    begun.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    begun.truncate(FINISHED);
    let finished = begun.into_par_iter();
    let finished = finished.filter_map(|fit| forgiving(evidence, unknowns, fit.z, Descent::Whole));
    let best = finished.min_by(|a, b| a.cost.total_cmp(&b.cost));
    best.filter(|fit| fit.cost < (1.0 - BETTER_VALLEY) * here.cost)
}

/// Returns the point `number` of a sequence that is uniform over the ranges of the ordinary parameters; the rest as in `z`.
fn all_over(unknowns: &Unknowns, z: &[f64], show_coils: bool, number: usize) -> Vec<f64> {
    let mut z = z.to_vec();
    let list = unknowns.list().iter().enumerate();
    let moved = list.filter(|(_, unknown)| {
        matches!(unknown, Unknown::Nuisance(_)) && !(show_coils && unknown.is_shown_by_currents())
    });
    for (dimension, (n, unknown)) in moved.enumerate() {
        let (least, most) = unknown.bounds();
        let share = START_REACH * (2.0 * additive_recurrence(dimension, number) - 1.0);
        z[n] = 0.5 * (least + most) + 0.5 * share * (most - least);
    }
    z
}

/// Returns element `number` of a low-discrepancy sequence in [0, 1): multiples of the square root of a prime, one prime for each dimension.
///
/// H. Niederreiter, Random Number Generation and Quasi-Monte Carlo Methods, SIAM (1992), chapter 3.
fn additive_recurrence(dimension: usize, number: usize) -> f64 {
    const PRIMES: [f64; 16] = [
        2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0, 23.0, 29.0, 31.0, 37.0, 41.0, 43.0, 47.0, 53.0,
    ];
    (number as f64 * PRIMES[dimension % PRIMES.len()].sqrt()).fract()
}
