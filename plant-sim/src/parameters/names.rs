//! Names in a plant file that are not parameters, and special tables.

use crate::description::{LagOf, SensorPlace};
use crate::valve::ValveFunction;

/// `[valves]`: functions of the two valves.
pub(super) const VALVES: &str = "valves";
pub(super) const VALVE_KEYS: [&str; 2] = ["fill", "vent"];
pub(super) const FUNCTIONS: [(&str, ValveFunction); 7] = [
    ("normally_closed", ValveFunction::NormallyClosed),
    ("normally_open", ValveFunction::NormallyOpen),
    ("on_off", ValveFunction::OnOff),
    ("proportional", ValveFunction::Proportional),
    ("always_open", ValveFunction::AlwaysOpen),
    ("blocked", ValveFunction::Blocked),
    ("absent", ValveFunction::Absent),
];

/// Keys that a file omits if they are 0.
pub(super) const OMITTED_IF_0: [(&str, &str); 12] = [
    ("gas", "thermometer_wall_share"),
    ("gas", "supply_gauge_offset_bar"),
    (CHAMBER, "growth_m3_per_bar"),
    (CHAMBER, "growth_pressure_bar"),
    ("proportional_fill", "opens_at_pct"),
    ("proportional_fill", "above_line_25_pct"),
    ("proportional_fill", "above_line_50_pct"),
    ("proportional_fill", "above_line_75_pct"),
    ("proportional_vent", "opens_at_pct"),
    ("proportional_vent", "above_line_25_pct"),
    ("proportional_vent", "above_line_50_pct"),
    ("proportional_vent", "above_line_75_pct"),
];

/// Table that a plant without chamber omits.
pub(super) const CHAMBER: &str = "chamber";

/// Table that a plant with one chamber omits.
pub(super) const SECOND_CHAMBER: &str = "second_chamber";

/// Key of that table with the place of the pressure sensor, in words; a file omits the first one.
pub(super) const SENSOR: &str = "pressure_sensor";
pub(super) const SENSOR_PLACES: [(&str, SensorPlace); 2] = [
    ("second_chamber", SensorPlace::SecondChamber),
    ("chamber", SensorPlace::Chamber),
];

/// Tables of on/off valves.
pub(super) const ON_OFF: [&str; 2] = ["on_off_fill", "on_off_vent"];

/// Tables of proportional valves, and their key with the part that lags, in words.
pub(super) const PROPORTIONAL: [&str; 2] = ["proportional_fill", "proportional_vent"];
pub(super) const LAG_OF: &str = "lag_of";
pub(super) const LAGS: [(&str, LagOf); 2] = [("spool", LagOf::Spool), ("opening", LagOf::Opening)];

impl LagOf {
    /// Returns its word in a plant file.
    pub fn word(self) -> &'static str {
        let [(spool, _), (opening, _)] = LAGS;
        match self {
            Self::Spool => spool,
            Self::Opening => opening,
        }
    }

    /// Returns the motion of a valve, as a clause.
    pub fn statement(self) -> &'static str {
        match self {
            Self::Spool => {
                "the spool follows the command with the lag, and its position gives the opening"
            }
            Self::Opening => "the opening follows with the lag what the command gives at rest",
        }
    }

    /// Returns the part with this word.
    pub fn of_word(word: &str) -> Option<Self> {
        let known = LAGS.iter().find(|(known, _)| *known == word);
        known.map(|(_, lag_of)| *lag_of)
    }
}

/// Optional table of a plant file.
pub(super) const REGULATING_VALVE: &str = "regulating_valve";

/// Key with the form of an effect's law.
pub(super) const VARIANT: &str = "variant";
