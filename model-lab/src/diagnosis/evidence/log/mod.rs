//! Log as the diagnosis uses it: inputs of the model and the signals to explain.

mod assignment;
mod part;

use std::sync::Arc;

use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::Part;
use plant_sim::replay::{
    ACTUATOR_POSITION, CurrentSampling, ROW_SIGNALS, Replay, ReplayInput, Row, SUPPLY_VOLTAGE,
    Surroundings,
};
use plant_sim::{PlantParameters, Tolerance};
use recording::{Recording, own_rows};

use super::predictor::Predictor;
use super::read_log::Read;
use super::sensor_noise::SensorNoise;
use crate::commands::Commands;
use crate::conditions::{Conditions, LogConditions, StartGas, UsualGas};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::verdict::MODEL_ERROR;
use crate::log_start::LogStart;
use crate::measured::{
    GAS_TEMPERATURE, Measured, PRESSURE, Restart, is_current, is_fitted_signal, start,
};
use crate::metrics::picked;
use crate::result::{
    ClockSource, FoundClock, FoundStart, Horizon, LogDefects, NotCompared, Warning,
};

/// Interval of its samples (s) below which a current is an instantaneous value; with a longer one it may be a mean.
const SCOPE_INTERVAL_S: f64 = 2e-4;
/// Interval of the commands, in samples of the ECU, above which the sample at which a command was given is undetermined.
const SLOWER: f64 = 0.75;

/// Conditions of a log with the instants at which its commands were given.
#[derive(Clone, Copy)]
pub(crate) struct Timing<'a> {
    pub(crate) conditions: &'a Conditions,
    /// Instant of the command of each row (ns of the ECU); empty where the rows are in the time of the ECU.
    pub(crate) issued_ns: &'a [u64],
}

/// Simulation of a log.
#[derive(Clone, Copy)]
pub(crate) struct Simulation {
    pub(crate) horizon: Horizon,
    pub(crate) tolerance: Tolerance,
}

impl Simulation {
    /// Returns the simulation for this horizon with the usual tolerance.
    fn to(horizon: Horizon) -> Self {
        Self {
            horizon,
            tolerance: Tolerance::default(),
        }
    }
}

/// Log that is prepared for repeated simulation.
#[derive(Clone)]
pub(crate) struct Log {
    pub(crate) source: String,
    pub(crate) commands: Commands,
    inputs: Vec<ReplayInput>,
    /// Sample time of the ECU (s).
    pub(crate) sample_time_s: f64,
    /// Median time from row to row, and from one row that shows the commands to the next (s).
    pub(crate) interval_s: f64,
    pub(crate) command_interval_s: f64,
    /// Median time from sample to sample of the currents (s).
    current_interval_s: f64,
    pub(crate) sampling: CurrentSampling,
    /// Whether several samples of a current show each PWM period.
    resolves_pwm: bool,
    /// Whether a duty cycle commands a valve of the plant.
    is_commanded: bool,
    pub(crate) conditions: Conditions,
    pub(crate) known_clock: KnownClock,
    /// Instant (ns, ECU time) at which the command of each row was given; empty without a clock.
    issued_ns: Vec<u64>,
    /// Surroundings measured with the log.
    surroundings: Surroundings,
    /// State of the model at the first row and after gaps.
    start: LogStart,
    pub(crate) predictor: Predictor,
    pub(crate) channels: Vec<Channel>,
    /// Signals of the diagnosis that are excluded, and the reasons.
    pub(crate) not_compared: Vec<NotCompared>,
    /// Gaps and missing cells.
    pub(crate) defects: LogDefects,
    /// Properties of the log that probably differ from their declaration.
    pub(crate) warnings: Vec<Warning>,
    /// Rows that count.
    pub(crate) counted: Vec<bool>,
    /// Whether the supply was shut off: assumed where the log does not show it and it explains the currents better.
    pub(crate) is_without_supply: bool,
}

/// Prior knowledge of a logger's clock from the rows of the logged commands.
#[derive(Debug, Clone, Copy)]
pub(crate) enum KnownClock {
    Nothing,
    /// Phase of the clock in the middle of the log.
    Middle(KnownPhase),
    /// Phases of the clock at the first and the last change of a command. A drift moves one against the other, so that the range of both
    /// together applies to each.
    Ends([KnownPhase; 2]),
}

