//! State in which the model of a log starts, and in which it restarts after a gap.

use plant_sim::parameters::{PA_PER_BAR, Part};
use plant_sim::replay::{CurrentSampling, ROW_SIGNALS, Replay, ReplayInput, Row};
use plant_sim::{Command, PlantParameters, Tolerance};

use crate::conditions::{Conditions, UsualGas};
use crate::gas_after_gap::Gas;
use crate::measured::{Measured, PRESSURE, Restart};

/// Relative pressure above ambient from which on a chamber counts as filled.
const FILLED: f64 = 0.1;
/// Least pressure after a correction (Pa abs).
const LEAST_PRESSURE: f64 = 1e3;

/// State of a plant at the first row of a log, and after its gaps.
#[derive(Debug, Clone)]
pub(crate) struct LogStart {
    /// Initial chamber pressure (Pa abs); none starts at rest.
    pub(crate) pressure: Option<f64>,
    /// Whether the chamber was filled before, so that its gas may still be warm.
    pub(crate) is_filled: bool,
    /// Prior knowledge of that gas.
    pub(crate) usual_gas: UsualGas,
    /// First supply pressure that its gauge showed (Pa abs), where the log drives the supply.
    pub(crate) supply_pressure: Option<f64>,
    /// Command of the first row.
    command: Option<Command>,
    /// Rows at which the model restarts, in order of time.
    pub(crate) restarts: Vec<Restart>,
    /// Ambient pressure (Pa abs) between logged pressures and those of this start, ...
    ambient: f64,
    /// ... and whether absolute pressures were logged: those are the same at another ambient pressure.
    is_absolute: bool,
    /// Temperature of the chamber's wall (K).
    wall_k: f64,
    /// Index of the chamber pressure in a row.
    pressure_place: usize,
}

impl LogStart {
    /// Returns the start of a log without a chamber pressure.
    pub(crate) fn at_rest(parameters: &PlantParameters) -> Self {
        let pressure_place = ROW_SIGNALS.iter().position(|(name, _)| *name == PRESSURE);
        Self {
            pressure: None,
            is_filled: false,
            usual_gas: UsualGas::BETWEEN_VALVES,
            supply_pressure: None,
            command: None,
            restarts: Vec::new(),
            ambient: parameters.gas.ambient_pressure_pa,
            is_absolute: false,
            wall_k: parameters.gas.temperature_k,
            pressure_place: pressure_place.expect("it is a signal of the model"),
        }
    }

    /// Returns the start of a log whose chamber pressure is `pressure`. The pressure begins at `level` (Pa abs) where that is away from
    /// ambient. `command` is that of the first row.
    pub(crate) fn at(
        parameters: &PlantParameters,
        pressure: Option<&Measured>,
        level: Option<f64>,
        command: Option<Command>,
    ) -> Self {
        let ambient = parameters.gas.ambient_pressure_pa;
        let is_above = |level: f64| level > (1.0 + FILLED) * ambient;
        Self {
            pressure: level,
            is_filled: level.is_some_and(is_above),
            usual_gas: match (Part::Commanded.is_in(parameters), level) {
                (false, Some(level)) => UsualGas::of_vessel(parameters, level),
                _ => UsualGas::BETWEEN_VALVES,
            },
            command,
            restarts: pressure.map_or_else(Vec::new, |signal| signal.restarts.clone()),
            is_absolute: pressure.is_some_and(|signal| signal.is_absolute),
            ..Self::at_rest(parameters)
        }
    }

    /// Returns the start at another `pressure` (Pa abs).
    pub(crate) fn moved(self, parameters: &PlantParameters, pressure: f64) -> Self {
        let Self {
            command,
            supply_pressure,
            ..
        } = self;
        Self::at(parameters, None, Some(pressure), command).supplied(supply_pressure)
    }

    /// Returns the start with the first `supply_pressure` that its gauge showed (Pa abs); none where the log does not drive the supply.
    pub(crate) fn supplied(self, supply_pressure: Option<f64>) -> Self {
        Self {
            supply_pressure,
            ..self
        }
    }

