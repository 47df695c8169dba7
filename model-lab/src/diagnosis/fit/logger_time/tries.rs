//! Evaluation of clocks and delays with the model.
//!
//! A part of a log determines phase and delay as well as the whole log. Therefore most clocks and delays are evaluated on the beginning of
//! the log alone, where a drift has no effect yet, and only the best of them on the whole log.

use plant_sim::PlantParameters;
use plant_sim::logger_clock::LoggerClock;
use rayon::prelude::*;

use crate::diagnosis::evidence::log::Log;
use crate::result::Horizon;

/// Length (s) of the beginning: a drift of 100 ppm moves its end by 1.5 ms.
const BEGINNING_S: f64 = 15.0;
/// Number of changes of the commands up to which the beginning is extended.
const CHANGES: usize = 30;
/// Number of candidates, the best at the beginning, that are compared with the whole log.
const PROMISING: usize = 3;
/// Error in noise floors above which the loss is linear instead of quadratic.
pub(super) const OUTLIER: f64 = 3.0;

/// Delays around the best one, in steps.
const BETWEEN: [f64; 6] = [-0.75, -0.5, -0.25, 0.25, 0.5, 0.75];

/// Clock with a delay of the commands, and their loss.
#[derive(Debug, Clone, Copy)]
pub(super) struct Tried {
    pub(super) clock: Option<LoggerClock>,
    pub(super) delay_s: f64,
    pub(super) loss: f64,
}

/// Best clock with its delay: loss at the beginning, and over the whole log.
#[derive(Debug, Clone, Copy)]
pub(super) struct Found {
    pub(super) begun_loss: f64,
    pub(super) whole: Tried,
}

/// Log on which clocks and delays are evaluated.
pub(super) struct Tries<'a> {
    plant: &'a PlantParameters,
    log: &'a Log,
    beginning: Option<Log>,
}

impl<'a> Tries<'a> {
    pub(super) fn on(plant: &'a PlantParameters, log: &'a Log) -> Self {
        Self {
            plant,
            log,
            beginning: log.beginning(BEGINNING_S, CHANGES, plant),
        }
    }

    /// Returns the beginning of the log; all of a short one.
    pub(super) fn beginning(&self) -> &Log {
        self.beginning.as_ref().unwrap_or(self.log)
    }

    /// Returns the losses at the beginning of each of `clocks` with each delay of `delays_s`, the smallest first.
    pub(super) fn begun(&self, clocks: &[Option<LoggerClock>], delays_s: &[f64]) -> Vec<Tried> {
        ranked(self.plant, self.beginning(), pairs(clocks, delays_s))
    }

    /// Returns the best of `clocks`, each with the delay of `delays_s` that has the smallest loss.
    pub(super) fn best(&self, clocks: &[Option<LoggerClock>], delays_s: &[f64]) -> Found {
        let begun = self.begun(clocks, delays_s);
        let promising = begun.iter().take(PROMISING);
        let promising = promising.map(|tried| (tried.clock, tried.delay_s));
        self.found(&begun, promising.collect())
    }

    /// Returns the best delay of `delays_s`, which are `step_s` apart, or between them, for rows that are samples of the ECU.
    pub(super) fn best_delay(&self, delays_s: &[f64], step_s: f64) -> Found {
        let coarse = self.best(&[None], delays_s);
        if delays_s.len() < 2 {
            return coarse;
        }
        let between_s = BETWEEN.map(|share| coarse.whole.delay_s + share * step_s);
        let between_s: Vec<f64> = between_s.into_iter().filter(|&s| s >= 0.0).collect();
        let fine = self.best(&[None], &between_s);
        match fine.whole.loss < coarse.whole.loss {
            true => fine,
            false => coarse,
        }
    }

    /// Returns the best clock with one of these phases at the beginning of the log, a delay of `delays_s` and a drift of `drifts_ppm`; none
    /// if the smallest loss at the beginning is above `most`.
    pub(super) fn best_drifting(
        &self,
        phases_s: &[f64],
        delays_s: &[f64],
        drifts_ppm: &[f64],
        most: f64,
    ) -> Option<Found> {
        let middle_s = self.beginning().middle_s();
        let clock = |phase_s, drift_ppm| LoggerClock::with_phase_at(middle_s, phase_s, drift_ppm);
        let clocks: Vec<_> = phases_s
            .iter()
            .map(|&phase_s| Some(clock(phase_s, 0.0)))
            .collect();
        let begun = self.begun(&clocks, delays_s);
        if begun[0].loss > most {
            return None;
        }
        let promising = begun.iter().take(PROMISING).flat_map(|tried| {
            let drifting = |&drift_ppm| tried.clock.map(|still| clock(still.phase_s, drift_ppm));
            drifts_ppm
                .iter()
                .map(move |drift_ppm| (drifting(drift_ppm), tried.delay_s))
        });
        Some(self.found(&begun, promising.collect()))
    }

    fn found(&self, begun: &[Tried], promising: Vec<(Option<LoggerClock>, f64)>) -> Found {
        Found {
            begun_loss: begun[0].loss,
            whole: ranked(self.plant, self.log, promising)[0],
        }
    }
}

/// Returns each clock with each delay.
fn pairs(clocks: &[Option<LoggerClock>], delays_s: &[f64]) -> Vec<(Option<LoggerClock>, f64)> {
    let with_delays = |&clock| delays_s.iter().map(move |&delay_s| (clock, delay_s));
    clocks.iter().flat_map(with_delays).collect()
}

/// Returns the losses of clocks with delays on `log`, the smallest first.
fn ranked(
    plant: &PlantParameters,
    log: &Log,
    pairs: Vec<(Option<LoggerClock>, f64)>,
) -> Vec<Tried> {
    let tried = pairs.into_par_iter().map(|(clock, delay_s)| Tried {
        clock,
        delay_s,
        loss: loss(plant, log, clock, delay_s),
    });
    let mut ranked: Vec<Tried> = tried.collect();
    ranked.sort_by(|a, b| a.loss.total_cmp(&b.loss));
    ranked
}

/// Returns the loss of `clock` with commands delayed by `delay_s`: quadratic for small errors, linear for large ones.
pub(super) fn loss(
    plant: &PlantParameters,
    log: &Log,
    clock: Option<LoggerClock>,
    delay_s: f64,
) -> f64 {
    let mut plant = plant.clone();
    plant.ecu.command_delay_s = delay_s;
    let residuals = log.residuals_assigned(&plant, clock, Horizon::OneStepAhead);
    residuals.map_or(f64::INFINITY, |residuals| {
        residuals
            .iter()
            .map(|residual| residual * residual / (1.0 + residual.abs() / OUTLIER))
            .sum()
    })
}
