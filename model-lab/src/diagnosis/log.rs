//! A log as the diagnosis sees it: what drives the model, and what it has to answer.

use std::sync::Arc;

use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::PA_PER_BAR;
use plant_sim::replay::{CurrentSampling, ROW_SIGNALS, Replay, ReplayInput, Row, inputs};
use plant_sim::{PlantParameters, Simulator, Tolerance};
use recording::Recording;

use super::error::DiagnoseError;
use super::predictor::Predictor;
use super::sensor_noise::SensorNoise;
use crate::commands::Commands;
use crate::error::CompareError;
use crate::measured::{Measured, PRESSURE, Restart, measured_signals, start};
use crate::result::{LogDefects, NotCompared, Warning};
use crate::warning::warnings;

/// Signals of a log that the diagnosis weighs; armature positions are the model's own.
pub(super) const SIGNALS: [&str; 3] = [PRESSURE, "i_fill", "i_vent"];
/// A correction leaves at least this pressure (Pa abs).
const LEAST_PRESSURE: f64 = 1e3;

/// A log, ready to be simulated again and again.
pub(crate) struct Log {
    pub(crate) source: String,
    pub(crate) commands: Commands,
    inputs: Vec<ReplayInput>,
    /// Sample time of the ECU (s).
    pub(crate) sample_time_s: f64,
    /// Median time from row to row (s).
    pub(crate) interval_s: f64,
    pub(crate) sampling: CurrentSampling,
    /// Clock of the logger; none where each row is an instant of the ECU's own clock at which it gave the row's command.
    pub(crate) clock: Option<LoggerClock>,
    /// Phase of the clock (s) that the logged commands tell, with its standard deviation: infinite where they do not.
    pub(crate) known_phase_s: (f64, f64),
    /// Of each row, the instant (ns, ECU time) at which its command was given; empty without a clock.
    issued_ns: Vec<u64>,
    /// Chamber pressure to begin with (Pa abs); none starts at rest.
    start_pressure: Option<f64>,
    /// Where the model begins again behind a gap.
    restarts: Vec<Restart>,
    pub(crate) predictor: Predictor,
    pub(crate) channels: Vec<Channel>,
    /// Signals that would have been weighed, and why they are not.
    pub(super) not_compared: Vec<NotCompared>,
    /// Gaps and missing cells.
    pub(super) defects: LogDefects,
    /// What in the log probably is not what it is declared to be.
    pub(super) warnings: Vec<Warning>,
    /// Rows that count.
    pub(crate) counted: Vec<bool>,
    /// Whether the supply was shut off: nothing in the log tells, and it explains the currents better.
    pub(crate) is_without_supply: bool,
}

/// One signal of a log.
pub(crate) struct Channel {
    pub(crate) signal: &'static str,
    /// Where it stands in a row of the model.
    pub(super) column: usize,
    /// In the unit of the model; NaN where missing.
    pub(crate) values: Arc<Vec<f64>>,
    /// Standard deviation of the measurement noise.
    pub(crate) sigma: f64,
}

/// When the rows of a log were taken, in the time of the ECU.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Timing<'a> {
    pub(crate) clock: LoggerClock,
    /// Of each row, the instant (ns, ECU time) at which its command was given.
    pub(crate) issued_ns: &'a [u64],
}

/// Which error of the model is looked at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Run {
    /// Corrected by the measured pressure.
    Predicted,
    /// Driven by the commands alone.
    Free,
}

/// Errors of a model over what a perfect model has, (measured - modelled) / floor; 0 where the measurement is missing
/// or does not count: channel after channel in the order of [`Evidence::channels`].
pub(crate) type Residuals = Vec<f64>;

/// What is read from a log before it is known how its sensors scatter.
pub(super) struct Read {
    commands: Commands,
    inputs: Vec<ReplayInput>,
    interval_s: f64,
    measured: Vec<Measured>,
    not_compared: Vec<NotCompared>,
    warnings: Vec<Warning>,
}

impl Read {
    pub(super) fn of(parameters: &PlantParameters, log: &Recording) -> Result<Self, DiagnoseError> {
        let commands = Commands::new(parameters, log).map_err(CompareError::from)?;
        let (base, mut inputs) = inputs(parameters, log).map_err(CompareError::from)?;
        commands.gaps.shorten(&mut inputs);
        let (measured, mut not_compared) = measured_signals(parameters, (log, base), &commands)?;
        not_compared.retain(|signal| SIGNALS.contains(&signal.name.as_str()));
        Ok(Self {
            warnings: warnings(parameters, log, &commands, &measured),
            interval_s: base.sampling().median_step_s.unwrap_or(f64::INFINITY),
            commands,
            inputs,
            measured,
            not_compared,
        })
    }

