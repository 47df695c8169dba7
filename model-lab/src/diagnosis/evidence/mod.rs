//! All logs together: their duration, the residuals of a model, and the computing time.

pub(crate) mod effect_unknown;
pub(crate) mod errors;
pub(crate) mod jumps;
pub(crate) mod log;
pub(crate) mod log_unknown;
pub(crate) mod logged_supply;
pub(crate) mod predictor;
pub(crate) mod read_log;
pub(crate) mod sensor_noise;
pub(crate) mod unknowns;

use core::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::time::Instant;

use plant_sim::replay::CurrentSampling;
use plant_sim::{PlantParameters, Tolerance};

use crate::conditions::Conditions;
use crate::result::Horizon;
use log::{Channel, Log, Residuals, Simulation, Timing};
use unknowns::Unknowns;

/// All logs of one kind: for training or for validation.
pub(crate) struct Evidence {
    pub(crate) logs: Vec<Log>,
    /// Whether it is the held-out part of the training logs, so that their conditions are the fitted ones.
    pub(crate) is_rest_of_fitted: bool,
    /// Simulation whose errors are fitted and judged.
    pub(crate) horizon: Horizon,
    simulations: AtomicUsize,
    computing_ns: AtomicU64,
}

impl Evidence {
    pub(super) fn of(logs: Vec<Log>) -> Self {
        Self {
            logs,
            is_rest_of_fitted: false,
            horizon: Horizon::OneStepAhead,
            simulations: AtomicUsize::new(0),
            computing_ns: AtomicU64::new(0),
        }
    }

    /// Returns the same logs, without the work that was done on them.
    pub(crate) fn copied(&self) -> Self {
        Self {
            is_rest_of_fitted: self.is_rest_of_fitted,
            horizon: self.horizon,
            ..Self::of(self.logs.clone())
        }
    }

    /// Adds the work that was done on `other`.
    pub(crate) fn add_work_of(&self, other: &Self) {
        let simulations = other.simulations.load(Ordering::Relaxed);
        let computing_ns = other.computing_ns.load(Ordering::Relaxed);
        self.simulations.fetch_add(simulations, Ordering::Relaxed);
        self.computing_ns.fetch_add(computing_ns, Ordering::Relaxed);
    }

    pub(crate) fn sources(&self) -> Vec<String> {
        self.logs.iter().map(|log| log.source.clone()).collect()
    }

    /// Returns the logged time of all logs (s).
    pub(crate) fn duration_s(&self) -> f64 {
        self.logs.iter().map(Log::duration_s).sum()
    }

    /// Returns the number of simulations of all logs.
    pub(crate) fn simulations(&self) -> usize {
        self.simulations.load(Ordering::Relaxed)
    }

    /// Returns the computing time of the simulations (s).
    pub(crate) fn computing_s(&self) -> f64 {
        self.computing_ns.load(Ordering::Relaxed) as f64 * 1e-9
    }

    /// Returns the number of samples of all channels that count.
    pub(crate) fn counted_samples(&self) -> f64 {
        let samples = self.logs.iter().map(Log::counted_samples).sum::<usize>();
        samples as f64
    }

    pub(crate) fn has_pressure(&self) -> bool {
        self.logs.iter().any(|log| log.pressure().is_some())
    }

    /// Returns every channel with the range of its residuals.
    pub(crate) fn channels(
        &self,
    ) -> impl Iterator<Item = (&Log, &Channel, core::ops::Range<usize>)> {
        let mut begin = 0;
        self.logs
            .iter()
            .flat_map(|log| log.channels.iter().map(move |channel| (log, channel)))
            .map(move |(log, channel)| {
                let range = begin..begin + channel.values.len();
                begin = range.end;
                (log, channel, range)
            })
    }

    /// Returns the residuals of `parameters`; none where the simulation was aborted.
    pub(crate) fn residuals(
        &self,
        parameters: &PlantParameters,
        horizon: Horizon,
    ) -> Option<Residuals> {
        self.residuals_within(parameters, horizon, Tolerance::default())
    }

