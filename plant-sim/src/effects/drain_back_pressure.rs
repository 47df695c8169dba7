//! Effect: the drain is not at ambient pressure.

use crate::additions::Line;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PA_PER_BAR, PlantParameters, Variant,
    effect_parameters,
};
use crate::plant::Plant;
use crate::restriction::{Mouth, Restriction};

effect_parameters! { "effects.drain_back_pressure":
    PRESSURE = pressure_bar ["bar gauge"] 0.001 ..= 5.0, Log 0.2, off 0.0,
        "pressure in the drain line (E56)";
    AREA = silencer_area_m2 ["m2"] 1e-8 ..= 1e-3, Log 4e-6, off f64::INFINITY,
        "effective area of the silencer or the outlet (E56)";
    VOLUME = line_volume_m3 ["m3"] 1e-7 ..= 1e-2, Log 1e-5,
        "volume between the vent valve and the silencer (E56)";
    RESISTANCE = silencer_resistance_bar_s_per_g ["bar s/g"] 1e-5 ..= 10.0, Log 0.1, off 0.0,
        "pressure before a porous silencer per mass flow (E56)";
    RESPONSE = silencer_response_s ["s"] 1e-3 ..= 10.0, Log 0.01,
        "time constant of the pressure before the silencer (E56)";
}

static ABOUT: About = About {
    id: "drain_back_pressure",
    sentence: "A silencer, a long hose or oil in the outlet holds the air back, so venting slows down before the chamber is empty.",
    source: "E56: ISO 6358-1 with another downstream pressure; Darcy's law for a porous silencer",
    acts_on: EntryPoint::Drain,
    variants: &[
        Variant {
            name: "constant",
            about: "a collecting line under pressure",
            parameters: &[&PRESSURE],
        },
        Variant {
            name: "silencer",
            about: "an orifice behind the vent valve: back pressure that grows with the flow",
            parameters: &[&AREA],
        },
        Variant {
            name: "line_volume",
            about: "a line before the silencer takes the first air and empties slowly",
            parameters: &[&AREA, &VOLUME],
        },
        Variant {
            name: "porous_silencer",
            about: "sintered metal: back pressure in proportion to the flow, with a time constant",
            parameters: &[&RESISTANCE, &RESPONSE],
        },
    ],
    excited_by: "venting to below 1 bar gauge and on to the end",
    confused_with: &["critical_ratio", "series_restriction", "sensor_offset"],
};

/// The effect.
#[derive(Debug)]
pub struct DrainBackPressure;

