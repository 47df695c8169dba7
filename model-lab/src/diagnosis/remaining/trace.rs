//! Prediction errors of a log as a time series: the pressure that is missing in the model, and the state of the valves.
//!
//! After row k the model is corrected by the share g of its error e, so that an error does not show the whole missing pressure, only the
//! part that was not yet corrected. With the corrections added, the missing pressure is
//!
//! ```text
//! m[k] = e[k] + Σ g[j] e[j] over j < k
//! ```
//!
//! which is exact where the flow does not depend on the chamber pressure (valves shut, choked flow), and approximate elsewhere, since the
//! corrections are small. It contains the measured pressure itself, never differentiated: the missing rate over an interval is the slope of
//! a line through m, and the sensor's noise averages out.

use plant_sim::PlantParameters;
use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::Row;

use crate::commands::Commands;
use crate::diagnosis::evidence::log::{Channel, Log};

/// State of the valves in the interval before a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Regime {
    Shut,
    Filling,
    Venting,
    /// Both valves at once, or the end of a pulse.
    Mixed,
}

impl Regime {
    /// Returns the name for people.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Shut => "both valves shut",
            Self::Filling => "filling",
            Self::Venting => "venting",
            Self::Mixed => "both valves open",
        }
    }
}

/// Time series of the prediction errors of a log with a measured pressure.
pub(super) struct Trace<'a> {
    pub(super) log: &'a Log,
    pub(super) channel: &'a Channel,
    /// Measured minus predicted (bar); NaN where missing.
    pub(super) errors_bar: Vec<f64>,
    /// Errors of a perfect model (bar).
    pub(super) floors_bar: Vec<f64>,
    /// Missing pressure (bar), since the start; NaN where the measurement is missing.
    pub(super) missing_bar: Vec<f64>,
    pub(super) regimes: Vec<Regime>,
    /// Row whose command is in force at each row; none before the first.
    pub(super) in_force: Vec<Option<usize>>,
}

impl<'a> Trace<'a> {
    /// Returns the time series; none where no chamber pressure was logged.
    pub(super) fn new(log: &'a Log, rows: &[Row]) -> Option<Self> {
        let channel = log.pressure()?;
        let errors_bar: Vec<f64> = channel
            .values
            .iter()
            .zip(rows)
            .map(|(measured, row)| measured - row[channel.column])
            .collect();
        let mut taken_on = 0.0;
        let missing_bar = errors_bar
            .iter()
            .zip(&log.predictor.gains)
            .map(|(error, gain)| {
                let missing = error + taken_on;
                if error.is_finite() {
                    taken_on += gain * error;
                }
                missing
            })
            .collect();
        let in_force = in_force(&log.commands);
        Some(Self {
            channel,
            errors_bar,
            floors_bar: log
                .predictor
                .floors
                .iter()
                .map(|floor| channel.sigma * floor)
                .collect(),
            missing_bar,
            regimes: regimes(&log.commands, &in_force),
            in_force,
            log,
        })
    }

    pub(super) fn times_s(&self) -> &[f64] {
        &self.log.commands.times_s
    }

    pub(super) fn len(&self) -> usize {
        self.errors_bar.len()
    }

    /// Returns the duty cycle of a valve in the interval before a row (%).
    pub(super) fn duty_pct(&self, valve: usize, row: usize) -> f64 {
        self.in_force[row].map_or(0.0, |row| self.log.commands.duty_pct[valve][row])
    }

    /// Returns the slope of the missing pressure over some rows (bar/s), with its variance due to the sensor's noise; none for too few
    /// rows.
    pub(super) fn rate(&self, rows: core::ops::Range<usize>) -> Option<(f64, f64)> {
        let points: Vec<(f64, f64)> = rows
            .map(|row| (self.times_s()[row], self.missing_bar[row]))
            .filter(|(_, missing)| missing.is_finite())
            .collect();
        let count = points.len() as f64;
        if count < 2.0 {
            return None;
        }
        let mean_s = points.iter().map(|(time, _)| time).sum::<f64>() / count;
        let spread: f64 = points.iter().map(|(time, _)| (time - mean_s).powi(2)).sum();
        let slope = points
            .iter()
            .map(|(time, missing)| (time - mean_s) * missing)
            .sum::<f64>()
            / spread;
        (spread > 0.0).then(|| (slope, self.channel.sigma.powi(2) / spread))
    }
}

/// Returns the row whose command is in force at each row.
pub(super) fn in_force(commands: &Commands) -> Vec<Option<usize>> {
    commands
        .times_s
        .iter()
        .map(|&time_s| commands.row_in_force(time_s))
        .collect()
}

fn regimes(commands: &Commands, in_force: &[Option<usize>]) -> Vec<Regime> {
    let opens =
        |valve: usize, row: usize| in_force[row].is_some_and(|row| commands.opens(valve, row));
    let mut regimes: Vec<Regime> = (0..commands.len())
        .map(|row| match (opens(FILL, row), opens(VENT, row)) {
            (true, false) => Regime::Filling,
            (false, true) => Regime::Venting,
            _ => Regime::Mixed,
        })
        .collect();
    for hold in commands.holds(0.0) {
        regimes[hold].fill(Regime::Shut);
    }
    regimes
}

/// Returns the rows of the model with `plant`, for each log; none where a simulation was aborted.
pub(super) fn predicted(logs: &[&Log], plant: &PlantParameters) -> Option<Vec<Vec<Row>>> {
    logs.iter().map(|log| log.predicted(plant)).collect()
}
