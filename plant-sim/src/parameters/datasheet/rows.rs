//! Values that data sheets give, in their words and units, and what a plant has of them.

use crate::description::{PA_PER_BAR, ParameterSpec, SensorPlace};

/// Value of a data sheet: parameter = value * `factor` + `offset`.
pub(super) struct Row {
    pub(super) key: &'static str,
    /// Parameter of a plant file that follows from it.
    pub(super) name: &'static str,
    pub(super) factor: f64,
    pub(super) offset: f64,
}

impl Row {
    /// Returns the value of a parameter in the unit of the key.
    pub(super) fn in_its_unit(&self, value: f64) -> f64 {
        (value - self.offset) / self.factor
    }

    /// Returns the allowed values in the unit of the key.
    pub(super) fn range(&self, spec: &ParameterSpec) -> (f64, f64) {
        let (least, most) = spec.range;
        (self.in_its_unit(least), self.in_its_unit(most))
    }
}

const fn row(key: &'static str, name: &'static str, factor: f64) -> Row {
    Row {
        key,
        name,
        factor,
        offset: 0.0,
    }
}

pub(super) const MILLI: f64 = 1e-3;
const CM3: f64 = 1e-6;
/// Sonic conductance (dm³/(s bar)) of choked air at 20 °C over the flow coefficient K_v (m³/h), with the ratio x_T = 0.72 of valves with a seat
/// (IEC 60534-2-1, equation of choked flow): 94.8 · 2/3 · sqrt(0.72 · 28.97 / 293.15) kg/h per bar.
pub(super) const C_PER_KV: f64 = 3.95;
/// The same over C_v (gallons of water per minute): K_v is 0.865 times as large.
pub(super) const C_PER_CV: f64 = 0.865 * C_PER_KV;

/// All values of data sheets.
#[rustfmt::skip]
pub(super) static ROWS: [Row; 65] = [
    row("supply_pressure_bar_gauge", "gas.supply_pressure_bar_gauge", 1.0),
    row("ambient_pressure_bar_abs", "gas.ambient_pressure_pa", PA_PER_BAR),
    Row { offset: 273.15, ..row("temperature_c", "gas.temperature_k", 1.0) },
    row("command_frequency_hz", "ecu.pwm_frequency_hz", 1.0),
    row("sample_time_ms", "ecu.sample_time_s", MILLI),
    row("command_delay_ms", "ecu.command_delay_s", MILLI),
    row("supply_voltage_v", "ecu.supply_voltage_v", 1.0),
    row("diode_drop_v", "ecu.free_wheel_diode_drop_v", 1.0),
    row("chamber_volume_cm3", "chamber.volume_m3", CM3),
    row("hose_growth_cm3_per_bar", "chamber.growth_m3_per_bar", CM3),
    row("hose_growth_pressure_bar", "chamber.growth_pressure_bar", 1.0),
    row("second_volume_cm3", "second_chamber.volume_m3", CM3),
    row("line_C_dm3_per_s_bar", "second_chamber.conductance_dm3_per_s_bar", 1.0),
    row("line_b", "second_chamber.critical_ratio", 1.0),
    row("fill_C_dm3_per_s_bar", "on_off_fill.conductance_dm3_per_s_bar", 1.0),
    row("fill_Kv_m3_per_h", "on_off_fill.conductance_dm3_per_s_bar", C_PER_KV),
    row("fill_Cv", "on_off_fill.conductance_dm3_per_s_bar", C_PER_CV),
    row("fill_b", "on_off_fill.critical_ratio", 1.0),
    row("fill_opening_delay_ms", "on_off_fill.opening_delay_s", MILLI),
    row("fill_closing_delay_ms", "on_off_fill.closing_delay_s", MILLI),
    row("fill_opening_ramp_ms", "on_off_fill.opening_ramp_s", MILLI),
    row("fill_closing_ramp_ms", "on_off_fill.closing_ramp_s", MILLI),
    row("vent_C_dm3_per_s_bar", "on_off_vent.conductance_dm3_per_s_bar", 1.0),
    row("vent_Kv_m3_per_h", "on_off_vent.conductance_dm3_per_s_bar", C_PER_KV),
    row("vent_Cv", "on_off_vent.conductance_dm3_per_s_bar", C_PER_CV),
    row("vent_b", "on_off_vent.critical_ratio", 1.0),
    row("vent_opening_delay_ms", "on_off_vent.opening_delay_s", MILLI),
    row("vent_closing_delay_ms", "on_off_vent.closing_delay_s", MILLI),
    row("vent_opening_ramp_ms", "on_off_vent.opening_ramp_s", MILLI),
    row("vent_closing_ramp_ms", "on_off_vent.closing_ramp_s", MILLI),
    row("fill_C_dm3_per_s_bar", "proportional_fill.conductance_dm3_per_s_bar", 1.0),
    row("fill_Kv_m3_per_h", "proportional_fill.conductance_dm3_per_s_bar", C_PER_KV),
    row("fill_Cv", "proportional_fill.conductance_dm3_per_s_bar", C_PER_CV),
    row("fill_b", "proportional_fill.critical_ratio", 1.0),
    row("fill_time_constant_ms", "proportional_fill.time_constant_s", MILLI),
    row("fill_opens_at_pct", "proportional_fill.opens_at_pct", 1.0),
    Row { offset: -25.0, ..row("fill_open_share_25_pct", "proportional_fill.above_line_25_pct", 1.0) },
    Row { offset: -50.0, ..row("fill_open_share_50_pct", "proportional_fill.above_line_50_pct", 1.0) },
    Row { offset: -75.0, ..row("fill_open_share_75_pct", "proportional_fill.above_line_75_pct", 1.0) },
    row("vent_C_dm3_per_s_bar", "proportional_vent.conductance_dm3_per_s_bar", 1.0),
    row("vent_Kv_m3_per_h", "proportional_vent.conductance_dm3_per_s_bar", C_PER_KV),
    row("vent_Cv", "proportional_vent.conductance_dm3_per_s_bar", C_PER_CV),
    row("vent_b", "proportional_vent.critical_ratio", 1.0),
    row("vent_time_constant_ms", "proportional_vent.time_constant_s", MILLI),
    row("vent_opens_at_pct", "proportional_vent.opens_at_pct", 1.0),
    Row { offset: -25.0, ..row("vent_open_share_25_pct", "proportional_vent.above_line_25_pct", 1.0) },
    Row { offset: -50.0, ..row("vent_open_share_50_pct", "proportional_vent.above_line_50_pct", 1.0) },
    Row { offset: -75.0, ..row("vent_open_share_75_pct", "proportional_vent.above_line_75_pct", 1.0) },
    row("orifice_fill_mm", "flow.orifice_fill_m", MILLI),
    row("orifice_vent_mm", "flow.orifice_vent_m", MILLI),
    row("discharge_fill", "flow.discharge_fill", 1.0),
    row("discharge_vent", "flow.discharge_vent", 1.0),
    row("critical_ratio", "flow.critical_ratio", 1.0),
    row("coil_resistance_ohm", "coil.resistance_20c_ohm", 1.0),
    row("inductance_released_h", "coil.inductance_closed_h", 1.0),
    row("inductance_pulled_h", "coil.inductance_open_h", 1.0),
    row("magnet_constant_n_m2_per_a2", "magnet.force_constant_n_m2_per_a2", 1.0),
    row("effective_gap_mm", "magnet.gap_closed_m", MILLI),
    row("stroke_mm", "armature.stroke_m", MILLI),
    row("armature_mass_g", "armature.mass_kg", MILLI),
    row("viscous_friction_ns_per_m", "armature.viscous_friction_ns_per_m", 1.0),
    row("spring_n_per_mm", "armature.spring_n_per_m", 1e3),
    row("preload_fill_n", "armature.preload_fill_n", 1.0),
    row("preload_vent_n", "armature.preload_vent_n", 1.0),
    row("pressure_face_fill_mm", "armature.pressure_force_diameter_m", MILLI),
];

