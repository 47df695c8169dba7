//! Names in a plant file that are not parameters, and special tables.

use crate::description::SensorPlace;
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

/// Optional table of a plant file.
pub(super) const REGULATING_VALVE: &str = "regulating_valve";

/// Key with the form of an effect's law.
pub(super) const VARIANT: &str = "variant";
