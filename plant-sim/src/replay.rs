//! Duty log in, recording out: the model driven by the commands of a measurement.
//!
//! A row of a log holds what the ECU knew at one instant: the duty cycles that it commands from there on,
//! and the sensor values sampled just then. Coil currents are means over the interval that ends there when
//! rows are slower than the PWM (an ECU log), and values of the instant when they are faster (a scope).

mod names;

pub use names::{UnknownSignal, unknown_signals};

use recording::{AddSignalError, Provenance, Quantity, Recording, Signal, TimeBase, Unit};
use recording::{ConversionError, Converter, MissingSignal};

use crate::ecu_output::Command;
use crate::parameters::{Part, PlantParameters};
use crate::plant::{FILL, VENT};
use crate::regulating_valve::RegulatingValve;
use crate::simulator::{Sample, Simulator, Statistics, Tolerance};

/// What the log tells the model at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayInput {
    /// Instant (ns) since the start of the log.
    pub time_ns: u64,
    /// Instant (ns) at which the ECU gave the command, not after `time_ns`.
    pub issued_ns: u64,
    /// Commanded duty cycles; none where the log misses them, which holds the last ones.
    pub command: Option<Command>,
    /// Supply voltage at the ECU (V), where logged; none holds the last one.
    pub supply_voltage_v: Option<f64>,
}

/// How the coil current of a row is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CurrentSampling {
    /// Mean over the interval that ends at the row: an ECU's current measurement.
    MeanOfInterval,
    /// Value of the instant: an oscilloscope.
    Instant,
}

impl CurrentSampling {
    /// What rows `interval_s` apart can show: a scope resolves the PWM period.
    pub fn of_interval(interval_s: f64, parameters: &PlantParameters) -> Self {
        if interval_s < 0.25 / parameters.ecu.pwm_frequency_hz {
            Self::Instant
        } else {
            Self::MeanOfInterval
        }
    }
}

/// One row of a simulated recording, in the order and the units of [`ROW_SIGNALS`]; NaN where the plant leaves out
/// what has the signal.
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

/// The signals that a plant has: those of its parts.
pub fn signals(parameters: &PlantParameters) -> impl Iterator<Item = (&'static str, Unit)> {
    ROW_SIGNALS
        .into_iter()
        .filter(|(name, _)| has_signal(parameters, name))
}

fn has_signal(parameters: &PlantParameters, name: &str) -> bool {
    let [fill, vent] = parameters.functions;
    match name {
        "duty_fill" | "i_fill" => fill.has_coil(),
        "duty_vent" | "i_vent" => vent.has_coil(),
        "x_fill" => fill.has_armature(),
        "x_vent" => vent.has_armature(),
        "u_bat" => Part::Coil.is_in(parameters),
        "x_plunger" => parameters.regulating_valve.is_some(),
        _ => Part::Chamber.is_in(parameters),
    }
}

/// Steps that a replay may take at its beginning ...
const WORK_AT_START: u64 = 100_000;
/// ... and for each PWM period of a row, at least one ...
const WORK_PER_PERIOD: u64 = 400;
/// ... and at most so many: a log with an hour between its rows is no longer than one with a second.
const PERIODS_OF_ROW_MAX: u64 = 100;

/// Replays a log row by row in constant memory, and in a number of steps that the number of its rows bounds: beyond it
/// the [simulation is given up](Simulator::is_given_up), and rows are NaN.
#[derive(Debug, Clone)]
pub struct Replay {
    simulator: Simulator,
    pwm_period_ns: u64,
    work_limit: u64,
    regulating_valve: Option<RegulatingValve>,
    sampling: CurrentSampling,
    ambient_pressure: f64,
    wall_temperature: f64,
    thermometer_wall_share: f64,
    has_coil: bool,
    command: Command,
    supply_voltage_v: f64,
    last: Option<Sample>,
    /// Simulated time before the first row (ns).
    lead_ns: u64,
}

/// Time (s) after which a coil and an armature rest under a lasting command.
const LEAD_S: f64 = 0.2;