    /// Starts a replay of the log.
    pub(crate) fn begin(
        &self,
        parameters: &PlantParameters,
        conditions: &Conditions,
        sampling: CurrentSampling,
        tolerance: Tolerance,
    ) -> Replay {
        let mut replay = Replay::new(parameters, sampling, tolerance);
        if self.is_absolute {
            replay.show_relative_to(self.ambient);
        }
        if let Some(shown) = self.supply_pressure {
            replay.begin_supplied(shown);
        }
        // The chamber was filled by commands before the log began.
        let command = self
            .command
            .filter(|&command| command != Command::default());
        if let Some(command) = command.filter(|_| self.is_filled) {
            replay.begin_under(command);
            // An open valve moves air before the first row.
            replay.advance_to_ns(conditions.first_row_ns());
        }
        if let Some(pressure) = self.pressure {
            let ratio = self.warmth(&mut replay, conditions, 0.0);
            let pressure = pressure + self.change_of_ambient(&replay);
            replay.begin_showing(pressure / ratio);
            let excess_k = conditions.start_gas.excess_k;
            if excess_k != 0.0 {
                // Where the temperature is not a state, a pressure ratio in each row accounts for the warm gas.
                let kelvin = parameters.gas.temperature_k + excess_k;
                replay.simulator().set_gas_temperature(kelvin);
            }
        }
        replay
    }

    /// Returns the change of a logged pressure (Pa) at the ambient pressure of `replay`: a gauge pressure is relative to it.
    fn change_of_ambient(&self, replay: &Replay) -> f64 {
        replay.gauge_reference() - self.ambient
    }

    /// Returns the true pressure over that of `replay`, whose gas has the temperature of the wall, at `time_s` since the first row. 1 where
    /// the gas temperature is a state of the plant, because that state already began warm.
    pub(crate) fn warmth(&self, replay: &mut Replay, conditions: &Conditions, time_s: f64) -> f64 {
        match replay.simulator().has_gas_temperature() {
            true => 1.0,
            false => conditions.start_gas.pressure_ratio(self.wall_k, time_s),
        }
    }

    /// Advances `replay` to `input`, which is in the time of the ECU, where the pressure is `warmth` times that of gas at the temperature
    /// of the wall. None if the simulation was aborted.
    pub(crate) fn row(&self, replay: &mut Replay, input: ReplayInput, warmth: f64) -> Option<Row> {
        let mut row = replay.row(input);
        if replay.simulator().is_aborted() {
            return None;
        }
        if warmth != 1.0 {
            let reference_bar = replay.gauge_reference() / PA_PER_BAR;
            let shown = &mut row[self.pressure_place];
            *shown = (*shown + reference_bar) * warmth - reference_bar;
        }
        Some(row)
    }

    /// Corrects the pressure of `replay` by `gain` times the error of what its sensor shows in `row`, where `measured_bar` was measured;
    /// not where that is missing (NaN).
    pub(crate) fn correct(
        &self,
        replay: &mut Replay,
        row: &Row,
        warmth: f64,
        measured_bar: f64,
        gain: f64,
    ) {
        let error = measured_bar - row[self.pressure_place];
        if error.is_finite() && gain > 0.0 {
            let simulator = replay.simulator();
            let corrected = simulator.state().pressure + gain * error * PA_PER_BAR / warmth;
            simulator.set_chamber_pressure(corrected.max(LEAST_PRESSURE));
        }
    }

    /// Restarts at the measured pressure where row `index` is the last one of a gap. `ahead` returns the rows after it in the time of the
    /// ECU, each with its measured pressure (bar gauge; NaN where missing).
    ///
    /// Commands in the gap leave the gas at an unknown temperature. Where that is a state of the plant, the pressures that follow show it.
    pub(crate) fn restart<I: Iterator<Item = (ReplayInput, f64)>>(
        &self,
        replay: &mut Replay,
        index: usize,
        ahead: impl Fn() -> I,
    ) {
        let Some(restart) = Restart::at(&self.restarts, index) else {
            return;
        };
        let restart = &Restart {
            pressure: restart.pressure + self.change_of_ambient(replay),
            ..*restart
        };
        replay.begin_showing(restart.pressure);
        let is_last = Restart::at(&self.restarts, index + 1).is_none();
        if is_last && replay.simulator().has_gas_temperature() {
            let errors = |gas: &Gas| {
                let mut replay = replay.clone();
                gas.put(&mut replay, self.wall_k);
                let end_ns = replay.time_ns() + Gas::SHOWN_NS;
                let rows = ahead().take_while(|(input, _)| input.time_ns < end_ns);
                let errors = rows.map(|(input, measured_bar)| {
                    let row = self.row(&mut replay, input, 1.0)?;
                    Some(measured_bar - row[self.pressure_place])
                });
                errors.collect()
            };
            if let Some(gas) = Gas::after_gap(restart, &self.usual_gas, errors) {
                gas.put(replay, self.wall_k);
            }
        }
    }
}
