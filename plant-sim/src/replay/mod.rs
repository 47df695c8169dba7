//! Replay: the model driven by the commands of a measurement, from a duty log to a recording.
//!
//! A row of a log contains data of the ECU at one instant: the duty cycles that it commands from this instant on, and
//! the sensor values sampled at this instant. Coil currents are means over the interval that ends there if rows are
//! slower than the PWM (an ECU log), and values of the instant if they are faster (a scope).
//!
//! Signals of several rates share the rows of [`united`]: a row exists for each instant of any of them.

mod actuator;
mod averaging;
mod error;
mod inputs;
mod mean_current;
mod names;
mod supply;
mod surroundings;

pub use actuator::ACTUATOR_POSITION;
pub use error::ReplayError;
pub use inputs::{
    Inputs, LONGEST_GAP_S, ReplayInput, SUPPLY_VOLTAGE, check_gap, initial_pressure, inputs, united,
};
pub use names::{UnknownSignal, unknown_signals};
pub use supply::{SUPPLY_PRESSURE, drives_supply, supply_bounds};
pub use surroundings::{AMBIENT_PRESSURE, AMBIENT_TEMPERATURE, COIL_TEMPERATURE, Surroundings};

use recording::{Provenance, Recording, Unit};

use crate::ecu_output::Command;
use crate::parameters::{Part, PlantParameters};
use crate::plant::{FILL, VENT};
use crate::regulating_valve::RegulatingValve;
use crate::simulator::{Sample, Simulator, Statistics, Tolerance};
use mean_current::MeanCurrent;

/// Meaning of the coil current of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurrentSampling {
    /// Mean over the interval that ends at the row: an ECU's current measurement.
    MeanOfInterval,
    /// Value at the instant: an oscilloscope.
    Instant,
}

impl CurrentSampling {
    /// Returns the sampling that rows `interval_s` apart can show: a scope resolves the PWM period.
    pub fn of_interval(interval_s: f64, parameters: &PlantParameters) -> Self {
        if interval_s < 0.25 / parameters.ecu.pwm_frequency_hz {
            Self::Instant
        } else {
            Self::MeanOfInterval
        }
    }
}

/// One row of a simulated recording, in the order and the units of [`ROW_SIGNALS`]; NaN for a signal of a part that the
/// plant omits.
pub type Row = [f64; ROW_SIGNALS.len()];

/// Names and units of a simulated row.
pub const ROW_SIGNALS: [(&str, Unit); 10] = [
    ("duty_fill", Unit::Percent),
    ("duty_vent", Unit::Percent),
    ("p_ch", Unit::BarGauge),
    ("i_fill", Unit::Milliampere),
    ("i_vent", Unit::Milliampere),
    ("u_bat", Unit::Volt),
    ("x_fill", Unit::Millimetre),
    ("x_vent", Unit::Millimetre),
    ("x_plunger", Unit::Millimetre),
    ("t_gas", Unit::Kelvin),
];

/// Returns the signals of a plant: those of its parts.
pub fn signals(parameters: &PlantParameters) -> impl Iterator<Item = (&'static str, Unit)> {
    ROW_SIGNALS
        .into_iter()
        .filter(|(name, _)| has_signal(parameters, name))
}

fn has_signal(parameters: &PlantParameters, name: &str) -> bool {
    let [fill, vent] = parameters.functions;
    match name {
        "duty_fill" => fill.is_commanded(),
        "duty_vent" => vent.is_commanded(),
        "i_fill" => fill.has_coil(),
        "i_vent" => vent.has_coil(),
        "x_fill" => fill.has_armature(),
        "x_vent" => vent.has_armature(),
        "u_bat" => Part::Coil.is_in(parameters),
        "x_plunger" => parameters.regulating_valve.is_some(),
        _ => Part::Chamber.is_in(parameters),
    }
}