impl Replay {
    /// Starts at rest; `tolerance` sets the accuracy.
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
            wall_temperature: parameters.gas.temperature_k,
            thermometer_wall_share: parameters.gas.thermometer_wall_share,
            has_coil: Part::Coil.is_in(parameters),
            command: Command::default(),
            supply_voltage_v: parameters.ecu.supply_voltage_v,
            last: None,
            lead_ns: 0,
        }
    }

    /// Begins under a `command` that has been in force for long: currents and armatures have come to rest. Called once, before the
    /// first row and before [`Self::begin_showing`].
    pub fn begin_under(&mut self, command: Command) {
        let periods = (LEAD_S * 1e9 / self.pwm_period_ns as f64).ceil() as u64;
        let lead_ns = periods * self.pwm_period_ns;
        for time_ns in [0, lead_ns] {
            self.row(ReplayInput {
                time_ns,
                issued_ns: 0,
                command: Some(command),
                supply_voltage_v: None,
            });
        }
        self.last = None;
        self.lead_ns = lead_ns;
    }

    /// The simulator, to correct its state or to read its statistics.
    pub fn simulator(&mut self) -> &mut Simulator {
        &mut self.simulator
    }

    /// Begins at the chamber pressure at which the sensor shows `shown` (Pa abs), whatever its offset.
    ///
    /// # Panics
    /// If `shown` is not positive and finite.
    pub fn begin_showing(&mut self, shown: f64) {
        self.simulator.set_chamber_pressure(shown);
        let too_much = self.simulator.sample().measured_pressure - shown;
        if too_much < shown {
            self.simulator.set_chamber_pressure(shown - too_much);
        }
    }

    /// Instant (ns) up to which the log has been simulated, since its first row; 0 before it.
    pub fn time_ns(&self) -> u64 {
        self.simulator.time_ns().saturating_sub(self.lead_ns)
    }

    /// Allows the simulator the steps of the row of `input` and hands over the command at the instant at which it was given: for
    /// whoever advances it on the way there.
    pub fn begin_row(&mut self, input: &ReplayInput) {
        let span_ns = input.time_ns.saturating_sub(self.time_ns());
        let periods = span_ns.div_ceil(self.pwm_period_ns.max(1));
        self.work_limit += WORK_PER_PERIOD * periods.clamp(1, PERIODS_OF_ROW_MAX);
        self.simulator.set_work_limit(self.work_limit);
        if let Some(command) = input.command
            && command != self.command
        {
            self.command = command;
            if self.has_coil {
                let issued_ns = input.issued_ns + self.lead_ns;
                self.simulator.command_at(issued_ns, command);
            }
        }
    }

    /// Advances to an instant (ns) on the way to a row that was begun.
    pub fn advance_to_ns(&mut self, time_ns: u64) {
        self.simulator.advance_to_ns(time_ns + self.lead_ns);
    }

    /// Begins the row of `input` unless it was begun, advances to its instant and samples.
    pub fn row(&mut self, input: ReplayInput) -> Row {
        self.begin_row(&input);
        self.advance_to_ns(input.time_ns);
        let sample = self.simulator.sample();
        let plunger = self.advance_plunger(&sample);
        self.last = Some(sample);
        if let Some(volt) = input.supply_voltage_v
            && volt != self.supply_voltage_v
        {
            self.supply_voltage_v = volt;
            self.simulator.set_supply_voltage(volt);
        }
        let current = match self.sampling {
            CurrentSampling::MeanOfInterval => sample.mean_current,
            CurrentSampling::Instant => sample.current,
        };
        [
            self.command.duty_fill_pct,
            self.command.duty_vent_pct,
            (sample.measured_pressure - self.ambient_pressure) / crate::parameters::PA_PER_BAR,
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

/// A replayed log and what it took.
#[derive(Debug, Clone)]
pub struct Replayed {
    /// The model's signals on the time base of the log.
    pub recording: Recording,
    /// How the currents are meant.
    pub sampling: CurrentSampling,
    /// Rows in which a command was missing and the last one was held.
    pub held_commands: usize,
    /// The simulator's work.
    pub statistics: Statistics,
}

/// Replays a whole log: the duty cycle of each coil that the plant has, and `u_bat` where it was logged. `correct` sees
/// the simulator after each row and may move its pressure, as a predictor does; pass `|_, _| {}` for a free run.
///
/// # Errors
/// As [`inputs`].
pub fn replay(
    parameters: &PlantParameters,
    log: &Recording,
    tolerance: Tolerance,
    mut correct: impl FnMut(usize, &mut Simulator),
) -> Result<Replayed, ReplayError> {
    let inputs = Inputs::of(parameters, log)?;
    let base = inputs.base();
    let interval_s = base.sampling().median_step_s.unwrap_or(f64::INFINITY);
    let sampling = CurrentSampling::of_interval(interval_s, parameters);
    let mut replay = Replay::new(parameters, sampling, tolerance);
    if let Some(pressure) = initial_pressure(parameters, log)? {
        replay.begin_showing(pressure);
    }
    let mut columns: [Vec<f64>; ROW_SIGNALS.len()] =
        core::array::from_fn(|_| Vec::with_capacity(inputs.len()));
    let mut held_commands = 0;
    for (index, input) in inputs.iter().enumerate() {
        held_commands += usize::from(input.command.is_none());
        let row = replay.row(input);
        if replay.simulator().is_given_up() {
            return Err(ReplayError::given_up(input.time_ns));
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

/// The longest time between two rows that is replayed (s): an hour of open valves takes seconds, a wrong clock
/// would take for ever.
pub const LONGEST_GAP_S: f64 = 3600.0;

/// Names of the commands, fill and vent.
const DUTIES: [&str; 2] = ["duty_fill", "duty_vent"];

/// What a log tells a plant, row by row. It is read from the log itself: an hour at 1 kHz takes no memory of its own.
#[derive(Debug, Clone)]
pub struct Inputs<'a> {
    base: &'a TimeBase,
    duties: [Option<Column<'a>>; 2],
    supply: Option<Column<'a>>,
}

/// A signal of the log in the unit of the model.
#[derive(Debug, Clone, Copy)]
struct Column<'a> {
    samples: &'a [f64],
    converter: Converter,
}

impl Column<'_> {
    fn at(&self, index: usize) -> f64 {
        self.converter.apply(self.samples[index])
    }
}

impl<'a> Inputs<'a> {
    /// Finds the commands of a log to a plant. A plant without coils is not commanded: the time base is that of the first
    /// signal that it has.
    ///
    /// # Errors
    /// As [`Inputs::of_part`], and a duty cycle without any value.
    pub fn of(parameters: &PlantParameters, log: &'a Recording) -> Result<Self, ReplayError> {
        let inputs = Self::of_part(parameters, log)?;
        let is_empty = |name: &&str| {
            let signal = log.signal(name);
            signal.is_some_and(|signal| signal.missing_count() == signal.len())
        };
        match commanded(parameters).find(is_empty) {
            Some(name) => Err(ReplayError::EmptyCommand { name }),
            None => Ok(inputs),
        }
    }

    /// As [`Inputs::of`], for some rows of a log, in which a command may be missing throughout.
    ///
    /// # Errors
    /// No duty cycle for a coil that the plant has, one of another kind, a duty cycle for a coil that the plant has not,
    /// signals that were not sampled together, or a gap of more than [`LONGEST_GAP_S`].
    pub fn of_part(parameters: &PlantParameters, log: &'a Recording) -> Result<Self, ReplayError> {
        for name in commanded(parameters) {
            require_command(parameters, log, name)?;
        }
        let id = driving_signal(parameters, log)?.time_base();
        let base = log.time_base(id).ok_or(ReplayError::NoTimeBase)?;
        for pair in base.times_s().windows(2) {
            check_gap(pair[0], pair[1])?;
        }
        let column = |name: &'static str, quantity, unit| -> Result<Option<Column>, ReplayError> {
            if !log.mentions(name) {
                return Ok(None);
            }
            let signal = log.require(name, quantity)?;
            if signal.time_base() != id {
                return Err(ReplayError::OtherTimeBase { name });
            }
            Ok(Some(Column {
                samples: signal.values_or_nan(),
                converter: signal.unit().converter(unit)?,
            }))
        };
        let duty = |valve: usize| column(DUTIES[valve], Quantity::DutyCycle, Unit::Percent);
        let duties = [duty(FILL)?, duty(VENT)?];
        for (valve, duty) in duties.iter().enumerate() {
            let acts = |duty: &Column| (0..duty.samples.len()).any(|index| duty.at(index) > 0.0);
            if !parameters.functions[valve].has_coil() && duty.as_ref().is_some_and(acts) {
                let name = DUTIES[valve];
                return Err(ReplayError::NoCoil { name });
            }
        }
        let supply = column("u_bat", Quantity::Voltage, Unit::Volt)?;
        Ok(Self {
            base,
            duties,
            supply,
        })
    }

    /// Returns the time base that the commands share.
    pub fn base(&self) -> &'a TimeBase {
        self.base
    }

    /// Returns the number of rows, at least 1.
    #[expect(
        clippy::len_without_is_empty,
        reason = "as its time base, it is never empty"
    )]
    pub fn len(&self) -> usize {
        self.base.len()
    }

    /// Returns what the log tells at instant `index`.
    ///
    /// # Panics
    /// If there is no such instant.
    pub fn row(&self, index: usize) -> ReplayInput {
        let duty = |valve: usize| self.duties[valve].map_or(0.0, |column| column.at(index));
        let command = Command {
            duty_fill_pct: duty(FILL),
            duty_vent_pct: duty(VENT),
        };
        let complete = !command.duty_fill_pct.is_nan() && !command.duty_vent_pct.is_nan();
        let times_s = self.base.times_s();
        let time_ns = ((times_s[index] - times_s[0]) * 1e9).round() as u64;
        ReplayInput {
            time_ns,
            issued_ns: time_ns,
            command: complete.then_some(command),
            supply_voltage_v: self
                .supply
                .map(|column| column.at(index))
                .filter(|volt| volt.is_finite()),
        }
    }

    /// Returns what the log tells at each instant.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = ReplayInput> + '_ {
        (0..self.len()).map(|index| self.row(index))
    }
}

