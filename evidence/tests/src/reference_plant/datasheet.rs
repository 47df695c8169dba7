//! Values of `data/nominal-plant.toml`, read by this plant's own code.

use serde::Deserialize;

/// Values of the datasheet; keys and units are those of the file.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Datasheet {
    pub ecu: Ecu,
    pub coil: Coil,
    pub magnet: Magnet,
    pub armature: Armature,
    pub flow: Flow,
    pub gas: Gas,
    pub chamber: Chamber,
}

/// Section `[ecu]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Ecu {
    pub sample_time_s: f64,
    pub pwm_frequency_hz: f64,
    pub command_delay_s: f64,
    pub supply_voltage_v: f64,
    pub free_wheel_diode_drop_v: f64,
}

/// Section `[coil]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Coil {
    pub resistance_20c_ohm: f64,
    pub resistance_temperature_coefficient_per_k: f64,
    pub inductance_closed_h: f64,
    pub inductance_open_h: f64,
}

/// Section `[magnet]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Magnet {
    pub force_constant_n_m2_per_a2: f64,
    pub gap_closed_m: f64,
}

/// Section `[armature]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Armature {
    pub mass_kg: f64,
    pub stroke_m: f64,
    pub viscous_friction_ns_per_m: f64,
    pub spring_n_per_m: f64,
    pub pressure_force_diameter_m: f64,
    pub preload_fill_n: f64,
    pub preload_vent_n: f64,
}

/// Section `[flow]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Flow {
    pub orifice_fill_m: f64,
    pub orifice_vent_m: f64,
    pub discharge_fill: f64,
    pub discharge_vent: f64,
}

/// Section `[gas]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Gas {
    pub gas_constant_j_per_kg_k: f64,
    pub heat_capacity_ratio: f64,
    pub temperature_k: f64,
    pub supply_pressure_bar_gauge: f64,
    pub ambient_pressure_pa: f64,
}

/// Section `[chamber]`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[allow(missing_docs, reason = "the file describes its keys")]
pub struct Chamber {
    pub volume_m3: f64,
}

impl Datasheet {
    /// Reads the bundled file.
    ///
    /// # Panics
    /// Panics if the file lacks a value that this plant needs; a test reads it.
    pub fn bundled() -> Self {
        toml::from_str(include_str!("../../../../data/nominal-plant.toml"))
            .expect("the bundled datasheet has every key of this plant")
    }
}
