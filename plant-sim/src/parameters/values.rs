//! The values of a plant file, by its tables.

use std::collections::BTreeMap;

use crate::effects::EffectSetting;
use crate::valve::ValveFunction;

/// Everything a plant file says.
#[derive(Debug, Clone, PartialEq)]
pub struct PlantParameters {
    /// `[ecu]`
    pub ecu: EcuParameters,
    /// `[coil]`, of both valves.
    pub coil: CoilParameters,
    /// `[magnet]`, of both valves.
    pub magnet: MagnetParameters,
    /// `[armature]`, of both valves but for the preloads.
    pub armature: ArmatureParameters,
    /// `[flow]`
    pub flow: FlowParameters,
    /// `[gas]`
    pub gas: GasParameters,
    /// `[chamber]`; a volume of 0 is none.
    pub chamber: ChamberParameters,
    /// `[valves]`: what sits between supply and chamber (fill), and between chamber and drain (vent).
    pub functions: [ValveFunction; 2],
    /// `[regulating_valve]`: an output stage, where the file has one.
    pub regulating_valve: Option<RegulatingValveParameters>,
    /// `[effects.*]`: what this plant has beyond the thesis' model, each effect at most once.
    pub effects: Vec<EffectSetting>,
    /// Where each value comes from, by `section.key`; the comment behind the value in the file.
    pub provenance: BTreeMap<String, String>,
}

/// The ECU's sampling and output stage.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct EcuParameters {
    pub sample_time_s: f64,
    pub pwm_frequency_hz: f64,
    pub command_delay_s: f64,
    pub supply_voltage_v: f64,
    pub free_wheel_diode_drop_v: f64,
}

/// Coil of each valve.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct CoilParameters {
    pub resistance_20c_ohm: f64,
    pub resistance_temperature_coefficient_per_k: f64,
    pub inductance_closed_h: f64,
    pub inductance_open_h: f64,
}

/// Magnetic circuit of each valve.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct MagnetParameters {
    pub force_constant_n_m2_per_a2: f64,
    pub gap_closed_m: f64,
}

/// Armature and spring of each valve.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct ArmatureParameters {
    pub mass_kg: f64,
    pub stroke_m: f64,
    pub viscous_friction_ns_per_m: f64,
    pub spring_n_per_m: f64,
    pub pressure_force_diameter_m: f64,
    pub preload_fill_n: f64,
    pub preload_vent_n: f64,
}

/// Orifices and flow law.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct FlowParameters {
    pub orifice_fill_m: f64,
    pub orifice_vent_m: f64,
    pub discharge_fill: f64,
    pub discharge_vent: f64,
    pub critical_ratio: f64,
}

/// The gas and the pressures around the plant.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct GasParameters {
    pub gas_constant_j_per_kg_k: f64,
    pub heat_capacity_ratio: f64,
    pub temperature_k: f64,
    pub supply_pressure_bar_gauge: f64,
    pub ambient_pressure_pa: f64,
    pub thermometer_wall_share: f64,
}

/// The chamber.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct ChamberParameters {
    pub volume_m3: f64,
}

/// The regulating valve behind the chamber.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct RegulatingValveParameters {
    pub plunger_mass_kg: f64,
    pub air_area_m2: f64,
    pub oil_area_m2: f64,
    pub oil_pressure_bar_gauge: f64,
    pub spring_n_per_m: f64,
    pub preload_n: f64,
    pub static_friction_n: f64,
    pub dynamic_friction_n: f64,
    pub stroke_m: f64,
}

/// Pascal per bar.
pub const PA_PER_BAR: f64 = 1e5;

impl EcuParameters {
    /// ECU sample time (ns).
    pub fn sample_time_ns(&self) -> u64 {
        nanoseconds(self.sample_time_s)
    }

    /// PWM period (ns).
    pub fn pwm_period_ns(&self) -> u64 {
        nanoseconds(1.0 / self.pwm_frequency_hz)
    }

    /// Delay from a command to its effect at the output (ns).
    pub fn command_delay_ns(&self) -> u64 {
        nanoseconds(self.command_delay_s)
    }
}

fn nanoseconds(seconds: f64) -> u64 {
    (seconds * 1e9).round() as u64
}

impl GasParameters {
    /// Supply pressure (Pa abs).
    pub fn supply_pressure_pa(&self) -> f64 {
        self.supply_pressure_bar_gauge * PA_PER_BAR + self.ambient_pressure_pa
    }
}

impl PlantParameters {
    /// The effect `id` as this plant has it; none where it has not.
    pub fn effect(&self, id: &str) -> Option<&EffectSetting> {
        self.effects.iter().find(|setting| setting.id() == id)
    }

    /// The same plant with an effect, which replaces the one of the same id.
    #[must_use]
    pub fn with_effect(&self, setting: EffectSetting) -> Self {
        let mut plant = self.without_effect(setting.id());
        plant.effects.push(setting);
        plant
    }

    /// The same plant without the effect `id`.
    #[must_use]
    pub fn without_effect(&self, id: &str) -> Self {
        let mut plant = self.clone();
        plant.effects.retain(|setting| setting.id() != id);
        let prefix = format!("effects.{id}.");
        plant
            .provenance
            .retain(|name, _| !name.starts_with(&prefix));
        plant
    }

    /// To be filled from a file. What stays is what a plant without the part has around it: air at the standard
    /// atmosphere, and for the leaks of a chamber without supply the pressure at which pneumatic components are rated.
    pub(super) fn blank() -> Self {
        Self {
            ecu: EcuParameters::default(),
            coil: CoilParameters::default(),
            magnet: MagnetParameters::default(),
            armature: ArmatureParameters::default(),
            flow: FlowParameters {
                critical_ratio: 0.528,
                ..FlowParameters::default()
            },
            gas: GasParameters {
                gas_constant_j_per_kg_k: 287.05,
                heat_capacity_ratio: 1.4,
                temperature_k: 293.15,
                supply_pressure_bar_gauge: 6.3,
                ambient_pressure_pa: 101_325.0,
                thermometer_wall_share: 0.0,
            },
            chamber: ChamberParameters::default(),
            functions: [ValveFunction::NormallyClosed; 2],
            regulating_valve: None,
            effects: Vec::new(),
            provenance: BTreeMap::new(),
        }
    }
}
