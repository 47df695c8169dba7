//! State in which the simulation of a log begins: the state in the log, or a given one.

use plant_sim::parameters::{PA_PER_BAR, ParameterSpec, Part};
use plant_sim::replay::{CurrentSampling, Inputs, Replay, ReplayInput, Row, united};
use plant_sim::{PlantParameters, Simulator, Tolerance};
use recording::{Bounds, Quantity, Recording};

use crate::commands::Commands;
use crate::conditions::{Conditions, LogConditions, StartGas};
use crate::error::CompareError;
use crate::log_start::LogStart;
use crate::measured::{LogAsRead, PRESSURE, measured_signals, start};

/// State in which a simulation begins. Currents and armatures are at rest: under the first command of the log where it begins with a filled
/// chamber, otherwise without current.
#[derive(Debug, Clone)]
pub struct SimulationStart {
    start: LogStart,
    /// Whether pressure or gas temperature are given, so that the gas is not the one with which the log began.
    is_given: bool,
    /// Given gas temperature (K).
    gas_k: Option<f64>,
    /// Origin of the pressure in words, without a full stop.
    statement: String,
    pressure_bar_gauge: f64,
}

/// Reason why a simulation cannot begin in a given state.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum StartError {
    /// The signal is not a state of a plant.
    #[error(
        "`{name}` cannot be given at the start: give p_ch in bar gauge or t_gas in K, as in p_ch=5.2"
    )]
    UnknownState {
        /// Name of the signal.
        name: String,
    },
    /// The plant has no chamber.
    #[error(
        "`{name}` is given at the start, but the plant has no chamber: take a plant file with [chamber]"
    )]
    NoChamber {
        /// Name of the state.
        name: String,
    },
    /// The gas keeps a constant temperature.
    #[error(
        "t_gas is given at the start, but the gas of this plant keeps gas.temperature_k: add the effect gas_temperature to the plant file"
    )]
    NoGasTemperature,
    /// The value is impossible for any plant.
    #[error(
        "{name} = {value} {unit} at the start is impossible (allowed {least} to {most}): correct it"
    )]
    OutOfRange {
        /// Name of the state.
        name: String,
        /// Given value.
        value: f64,
        /// Unit of the value.
        unit: &'static str,
        /// Least allowed value.
        least: f64,
        /// Largest allowed value.
        most: f64,
    },
}

impl SimulationStart {
    /// Returns the start of a simulation of `log`: its first measured pressure where that is away from ambient, as in a comparison,
    /// otherwise at rest and ambient pressure.
    ///
    /// # Errors
    /// [`CompareError`]: the log cannot drive the model.
    pub fn of(parameters: &PlantParameters, log: &Recording) -> Result<Self, CompareError> {
        let original = log;
        let log = &*united(parameters, original);
        let inputs = Inputs::of(parameters, log)?;
        let commands = Commands::new(parameters, log)?;
        // A log without measured signals contains commands alone.
        let measured = measured_signals(parameters, LogAsRead { log, original }, &commands);
        let (measured, _) = measured.unwrap_or_default();
        let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
        let (found, level) = start(parameters, pressure, &commands);
        let mut start = LogStart::at(parameters, pressure, level, inputs.row(0).command)
            .supplied(inputs.first_supply_pressure());
        // A simulation has no measurement at which to restart.
        start.restarts.clear();
        Ok(Self {
            start,
            is_given: false,
            gas_k: None,
            statement: found.statement,
            pressure_bar_gauge: found.pressure_bar_gauge,
        })
    }

    /// Returns the start with `value` given for the state `name`: `p_ch` in bar gauge or `t_gas` in K.
    ///
    /// # Errors
    /// [`StartError`]: another name, a state that the plant lacks, or a value that is impossible.
    pub fn given(
        mut self,
        parameters: &PlantParameters,
        name: &str,
        value: f64,
    ) -> Result<Self, StartError> {
        self.is_given = true;
        let has_chamber = Part::Chamber.is_in(parameters);
        let owned = || name.to_owned();
        let within =
            |unit: &'static str, least: f64, most: f64| match (least..=most).contains(&value) {
                true => Ok(()),
                false => Err(StartError::OutOfRange {
                    name: owned(),
                    value,
                    unit,
                    least,
                    most,
                }),
            };
        match name {
            PRESSURE | "t_gas" if !has_chamber => Err(StartError::NoChamber { name: owned() }),
            PRESSURE => {
                let ambient = parameters.gas.ambient_pressure_pa;
                let least = Bounds::of(Quantity::Pressure).least - ambient / PA_PER_BAR;
                let supply = ParameterSpec::by_name("gas.supply_pressure_bar_gauge");
                within(
                    "bar gauge",
                    least,
                    supply.map_or(f64::INFINITY, |spec| spec.range.1),
                )?;
                self.start = self.start.moved(parameters, value * PA_PER_BAR + ambient);
                self.pressure_bar_gauge = value;
                self.statement = format!("from the given pressure, {value} bar gauge");
                Ok(self)
            }
            "t_gas" => {
                let range = ParameterSpec::by_name("gas.temperature_k").map(|spec| spec.range);
                let (least, most) = range.unwrap_or((0.0, f64::INFINITY));
                within("K", least, most)?;
                if !Simulator::new(parameters).has_gas_temperature() {
                    return Err(StartError::NoGasTemperature);
                }
                self.gas_k = Some(value);
                Ok(self)
            }
            _ => Err(StartError::UnknownState { name: owned() }),
        }
    }

    /// Returns the origin of the initial pressure in words, without a full stop.
    pub fn statement(&self) -> &str {
        &self.statement
    }

    /// Returns the initial chamber pressure (bar gauge); 0 for a plant without chamber.
    pub fn pressure_bar_gauge(&self) -> f64 {
        self.pressure_bar_gauge
    }

    /// Starts a replay of the log, which was made under `conditions`.
    pub fn begin(
        &self,
        parameters: &PlantParameters,
        conditions: &LogConditions,
        sampling: CurrentSampling,
        tolerance: Tolerance,
    ) -> Replay {
        let conditions = self.conditions(conditions);
        let mut replay = self
            .start
            .begin(parameters, &conditions, sampling, tolerance);
        if let Some(kelvin) = self.gas_k {
            replay.simulator().set_gas_temperature(kelvin);
        }
        replay
    }

    /// Advances `replay` to `input`, which is in the time of the ECU and `time_s` after the first row by the clock of the logger. None if
    /// the simulation was aborted.
    pub fn row(
        &self,
        replay: &mut Replay,
        conditions: &LogConditions,
        (input, time_s): (ReplayInput, f64),
    ) -> Option<Row> {
        let conditions = self.conditions(conditions);
        let warmth = self.start.warmth(replay, &conditions, time_s);
        self.start.row(replay, input, warmth)
    }

    /// Returns whether pressure or gas temperature are given.
    pub fn is_given(&self) -> bool {
        self.is_given
    }

    /// Returns the `conditions` of the log; a given start replaces its gas.
    fn conditions(&self, conditions: &LogConditions) -> Conditions {
        let mut conditions = conditions.conditions;
        if self.is_given {
            conditions.start_gas = StartGas::default();
        }
        conditions
    }
}
