//! From parameters to physics.

use super::values::PlantParameters;
use crate::additions::Additions;
use crate::armature::Armature;
use crate::chamber::Chamber;
use crate::coil::Coil;
use crate::effects::{EffectSetting, LIBRARY};
use crate::magnet::Magnet;
use crate::orifice::{NozzleLaw, Orifice};
use crate::plant::Plant;
use crate::subsonic_curves::SubsonicCurves;
use crate::valve::{Valve, ValveFunction};

impl PlantParameters {
    /// The physics that these parameters describe, effects included.
    pub fn plant(&self) -> Plant {
        let mut plant = self.thesis_plant();
        // In the order of the library, whatever the order in the file; effects of your own come last.
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

    /// The physics without effects.
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
            subsonic: SubsonicCurves::new(&nozzle),
            nozzle,
            chamber: Chamber::new(
                self.chamber.volume_m3,
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
