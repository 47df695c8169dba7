//! Rounds of fit and assignment: each fit uses a robust loss, and reassigns the commands to the samples of the ECU.
//!
//! A first plant file assigns some commands to wrong samples, and wrong commands distort the fit. Therefore both alternate.

use plant_sim::PlantParameters;

use super::unknowns_of;
use crate::conditions::Conditions;
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::errors::Errors;
use crate::diagnosis::evidence::log::Log;
use crate::diagnosis::evidence::unknowns::{Unknown, Unknowns};
use crate::diagnosis::fit::logger_time::{
    Delay, Search, centre_slow_clocks, choose_clocks_again, find_clock, find_slow_clocks,
};
use crate::diagnosis::fit::split::Split;
use crate::diagnosis::fit::{Descent, Fit, Fitter, Loss};
use crate::diagnosis::search::{Watch, report, report_error};
use crate::result::Horizon;

/// Residual in noise floors above which the robust loss is linear.
pub(super) const OUTLIER: f64 = 3.0;
/// Difference steps over the usual ones: a first plant file is farther from the fit than tolerances of parts.
const COARSE: f64 = 0.5;
/// Number of rounds, and the largest number where several samples of the ECU may lie between two rows.
pub(super) const ROUNDS: usize = 2;
pub(super) const ROUNDS_OF_SLOW_LOGS: usize = 12;
/// Number of consecutive rounds without success after which the rounds end; ...
const ROUNDS_IN_VAIN: usize = 2;
/// ... a round succeeds if it lowers the cost by this share.
const BETTER_ROUND: f64 = 0.02;

/// Unknowns of a fit, and the coordinates at which it begins.
pub(super) struct Start {
    pub(super) unknowns: Unknowns,
    pub(super) z: Vec<f64>,
}

impl Start {
    /// Returns the values of the plant file.
    pub(super) fn of(unknowns: Unknowns) -> Self {
        let z = unknowns.start();
        Self { unknowns, z }
    }
}

/// Fits from `z` with a robust loss.
pub(super) fn forgiving(
    evidence: &Evidence,
    unknowns: &Unknowns,
    z: Vec<f64>,
    descent: Descent,
) -> Option<Fit> {
    let fitter = forgiving_fitter(evidence, unknowns);
    fitter.descend(fitter.at(z)?, descent)
}

pub(super) fn forgiving_fitter<'a>(evidence: &'a Evidence, unknowns: &'a Unknowns) -> Fitter<'a> {
    let mut fitter = Fitter::new(evidence, unknowns);
    fitter.loss = Loss::Forgiving(OUTLIER);
    fitter.step_scale = COARSE;
    fitter
}

/// Shows `watch` the error of the model at the point `fit`. If it stops the work, the next stage ends it.
pub(super) fn show_error(
    watch: Watch,
    stage: &'static str,
    done: f64,
    evidence: &Evidence,
    fit: &Fit,
) {
    let errors = Errors::new(evidence, &fit.residuals, Horizon::OneStepAhead);
    let _ = report_error(watch, stage, done, Some(&errors));
}

/// Fits from `start` with a robust loss and reassigns the commands, in `rounds` at most; it ends when several consecutive rounds do not lower
/// the cost.
pub(super) fn in_rounds(
    plant: &PlantParameters,
    split: &mut Split,
    mut start: Start,
    rounds: usize,
    watch: Watch,
) -> Result<Start, DiagnoseError> {
    let mut best: Option<Assigned> = None;
    let mut in_vain = 0;
    for round in 0..rounds {
        let done = round as f64 / rounds as f64;
        const STAGE: &str = "estimating, large errors forgiven";
        report(watch, STAGE, done)?;
        let show = |fit: &Fit| show_error(watch, STAGE, done, &split.fitting, fit);
        let Start { unknowns, z } = &start;
        let mut fitter = forgiving_fitter(&split.fitting, unknowns);
        fitter.on_step = Some(&show);
        let fit = fitter
            .at(z.clone())
            .and_then(|start| fitter.descend(start, Descent::Whole));
        let fit = fit.ok_or_else(|| split.not_simulated())?;
        let fitted = Assigned::of(split, unknowns, &fit);
        let is_better = |best: &Assigned| fitted.cost < (1.0 - BETTER_ROUND) * best.cost;
        in_vain = match best.as_ref().is_none_or(is_better) {
            true => 0,
            false => in_vain + 1,
        };
        if best.as_ref().is_none_or(|best| fitted.cost < best.cost) {
            best = Some(fitted);
        }
        if in_vain == ROUNDS_IN_VAIN {
            break;
        }
        start = assigned_anew(plant, split, unknowns, &fit.z);
    }
    // The two rounds of fast logs end with the clocks of the last round.
    if let Some(best) = best.filter(|_| rounds > ROUNDS) {
        start = best.restored(split);
    }
    Ok(start)
}