/// Maximum number of steps of a replay at its beginning.
const WORK_AT_START: u64 = 100_000;
/// Maximum number of steps for each PWM period of a row; a row counts as at least one period.
const WORK_PER_PERIOD: u64 = 400;
/// Maximum number of PWM periods that count for a row: a log with an hour between its rows takes no longer than one
/// with a second.
const PERIODS_OF_ROW_MAX: u64 = 100;

/// Replay of a log row by row in constant memory. The number of rows limits the number of steps: beyond it the
/// [simulation is aborted](Simulator::is_aborted), and rows are NaN.
#[derive(Debug, Clone)]
pub struct Replay {
    simulator: Simulator,
    pwm_period_ns: u64,
    work_limit: u64,
    regulating_valve: Option<RegulatingValve>,
    sampling: CurrentSampling,
    ambient_pressure: f64,
    /// Pressure (Pa abs) to which the chamber pressure of a row is relative.
    gauge_reference: f64,
    wall_temperature: f64,
    thermometer_wall_share: f64,
    is_commanded: bool,
    command: Command,
    /// Last command that a row of the log showed; `command` may be the next one already.
    shown: Command,
    supply_voltage_v: f64,
    /// Supply pressure as shown by its gauge (Pa abs); `None` before one was logged.
    supply_pressure: Option<f64>,
    /// Offset of the gauge (Pa).
    supply_gauge_offset: f64,
    /// Position of the actuator (m) to which the last row moved it; `None` before one was logged.
    actuator_position: Option<f64>,
    last: Option<Sample>,
    mean_current: [MeanCurrent; 2],
    /// Simulated time before the first row (ns).
    lead_ns: u64,
}

/// Lowest supply pressure (Pa abs).
const LEAST_SUPPLY: f64 = 1.0;
/// Time (s) after which coil current and armature are at rest under a constant command.
const LEAD_S: f64 = 0.2;

impl Replay {
    /// Creates a replay from rest; `tolerance` sets the accuracy.
    pub fn new(
        parameters: &PlantParameters,
        sampling: CurrentSampling,
        tolerance: Tolerance,
    ) -> Self {
        Self {
            simulator: Simulator::with_tolerance(parameters, tolerance),
            pwm_period_ns: parameters.ecu.pwm_period_ns(),
            work_limit: WORK_AT_START,
            regulating_valve: parameters
                .regulating_valve
                .clone()
                .map(RegulatingValve::new),
            sampling,
            ambient_pressure: parameters.gas.ambient_pressure_pa,
            gauge_reference: parameters.gas.ambient_pressure_pa,
            wall_temperature: parameters.gas.temperature_k,
            thermometer_wall_share: parameters.gas.thermometer_wall_share,
            is_commanded: Part::Commanded.is_in(parameters),
            command: Command::default(),
            shown: Command::default(),
            supply_voltage_v: parameters.ecu.supply_voltage_v,
            supply_pressure: None,
            supply_gauge_offset: parameters.gas.supply_gauge_offset_bar
                * crate::parameters::PA_PER_BAR,
            actuator_position: None,
            last: None,
            mean_current: Default::default(),
            lead_ns: 0,
        }
    }

    /// Begins under a `command` that has been valid for a long time: currents and armatures are at rest. Call it once,
    /// before the first row and before [`Self::begin_showing`].
    pub fn begin_under(&mut self, command: Command) {
        let periods = (LEAD_S * 1e9 / self.pwm_period_ns as f64).ceil() as u64;
        let lead_ns = periods * self.pwm_period_ns;
        for time_ns in [0, lead_ns] {
            self.row(ReplayInput {
                issued_ns: 0,
                command: Some(command),
                ..ReplayInput::at(time_ns)
            });
        }
        self.last = None;
        self.lead_ns = lead_ns;
    }

    /// Begins with a supply whose gauge shows `shown` (Pa abs). Call it before [`Self::begin_under`] and the first row.
    pub fn begin_supplied(&mut self, shown: f64) {
        self.supply_pressure = Some(shown);
        // The reading less the offset may be negative, but a pressure is not.
        let pressure = (shown - self.supply_gauge_offset).max(LEAST_SUPPLY);
        self.simulator.set_supply_pressure(pressure);
    }

