//! Effect: the chamber grows with the pressure, by the plunger of the regulating valve or by walls that widen.

use crate::additions::Plunger;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PA_PER_BAR, PlantParameters, Variant,
    effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.regulating_valve_volume":
    SWEPT = swept_volume_m3 ["m3"] 1e-8 ..= 1e-2, Log 1e-5, off 0.0,
        "volume that the plunger sweeps over its whole travel (E53)";
    BEGIN = begin_bar ["bar gauge"] 0.0 ..= 20.0, Linear 1.4,
        "chamber pressure at which the plunger leaves its stop (E53)";
    TRAVEL = travel_bar ["bar"] 0.1 ..= 40.0, Log 4.5,
        "rise of the chamber pressure over the plunger's whole travel (E53)";
    FRICTION = friction_bar ["bar"] 0.001 ..= 5.0, Log 0.1,
        "pressure that the plunger's friction holds (E53)";
    DAMPING = damping_s ["s"] 1e-3 ..= 10.0, Log 0.02,
        "time constant with which the plunger follows the pressure (E53)";
    COMPLIANCE = compliance_m3_per_bar ["m3/bar"] 1e-9 ..= 1e-3, Log 5e-7, off 0.0,
        "volume by which hoses and walls widen per bar (E53)";
    CREEP = creep_s ["s"] 1e-3 ..= 100.0, Log 0.5,
        "time constant with which hoses and walls follow the pressure (E53)";
}

/// Rise of the pressure (Pa) up to which walls widen in proportion.
const WIDENING: f64 = 100.0 * PA_PER_BAR;

static ABOUT: About = About {
    id: "regulating_valve_volume",
    sentence: "The plunger of the regulating valve, a hose or a wall gives way to the pressure, so the chamber is larger at high pressure and takes more air for the last bar.",
    source: "E53: thesis, section 3.4 and equation 3.25 without the plunger's mass; a hose as a spring in parallel with a damper",
    acts_on: EntryPoint::Volume,
    variants: &[
        Variant {
            name: "frictionless",
            about: "the plunger follows the pressure",
            parameters: &[&SWEPT, &BEGIN, &TRAVEL],
        },
        Variant {
            name: "friction",
            about: "the plunger sticks while the pressure reverses",
            parameters: &[&SWEPT, &BEGIN, &TRAVEL, &FRICTION],
        },
        Variant {
            name: "damped",
            about: "oil or a throttle holds the plunger back: it follows the pressure late",
            parameters: &[&SWEPT, &BEGIN, &TRAVEL, &DAMPING],
        },
        Variant {
            name: "elastic",
            about: "hoses and walls widen in proportion with the pressure and creep after it",
            parameters: &[&COMPLIANCE, &CREEP],
        },
    ],
    excited_by: "the same pulses at 1 bar and at 5 bar, up and down",
    confused_with: &["gas_temperature", "sensor_offset", "critical_ratio"],
};

/// The effect.
#[derive(Debug)]
pub struct RegulatingValveVolume;