    /// Tells how the sensors scatter in this log.
    pub(super) fn tell(&self, noise: &mut SensorNoise) {
        noise.hear(&self.measured, self.interval_s);
    }
}

impl Log {
    pub(super) fn new(
        parameters: &PlantParameters,
        log: &Recording,
        read: Read,
        noise: &SensorNoise,
    ) -> Result<Self, DiagnoseError> {
        let Read {
            commands,
            inputs,
            interval_s,
            measured,
            mut not_compared,
            warnings,
        } = read;
        let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
        let (_, start_pressure) = start(parameters, pressure, &commands);
        let restarts = pressure.map_or_else(Vec::new, |signal| signal.restarts.clone());
        let defects = LogDefects::of(log, &commands, pressure);
        let sigma = |signal: &Measured| {
            let told = noise.of(signal.name, &signal.floor, interval_s);
            told.unwrap_or_else(|| scatter(&signal.values))
        };
        let sigmas: Vec<f64> = measured.iter().map(sigma).collect();
        let (weighed, still): (Vec<_>, Vec<_>) = measured
            .into_iter()
            .zip(sigmas)
            .filter(|(signal, _)| SIGNALS.contains(&signal.name))
            .partition(|(_, sigma)| *sigma > 0.0);
        not_compared.extend(
            still
                .into_iter()
                .map(|(signal, _)| without_noise(signal.name)),
        );
        let channels: Vec<Channel> = weighed
            .into_iter()
            .map(|(signal, sigma)| {
                let column = ROW_SIGNALS
                    .iter()
                    .position(|(name, _)| *name == signal.name)
                    .expect("measured signals are of the model");
                Channel {
                    signal: signal.name,
                    column,
                    sigma,
                    values: signal.values,
                }
            })
            .collect();
        if channels.is_empty() {
            return Err(DiagnoseError::NothingToWeigh {
                log: log.provenance().source.clone(),
            });
        }
        let samples = commands.len();
        let mut log = Self {
            source: log.provenance().source.clone(),
            commands,
            inputs,
            sampling: CurrentSampling::of_interval(interval_s, parameters),
            clock: None,
            known_phase_s: (0.0, f64::INFINITY),
            issued_ns: Vec::new(),
            sample_time_s: parameters.ecu.sample_time_s,
            interval_s,
            start_pressure,
            restarts,
            predictor: Predictor::free_run(samples),
            channels,
            not_compared,
            defects,
            warnings,
            counted: vec![true; samples],
            is_without_supply: false,
        };
        log.find_predictor(parameters);
        Ok(log)
    }

    pub(crate) fn inputs(&self) -> &[ReplayInput] {
        &self.inputs
    }

    /// A row in the time of the ECU, less what was taken out of pauses before it.
    fn on_ecu_time(&self, row: usize, Timing { clock, issued_ns }: Timing) -> ReplayInput {
        let input = self.inputs[row];
        let taken_ns = self.log_ns(row) - input.time_ns;
        let time_ns = clock.ecu_time_ns(self.log_ns(row)).saturating_sub(taken_ns);
        ReplayInput {
            time_ns,
            issued_ns: issued_ns[row].saturating_sub(taken_ns).min(time_ns),
            ..input
        }
    }

    /// Time of a row since the first one (ns), by the clock of the logger.
    fn log_ns(&self, row: usize) -> u64 {
        (self.commands.times_s[row] * 1e9).round() as u64
    }

    /// Takes `clock` for the clock of the logger, and by it assigns the command of each row to a sample of the ECU.
    pub(crate) fn set_clock(&mut self, clock: LoggerClock, parameters: &PlantParameters) {
        self.clock = Some(clock);
        self.issued_ns = self.issued_by(clock, parameters);
    }

    /// Of each row, the instant (ns, ECU time) at which its command was given if the logger has `clock`.
    fn issued_by(&self, clock: LoggerClock, parameters: &PlantParameters) -> Vec<u64> {
        let sample_time_ns = parameters.ecu.sample_time_ns();
        let interval_ns = (self.interval_s * 1e9) as u64;
        (0..self.inputs.len())
            .map(|row| {
                sample_time_ns * clock.ecu_sample(self.log_ns(row), interval_ns, sample_time_ns)
            })
            .collect()
    }