/// Prior knowledge of a phase.
#[derive(Debug, Clone, Copy)]
pub(crate) struct KnownPhase {
    /// Time since the first row of the log (s).
    pub(crate) at_s: f64,
    /// Phase there (s) with its standard deviation.
    pub(crate) value_s: f64,
    pub(crate) sd_s: f64,
    /// Largest distance of a fitted phase from the known one (s).
    pub(crate) reach_s: f64,
}

/// Signal of a log.
#[derive(Clone)]
pub(crate) struct Channel {
    pub(crate) signal: &'static str,
    /// Index in a row of the model.
    pub(crate) column: usize,
    /// Values in the unit of the model; NaN where missing.
    pub(crate) values: Arc<Vec<f64>>,
    /// Whether it was sampled at a lower rate than the rows.
    pub(crate) has_own_rate: bool,
    /// Standard deviation of the measurement noise, or where that is less, the error that a correct model may have: a better sensor does
    /// not make the model better.
    pub(crate) sigma: f64,
}

/// Errors of a model over those of a perfect model, (measured - modelled) / floor; 0 where the measurement is missing or does not count.
/// Channel after channel in the order of [`Evidence::channels`].
pub(crate) type Residuals = Vec<f64>;

impl Log {
    pub(crate) fn new(
        parameters: &PlantParameters,
        log: &Recording,
        read: Read,
        noise: &SensorNoise,
    ) -> Result<Self, DiagnoseError> {
        let Read {
            commands,
            inputs,
            interval_s,
            command_interval_s,
            current_interval_s,
            measured,
            mut not_compared,
            warnings,
            surroundings,
        } = read;
        let parameters = &*surroundings.around(parameters);
        let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
        let first_command = inputs.first().and_then(|input| input.command);
        let (_, level) = start(parameters, pressure, &commands);
        let supply_pressure = inputs.iter().find_map(|input| input.supply_pressure);
        let start =
            LogStart::at(parameters, pressure, level, first_command).supplied(supply_pressure);
        let defects = LogDefects::of(log, &commands, &measured);
        let sigma = |signal: &Measured| {
            let known = noise.of(signal.name, &signal.floor, signal.interval_s);
            known.unwrap_or_else(|| scatter_or_resolution(signal))
        };
        let sigmas: Vec<f64> = measured.iter().map(sigma).collect();
        let (fitted, still): (Vec<_>, Vec<_>) = measured
            .into_iter()
            .zip(sigmas)
            .filter(|(signal, _)| is_fitted_signal(parameters, signal.name))
            .partition(|(_, sigma)| *sigma > 0.0);
        not_compared.extend(
            still
                .into_iter()
                .map(|(signal, _)| without_noise(signal.name)),
        );
        let channels: Vec<Channel> = fitted
            .into_iter()
            .map(|(signal, sigma)| {
                let column = ROW_SIGNALS
                    .iter()
                    .position(|(name, _)| *name == signal.name)
                    .expect("measured signals are of the model");
                let model_error = MODEL_ERROR * full_scale(parameters, signal.name);
                let model_error = model_error.max(log.need(signal.name));
                Channel {
                    signal: signal.name,
                    column,
                    sigma: sigma.max(model_error),
                    has_own_rate: own_rows(&signal.values).is_some(),
                    values: signal.values,
                }
            })
            .collect();
        if channels.is_empty() {
            return Err(DiagnoseError::NothingToFit {
                log: log.provenance().source.clone(),
            });
        }
        let samples = commands.len();
        let usual_sampling = CurrentSampling::of_interval(current_interval_s, parameters);
        let mut log = Self {
            source: log.provenance().source.clone(),
            commands,
            inputs,
            is_commanded: Part::Commanded.is_in(parameters),
            sampling: usual_sampling,
            resolves_pwm: usual_sampling == CurrentSampling::Instant,
            conditions: Conditions {
                clock: None,
                start_gas: StartGas {
                    excess_k: 0.0,
                    cooling_s: start.usual_gas.usual_s,
                },
                pwm_lead_ns: 0,
            },
            known_clock: KnownClock::Nothing,
            issued_ns: Vec::new(),
            sample_time_s: parameters.ecu.sample_time_s,
            interval_s,
            command_interval_s,
            current_interval_s,
            surroundings,
            start,
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

    /// Returns the instant (ns, ECU time) at which the command of each row was given; empty without a clock.
    pub(crate) fn issued_ns(&self) -> &[u64] {
        &self.issued_ns
    }

    pub(crate) fn inputs(&self) -> &[ReplayInput] {
        &self.inputs
    }

    /// Returns the time of a row since the first one (ns), by the clock of the logger.
    fn log_ns(&self, row: usize) -> u64 {
        (self.commands.times_s[row] * 1e9).round() as u64
    }

    /// Returns the residuals of `parameters` with `clock`, by which the commands are reassigned.
    pub(crate) fn residuals_assigned(
        &self,
        parameters: &PlantParameters,
        clock: Option<LoggerClock>,
        horizon: Horizon,
    ) -> Option<Residuals> {
        let issued_ns = clock.map(|clock| self.issued_by(clock, parameters));
        let conditions = Conditions {
            clock,
            ..self.conditions
        };
        let issued_ns = issued_ns.as_deref().unwrap_or_default();
        let mut residuals = Residuals::new();
        let timing = Timing {
            conditions: &conditions,
            issued_ns,
        };
        self.residuals_into(parameters, timing, Simulation::to(horizon), &mut residuals)?;
        Some(residuals)
    }

    /// Returns the found conditions under which the log was made.
    pub(crate) fn found(&self) -> LogConditions {
        LogConditions {
            conditions: self.conditions,
            clock_source: match self.is_clock_from_commands() {
                true => ClockSource::Commands,
                false => ClockSource::Model,
            },
            admitted_drifts_ppm: None,
            begins_filled: self.begins_filled(),
            issued_ns: match self.is_slow() {
                true => self.shown_and_issued_ns(self.issued_ns.len()),
                // The clock does not show when the first command was given.
                false => self.shown_and_issued_ns(1),
            },
            interval_ns: (self.command_interval_s * 1e9) as u64,
            sample_time_ns: (self.sample_time_s * 1e9).round() as u64,
            sampling: Some(self.sampling),
        }
    }

    /// Returns the clock of the logger, and the meaning of the currents where the log leaves it open.
    pub(crate) fn found_clock(&self) -> Option<FoundClock> {
        let mut clock = self.found().clock(&self.source)?;
        if self.is_sampling_open() {
            clock.statement += match self.sampling {
                CurrentSampling::MeanOfInterval => {
                    "; currents are taken for means since the row before"
                }
                CurrentSampling::Instant => "; currents are taken for values of the instant",
            };
        }
        Some(clock)
    }

    pub(crate) fn found_start(&self) -> Option<FoundStart> {
        self.found().start(&self.source)
    }

    /// Returns the time from the first row to the last (s).
    pub(crate) fn duration_s(&self) -> f64 {
        self.commands.times_s.last().copied().unwrap_or(0.0)
    }

    /// Returns whether the commands determine the clock without the model.
    pub(crate) fn is_clock_from_commands(&self) -> bool {
        matches!(self.known_clock, KnownClock::Ends(_))
    }

    /// Returns whether only a model can determine the clock of the logger: the log has commands, and they do not determine it.
    pub(crate) fn is_clock_open(&self) -> bool {
        self.is_commanded && !self.is_clock_from_commands() && self.duration_s() > self.interval_s
    }

    /// Returns whether it begins with a filled chamber, whose gas may still be warm.
    pub(crate) fn begins_filled(&self) -> bool {
        self.start.is_filled && self.pressure().is_some()
    }

    /// Returns the prior knowledge of the gas with which it begins.
    pub(crate) fn usual_gas(&self) -> UsualGas {
        self.start.usual_gas
    }

    /// Returns whether its supply pressure was logged and drives the model.
    pub(crate) fn drives_supply(&self) -> bool {
        self.start.supply_pressure.is_some()
    }

    /// Returns the logged values of an input that drives an effect.
    pub(crate) fn driving_values(&self, signal: &str) -> Vec<f64> {
        let value = |input: &ReplayInput| match signal {
            ACTUATOR_POSITION => input.actuator_position,
            SUPPLY_VOLTAGE => input.supply_voltage_v,
            _ => None,
        };
        self.inputs.iter().filter_map(value).collect()
    }

    /// Returns whether its rows do not determine the sample of the ECU at which a command was given.
    pub(crate) fn is_slow(&self) -> bool {
        self.command_interval_s > SLOWER * self.sample_time_s
    }

    /// Returns the middle of the log since its first row (s): there a phase does not depend on the drift.
    pub(crate) fn middle_s(&self) -> f64 {
        0.5 * self.duration_s()
    }

    /// Returns the number of samples of all channels that count.
    pub(crate) fn counted_samples(&self) -> usize {
        let counts = |channel: &Channel| {
            let samples = channel.values.iter().zip(&self.counted);
            samples
                .filter(|(value, counted)| **counted && !value.is_nan())
                .count()
        };
        self.channels.iter().map(counts).sum()
    }

    /// Returns whether its currents may be either means since the row before or instantaneous values: the logger is between an ECU, which
    /// averages, and an oscilloscope, which does not.
    pub(crate) fn is_sampling_open(&self) -> bool {
        self.has_current() && self.current_interval_s >= SCOPE_INTERVAL_S && self.resolves_pwm
    }

    pub(crate) fn has_current(&self) -> bool {
        self.channels
            .iter()
            .any(|channel| is_current(channel.signal))
    }

    pub(crate) fn is_commanded(&self) -> bool {
        self.is_commanded
    }

    pub(crate) fn pressure(&self) -> Option<&Channel> {
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
        let timing = Timing {
            conditions: &Conditions::default(),
            issued_ns: &[],
        };
        self.run(
            parameters,
            timing,
            Simulation::to(Horizon::FreeRun),
            |row, values| {
                let span_s = self.commands.times_s[row] - last_s;
                let periods = (span_s * parameters.ecu.pwm_frequency_hz).max(1.0);
                largest = largest.max((values[column] - last).abs() / periods);
                // After a gap the model restarts elsewhere: that is no change.
                last = match Restart::at(&self.start.restarts, row) {
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
            (self.start.pressure.is_some(), &self.start.restarts),
        );
    }

    /// Runs the model; `row` receives index, values and simulator. None if the simulation was aborted.
    fn run(
        &self,
        parameters: &PlantParameters,
        timing: Timing<'_>,
        simulation: Simulation,
        mut see: impl FnMut(usize, &Row),
    ) -> Option<()> {
        let without_supply;
        let parameters = if self.is_without_supply {
            without_supply = shut_off(parameters);
            &without_supply
        } else {
            parameters
        };
        let Simulation { horizon, tolerance } = simulation;
        let mut replay = self.begin(parameters, timing.conditions, tolerance);
        for index in 0..self.inputs.len() {
            let row = self.step(&mut replay, index, timing, horizon)?;
            see(index, &row);
        }
        Some(())
    }

    fn begin(
        &self,
        parameters: &PlantParameters,
        conditions: &Conditions,
        tolerance: Tolerance,
    ) -> Replay {
        let around = self.surroundings.around(parameters);
        self.start
            .begin(&around, conditions, self.sampling, tolerance)
    }

    /// Returns the input of row `index` in the time of the ECU, whose command was given at an instant of the ECU if the logger has its own
    /// clock.
    fn on_ecu_time(&self, index: usize, timing: Timing<'_>) -> ReplayInput {
        let issued_ns = timing.issued_ns.get(index).copied();
        timing
            .conditions
            .on_ecu_time(self.inputs[index], self.log_ns(index), issued_ns)
    }

    /// Advances to row `index`, and corrects the model there; none where the simulation was aborted. The commands were given at instants of
    /// the ECU if the logger has its own clock.
    fn step(
        &self,
        replay: &mut Replay,
        index: usize,
        timing: Timing<'_>,
        horizon: Horizon,
    ) -> Option<Row> {
        let input = self.on_ecu_time(index, timing);
        let time_s = self.commands.times_s[index];
        let warmth = self.start.warmth(replay, timing.conditions, time_s);
        let row = self.start.row(replay, input, warmth)?;
        self.start.restart(replay, index, || {
            (index + 1..self.inputs.len()).map(|row| {
                let pressure = self.pressure().map_or(f64::NAN, |one| one.values[row]);
                (self.on_ecu_time(row, timing), pressure)
            })
        });
        if let Some(channel) = self.pressure().filter(|_| horizon == Horizon::OneStepAhead) {
            let (measured, gain) = (channel.values[index], self.predictor.gains[index]);
            self.start.correct(replay, &row, warmth, measured, gain);
        }
        Some(row)
    }

    /// Returns the rows of the model, corrected by the measured pressure; none where the simulation was aborted.
    pub(crate) fn predicted(&self, parameters: &PlantParameters) -> Option<Vec<Row>> {
        let mut rows = Vec::with_capacity(self.inputs.len());
        let timing = Timing {
            conditions: &self.conditions,
            issued_ns: &self.issued_ns,
        };
        let simulation = Simulation::to(Horizon::OneStepAhead);
        self.run(parameters, timing, simulation, |_, row| rows.push(*row))?;
        Some(rows)
    }

    /// Appends the residuals of `parameters`; none where the simulation was aborted.
    pub(crate) fn residuals_into(
        &self,
        parameters: &PlantParameters,
        timing: Timing<'_>,
        simulation: Simulation,
        all: &mut Residuals,
    ) -> Option<()> {
        let rows = self.inputs.len();
        let begin = all.len();
        all.resize(begin + rows * self.channels.len(), 0.0);
        self.run(parameters, timing, simulation, |index, row| {
            for (n, channel) in self.channels.iter().enumerate() {
                let error = channel.values[index] - row[channel.column];
                if error.is_finite() && self.counted[index] {
                    let floor = self.floor(channel, simulation.horizon, index);
                    all[begin + n * rows + index] = error / floor;
                }
            }
        })
    }

    /// Returns the error of a perfect model at this row, in the unit of the channel.
    pub(crate) fn floor(&self, channel: &Channel, horizon: Horizon, row: usize) -> f64 {
        if channel.signal == PRESSURE && horizon == Horizon::OneStepAhead {
            channel.sigma * self.predictor.floors[row]
        } else {
            channel.sigma
        }
    }
}

/// Returns the pressure of the supply (bar), the temperature of the gas (K) or the current of a coil that stays on (mA); 0 without
/// switching valves.
fn full_scale(parameters: &PlantParameters, signal: &str) -> f64 {
    if !Part::Commanded.is_in(parameters) {
        0.0
    } else if signal == PRESSURE {
        parameters.gas.supply_pressure_bar_gauge
    } else if signal == GAS_TEMPERATURE {
        parameters.gas.temperature_k
    } else {
        parameters.ecu.supply_voltage_v / parameters.coil.resistance_20c_ohm * 1e3
    }
}

/// Returns the exclusion of a signal without noise, for which the error cannot be normalised.
fn without_noise(signal: &str) -> NotCompared {
    NotCompared {
        name: signal.to_owned(),
        reason: "it hardly changes, so that its noise is unknown; log it finer".to_owned(),
    }
}

/// Returns the plant with its supply at ambient pressure.
fn shut_off(parameters: &PlantParameters) -> PlantParameters {
    let mut plant = parameters.clone();
    plant.gas.supply_pressure_bar_gauge = 0.0;
    plant
}

/// Returns the standard deviation of the noise of a signal without a quiet interval. For a coarse signal that is constant most of the time,
/// it is that of the resolution; for one that never changes, 0.
fn scatter_or_resolution(signal: &Measured) -> f64 {
    let scatter = scatter(&signal.values);
    if scatter > 0.0 {
        return scatter;
    }
    let step = signal.floor.summary.quantisation_step;
    step.map_or(0.0, |step| step / 12_f64.sqrt())
}

/// Returns the standard deviation of the noise from second differences, which remove a slow signal. Their median is insensitive to the few
/// samples at a switching valve.
fn scatter(values: &[f64]) -> f64 {
    let own: Option<Vec<f64>> = own_rows(values).map(|rows| picked(values, &rows));
    let mut curvatures: Vec<f64> = own
        .as_deref()
        .unwrap_or(values)
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
mod tests;
