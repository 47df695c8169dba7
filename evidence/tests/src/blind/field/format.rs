//! Sealed answer of a field rig.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::super::format::{Hidden, Profile};
use super::super::score::finding::BySignal;

/// Version of the sealed answers.
pub const FIELD_SCHEMA: &str = "retarder.field-answer/1";

/// Answer of a field rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FieldAnswer {
    /// [`FIELD_SCHEMA`].
    pub schema: String,
    /// Name of the rig, as in the names of its logs.
    pub rig: String,
    /// Effects beyond the plain plant.
    pub hidden: Vec<Hidden>,
    /// Removal cost of each hidden effect: rms residual of the check log's readings for the rig without the effect,
    /// after its ordinary parameters are fitted; by logged signal, in units of the noise and converter steps of the
    /// channel.
    #[serde(default)]
    pub cost_if_left_out: BTreeMap<String, BySignal>,
    /// Whether the vent valve is open without current.
    pub is_vent_normally_open: bool,
    /// True values of all parameters that the draw changes, by their names in a plant file.
    pub parameters: BTreeMap<String, f64>,
    /// Logger.
    pub logger: LoggerAnswer,
    /// The id log and the check log.
    pub logs: [LogAnswer; 2],
}

impl FieldAnswer {
    /// Returns the removal cost of a hidden effect in the signal with the largest one (noise floors).
    pub fn removal_cost(&self, effect: &str) -> f64 {
        let costs = self.cost_if_left_out.get(effect);
        costs.map_or(0.0, |costs| costs.values().copied().fold(0.0, f64::max))
    }

    /// Returns the kind of the rig and of its logs, in words.
    pub fn kind(&self) -> String {
        let logger = &self.logger;
        let valves = if self.is_vent_normally_open {
            "vent normally open"
        } else {
            "normally closed"
        };
        let signals = match (logger.currents, logger.supply_pressure) {
            (true, true) => "currents, supply",
            (true, false) => "currents",
            (false, true) => "supply",
            (false, false) => "pressure alone",
        };
        let warm = match self.logs.each_ref().map(|log| log.relaxation_s > 0.0) {
            [true, true] => ", both logs begin warm",
            [true, false] => ", id log begins warm",
            [false, true] => ", check log begins warm",
            [false, false] => "",
        };
        format!(
            "{valves}, {:.0} Hz, {} bits, {:.1} mbar, {signals}{warm}",
            logger.rate_hz,
            logger.bits,
            1e3 * logger.sensor_share * logger.noise_bar
        )
    }
}

/// Logger of a field rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoggerAnswer {
    /// Rows per logged second.
    pub rate_hz: f64,
    /// Excess of the true time over the logged one (ppm).
    pub clock_error_ppm: f64,
    /// Largest shift of a row from an even time base, as a share of the interval; its time stamp includes the shift.
    pub unevenness: f64,
    /// Resolution of the converter over its range.
    pub bits: usize,
    /// Noise of the pressure (bar, rms), before `sensor_share`.
    pub noise_bar: f64,
    /// Noise and converter steps of all channels relative to those that were drawn; below 1 for better sensors.
    #[serde(default = "as_drawn")]
    pub sensor_share: f64,
    /// Whether the currents are logged.
    pub currents: bool,
    /// Whether the supply pressure is logged.
    pub supply_pressure: bool,
}

fn as_drawn() -> f64 {
    1.0
}

/// Log of a field rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LogAnswer {
    /// Command profile.
    pub profile: Profile,
    /// Smallest number of ECU samples with one command.
    pub command_grid: usize,
    /// True time from the last ECU sample before the first row to that row (s).
    pub phase_s: f64,
    /// Begin and end of the gaps in logged time (s).
    pub gaps: Vec<[f64; 2]>,
    /// Pressure in the chamber at the first row (bar gauge).
    pub first_pressure_bar_gauge: f64,
    /// Temperature of the gas above that of the wall at the first row (K).
    pub first_surplus_k: f64,
    /// Time constant of its cooling by the wall (s); 0 if the log begins at rest.
    pub relaxation_s: f64,
}
