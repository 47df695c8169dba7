//! Inputs of a plant from a log, row by row.

use std::borrow::Cow;
use std::sync::Arc;

use recording::{Converter, Quantity, Recording, Signal, TimeBase, Unit, median_step_s};

use super::error::ReplayError;
use super::{actuator, names, signals, supply};
use crate::ecu_output::Command;
use crate::parameters::{Part, PlantParameters, SensorPlace};
use crate::plant::{FILL, VENT};

/// Input of the model at one instant of a log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayInput {
    /// Instant (ns) since the start of the log.
    pub time_ns: u64,
    /// Instant (ns) of the row that shows the command: this row, or a later one if the log has the commands at a lower
    /// rate.
    pub shown_ns: u64,
    /// Instant (ns) at which the ECU gave the command, not after `shown_ns`.
    pub issued_ns: u64,
    /// Commanded duty cycles; `None` if the log misses them, and then the last ones stay valid.
    pub command: Option<Command>,
    /// Whether the current of each coil was sampled at this row: a mean since its sample before ends here.
    pub samples_current: [bool; 2],
    /// Supply voltage at the ECU (V), if logged; with `None` the last one stays valid.
    pub supply_voltage_v: Option<f64>,
    /// Supply pressure as shown by its gauge (Pa abs), if logged; with `None` the last one stays valid.
    pub supply_pressure: Option<f64>,
    /// Position of the actuator (m), if logged: it moves there from its last one at a constant velocity.
    pub actuator_position: Option<f64>,
}

impl ReplayInput {
    /// Creates the input of a row at `time_ns` at which nothing changes.
    pub fn at(time_ns: u64) -> Self {
        Self {
            time_ns,
            shown_ns: time_ns,
            issued_ns: time_ns,
            command: None,
            samples_current: [true; 2],
            supply_voltage_v: None,
            supply_pressure: None,
            actuator_position: None,
        }
    }
}

/// Longest time between two rows that is replayed (s): an hour of open valves takes seconds to simulate, but the gap of
/// a wrong clock may be much longer.
pub const LONGEST_GAP_S: f64 = 3600.0;

/// Names of the commands, fill and vent.
const DUTIES: [&str; 2] = ["duty_fill", "duty_vent"];
/// Names of the coil currents, fill and vent.
const CURRENTS: [&str; 2] = ["i_fill", "i_vent"];
/// Name of the pressure in a second chamber.
const SECOND_PRESSURE: &str = "p_second";
/// Name of the supply voltage.
pub const SUPPLY_VOLTAGE: &str = "u_bat";
/// Number of median steps of the commands above which a pause hides commands: a row in it does not look ahead.
const PAUSE_STEPS: f64 = 2.5;
/// Ratio of two intervals up to which duty cycles count as logged at one rate.
const ALIKE_RATE: f64 = 1.5;

/// Returns `log` with the commands and all signals that the model computes on one time base, each at its own instants.
/// The pressure of a plant whose sensor is in the second chamber is `p_second`, where the log has it.
/// The supply voltage is an input as the supply pressure, and keeps its time base.
pub fn united<'a>(parameters: &PlantParameters, log: &'a Recording) -> Cow<'a, Recording> {
    let is_computed = |name: &str| {
        let mut of_model = signals(parameters).map(|(signal, _)| signal);
        DUTIES.contains(&name) || (name != SUPPLY_VOLTAGE && of_model.any(|one| one == name))
    };
    if Part::SecondChamber.is_in(parameters)
        && parameters.second_chamber.sensor == SensorPlace::SecondChamber
        && let Some(renamed) = log.renamed(SECOND_PRESSURE, "p_ch")
    {
        return Cow::Owned(renamed.united(is_computed).into_owned());
    }
    log.united(is_computed)
}

/// Inputs of a plant from a log, row by row. They are read from the log itself: an hour at 1 kHz takes no additional
/// memory, except for a logged supply pressure or actuator position and for signals of a lower rate than the rows.
#[derive(Debug, Clone)]
pub struct Inputs<'a> {
    base: &'a TimeBase,
    duties: [Option<Column<'a>>; 2],
    /// Rows that show a command, if it was logged at a lower rate than the rows.
    slow_commands: Option<SlowCommands>,
    /// Rows at which the current of each coil was sampled, if at a lower rate than the rows.
    current_rows: [Option<Vec<usize>>; 2],
    supply: Option<Supply<'a>>,
    /// Supply pressure of each row (Pa abs), NaN if the last one stays valid.
    supply_pressure: Option<Arc<Vec<f64>>>,
    /// Position of the actuator of each row (m).
    actuator_position: Option<Arc<Vec<f64>>>,
}