impl Effect for RegulatingValveVolume {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let pascal = |key: &str| setting.get(key).unwrap_or(0.0) * PA_PER_BAR;
        let (swept, travel) = match setting.get("compliance_m3_per_bar") {
            Some(compliance) => (compliance / PA_PER_BAR * WIDENING, WIDENING),
            None => (setting.value("swept_volume_m3"), pascal("travel_bar")),
        };
        plant.additions.plunger = Some(Plunger {
            swept,
            begin: pascal("begin_bar") + parameters.gas.ambient_pressure_pa,
            travel,
            friction: pascal("friction_bar"),
            damping: setting.get("damping_s").or(setting.get("creep_s")),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::by_id;
    use crate::{Command, Simulator, Tolerance};

    /// Isothermal: p V is R T times the mass, independent of the plunger's motion.
    #[test]
    fn the_mass_that_fills_the_chamber_is_that_of_pressure_and_volume() {
        let setting = EffectSetting::typical(&RegulatingValveVolume);
        let fill = |plant: &PlantParameters| {
            let mut simulator = Simulator::with_tolerance(plant, Tolerance::scaled(0.01));
            simulator.command(Command {
                duty_fill_pct: 100.0,
                duty_vent_pct: 0.0,
            });
            simulator.advance_to_ns(60_000_000);
            simulator.state().pressure
        };
        // Choked filling: the same mass enters both chambers in the same time.
        let plain = PlantParameters::nominal();
        let (stiff, soft) = (fill(&plain), fill(&plain.with_effect(setting)));
        let volume = 75e-6 + 1e-5 * (soft - 101_325.0 - 1.4e5) / 4.5e5;
        assert!(soft < stiff - 1e3, "{soft} {stiff}");
        assert!(
            (soft * volume / (stiff * 75e-6) - 1.0).abs() < 1e-4,
            "{soft} {stiff}"
        );
    }

    /// Choked filling: the same mass of air enters a stiff chamber and one with a wall that creeps to V + C (p - p_amb).
    #[test]
    fn a_wall_creeps_to_the_volume_of_its_pressure() {
        let compliance = 2e-6;
        let elastic = ABOUT.variant("elastic").unwrap();
        let setting = EffectSetting::typical_variant(&RegulatingValveVolume, elastic)
            .with("compliance_m3_per_bar", compliance)
            .with("creep_s", 0.3);
        let pressures = |plant: &PlantParameters| {
            let mut simulator = Simulator::with_tolerance(plant, Tolerance::scaled(0.01));
            let command = |duty_fill_pct| Command {
                duty_fill_pct,
                duty_vent_pct: 0.0,
            };
            simulator.command(command(100.0));
            simulator.advance_to_ns(40_000_000);
            simulator.command(command(0.0));
            [0.1, 6.0].map(|time_s| {
                simulator.advance_to_ns((1e9 * time_s) as u64);
                simulator.state().pressure
            })
        };
        let plain = PlantParameters::nominal();
        let [_, stiff] = pressures(&plain);
        let [soon, crept] = pressures(&plain.with_effect(setting));
        assert!(stiff > 2e5, "{stiff}");
        assert!(soon > crept + 3e3, "{soon} {crept}");
        let widened = 75e-6 + compliance * (crept - 101_325.0) / 1e5;
        let ratio = crept * widened / (stiff * 75e-6);
        assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
    }

    /// With and without an energy balance: the two terms of the volume's change agree.
    #[test]
    fn light_damping_is_the_plunger_that_follows_at_once() {
        let gas_temperature = by_id("gas_temperature").unwrap();
        for warms in [false, true] {
            let pressure = |variant: &str, damping: Option<f64>| {
                let variant = ABOUT.variant(variant).unwrap();
                let typical = EffectSetting::typical_variant(&RegulatingValveVolume, variant);
                let setting = match damping {
                    Some(damping) => typical.with("damping_s", damping),
                    None => typical,
                };
                let mut plant = PlantParameters::nominal().with_effect(setting);
                if warms {
                    plant = plant.with_effect(EffectSetting::typical(gas_temperature));
                }
                let mut simulator = Simulator::new(&plant);
                simulator.command(Command {
                    duty_fill_pct: 100.0,
                    duty_vent_pct: 0.0,
                });
                simulator.advance_to_ns(60_000_000);
                simulator.state().pressure
            };
            let at_once = pressure("frictionless", None);
            // Lag behind a constant rise: the deviation is proportional to the time constant.
            let off_by = [1e-3, 2e-3].map(|damping| pressure("damped", Some(damping)) - at_once);
            assert!(off_by[0] > 0.0, "{warms}: {off_by:?}");
            assert!(
                (off_by[1] / off_by[0] - 2.0).abs() < 0.1,
                "{warms}: {off_by:?}"
            );
        }
    }
}