/// The commands of a log to a plant as a list, with the time base that they share.
///
/// # Errors
/// As [`Inputs::of`].
pub fn inputs<'a>(
    parameters: &PlantParameters,
    log: &'a Recording,
) -> Result<(&'a TimeBase, Vec<ReplayInput>), ReplayError> {
    let inputs = Inputs::of(parameters, log)?;
    Ok((inputs.base(), inputs.iter().collect()))
}

/// As [`inputs`], for some rows of a log, in which a command may be missing throughout.
///
/// # Errors
/// As [`Inputs::of_part`].
pub fn inputs_of_part<'a>(
    parameters: &PlantParameters,
    log: &'a Recording,
) -> Result<(&'a TimeBase, Vec<ReplayInput>), ReplayError> {
    let inputs = Inputs::of_part(parameters, log)?;
    Ok((inputs.base(), inputs.iter().collect()))
}

/// The chamber pressure (Pa abs) to begin with, where the log alone tells it: the first one of a plant without coils,
/// which nothing can have filled. None where the plant begins at rest.
///
/// # Errors
/// `p_ch` is no pressure.
pub fn initial_pressure(
    parameters: &PlantParameters,
    log: &Recording,
) -> Result<Option<f64>, ReplayError> {
    let has_one = Part::Chamber.is_in(parameters) && log.mentions("p_ch");
    if Part::Coil.is_in(parameters) || !has_one {
        return Ok(None);
    }
    let signal = log.require("p_ch", Quantity::Pressure)?;
    let ambient = parameters.gas.ambient_pressure_pa;
    let values = signal.values_at_ambient(Unit::PascalAbsolute, ambient)?;
    Ok(values
        .into_iter()
        .find(|value| value.is_finite() && *value > 0.0))
}