/// Searches the clocks of slow loggers without prior knowledge, now that the plant is better known, and fits with them; returns to the
/// previous state if the cost is not lower.
pub(super) fn with_clocks_anew(
    plant: &PlantParameters,
    split: &mut Split,
    start: Start,
    watch: Watch,
) -> Result<Start, DiagnoseError> {
    let before = Assigned::at(split, start)?;
    let open = split
        .fitting
        .logs
        .iter_mut()
        .filter(|log| log.is_clock_open());
    open.for_each(|log| log.conditions.clock = None);
    let Start { unknowns, z } = &before.start;
    let begun = with_clocks(plant, split, unknowns, z);
    match before.improved_from(begun, plant, split, ROUNDS_OF_SLOW_LOGS, watch)? {
        Some(anew) => Ok(anew),
        None => Ok(before.restored(split)),
    }
}

/// Chooses again among the clocks that the logged commands admit, now that the plant is better known, and fits with them; returns to the
/// previous state if the cost is not lower.
pub(super) fn with_clocks_chosen_again(
    plant: &PlantParameters,
    split: &mut Split,
    start: Start,
    watch: Watch,
) -> Result<Start, DiagnoseError> {
    let before = Assigned::at(split, start)?;
    let logs = split.fitting.logs.clone();
    let Start { unknowns, z } = &before.start;
    split.fitting.take_conditions(unknowns, z);
    if choose_clocks_again(&unknowns.plant(z), &mut split.fitting) {
        let begun = begun_at(plant, &split.fitting, unknowns, z);
        if let Some(anew) = before.improved_from(begun, plant, split, ROUNDS, watch)? {
            return Ok(anew);
        }
    }
    split.fitting.logs = logs;
    Ok(before.start)
}

/// Assigns the commands of slow logs in pairs with the fitted plant, and fits with them.
pub(super) fn with_commands_settled(
    plant: &PlantParameters,
    split: &mut Split,
    mut start: Start,
) -> Result<Start, DiagnoseError> {
    if !split.fitting.logs.iter().any(Log::is_slow) {
        return Ok(start);
    }
    for _ in 0..ROUNDS {
        let Start { unknowns, z } = start;
        split.fitting.take_conditions(&unknowns, &z);
        let there = unknowns.plant(&z);
        for log in &mut split.fitting.logs {
            log.settle_commands(&there);
        }
        start = begun_at(plant, &split.fitting, &unknowns, &z);
        let fit = forgiving(&split.fitting, &start.unknowns, start.z, Descent::Whole);
        start.z = fit.ok_or_else(|| split.not_simulated())?.z;
    }
    Ok(start)
}

/// Fit with the conditions of the logs.
struct Assigned {
    cost: f64,
    conditions: Vec<Conditions>,
    issued_ns: Vec<Vec<u64>>,
    start: Start,
}

impl Assigned {
    fn of(split: &Split, unknowns: &Unknowns, fit: &Fit) -> Self {
        let logs = split.fitting.logs.iter();
        Self {
            cost: fit.cost,
            conditions: split.fitting.conditions(),
            issued_ns: logs.map(|log| log.issued_ns().to_vec()).collect(),
            start: Start {
                unknowns: unknowns.clone(),
                z: fit.z.clone(),
            },
        }
    }

    /// Returns the state at `start`, with the present conditions of the logs.
    fn at(split: &Split, start: Start) -> Result<Self, DiagnoseError> {
        let there = forgiving_fitter(&split.fitting, &start.unknowns).at(start.z);
        let there = there.ok_or_else(|| split.not_simulated())?;
        Ok(Self::of(split, &start.unknowns, &there))
    }

