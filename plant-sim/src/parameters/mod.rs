//! Parameters of the plant, as they stand in a plant file.
//!
//! A plant file is TOML with the unit in every key. [`PARAMETERS`] is the one list of all keys with unit,
//! range and meaning; reading, writing, checking and fitting all go through it.

mod error;
mod read;
mod table;
mod units;
mod write;

use std::collections::BTreeMap;

pub use error::{ParameterError, Problem};
pub use table::{PARAMETERS, ParameterSpec};

use crate::armature::Armature;
use crate::chamber::Chamber;
use crate::coil::Coil;
use crate::magnet::Magnet;
use crate::orifice::{NozzleLaw, Orifice};
use crate::plant::Plant;
use crate::regulating_valve::RegulatingValveParameters;
use crate::valve::{Valve, ValveFunction};

/// The plant file shipped with the crate: the thesis model.
pub const NOMINAL_PLANT_TOML: &str = include_str!("../../models/nominal-plant.toml");

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
    /// `[chamber]`
    pub chamber: ChamberParameters,
    /// `[valves]`: normally closed or normally open, fill and vent.
    pub functions: [ValveFunction; 2],
    /// `[regulating_valve]`: an output stage, where the file has one.
    pub regulating_valve: Option<RegulatingValveParameters>,
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
}

/// The chamber.
#[derive(Debug, Clone, PartialEq, Default)]
#[allow(missing_docs, reason = "each field is described in PARAMETERS")]
pub struct ChamberParameters {
    pub volume_m3: f64,
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
    /// The thesis model as shipped.
    pub fn nominal() -> Self {
        Self::from_toml(NOMINAL_PLANT_TOML, "nominal-plant.toml")
            .expect("the shipped plant file is checked by a test")
    }

    /// Reads a plant file; `name` is what errors call it.
    pub fn from_toml(text: &str, name: &str) -> Result<Self, ParameterError> {
        read::read(text, name)
    }

    /// The parameters as a plant file, with units, ranges and provenance as comments.
    pub fn to_toml(&self) -> String {
        write::write(self)
    }

    /// The value of `section.key`, where the plant has it.
    pub fn get(&self, name: &str) -> Option<f64> {
        ParameterSpec::by_name(name).and_then(|spec| spec.value(self))
    }

    /// Sets `section.key` after checking its range; says `provenance` from now on.
    pub fn set(&mut self, name: &str, value: f64, provenance: &str) -> Result<(), ParameterError> {
        let refuse = |problem| ParameterError::new(name, vec![problem]);
        let spec = ParameterSpec::by_name(name).ok_or_else(|| {
            refuse(Problem::UnknownKey {
                line: 0,
                key: name.to_owned(),
                suggestion: None,
            })
        })?;
        if !spec.contains(value) {
            return Err(refuse(Problem::OutOfRange {
                line: 0,
                spec,
                value,
            }));
        }
        let mut changed = self.clone();
        if let Some(slot) = (spec.slot)(&mut changed) {
            *slot = value;
        }
        changed
            .provenance
            .insert(name.to_owned(), provenance.to_owned());
        if let Some(problem) = changed.inconsistency() {
            return Err(refuse(problem));
        }
        *self = changed;
        Ok(())
    }

    /// What no single range can catch.
    fn inconsistency(&self) -> Option<Problem> {
        let at = |key: &'static str, rule: String| Some(Problem::Inconsistent { key, rule });
        if self.magnet.gap_closed_m <= self.armature.stroke_m {
            return at(
                "magnet.gap_closed_m",
                format!(
                    "the effective gap {} m must be larger than armature.stroke_m = {} m, else the magnetic force is infinite",
                    self.magnet.gap_closed_m, self.armature.stroke_m
                ),
            );
        }
        if let Some(valve) = &self.regulating_valve
            && valve.dynamic_friction_n > valve.static_friction_n
        {
            return at(
                "regulating_valve.dynamic_friction_n",
                format!(
                    "friction in motion, {} N, cannot exceed friction at rest, static_friction_n = {} N",
                    valve.dynamic_friction_n, valve.static_friction_n
                ),
            );
        }
        None
    }

    /// The physics that these parameters describe.
    pub fn plant(&self) -> Plant {
        let gas = &self.gas;
        Plant {
            valves: [
                self.valve(
                    self.functions[0],
                    self.armature.preload_fill_n,
                    self.flow.orifice_fill_m,
                    self.flow.discharge_fill,
                ),
                self.valve(
                    self.functions[1],
                    self.armature.preload_vent_n,
                    self.flow.orifice_vent_m,
                    self.flow.discharge_vent,
                ),
            ],
            nozzle: NozzleLaw::new(
                gas.heat_capacity_ratio,
                gas.gas_constant_j_per_kg_k,
                gas.temperature_k,
                self.flow.critical_ratio,
            ),
            chamber: Chamber::new(
                self.chamber.volume_m3,
                gas.gas_constant_j_per_kg_k,
                gas.temperature_k,
            ),
            supply_pressure: gas.supply_pressure_pa(),
            ambient_pressure: gas.ambient_pressure_pa,
            diode_drop: self.ecu.free_wheel_diode_drop_v,
        }
    }

    fn valve(&self, function: ValveFunction, preload: f64, orifice: f64, discharge: f64) -> Valve {
        let armature = &self.armature;
        let area = core::f64::consts::PI * (armature.pressure_force_diameter_m / 2.0).powi(2);
        Valve {
            coil: Coil {
                resistance: self.coil.resistance_20c_ohm,
                inductance_at_rest: self.coil.inductance_closed_h,
                inductance_slope: (self.coil.inductance_open_h - self.coil.inductance_closed_h)
                    / armature.stroke_m,
            },
            magnet: Magnet {
                force_constant: self.magnet.force_constant_n_m2_per_a2,
                gap: self.magnet.gap_closed_m,
            },
            armature: Armature {
                mass: armature.mass_kg,
                stroke: armature.stroke_m,
                viscous_friction: armature.viscous_friction_ns_per_m,
                spring_rate: armature.spring_n_per_m,
                preload,
                // The pressure lifts the seat: with the magnet in a normally closed valve, against it
                // in a normally open one.
                pressure_area: match function {
                    ValveFunction::NormallyClosed => area,
                    ValveFunction::NormallyOpen => -area,
                },
            },
            orifice: Orifice::new(orifice, discharge),
            function,
        }
    }
}