    /// The residuals of `parameters` with `clock`, by which the commands are assigned anew.
    pub(super) fn residuals_assigned(
        &self,
        parameters: &PlantParameters,
        clock: Option<LoggerClock>,
        run: Run,
    ) -> Option<Residuals> {
        let issued_ns = clock.map(|clock| self.issued_by(clock, parameters));
        let timing = clock.zip(issued_ns.as_deref());
        let timing = timing.map(|(clock, issued_ns)| Timing { clock, issued_ns });
        let mut residuals = Residuals::new();
        self.residuals_into(
            parameters,
            timing,
            (run, Tolerance::default()),
            &mut residuals,
        )?;
        Some(residuals)
    }

    /// Time from the first row to the last (s).
    pub(crate) fn duration_s(&self) -> f64 {
        self.commands.times_s.last().copied().unwrap_or(0.0)
    }

    /// The timing by `clock`, with the commands assigned as by the log's own clock.
    pub(crate) fn timing(&self, clock: Option<LoggerClock>) -> Option<Timing<'_>> {
        Some(Timing {
            clock: clock?,
            issued_ns: &self.issued_ns,
        })
    }

    /// Samples of all channels that count.
    pub(crate) fn counted_samples(&self) -> usize {
        let counts = |channel: &Channel| {
            let samples = channel.values.iter().zip(&self.counted);
            samples
                .filter(|(value, counted)| **counted && !value.is_nan())
                .count()
        };
        self.channels.iter().map(counts).sum()
    }

    pub(crate) fn has_current(&self) -> bool {
        self.channels
            .iter()
            .any(|channel| channel.signal != PRESSURE)
    }

    pub(super) fn pressure(&self) -> Option<&Channel> {
        self.channels
            .iter()
            .find(|channel| channel.signal == PRESSURE)
    }

    fn find_predictor(&mut self, parameters: &PlantParameters) {
        let Some(pressure) = self.pressure() else {
            return;
        };
        let sigma = pressure.sigma;
        let mut largest = 0.0_f64;
        let mut last = f64::NAN;
        let column = pressure.column;
        let mut last_s = 0.0;
        self.run(
            parameters,
            None,
            (Run::Free, Tolerance::default()),
            |row, values, _| {
                let span_s = self.commands.times_s[row] - last_s;
                let periods = (span_s * parameters.ecu.pwm_frequency_hz).max(1.0);
                largest = largest.max((values[column] - last).abs() / periods);
                // Behind a gap the model begins elsewhere: that is no change.
                last = match Restart::at(&self.restarts, row) {
                    Some(_) => f64::NAN,
                    None => values[column],
                };
                last_s = self.commands.times_s[row];
            },
        );
        self.predictor = Predictor::new(
            parameters,
            &self.commands,
            &pressure.values,
            sigma,
            largest,
            (self.start_pressure.is_some(), &self.restarts),
        );
    }

    /// Runs the model; `row` sees index, values and simulator. None where the simulation was given up.
    fn run(
        &self,
        parameters: &PlantParameters,
        timing: Option<Timing>,
        (run, tolerance): (Run, Tolerance),
        mut see: impl FnMut(usize, &Row, &mut Simulator),
    ) -> Option<()> {
        let without_supply;
        let parameters = if self.is_without_supply {
            without_supply = shut_off(parameters);
            &without_supply
        } else {
            parameters
        };
        let mut replay = Replay::new(parameters, self.sampling, tolerance);
        if let Some(pressure) = self.start_pressure {
            replay.begin_showing(pressure);
        }
        let pressure = self.pressure().filter(|_| run == Run::Predicted);
        for (index, &input) in self.inputs.iter().enumerate() {
            let row = replay.row(match timing {
                Some(timing) => self.on_ecu_time(index, timing),
                None => input,
            });
            if replay.simulator().is_given_up() {
                return None;
            }
            see(index, &row, replay.simulator());
            if let Some(restart) = Restart::at(&self.restarts, index) {
                replay.begin_showing(restart.pressure);
            }
            if let Some(channel) = pressure {
                let error = channel.values[index] - row[channel.column];
                let gain = self.predictor.gains[index];
                if error.is_finite() && gain > 0.0 {
                    let simulator = replay.simulator();
                    let corrected = simulator.state().pressure + gain * error * PA_PER_BAR;
                    simulator.set_chamber_pressure(corrected.max(LEAST_PRESSURE));
                }
            }
        }
        Some(())
    }

    /// The rows of the model, corrected by the measured pressure; none where the simulation was given up.
    pub(super) fn predicted(&self, parameters: &PlantParameters) -> Option<Vec<Row>> {
        let mut rows = Vec::with_capacity(self.inputs.len());
        let run = (Run::Predicted, Tolerance::default());
        self.run(parameters, self.timing(self.clock), run, |_, row, _| {
            rows.push(*row)
        })?;
        Some(rows)
    }

    /// Appends the residuals of `parameters`; none where the simulation was given up.
    pub(super) fn residuals_into(
        &self,
        parameters: &PlantParameters,
        timing: Option<Timing>,
        (run, tolerance): (Run, Tolerance),
        all: &mut Residuals,
    ) -> Option<()> {
        let rows = self.inputs.len();
        let begin = all.len();
        all.resize(begin + rows * self.channels.len(), 0.0);
        self.run(parameters, timing, (run, tolerance), |index, row, _| {
            for (n, channel) in self.channels.iter().enumerate() {
                let error = channel.values[index] - row[channel.column];
                if error.is_finite() && self.counted[index] {
                    all[begin + n * rows + index] = error / self.floor(channel, run, index);
                }
            }
        })
    }

    /// What a perfect model has there, in the unit of the channel.
    pub(super) fn floor(&self, channel: &Channel, run: Run, row: usize) -> f64 {
        if channel.signal == PRESSURE && run == Run::Predicted {
            channel.sigma * self.predictor.floors[row]
        } else {
            channel.sigma
        }
    }
}