/// Signal of the log in the unit of the model.
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

/// Supply voltage of the log.
#[derive(Debug, Clone)]
struct Supply<'a> {
    column: Column<'a>,
    /// Its sample of each row, if it has another time base: the last one before the row; `None` before the first.
    places: Option<Vec<Option<usize>>>,
}

impl Supply<'_> {
    fn at(&self, index: usize) -> Option<f64> {
        let place = match &self.places {
            None => Some(index),
            Some(places) => places[index],
        };
        let volt = place.map(|place| self.column.at(place));
        volt.filter(|volt| volt.is_finite())
    }
}

/// Commands of a log with more rows than commands.
#[derive(Debug, Clone)]
struct SlowCommands {
    /// Rows that show a command, in order, and the commands.
    shown: Vec<(usize, Command)>,
    /// Median time between them (s).
    interval_s: f64,
}

impl SlowCommands {
    /// Finds the commands; `None` if the duty cycles were logged at every row.
    fn of(duties: &[Option<(&Signal, Column)>; 2], base: &TimeBase) -> Option<Self> {
        let own_rows = duties.map(|duty| duty.and_then(|(signal, _)| signal.own_rows()));
        if own_rows.iter().all(Option::is_none) {
            return None;
        }
        let intervals_s = [FILL, VENT].map(|valve| match &own_rows[valve] {
            Some(rows) => interval_s(base, rows),
            None => duties[valve].map_or(f64::INFINITY, |_| base_interval_s(base)),
        });
        let fastest_s = intervals_s[FILL].min(intervals_s[VENT]);
        // Two duty cycles of one rate show a command once both were sampled; a slower one keeps its last value.
        let waits = intervals_s.map(|interval_s| interval_s <= ALIKE_RATE * fastest_s);
        let mut duty_pct = duties.map(|duty| duty.map_or(0.0, |_| f64::NAN));
        let mut is_new = [false; 2];
        let mut shown = Vec::new();
        for row in 0..base.len() {
            for (valve, duty) in duties.iter().enumerate() {
                let value = duty.map_or(f64::NAN, |(_, column)| column.at(row));
                if !value.is_nan() {
                    (duty_pct[valve], is_new[valve]) = (value, true);
                }
            }
            let is_shown = (0..2).all(|valve| is_new[valve] || !waits[valve]);
            let [duty_fill_pct, duty_vent_pct] = duty_pct;
            if is_shown && !duty_pct.iter().any(|duty_pct| duty_pct.is_nan()) {
                is_new = [false; 2];
                let command = Command {
                    duty_fill_pct,
                    duty_vent_pct,
                };
                shown.push((row, command));
            }
        }
        Some(Self {
            interval_s: fastest_s,
            shown,
        })
    }

    /// Returns the command that is known of the time up to `row`, and the row that shows it: this row or the next one
    /// that shows a command. `None` in a pause of the commands and after the last one.
    fn at(&self, row: usize, base: &TimeBase) -> Option<(usize, Command)> {
        let next = self.shown.partition_point(|&(shown, _)| shown < row);
        let &(shown, command) = self.shown.get(next)?;
        let times_s = base.times_s();
        let before = next.checked_sub(1).map_or(0, |before| self.shown[before].0);
        let is_pause = times_s[shown] - times_s[before] > PAUSE_STEPS * self.interval_s;
        (shown == row || !is_pause).then_some((shown, command))
    }
}

/// Returns the median time between two rows of `base` (s); infinite for a single one.
fn base_interval_s(base: &TimeBase) -> f64 {
    median_step_s(base.times_s()).unwrap_or(f64::INFINITY)
}

/// Returns the median time between `rows` of `base` (s); infinite for a single one.
fn interval_s(base: &TimeBase, rows: &[usize]) -> f64 {
    let times_s: Vec<f64> = rows.iter().map(|&row| base.times_s()[row]).collect();
    median_step_s(&times_s).unwrap_or(f64::INFINITY)
}

impl<'a> Inputs<'a> {
    /// Finds the commands of a log to a plant. A plant without coils gets no commands: the time base is that of the
    /// first signal that it has.
    ///
    /// # Errors
    /// Returns the errors of [`Inputs::of_part`], or an error for a duty cycle without any value.
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