impl Effect for DrainBackPressure {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        plant.drain_pressure += setting.get("pressure_bar").unwrap_or(0.0) * PA_PER_BAR;
        if let Some(resistance) = setting.get("silencer_resistance_bar_s_per_g") {
            plant.additions.drain_line =
                Line::yielding(resistance, setting.value("silencer_response_s"));
        }
        let Some(effective_area) = setting.get("silencer_area_m2") else {
            return;
        };
        if let Some(volume) = setting.get("line_volume_m3") {
            let gas = parameters.gas.rt();
            let mouth = Mouth::new(effective_area, volume, &plant.nozzle, gas);
            plant.additions.drain_line = Some(Line::Volume(mouth, volume));
        } else {
            let restriction = Restriction { effective_area };
            let slot = &mut plant.additions.restrictions[1];
            *slot = Some(restriction.in_series_with(*slot));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    fn venting(setting: EffectSetting, milliseconds: u64) -> f64 {
        let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
        simulator.set_chamber_pressure(6e5);
        simulator.command(Command {
            duty_fill_pct: 0.0,
            duty_vent_pct: 100.0,
        });
        simulator.advance_to_ns(milliseconds * 1_000_000);
        simulator.state().pressure
    }

    #[test]
    fn venting_ends_at_the_pressure_of_the_drain() {
        let setting = EffectSetting::typical(&DrainBackPressure).with("pressure_bar", 0.5);
        let end = venting(setting, 5000);
        assert!((end - 151_325.0).abs() < 1.0, "{end}");
    }

    /// While both orifices are choked, the narrower one determines the flow: p falls exponentially with its area.
    #[test]
    fn a_narrow_silencer_decides_the_venting() {
        let variant = &ABOUT.variants[1];
        let setting = EffectSetting::typical_variant(&DrainBackPressure, variant)
            .with("silencer_area_m2", 0.2e-6);
        let (early, late) = (venting(setting.clone(), 200), venting(setting, 300));
        let plant = PlantParameters::nominal().plant();
        // The pressure upstream of the silencer is close to the chamber's: the valve is fourteen times as wide.
        let rate = plant.chamber.pressure_per_mass * plant.nozzle.choked_factor() * 0.2e-6;
        let measured = (early / late).ln() / 0.1;
        assert!((measured / rate - 1.0).abs() < 0.01, "{measured} {rate}");
    }

    /// A large chamber vents at a constant flow: the drain pressure is the silencer's resistance times the flow.
    #[test]
    fn a_porous_silencer_dams_in_proportion_to_the_flow() {
        let setting = EffectSetting::typical_variant(&DrainBackPressure, &ABOUT.variants[3])
            .with("silencer_resistance_bar_s_per_g", 0.2);
        let mut plant = PlantParameters::nominal().with_effect(setting);
        plant.chamber.volume_m3 = 1.0;
        let mut simulator = Simulator::new(&plant);
        simulator.set_chamber_pressure(6e5);
        simulator.command(Command {
            duty_fill_pct: 0.0,
            duty_vent_pct: 100.0,
        });
        simulator.advance_to_ns(200_000_000);
        let before = simulator.state().pressure;
        simulator.advance_to_ns(220_000_000);
        let fall = before - simulator.state().pressure;
        let grams_per_s = fall / 0.02 / simulator.plant().chamber.pressure_per_mass * 1e3;
        let mut states = simulator.effect_states();
        let drain = states.find(|state| state.name == "p_drain").unwrap();
        let dammed = (drain.value - simulator.plant().ambient_pressure) / PA_PER_BAR;
        assert!(
            (dammed / (0.2 * grams_per_s) - 1.0).abs() < 1e-3,
            "{dammed} {grams_per_s}"
        );
    }

    /// An outlet that is nearly shut: chamber and line reach one pressure, and no air is lost.
    #[test]
    fn the_line_fills_from_the_chamber() {
        let setting = EffectSetting::typical_variant(&DrainBackPressure, &ABOUT.variants[2])
            .with("silencer_area_m2", 1e-8)
            .with("line_volume_m3", 25e-6);
        let pressure = venting(setting, 200);
        let expected = (6e5 * 75e-6 + 101_325.0 * 25e-6) / (75e-6 + 25e-6);
        assert!(
            (pressure / expected - 1.0).abs() < 0.02,
            "{pressure} {expected}"
        );
        assert!(pressure < expected, "{pressure} {expected}");
    }

    /// Near ambient pressure the flows through valve and silencer are linear, so chamber and line are two linear
    /// volumes in series. With x = p - p_atm and y = p_d - p_atm: dx/dt = -a (x - y), dy/dt = b (x - y) - c y (E11,
    /// E12, E56). Their slow mode has a closed form. The explicit method ended 17 Pa above ambient pressure.
    #[test]
    fn chamber_and_line_come_to_ambient_pressure_as_two_linear_volumes() {
        let check = |variant: usize, values: [f64; 2]| {
            let mut setting =
                EffectSetting::typical_variant(&DrainBackPressure, &ABOUT.variants[variant]);
            setting.values_mut().copy_from_slice(&values);
            let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
            let plant = simulator.plant();
            let (ambient, nozzle) = (plant.ambient_pressure, &plant.nozzle);
            let gas = plant.chamber.pressure_per_mass * plant.chamber.volume;
            let valve =
                plant.valves[1].orifice.effective_area(f64::INFINITY) * nozzle.laminar_slope();
            let a = gas / plant.chamber.volume * valve;
            let [b, c] = match plant.additions.drain_line {
                Some(Line::Volume(silencer, volume)) => {
                    [valve, silencer.effective_area * silencer.linear_slope()]
                        .map(|slope| gas / volume * slope)
                }
                Some(Line::Yielding {
                    resistance,
                    response,
                }) => [resistance * valve / response, response.recip()],
                _ => unreachable!("both variants have a line with a pressure"),
            };
            let sum = a + b + c;
            let slow = 0.5 * (sum - (sum * sum - 4.0 * a * c).sqrt());

            simulator.set_chamber_pressure(ambient + 500.0);
            simulator.command(Command {
                duty_fill_pct: 0.0,
                duty_vent_pct: 100.0,
            });
            simulator.advance_to_ns(50_000_000);
            let start = simulator.state().pressure - ambient;
            for milliseconds in [60, 100, 150, 250, 1000] {
                simulator.advance_to_ns(milliseconds * 1_000_000);
                let expected = start * (-slow * (milliseconds as f64 - 50.0) * 1e-3).exp();
                let found = simulator.state().pressure - ambient;
                assert!(
                    (found - expected).abs() < 2.0,
                    "{variant}, {milliseconds} ms: {found} Pa, not {expected} Pa"
                );
            }
        };
        check(2, [3.78e-7, 0.913e-6]);
        check(2, [3.78e-7, 0.1e-6]);
        check(3, [1.27, 1e-3]);
    }
}
