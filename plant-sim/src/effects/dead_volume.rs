//! Effect: a part of the air is behind a tube, with or without the sensor.

use super::chamber_leak::leak;
use crate::additions::{Cavity, Tube};
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;
use crate::restriction::Mouth;

effect_parameters! { "effects.dead_volume":
    VOLUME = cavity_volume_m3 ["m3"] 1e-8 ..= 1e-3, Log 3e-6, off 0.0,
        "volume of the cavity at the end of the tube (E59)";
    AREA = area_m2 ["m2"] 1e-9 ..= 1e-4, Log 3e-7,
        "effective area of the tube: the orifice that lets as much through (E59)";
}

static ABOUT: About = About {
    id: "dead_volume",
    sentence: "A part of the air, often with the sensor, sits behind a thin tube and follows the chamber late.",
    source: "E59: mass balance of the cavity; ISO 6358-1 or Hagen and Poiseuille for the tube",
    acts_on: EntryPoint::Volume,
    variants: &[
        Variant {
            name: "orifice",
            about: "a short tube: an orifice between the volumes",
            parameters: &[&VOLUME, &AREA],
        },
        Variant {
            name: "laminar",
            about: "a long thin tube: flow as the difference of the squared pressures",
            parameters: &[&VOLUME, &AREA],
        },
        Variant {
            name: "side_chamber",
            about: "an orifice to a volume beside; the sensor sits in the chamber",
            parameters: &[&VOLUME, &AREA],
        },
    ],
    excited_by: "short pulses with both valves shut for 100 ms in between",
    confused_with: &["sensor_lag", "gas_temperature", "regulating_valve_volume"],
};

/// The effect.
#[derive(Debug)]
pub struct DeadVolume;

impl Effect for DeadVolume {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        plant.additions.cavity = Some(Cavity {
            volume: setting.value("cavity_volume_m3"),
            tube: match setting.variant().name {
                "laminar" => Tube::Laminar(leak(setting, parameters, plant)),
                _ => Tube::Orifice(Mouth::new(
                    setting.value("area_m2"),
                    setting.value("cavity_volume_m3"),
                    &plant.nozzle,
                    parameters.gas.rt(),
                )),
            },
            holds_the_sensor: setting.variant().name != "side_chamber",
            has_the_leak: false,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator, Tolerance};

    /// After a pulse both volumes reach one pressure, that of all the air in both. Before, the chamber had p V and the
    /// cavity p_atm V_c.
    #[test]
    fn the_volumes_equalise_and_no_air_is_lost() {
        for variant in ABOUT.variants {
            let setting = EffectSetting::typical_variant(&DeadVolume, variant);
            let plant = PlantParameters::nominal();
            let fill = |plant: &PlantParameters| {
                let mut simulator = Simulator::with_tolerance(plant, Tolerance::scaled(0.01));
                for (at_ns, duty_fill_pct) in [(0, 100.0), (50_000_000, 0.0)] {
                    simulator.advance_to_ns(at_ns);
                    simulator.command(Command {
                        duty_fill_pct,
                        duty_vent_pct: 0.0,
                    });
                }
                // Just after the valve has closed, and long after.
                simulator.advance_to_ns(90_000_000);
                let early = simulator.sample();
                simulator.advance_to_ns(2_000_000_000);
                (early, simulator.sample())
            };
            let (early, late) = fill(&plant.with_effect(setting));
            // The sensor lags if it is in the cavity.
            let lag = early.pressure - early.measured_pressure;
            let in_chamber = variant.name == "side_chamber";
            assert!(
                if in_chamber { lag == 0.0 } else { lag > 100.0 },
                "{early:?}"
            );
            assert!(
                (late.measured_pressure - late.pressure).abs() < 10.0,
                "{late:?}"
            );
            // Choked filling: the same mass as into the plain chamber.
            let (_, plain) = fill(&plant);
            let expected = (plain.pressure * 75e-6 + 101_325.0 * 3e-6) / (75e-6 + 3e-6);
            assert!(
                (late.pressure / expected - 1.0).abs() < 1e-3,
                "{} {expected}",
                late.pressure
            );
        }
    }
}