    /// Finds the commands as [`Inputs::of`], for some rows of a log, in which a command may be missing in all rows.
    ///
    /// # Errors
    /// Returns an error if there is no duty cycle for a coil of the plant, one of another quantity, or a duty cycle for
    /// a coil that the plant does not have; if signals were not sampled together; or for a gap of more than
    /// [`LONGEST_GAP_S`].
    pub fn of_part(parameters: &PlantParameters, log: &'a Recording) -> Result<Self, ReplayError> {
        for name in commanded(parameters) {
            require_command(parameters, log, name)?;
        }
        let id = driving_signal(parameters, log)?.time_base();
        let base = log.time_base(id).ok_or(ReplayError::NoTimeBase)?;
        for pair in base.times_s().windows(2) {
            check_gap(pair[0], pair[1])?;
        }
        let column = |name: &'static str, quantity, unit| -> Result<_, ReplayError> {
            if !log.mentions(name) {
                return Ok(None);
            }
            let signal = log.require(name, quantity)?;
            let column = Column {
                samples: signal.values_or_nan(),
                converter: signal.unit().converter(unit)?,
            };
            Ok(Some((signal, column)))
        };
        let duty = |valve: usize| {
            let name = DUTIES[valve];
            let duty = column(name, Quantity::DutyCycle, Unit::Percent)?;
            match duty {
                Some((signal, _)) if signal.time_base() != id => {
                    Err(ReplayError::OtherTimeBase { name })
                }
                duty => Ok(duty),
            }
        };
        let duties = [duty(FILL)?, duty(VENT)?];
        for (valve, duty) in duties.iter().enumerate() {
            let acts =
                |(_, duty): &(_, Column)| (0..duty.samples.len()).any(|index| duty.at(index) > 0.0);
            if !parameters.functions[valve].is_commanded() && duty.as_ref().is_some_and(acts) {
                let name = DUTIES[valve];
                return Err(ReplayError::NoCoil { name });
            }
        }
        let supply = column(SUPPLY_VOLTAGE, Quantity::Voltage, Unit::Volt)?;
        let supply = supply.map(|(signal, column)| {
            let own = log.time_base(signal.time_base());
            let own = own.filter(|own| *own != base);
            let places = own.map(|own| supply::last_before(own, base));
            Supply { column, places }
        });
        let current_rows = CURRENTS.map(|name| {
            let signal = log.signal(name).filter(|signal| signal.time_base() == id);
            signal.and_then(Signal::own_rows)
        });
        Ok(Self {
            base,
            slow_commands: SlowCommands::of(&duties, base),
            duties: duties.map(|duty| duty.map(|(_, column)| column)),
            current_rows,
            supply,
            supply_pressure: supply::logged_supply(parameters, log, base).map(Arc::new),
            actuator_position: actuator::logged_position(parameters, log, base)?.map(Arc::new),
        })
    }

    /// Returns the initial supply pressure (Pa abs), as shown by its gauge: the first logged one. `None` if the log has
    /// none that drives the plant.
    pub fn first_supply_pressure(&self) -> Option<f64> {
        let mut rows = self.supply_pressure.as_ref()?.iter().copied();
        rows.find(|pressure| pressure.is_finite())
    }

    /// Returns the position of the actuator at all rows (m), if logged.
    pub fn actuator_position(&self) -> Option<Arc<Vec<f64>>> {
        self.actuator_position.clone()
    }

    /// Returns the common time base of the commands.
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

    /// Returns the input at instant `index`.
    ///
    /// # Panics
    /// Panics if there is no such instant.
    pub fn row(&self, index: usize) -> ReplayInput {
        let (shown, command) = match &self.slow_commands {
            None => (index, self.command_of_row(index)),
            Some(slow) => match slow.at(index, self.base) {
                Some((shown, command)) => (shown, Some(command)),
                None => (index, None),
            },
        };
        let shown_ns = self.time_ns(shown);
        ReplayInput {
            shown_ns,
            issued_ns: shown_ns,
            command,
            samples_current: self.current_rows.each_ref().map(|rows| {
                let rows = rows.as_ref();
                rows.is_none_or(|rows| rows.binary_search(&index).is_ok())
            }),
            supply_voltage_v: self.supply.as_ref().and_then(|supply| supply.at(index)),
            supply_pressure: self
                .supply_pressure
                .as_ref()
                .map(|rows| rows[index])
                .filter(|pressure| pressure.is_finite()),
            actuator_position: self.actuator_position.as_ref().map(|rows| rows[index]),
            ..ReplayInput::at(self.time_ns(index))
        }
    }

    /// Returns the time of a row since the first one (ns).
    fn time_ns(&self, index: usize) -> u64 {
        let times_s = self.base.times_s();
        ((times_s[index] - times_s[0]) * 1e9).round() as u64
    }

    /// Returns the command that a row contains, if it is complete.
    fn command_of_row(&self, index: usize) -> Option<Command> {
        let duty = |valve: usize| self.duties[valve].map_or(0.0, |column| column.at(index));
        let command = Command {
            duty_fill_pct: duty(FILL),
            duty_vent_pct: duty(VENT),
        };
        let is_complete = !command.duty_fill_pct.is_nan() && !command.duty_vent_pct.is_nan();
        is_complete.then_some(command)
    }

    /// Returns the commands that the log shows: row and command, `None` if the command of this row is missing. Rows
    /// between commands of a lower rate are left out.
    pub fn shown_commands(&self) -> Box<dyn Iterator<Item = (usize, Option<Command>)> + '_> {
        match &self.slow_commands {
            None => Box::new((0..self.len()).map(|row| (row, self.command_of_row(row)))),
            Some(slow) => Box::new(
                slow.shown
                    .iter()
                    .map(|&(row, command)| (row, Some(command))),
            ),
        }
    }

    /// Returns the median time between two rows (s); infinite for a single row.
    pub fn interval_s(&self) -> f64 {
        base_interval_s(self.base)
    }

    /// Returns the median time between two commands (s).
    pub fn command_interval_s(&self) -> f64 {
        let slow = self.slow_commands.as_ref();
        slow.map_or_else(|| self.interval_s(), |slow| slow.interval_s)
    }

    /// Returns the median time between two samples of a coil current (s), the longer one of the two coils.
    pub fn current_interval_s(&self) -> f64 {
        let of_coils = self.current_rows.iter().flatten();
        let slow_s = of_coils.map(|rows| interval_s(self.base, rows));
        slow_s.fold(self.interval_s(), f64::max)
    }

    /// Iterates over the inputs of all instants.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = ReplayInput> + '_ {
        (0..self.len()).map(|index| self.row(index))
    }
}

