//! Conversion of parameters into physics.

use super::parts::Part;
use crate::additions::{Additions, Cavity, Growth, Tube};
use crate::armature::Armature;
use crate::chamber::Chamber;
use crate::coil::Coil;
use crate::description::{
    EffectSetting, LagOf, OnOffValveParameters, PA_PER_BAR, PlantParameters,
    ProportionalValveParameters, SensorPlace,
};
use crate::effects::LIBRARY;
use crate::magnet::Magnet;
use crate::orifice::{NozzleLaw, Orifice, Subsonic};
use crate::plant::{FILL, Plant, VENT};
use crate::restriction::Mouth;
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

/// Armature of a valve without a coil: no force but its friction acts on it, so that the command gives it its velocity. Its position is the
/// open share of 1 mm.
const FREE: (Magnet, Armature) = (
    Magnet {
        force_constant: 0.0,
        gap: 2.0,
    },
    Armature {
        mass: 1e9,
        stroke: 1e-3,
        viscous_friction: 0.0,
        spring_rate: 0.0,
        preload: 0.0,
        pressure_area: 0.0,
    },
);

/// Density of air (kg/m³) and temperature (K) to which a conductance refers (ISO 6358-1: ANR).
const REFERENCE_AIR: (f64, f64) = (1.185, 293.15);
/// Conversion of dm³/(s bar) into m³/(s Pa).
const M3_PER_PA_S: f64 = 1e-8;

/// Coil with a negligible current, in case it is commanded.
const NO_COIL: Coil = Coil {
    resistance: 1e9,
    inductance_at_rest: 1.0,
    inductance_slope: 0.0,
};

/// Returns a valve whose opening is the open share of its conductance, given its effective area (m²) when open, the law of its flow (E63) and
/// the viscous friction (N s/m) of its free armature.
fn free_valve(
    function: ValveFunction,
    area: f64,
    nozzle: NozzleLaw,
    viscous_friction: f64,
) -> Valve {
    let (magnet, armature) = FREE;
    // A curtain of this diameter reaches its largest area at full stroke.
    let diameter = 4.0 * armature.stroke;
    let bore = core::f64::consts::PI * (diameter / 2.0).powi(2);
    Valve {
        coil: NO_COIL,
        magnet,
        orifice: Orifice::new(diameter, area / bore),
        armature: Armature {
            viscous_friction,
            ..armature
        },
        nozzle,
        function,
    }
}

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
        let valves = [FILL, VENT].map(|index| match self.functions[index] {
            ValveFunction::OnOff => self.on_off_valve(index),
            ValveFunction::Proportional => self.proportional_valve(index),
            _ => self.valve(index, &nozzle),
        });
        let [fill, vent] = &valves;
        Plant {
            subsonic: SubsonicCurves::new([&fill.nozzle, &vent.nozzle]),
            valves,
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
            additions: Additions {
                growth: Growth::new(
                    self.chamber.growth_m3_per_bar / PA_PER_BAR,
                    self.chamber.growth_pressure_bar * PA_PER_BAR,
                    gas.ambient_pressure_pa,
                ),
                cavity: self.second_chamber(),
                ..Additions::default()
            },
        }
    }

    /// Returns the parameters of the on/off valve in the place `index`.
    pub(crate) fn on_off(&self, index: usize) -> &OnOffValveParameters {
        [&self.on_off_fill, &self.on_off_vent][index]
    }

    /// Returns the parameters of the proportional valve in the place `index`.
    pub(crate) fn proportional(&self, index: usize) -> &ProportionalValveParameters {
        [&self.proportional_fill, &self.proportional_vent][index]
    }

    pub(super) fn proportional_mut(&mut self, index: usize) -> &mut ProportionalValveParameters {
        match index {
            FILL => &mut self.proportional_fill,
            _ => &mut self.proportional_vent,
        }
    }

    /// Returns the places of the proportional valves of which the plant file leaves open which part lags.
    pub fn with_open_lag(&self) -> impl Iterator<Item = usize> {
        [FILL, VENT].into_iter().filter(|&valve| {
            self.functions[valve] == ValveFunction::Proportional
                && self.proportional(valve).lag_of.is_none()
        })
    }

    /// Returns the plant with this part that lags in each proportional valve that leaves it open.
    pub fn with_lag_of(&self, lag_of: Option<LagOf>) -> Self {
        let mut plant = self.clone();
        for valve in self.with_open_lag() {
            plant.proportional_mut(valve).lag_of = lag_of;
        }
        plant
    }

    fn on_off_valve(&self, index: usize) -> Valve {
        let OnOffValveParameters {
            conductance_dm3_per_s_bar,
            critical_ratio,
            ..
        } = *self.on_off(index);
        let (area, nozzle) = self.iso6358(conductance_dm3_per_s_bar, critical_ratio);
        free_valve(self.functions[index], area, nozzle, 0.0)
    }

    /// Returns a proportional valve; its friction gives it the time constant of its lag.
    fn proportional_valve(&self, index: usize) -> Valve {
        let ProportionalValveParameters {
            conductance_dm3_per_s_bar,
            critical_ratio,
            time_constant_s,
            ..
        } = *self.proportional(index);
        let (area, nozzle) = self.iso6358(conductance_dm3_per_s_bar, critical_ratio);
        let viscous_friction = FREE.1.mass / time_constant_s;
        free_valve(self.functions[index], area, nozzle, viscous_friction)
    }

    /// Returns the effective area (m²) and the law of a flow with conductance C (dm³/(s bar)) and critical ratio b (E63).
    fn iso6358(&self, conductance: f64, critical_ratio: f64) -> (f64, NozzleLaw) {
        let gas = &self.gas;
        let nozzle = NozzleLaw::with_branch(
            gas.heat_capacity_ratio,
            gas.gas_constant_j_per_kg_k,
            gas.temperature_k,
            critical_ratio,
            Subsonic::Ellipse,
        );
        let (density, temperature) = REFERENCE_AIR;
        let choked_flow =
            conductance * M3_PER_PA_S * density * (temperature / gas.temperature_k).sqrt();
        (choked_flow / nozzle.choked_factor(), nozzle)
    }

    /// Returns the second chamber with its line, if there is one.
    fn second_chamber(&self) -> Option<Cavity> {
        let second = &self.second_chamber;
        let is_there = Part::SecondChamber.is_in(self);
        is_there.then(|| {
            let (effective_area, nozzle) =
                self.iso6358(second.conductance_dm3_per_s_bar, second.critical_ratio);
            Cavity {
                volume: second.volume_m3,
                tube: Tube::Line(
                    Mouth::new(effective_area, second.volume_m3, &nozzle, self.gas.rt()),
                    Box::new(nozzle),
                ),
                holds_the_sensor: second.sensor == SensorPlace::SecondChamber,
                has_the_leak: true,
            }
        })
    }

    fn valve(&self, index: usize, nozzle: &NozzleLaw) -> Valve {
        let (armature, flow) = (&self.armature, &self.flow);
        let preload = [armature.preload_fill_n, armature.preload_vent_n][index];
        let orifice = [flow.orifice_fill_m, flow.orifice_vent_m][index];
        let discharge = [flow.discharge_fill, flow.discharge_vent][index];
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
            nozzle: nozzle.clone(),
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
