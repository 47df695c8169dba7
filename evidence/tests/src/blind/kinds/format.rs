//! Sealed answer of a rig of another kind.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use super::super::score::finding::BySignal;

/// Version of the sealed answers.
pub const KIND_SCHEMA: &str = "retarder.kind-answer/1";

/// Kind of a rig.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Two on/off valves at a rigid chamber.
    OnOff,
    /// Two on/off valves at a hose whose volume grows with the pressure.
    Hose,
    /// Two on/off valves at a first chamber, and a second one behind a line.
    SecondChamber,
    /// A proportional fill valve, and a vent valve that is proportional or on/off.
    Proportional,
}

impl Kind {
    /// All kinds, in the order of their rigs in a draw.
    pub const ALL: [Self; 4] = [
        Self::OnOff,
        Self::Hose,
        Self::SecondChamber,
        Self::Proportional,
    ];
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::OnOff => "on_off",
            Self::Hose => "hose",
            Self::SecondChamber => "second_chamber",
            Self::Proportional => "proportional",
        })
    }
}

/// Answer of a rig of another kind.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KindAnswer {
    /// [`KIND_SCHEMA`].
    pub schema: String,
    /// Name of the rig, as in the names of its logs.
    pub rig: String,
    /// Kind.
    pub kind: Kind,
    /// True values of the lines of the plate, in their units, and the pressure at the beginning.
    pub truth: BTreeMap<String, f64>,
    /// Hidden effects by their ids in the library, each with its true values by their keys there. A leak and a narrow
    /// place are given as the area of the ideal nozzle with the same choked flow.
    pub effects: BTreeMap<String, BTreeMap<String, f64>>,
    /// Rms change of the check log by leaving out a hidden effect while nothing is refitted: by effect and column of
    /// the pressure, in units of noise and converter steps.
    pub cost_if_left_out_noise_floors: BTreeMap<String, BySignal>,
    /// Logger.
    pub logger: KindLogger,
}

impl KindAnswer {
    /// Returns the cost of leaving out a hidden effect in the column with the largest one (noise floors).
    pub fn cost(&self, effect: &str) -> f64 {
        let costs = self.cost_if_left_out_noise_floors.get(effect);
        costs.map_or(0.0, |costs| costs.values().copied().fold(0.0, f64::max))
    }
}

/// Logger of a rig.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct KindLogger {
    /// Rows per logged second (Hz).
    pub rate_hz: f64,
    /// True time of the first row of each log (s).
    pub offset_of_first_row_s: [f64; 2],
    /// Excess of the true time over the logged one (ppm).
    pub clock_error_ppm: f64,
    /// Begin and end of the gaps of each log in logged time (s).
    pub gaps_s: [Vec<[f64; 2]>; 2],
    /// Lengths of the logs (s).
    pub lengths_s: [f64; 2],
    /// Resolution of the converter over its range.
    pub bits: usize,
    /// Range of the converter (bar).
    pub range_bar: f64,
    /// Noise of the pressure (bar, rms).
    pub noise_bar: f64,
    /// Whether the pressures are absolute.
    pub pressure_absolute: bool,
    /// Whether the supply pressure is logged.
    pub supply_pressure: bool,
    /// Whether the valves are logged as states 0 and 1 instead of duty cycles.
    pub states: bool,
    /// Whether the position of an actuator is logged.
    #[serde(default)]
    pub position: bool,
    /// Whether the supply voltage is logged.
    #[serde(default)]
    pub voltage: bool,
    /// Chambers whose pressure is logged: 0 for the first, 1 for the second.
    pub chambers: Vec<usize>,
}