    /// Returns the same as [`Self::residuals`], with a given accuracy of the simulation.
    pub(crate) fn residuals_within(
        &self,
        parameters: &PlantParameters,
        horizon: Horizon,
        tolerance: Tolerance,
    ) -> Option<Residuals> {
        self.residuals_on(parameters, &self.conditions(), horizon, tolerance)
    }

    /// Returns the conditions, log after log.
    pub(crate) fn conditions(&self) -> Vec<Conditions> {
        self.logs.iter().map(|log| log.conditions).collect()
    }

    /// Returns the known drifts of the loggers' clocks (ppm).
    pub(crate) fn drifts_ppm(&self) -> Vec<f64> {
        let clocks = self.logs.iter().filter_map(|log| log.conditions.clock);
        clocks.map(|clock| clock.drift_ppm).collect()
    }

    /// Sets these conditions of the logs, and assigns the commands by their clocks.
    pub(crate) fn set_conditions(&mut self, conditions: &[Conditions], plant: &PlantParameters) {
        for (log, conditions) in self.logs.iter_mut().zip(conditions) {
            log.conditions = *conditions;
            if let Some(clock) = conditions.clock {
                log.set_clock(clock, plant);
            }
        }
    }

    /// Sets the conditions of the logs to those at the coordinates `z` of `unknowns`; the assignment of the commands is unchanged.
    pub(crate) fn take_conditions(&mut self, unknowns: &Unknowns, z: &[f64]) {
        let mut conditions = self.conditions();
        unknowns.conditions(z, &mut conditions);
        self.replace_conditions(&conditions);
    }

    /// Sets these conditions of the logs; the assignment of the commands is unchanged.
    pub(crate) fn replace_conditions(&mut self, conditions: &[Conditions]) {
        for (log, conditions) in self.logs.iter_mut().zip(conditions) {
            log.conditions = *conditions;
        }
    }

    /// Shifts the clocks that the commands do not determine by `shift_s`; the assignment of the commands is unchanged.
    pub(crate) fn shift_clocks(&mut self, shift_s: f64) {
        for log in self.logs.iter_mut().filter(|log| log.is_clock_open()) {
            if let Some(clock) = &mut log.conditions.clock {
                clock.phase_s += shift_s;
            }
        }
    }

    /// Sets the current sampling of each log that leaves it open to `sampling`; returns whether there is such a log.
    pub(crate) fn set_open_sampling(&mut self, sampling: CurrentSampling) -> bool {
        let open = self.logs.iter_mut().filter(|log| log.is_sampling_open());
        open.map(|log| log.sampling = sampling).count() > 0
    }

    /// Switches the current sampling of each log that leaves it open; returns whether there is such a log.
    pub(crate) fn take_other_sampling(&mut self) -> bool {
        let open = self.logs.iter().find(|log| log.is_sampling_open());
        let other = match open.map(|log| log.sampling) {
            Some(CurrentSampling::Instant) => CurrentSampling::MeanOfInterval,
            Some(CurrentSampling::MeanOfInterval) => CurrentSampling::Instant,
            None => return false,
        };
        self.set_open_sampling(other)
    }

    /// Returns the same as [`Self::residuals_within`], under these conditions, log after log.
    pub(crate) fn residuals_on(
        &self,
        parameters: &PlantParameters,
        conditions: &[Conditions],
        horizon: Horizon,
        tolerance: Tolerance,
    ) -> Option<Residuals> {
        let begin = Instant::now();
        let mut all = Residuals::new();
        let done = self
            .logs
            .iter()
            .zip(conditions)
            .try_for_each(|(log, conditions)| {
                let timing = Timing {
                    conditions,
                    issued_ns: log.issued_ns(),
                };
                let simulation = Simulation { horizon, tolerance };
                log.residuals_into(parameters, timing, simulation, &mut all)
            });
        self.simulations.fetch_add(1, Ordering::Relaxed);
        let elapsed_ns = begin.elapsed().as_nanos() as u64;
        self.computing_ns.fetch_add(elapsed_ns, Ordering::Relaxed);
        done.map(|()| all)
    }
}