/// The commands that the plant needs: those of its coils.
fn commanded(parameters: &PlantParameters) -> impl Iterator<Item = &'static str> {
    let valves = DUTIES.into_iter().zip(parameters.functions);
    valves
        .filter(|(_, function)| function.has_coil())
        .map(|(name, _)| name)
}

/// A command that is not there is not zero: perhaps its column has another name.
fn require_command(
    parameters: &PlantParameters,
    log: &Recording,
    name: &'static str,
) -> Result<(), ReplayError> {
    if !log.mentions(name) {
        let signals = log.signals().iter();
        return Err(ReplayError::NoCommand {
            source_name: log.provenance().source.clone(),
            name,
            present: signals.map(|signal| signal.name().to_owned()).collect(),
            meant: names::meant_by(parameters, log, name),
        });
    }
    log.require(name, Quantity::DutyCycle)?;
    Ok(())
}

/// What the log has instead of a command, and what to do.
fn about_missing_command(name: &str, present: &[String], meant: &[String]) -> String {
    let instead = match (meant, present) {
        ([], []) => ".".to_owned(),
        ([], present) => format!("; it has {}.", present.join(", ")),
        (meant, _) => format!("; is it {}?", meant.join(" or ")),
    };
    format!(
        "{instead} Map its column to `{name}`, or where the valve was not commanded, say so in a mapping: \
         constant.{name} = {{ value = 0, unit = \"pct\" }}"
    )
}

