//! The names of a plant file that are no parameters, and the tables that are special.

use crate::valve::ValveFunction;

/// `[valves]`: what sits where the valves are.
pub(super) const VALVES: &str = "valves";
pub(super) const VALVE_KEYS: [&str; 2] = ["fill", "vent"];
pub(super) const FUNCTIONS: [(&str, ValveFunction); 5] = [
    ("normally_closed", ValveFunction::NormallyClosed),
    ("normally_open", ValveFunction::NormallyOpen),
    ("always_open", ValveFunction::AlwaysOpen),
    ("blocked", ValveFunction::Blocked),
    ("absent", ValveFunction::Absent),
];

/// The keys that a file leaves out where they are 0: those of sensors that a rig need not have.
pub(super) const OF_SENSORS: [(&str, &str); 2] = [
    ("gas", "thermometer_wall_share"),
    ("gas", "supply_gauge_offset_bar"),
];

/// The table that a plant without chamber leaves out.
pub(super) const CHAMBER: &str = "chamber";

/// The table of a plant file that may be absent.
pub(super) const REGULATING_VALVE: &str = "regulating_valve";

/// The key that names the form of an effect's law.
pub(super) const VARIANT: &str = "variant";