/// Keys without a parameter: they describe the logger, or a plant has one value for both valves.
pub(super) const WITHOUT_PARAMETER: [&str; 6] = [
    "pressure_face_vent_mm",
    "sensor_range_bar",
    "logger_rate_hz",
    "rig",
    "drive",
    "currents",
];
/// Words for the place of the sensor in a plant with two chambers; a word of the text decides.
pub(super) const SENSOR_PLACES: [(&str, &str, SensorPlace); 3] = [
    (
        "second",
        "in the second chamber",
        SensorPlace::SecondChamber,
    ),
    ("each", "one in each chamber", SensorPlace::SecondChamber),
    ("first", "in the first chamber", SensorPlace::Chamber),
];
/// Kinds of the valves, in the words of a plant file.
pub(super) const VALVES: [&str; 2] = ["fill_valve", "vent_valve"];
/// Begin of the keys of a characteristic, and the distance from a straight line (%) that they may have where the data sheet gives none.
pub(super) const ABOVE_LINE: &str = "above_line";
pub(super) const CURVATURE_PCT: f64 = 15.0;
/// Value that only a proportional valve has.
pub(super) const TIME_CONSTANTS: [&str; 2] = ["fill_time_constant_ms", "vent_time_constant_ms"];
/// Values of which an on/off and a proportional valve have one.
pub(super) const CONDUCTANCES: [[&str; 3]; 2] = [
    ["fill_C_dm3_per_s_bar", "fill_Kv_m3_per_h", "fill_Cv"],
    ["vent_C_dm3_per_s_bar", "vent_Kv_m3_per_h", "vent_Cv"],
];
/// Allowed conductances and flow coefficients of a valve with a coil.
pub(super) const CONDUCTANCE_RANGE: (f64, f64) = (1e-4, 1e3);
/// Other keys from which a parameter of a valve with a coil follows.
pub(super) const ALTERNATIVES: [(&str, &str); 4] = [
    (
        "coil.resistance_20c_ohm",
        "`coil_power_w` or `coil_current_ma`, with `coil_voltage_v`",
    ),
    (
        "magnet.force_constant_n_m2_per_a2",
        "`fill_valve_opens_at_ma` or `fill_valve_opens_at_v`, without pressure",
    ),
    (
        "flow.orifice_fill_m",
        "`fill_C_dm3_per_s_bar`: alone for an on/off valve, with `fill_valve = \"normally_closed\"` for one with a coil",
    ),
    (
        "flow.orifice_vent_m",
        "`vent_C_dm3_per_s_bar`: alone for an on/off valve, with `vent_valve = \"normally_closed\"` for one with a coil",
    ),
];
/// Parameter that follows from the frequency of the commands where it is not given.
pub(super) const SAMPLE_TIME: &str = "ecu.sample_time_s";
/// Values that data sheets omit.
pub(super) const USUAL: [(&str, f64); 6] = [
    ("gas.gas_constant_j_per_kg_k", 287.05),
    ("gas.heat_capacity_ratio", 1.4),
    ("gas.temperature_k", 293.15),
    ("gas.ambient_pressure_pa", 101_325.0),
    ("flow.critical_ratio", 0.528),
    ("coil.resistance_temperature_coefficient_per_k", 0.0039),
];