    /// Returns the fit from `begun` in `rounds`, with other conditions of the logs; none if its cost is not lower.
    fn improved_from(
        &self,
        begun: Start,
        plant: &PlantParameters,
        split: &mut Split,
        rounds: usize,
        watch: Watch,
    ) -> Result<Option<Start>, DiagnoseError> {
        let anew = in_rounds(plant, split, begun, rounds, watch)?;
        let there = forgiving_fitter(&split.fitting, &anew.unknowns).at(anew.z.clone());
        let is_lower = there.is_some_and(|there| there.cost < self.cost);
        Ok(is_lower.then_some(anew))
    }

    fn restored(self, split: &mut Split) -> Start {
        split.fitting.replace_conditions(&self.conditions);
        for (log, issued_ns) in split.fitting.logs.iter_mut().zip(self.issued_ns) {
            log.set_issued_ns(issued_ns);
        }
        self.start
    }
}

/// Sets the clocks of the loggers to the fitted ones, searches those that are not known yet, and assigns the commands by all of them. The
/// coordinates of the logs' conditions begin there.
pub(super) fn assigned_anew(
    plant: &PlantParameters,
    split: &mut Split,
    fitted: &Unknowns,
    z: &[f64],
) -> Start {
    let mut conditions = split.fitting.conditions();
    fitted.conditions(z, &mut conditions);
    split.fitting.set_conditions(&conditions, &fitted.plant(z));
    with_clocks(plant, split, fitted, z)
}

/// Searches clocks that are not known yet with the fitted plant, and those of slow loggers together with the delay.
fn with_clocks(plant: &PlantParameters, split: &mut Split, fitted: &Unknowns, z: &[f64]) -> Start {
    let there = fitted.plant(z);
    let drifts_ppm = split.fitting.drifts_ppm();
    for log in split
        .fitting
        .logs
        .iter_mut()
        .filter(|log| log.conditions.clock.is_none())
    {
        find_clock(&there, log, Delay::AsGiven, &drifts_ppm);
    }
    let delay = fitted.list().iter().find(|unknown| unknown.is_delay());
    let there_s = there.ecu.command_delay_s;
    let delays_s = delay.map_or(there_s..=there_s, |delay| {
        let (least, most) = delay.bounds();
        delay.value(least)..=delay.value(most)
    });
    let delay_s = find_slow_clocks(&there, &mut split.fitting, delays_s.clone(), Search::InTurn);
    let mut with_delay = there;
    with_delay.ecu.command_delay_s = delay_s.unwrap_or(with_delay.ecu.command_delay_s);
    let centred_s = centre_slow_clocks(&with_delay, &mut split.fitting, delays_s);
    let mut next = begun_at(plant, &split.fitting, fitted, z);
    if let Some(delay_s) = centred_s.or(delay_s) {
        begin_at_delay(&mut next, delay_s);
    }
    next
}

/// Returns coordinates that begin at the present conditions of the logs, and at `z` of `fitted` for the rest.
fn begun_at(plant: &PlantParameters, evidence: &Evidence, fitted: &Unknowns, z: &[f64]) -> Start {
    let unknowns = unknowns_of(plant, evidence);
    let is_kept = |unknown: &&Unknown| !matches!(unknown, Unknown::Log(_));
    let of_rest = fitted.list().iter().zip(z);
    let mut of_rest = of_rest
        .filter(|(unknown, _)| is_kept(unknown))
        .map(|(_, &z)| z);
    let mut begun = unknowns.start();
    for (to, _) in begun
        .iter_mut()
        .zip(unknowns.list())
        .filter(|(_, unknown)| is_kept(unknown))
    {
        *to = of_rest.next().unwrap_or(*to);
    }
    Start { unknowns, z: begun }
}

/// Sets the delay of the commands to the value that the logs show best: a step of a fit does not reach beyond a pulse.
pub(super) fn begin_at_delay(start: &mut Start, delay_s: f64) {
    for (unknown, z) in start.unknowns.list().iter().zip(&mut start.z) {
        if unknown.is_delay() {
            let (least, most) = unknown.bounds();
            *z = unknown.coordinate_of(delay_s).clamp(least, most);
        }
    }
}