/// Returns the commands of a log to a plant as a list, with their common time base.
///
/// # Errors
/// Returns the same errors as [`Inputs::of`].
pub fn inputs<'a>(
    parameters: &PlantParameters,
    log: &'a Recording,
) -> Result<(&'a TimeBase, Vec<ReplayInput>), ReplayError> {
    let inputs = Inputs::of(parameters, log)?;
    Ok((inputs.base(), inputs.iter().collect()))
}

/// Returns the initial chamber pressure (Pa abs), if the log alone determines it: the first logged pressure, for a
/// plant without commanded valves, in which no command can have changed the pressure before. `None` if the plant begins at rest.
///
/// # Errors
/// Returns an error if `p_ch` is not a pressure.
pub fn initial_pressure(
    parameters: &PlantParameters,
    log: &Recording,
) -> Result<Option<f64>, ReplayError> {
    let has_one = Part::Chamber.is_in(parameters) && log.mentions("p_ch");
    if Part::Commanded.is_in(parameters) || !has_one {
        return Ok(None);
    }
    let signal = log.require("p_ch", Quantity::Pressure)?;
    let ambient = parameters.gas.ambient_pressure_pa;
    let values = signal.values_at_ambient(Unit::PascalAbsolute, ambient)?;
    Ok(values
        .into_iter()
        .find(|value| value.is_finite() && *value > 0.0))
}

/// Returns the commands that the plant needs.
fn commanded(parameters: &PlantParameters) -> impl Iterator<Item = &'static str> {
    let valves = DUTIES.into_iter().zip(parameters.functions);
    valves
        .filter(|(_, function)| function.is_commanded())
        .map(|(name, _)| name)
}

/// Refuses a missing command, which is not zero: perhaps its column has another name.
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

/// Returns the signal whose instants are those of the replay.
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

/// Checks whether the time from one row to the next can be replayed.
///
/// # Errors
/// Returns [`ReplayError::Gap`] if it is longer than [`LONGEST_GAP_S`].
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