/// A signal that shows no noise by which its error could be weighed.
fn without_noise(signal: &str) -> NotCompared {
    NotCompared {
        name: signal.to_owned(),
        reason: "it hardly changes, so that its noise is unknown; log it finer".to_owned(),
    }
}

/// The plant with its supply at ambient pressure.
fn shut_off(parameters: &PlantParameters) -> PlantParameters {
    let mut plant = parameters.clone();
    plant.gas.supply_pressure_bar_gauge = 0.0;
    plant
}

/// Standard deviation of the noise where no quiet stretch tells it: that of what no slow course can be, the second
/// differences (a median, which the few samples at a switching valve do not move).
fn scatter(values: &[f64]) -> f64 {
    let mut curvatures: Vec<f64> = values
        .windows(3)
        .map(|three| (three[0] - 2.0 * three[1] + three[2]).abs())
        .filter(|curvature| curvature.is_finite())
        .collect();
    if curvatures.is_empty() {
        return 0.0;
    }
    curvatures.sort_by(f64::total_cmp);
    // The median of a normal magnitude is 0.6745 standard deviations; the weights 1, -2, 1 give sqrt(6).
    curvatures[curvatures.len() / 2] / (0.6745 * 6_f64.sqrt())
}

#[cfg(test)]
mod tests {
    use super::super::gather::gather;
    use super::*;
    use crate::bench::{Bench, without_rows};
    use crate::metrics::rms;

    /// Rms of the errors over the noise, of each channel.
    fn errors(log: &Recording, run: Run) -> Vec<f64> {
        let plant = PlantParameters::nominal();
        let evidence = gather(&plant, [log]).unwrap();
        let residuals = evidence.residuals(&plant, run).unwrap();
        let of = |range: core::ops::Range<usize>| {
            let counted: Vec<f64> = residuals[range]
                .iter()
                .copied()
                .filter(|error| *error != 0.0)
                .collect();
            rms(&counted).unwrap()
        };
        evidence.channels().map(|(_, _, range)| of(range)).collect()
    }

    /// A logger that pauses for 0.7 s while a valve is open: what happens meanwhile was an error of the model.
    #[test]
    fn a_pause_of_the_logger_is_no_error_of_the_model() {
        let whole = Bench::default().measure();
        let duty = whole.signal("duty_vent").unwrap().values_or_nan().to_vec();
        let opens = (150..duty.len()).find(|&row| duty[row] > 0.0).unwrap();
        for begin in [opens + 1, opens + 30, opens - 20] {
            let paused = without_rows(&whole, begin..begin + 70);
            for run in [Run::Predicted, Run::Free] {
                for (error, of_whole) in errors(&paused, run).into_iter().zip(errors(&whole, run)) {
                    assert!(
                        error < 1.3 * of_whole,
                        "{begin} {run:?}: {error} {of_whole}"
                    );
                }
            }
        }
    }
}