/// The signal whose instants are those of the replay.
fn driving_signal<'a>(
    parameters: &PlantParameters,
    log: &'a Recording,
) -> Result<&'a Signal, ReplayError> {
    if let Some(name) = commanded(parameters).next() {
        return Ok(log.require(name, Quantity::DutyCycle)?);
    }
    let logged = signals(parameters).find_map(|(name, _)| log.signal(name));
    match logged {
        Some(signal) => Ok(signal),
        None => Ok(log.require("p_ch", Quantity::Pressure)?),
    }
}

/// Whether the time from one row to the next can be replayed.
///
/// # Errors
/// [`ReplayError::Gap`] if it is longer than [`LONGEST_GAP_S`].
pub fn check_gap(from_s: f64, to_s: f64) -> Result<(), ReplayError> {
    let gap_s = to_s - from_s;
    if gap_s > LONGEST_GAP_S {
        return Err(ReplayError::Gap {
            after_s: from_s,
            gap_s,
        });
    }
    Ok(())
}

impl ReplayError {
    /// The simulation was given up before the row at `time_ns`.
    pub fn given_up(time_ns: u64) -> Self {
        Self::GivenUp {
            time_s: time_ns as f64 * 1e-9,
        }
    }
}

/// Why a log cannot be replayed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The simulation takes more steps than a log of this length may ask for.
    #[error(
        "the plant cannot be simulated on this log in a bounded number of steps: given up {time_s} s after its begin; \
         bring the parameters nearer to sizes that are met in practice, and look at the supply voltage and the time there"
    )]
    GivenUp {
        /// Time since the start of the log (s).
        time_s: f64,
    },
    /// A signal is absent or of another kind.
    #[error(transparent)]
    MissingSignal(#[from] MissingSignal),
    /// A coil of the plant has no command in the log.
    #[error(
        "{source_name} has no duty cycle `{name}`, but the plant has that coil{}",
        about_missing_command(name, present, meant)
    )]
    NoCommand {
        /// Source of the log.
        source_name: String,
        /// The command.
        name: &'static str,
        /// Signals of the log.
        present: Vec<String>,
        /// Those of them, and of the channels that were left out, that may be it.
        meant: Vec<String>,
    },
    /// The log has a command without any value.
    #[error(
        "every sample of the duty cycle `{name}` is missing: log it, or leave out the column and say in a mapping what it was: \
         constant.{name} = {{ value = 0, unit = \"pct\" }}"
    )]
    EmptyCommand {
        /// The command.
        name: &'static str,
    },
    /// A signal cannot be converted.
    #[error(transparent)]
    Conversion(#[from] ConversionError),
    /// The simulated signals do not make a recording.
    #[error(transparent)]
    Recording(#[from] AddSignalError),
    /// A gap that no bench log has.
    #[error(
        "no row for {gap_s} s after {after_s} s, longer than {LONGEST_GAP_S} s: cut the log there, or mend its time"
    )]
    Gap {
        /// Time of the last row before the gap (s).
        after_s: f64,
        /// Length of the gap (s).
        gap_s: f64,
    },
    /// The log commands what is not there.
    #[error(
        "the log has a command `{name}` above 0 %, but the plant has no such coil: take a plant file with the valve, or leave out the column"
    )]
    NoCoil {
        /// The signal.
        name: &'static str,
    },
    /// The commands have no time base.
    #[error("the duty cycles have no time base")]
    NoTimeBase,
    /// Commands and voltage must be sampled together.
    #[error(
        "`{name}` has another time base than the duty cycles: say in a mapping, under [rows], instants_of = \"duty_fill\""
    )]
    OtherTimeBase {
        /// The signal.
        name: &'static str,
    },
}
