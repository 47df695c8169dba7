//! Conversion of parameters into physics.

use super::parts::Part;
use crate::additions::Additions;
use crate::armature::Armature;
use crate::chamber::Chamber;
use crate::coil::Coil;
use crate::description::{EffectSetting, PlantParameters};
use crate::effects::LIBRARY;
use crate::magnet::Magnet;
use crate::orifice::{NozzleLaw, Orifice};
use crate::plant::{FILL, Plant, VENT};
use crate::subsonic_curves::SubsonicCurves;
use crate::valve::{Valve, ValveFunction};

/// Volume (m³) in a plant without chamber: nothing flows into it or out of it.
const ANY_VOLUME: f64 = 1.0;

/// Armature that cannot move.
const HELD: (Magnet, Armature) = (
    Magnet {
        force_constant: 0.0,
        gap: 2.0,
    },
    Armature {
        mass: 1.0,
        stroke: 1.0,
        viscous_friction: 0.0,
        spring_rate: 0.0,
        preload: 1.0,
        pressure_area: 0.0,
    },
);

/// Coil with a negligible current, in case it is commanded.
const NO_COIL: Coil = Coil {
    resistance: 1e9,
    inductance_at_rest: 1.0,
    inductance_slope: 0.0,
};

impl PlantParameters {
    /// Returns the physics of these parameters, including effects.
    pub fn plant(&self) -> Plant {
        let mut plant = self.thesis_plant();
        // In the order of the library, independent of the order in the file; user-defined effects come last.
        let rank = |setting: &&EffectSetting| {
            let id = setting.id();
            let place = LIBRARY.iter().position(|effect| effect.about().id == id);
            place.unwrap_or(LIBRARY.len())
        };
        let mut settings: Vec<_> = self.effects.iter().filter(|one| !one.is_off()).collect();
        settings.sort_by_key(rank);
        for setting in settings {
            setting.effect().install(setting, self, &mut plant);
        }
        plant
    }

    /// Returns the physics without effects.
    fn thesis_plant(&self) -> Plant {
        let gas = &self.gas;
        let nozzle = NozzleLaw::new(
            gas.heat_capacity_ratio,
            gas.gas_constant_j_per_kg_k,
            gas.temperature_k,
            self.flow.critical_ratio,
        );
        Plant {
            valves: [
                self.valve(
                    FILL,
                    self.armature.preload_fill_n,
                    self.flow.orifice_fill_m,
                    self.flow.discharge_fill,
                ),
                self.valve(
                    VENT,
                    self.armature.preload_vent_n,
                    self.flow.orifice_vent_m,
                    self.flow.discharge_vent,
                ),
            ],
            subsonic: SubsonicCurves::new(&nozzle),
            nozzle,
            chamber: Chamber::new(
                if Part::Chamber.is_in(self) {
                    self.chamber.volume_m3
                } else {
                    ANY_VOLUME
                },
                gas.gas_constant_j_per_kg_k,
                gas.temperature_k,
            ),
            supply_pressure: gas.supply_pressure_pa(),
            ambient_pressure: gas.ambient_pressure_pa,
            drain_pressure: gas.ambient_pressure_pa,
            diode_drop: self.ecu.free_wheel_diode_drop_v,
            additions: Additions::default(),
        }
    }

    fn valve(&self, index: usize, preload: f64, orifice: f64, discharge: f64) -> Valve {
        let function = self.functions[index];
        let (magnet, armature) = if function.has_armature() {
            self.moving(function, preload)
        } else {
            HELD
        };
        let stroke = armature.stroke;
        Valve {
            coil: if function.has_coil() {
                self.coil(function)
            } else {
                NO_COIL
            },
            magnet,
            armature,
            orifice: if Part::FlowThrough(index).is_in(self) {
                Orifice::new(orifice, discharge)
            } else {
                // No air, and no kink of the area within the stroke.
                Orifice::new(4.0 * stroke, 0.0)
            },
            function,
        }
    }

    fn coil(&self, function: ValveFunction) -> Coil {
        let Self { coil, armature, .. } = self;
        Coil {
            resistance: coil.resistance_20c_ohm,
            inductance_at_rest: coil.inductance_closed_h,
            inductance_slope: if function.has_armature() {
                (coil.inductance_open_h - coil.inductance_closed_h) / armature.stroke_m
            } else {
                0.0
            },
        }
    }

    fn moving(&self, function: ValveFunction, preload: f64) -> (Magnet, Armature) {
        let Self {
            magnet, armature, ..
        } = self;
        let area = core::f64::consts::PI * (armature.pressure_force_diameter_m / 2.0).powi(2);
        let magnet = Magnet {
            force_constant: magnet.force_constant_n_m2_per_a2,
            gap: magnet.gap_closed_m,
        };
        let armature = Armature {
            mass: armature.mass_kg,
            stroke: armature.stroke_m,
            viscous_friction: armature.viscous_friction_ns_per_m,
            spring_rate: armature.spring_n_per_m,
            preload,
            // The pressure lifts the seat: in the direction of the magnet in a normally closed valve, against it in a
            // normally open one.
            pressure_area: if function == ValveFunction::NormallyOpen {
                -area
            } else {
                area
            },
        };
        (magnet, armature)
    }
}