    /// Gives the chamber pressure of each row relative to `reference` (Pa abs) and not to the ambient pressure: the
    /// absolute pressures of a log were converted with it.
    pub fn show_relative_to(&mut self, reference: f64) {
        self.gauge_reference = reference;
    }

    /// Returns the pressure (Pa abs) to which the chamber pressure of a row is relative.
    pub fn gauge_reference(&self) -> f64 {
        self.gauge_reference
    }

    /// Returns the simulator, to correct its state or to read its statistics.
    pub fn simulator(&mut self) -> &mut Simulator {
        &mut self.simulator
    }

    /// Begins at the chamber pressure at which the sensor shows `shown` (Pa abs), with its offset.
    ///
    /// # Panics
    /// Panics if `shown` is not positive and finite.
    pub fn begin_showing(&mut self, shown: f64) {
        self.simulator.set_chamber_pressure(shown);
        let too_much = self.simulator.sample().measured_pressure - shown;
        if too_much < shown {
            self.simulator.set_chamber_pressure(shown - too_much);
        }
    }

    /// Returns the instant (ns) up to which the log has been simulated, since its first row; 0 before it.
    pub fn time_ns(&self) -> u64 {
        self.simulator.time_ns().saturating_sub(self.lead_ns)
    }

    /// Raises the simulator's step limit for the row of `input`, and passes the command at the instant at which it was
    /// given. Callers that advance to instants before the row call it first.
    pub fn begin_row(&mut self, input: &ReplayInput) {
        let span_ns = input.time_ns.saturating_sub(self.time_ns());
        let periods = span_ns.div_ceil(self.pwm_period_ns.max(1));
        self.work_limit += WORK_PER_PERIOD * periods.clamp(1, PERIODS_OF_ROW_MAX);
        self.simulator.set_work_limit(self.work_limit);
        self.move_actuator(input, span_ns);
        if let Some(command) = input.command
            && command != self.command
        {
            self.command = command;
            if self.is_commanded {
                let issued_ns = input.issued_ns + self.lead_ns;
                self.simulator.command_at(issued_ns, command);
            }
        }
    }

    /// Moves the actuator so that it is at the position of the row after `span_ns`; without a position it rests.
    fn move_actuator(&mut self, input: &ReplayInput, span_ns: u64) {
        let Some(position) = input.actuator_position.or(self.actuator_position) else {
            return;
        };
        let is_known = self.actuator_position.replace(position).is_some();
        let within_s = if is_known { span_ns as f64 * 1e-9 } else { 0.0 };
        self.simulator.move_actuator(position, within_s);
    }

    /// Advances to an instant (ns) before the row that was begun.
    pub fn advance_to_ns(&mut self, time_ns: u64) {
        self.simulator.advance_to_ns(time_ns + self.lead_ns);
    }

    /// Begins the row of `input` unless it was begun, advances to its instant and samples.
    pub fn row(&mut self, input: ReplayInput) -> Row {
        self.begin_row(&input);
        self.advance_to_ns(input.time_ns);
        let sample = self.simulator.sample();
        let plunger = self.advance_plunger(&sample);
        let mean_current = [FILL, VENT].map(|coil| {
            let (mean, sampled) = (sample.mean_current[coil], input.samples_current[coil]);
            self.mean_current[coil].at_row(mean, sample.time_ns, sampled)
        });
        self.last = Some(sample);
        if input.shown_ns == input.time_ns {
            self.shown = self.command;
        }
        if let Some(volt) = input.supply_voltage_v
            && volt != self.supply_voltage_v
        {
            self.supply_voltage_v = volt;
            self.simulator.set_supply_voltage(volt);
        }
        if let Some(shown) = input.supply_pressure
            && Some(shown) != self.supply_pressure
        {
            self.begin_supplied(shown);
        }
        let current = match self.sampling {
            CurrentSampling::MeanOfInterval => mean_current,
            CurrentSampling::Instant => sample.current,
        };
        [
            self.shown.duty_fill_pct,
            self.shown.duty_vent_pct,
            (sample.measured_pressure - self.gauge_reference) / crate::parameters::PA_PER_BAR,
            current[FILL] * 1e3,
            current[VENT] * 1e3,
            self.supply_voltage_v,
            sample.position[FILL] * 1e3,
            sample.position[VENT] * 1e3,
            plunger.unwrap_or(f64::NAN),
            sample.temperature
                + self.thermometer_wall_share * (self.wall_temperature - sample.temperature),
        ]
    }

