//! Inputs of a plant from a log, row by row.

use std::sync::Arc;

use recording::{Converter, Quantity, Recording, Signal, TimeBase, Unit};

use super::error::ReplayError;
use super::{names, signals, supply};
use crate::ecu_output::Command;
use crate::parameters::{Part, PlantParameters};
use crate::plant::{FILL, VENT};

/// Input of the model at one instant of a log.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ReplayInput {
    /// Instant (ns) since the start of the log.
    pub time_ns: u64,
    /// Instant (ns) at which the ECU gave the command, not after `time_ns`.
    pub issued_ns: u64,
    /// Commanded duty cycles; `None` if the log misses them, and then the last ones stay valid.
    pub command: Option<Command>,
    /// Supply voltage at the ECU (V), if logged; with `None` the last one stays valid.
    pub supply_voltage_v: Option<f64>,
    /// Supply pressure as shown by its gauge (Pa abs), if logged; with `None` the last one stays valid.
    pub supply_pressure: Option<f64>,
}

/// Longest time between two rows that is replayed (s): an hour of open valves takes seconds to simulate, but the gap of
/// a wrong clock may be much longer.
pub const LONGEST_GAP_S: f64 = 3600.0;

/// Names of the commands, fill and vent.
const DUTIES: [&str; 2] = ["duty_fill", "duty_vent"];

/// Inputs of a plant from a log, row by row. They are read from the log itself: an hour at 1 kHz takes no additional
/// memory, except for a logged supply pressure.
#[derive(Debug, Clone)]
pub struct Inputs<'a> {
    base: &'a TimeBase,
    duties: [Option<Column<'a>>; 2],
    supply: Option<Column<'a>>,
    /// Supply pressure of each row (Pa abs), NaN if the last one stays valid.
    supply_pressure: Option<Arc<Vec<f64>>>,
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
            supply_pressure: supply::logged_supply(parameters, log, base).map(Arc::new),
        })
    }

    /// Returns the initial supply pressure (Pa abs), as shown by its gauge: the first logged one. `None` if the log has
    /// none that drives the plant.
    pub fn first_supply_pressure(&self) -> Option<f64> {
        let mut rows = self.supply_pressure.as_ref()?.iter().copied();
        rows.find(|pressure| pressure.is_finite())
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
            supply_pressure: self
                .supply_pressure
                .as_ref()
                .map(|rows| rows[index])
                .filter(|pressure| pressure.is_finite()),
        }
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

/// Returns the commands as [`inputs`], for some rows of a log, in which a command may be missing in all rows.
///
/// # Errors
/// Returns the same errors as [`Inputs::of_part`].
pub fn inputs_of_part<'a>(
    parameters: &PlantParameters,
    log: &'a Recording,
) -> Result<(&'a TimeBase, Vec<ReplayInput>), ReplayError> {
    let inputs = Inputs::of_part(parameters, log)?;
    Ok((inputs.base(), inputs.iter().collect()))
}

/// Returns the initial chamber pressure (Pa abs), if the log alone determines it: the first logged pressure, for a
/// plant without coils, in which no command can have changed the pressure before. `None` if the plant begins at rest.
///
/// # Errors
/// Returns an error if `p_ch` is not a pressure.
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

/// Returns the commands that the plant needs: those of its coils.
fn commanded(parameters: &PlantParameters) -> impl Iterator<Item = &'static str> {
    let valves = DUTIES.into_iter().zip(parameters.functions);
    valves
        .filter(|(_, function)| function.has_coil())
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