    fn advance_plunger(&mut self, sample: &Sample) -> Option<f64> {
        let valve = self.regulating_valve.as_mut()?;
        if let Some(last) = self.last
            && sample.time_ns > last.time_ns
        {
            let span = (sample.time_ns - last.time_ns) as f64 * 1e-9;
            valve.advance(
                span,
                last.pressure - self.ambient_pressure,
                sample.pressure - self.ambient_pressure,
            );
        }
        Some(valve.position() * 1e3)
    }
}

/// Replayed log, with the simulator's work.
#[derive(Debug, Clone)]
pub struct Replayed {
    /// Signals of the model on the time base of the log.
    pub recording: Recording,
    /// Meaning of the currents.
    pub sampling: CurrentSampling,
    /// Number of rows without a command, for which the last one stayed valid.
    pub held_commands: usize,
    /// Work of the simulator.
    pub statistics: Statistics,
}

/// Replays a whole log: the duty cycle of each coil that the plant has, and `u_bat` and `p_sup` if they were logged.
/// `correct` gets the simulator after each row and may change its pressure, as a predictor does; pass `|_, _| {}` for a
/// free-run simulation.
///
/// # Errors
/// Returns the same errors as [`inputs`].
pub fn replay(
    parameters: &PlantParameters,
    log: &Recording,
    tolerance: Tolerance,
    mut correct: impl FnMut(usize, &mut Simulator),
) -> Result<Replayed, ReplayError> {
    let surroundings = Surroundings::of(parameters, log)?;
    let parameters = &*surroundings.around(parameters);
    let log = &*united(parameters, log);
    let inputs = Inputs::of(parameters, log)?;
    let base = inputs.base();
    let sampling = CurrentSampling::of_interval(inputs.current_interval_s(), parameters);
    let mut replay = Replay::new(parameters, sampling, tolerance);
    if let Some(shown) = inputs.first_supply_pressure() {
        replay.begin_supplied(shown);
    }
    if let Some(pressure) = initial_pressure(parameters, log)? {
        replay.begin_showing(pressure);
    }
    let mut columns: [Vec<f64>; ROW_SIGNALS.len()] =
        core::array::from_fn(|_| Vec::with_capacity(inputs.len()));
    let mut held_commands = 0;
    for (index, input) in inputs.iter().enumerate() {
        held_commands += usize::from(input.command.is_none());
        let row = replay.row(input);
        if replay.simulator().is_aborted() {
            return Err(ReplayError::aborted(input.time_ns));
        }
        for (column, value) in columns.iter_mut().zip(row) {
            column.push(value);
        }
        correct(index, replay.simulator());
    }
    let provenance = Provenance::from_source(format!("model of {}", log.provenance().source))
        .with_note("producer", concat!("plant-sim ", env!("CARGO_PKG_VERSION")));
    let mut recording = Recording::new(provenance);
    let id = recording.add_time_base(base.clone());
    for ((name, unit), column) in ROW_SIGNALS.into_iter().zip(columns) {
        if has_signal(parameters, name) {
            recording.add_signal(name, unit, id, column)?;
        }
    }
    Ok(Replayed {
        recording,
        sampling,
        held_commands,
        statistics: replay.simulator.statistics(),
    })
}
