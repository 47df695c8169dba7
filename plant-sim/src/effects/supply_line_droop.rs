//! Effect: the supply pressure falls while the fill valve is open.

use crate::additions::Line;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::orifice::{NozzleLaw, Subsonic};
use crate::plant::Plant;
use crate::restriction::{Mouth, Restriction};

effect_parameters! { "effects.supply_line_droop":
    AREA = restriction_area_m2 ["m2"] 1e-8 ..= 1e-3, Log 4e-6, off f64::INFINITY,
        "effective area of the narrowest place between reservoir and fill valve (E51)";
    VOLUME = line_volume_m3 ["m3"] 1e-7 ..= 1e-2, Log 5e-5,
        "volume of the line between that place and the fill valve (E51)";
    RATIO = line_critical_ratio [""] 0.05 ..= 0.6, Linear 0.3,
        "critical pressure ratio of the line, from 0.5 of a short one to 0.2 of a long one (E51)";
    DROOP = regulator_droop_bar_s_per_g ["bar s/g"] 1e-5 ..= 10.0, Log 0.02, off 0.0,
        "pressure that the regulator loses per mass flow, the slope of its flow characteristic (E51)";
    RESPONSE = regulator_response_s ["s"] 1e-3 ..= 10.0, Log 0.03,
        "time constant of the regulator (E51)";
}

static ABOUT: About = About {
    id: "supply_line_droop",
    sentence: "The line to the fill valve is narrow: its pressure falls while the valve is open and recovers afterwards, so long fillings take longer than short pulses suggest.",
    source: "E51: ISO 6358-1 and the mass balance of the line; ISO 6953-1 for a regulator",
    acts_on: EntryPoint::AirSupply,
    variants: &[
        Variant {
            name: "line_volume",
            about: "air stored in the line feeds the first milliseconds",
            parameters: &[&AREA, &VOLUME],
        },
        Variant {
            name: "tube",
            about: "the same through a tube with a critical pressure ratio of its own",
            parameters: &[&AREA, &VOLUME, &RATIO],
        },
        Variant {
            name: "static",
            about: "no air stored: an orifice in series with the valve",
            parameters: &[&AREA],
        },
        Variant {
            name: "regulator",
            about: "a pressure regulator that gives way in proportion to the flow, with a time constant",
            parameters: &[&DROOP, &RESPONSE],
        },
    ],
    excited_by: "one long filling, then the same by short pulses with pauses",
    confused_with: &["series_restriction", "critical_ratio"],
};

/// The effect.
#[derive(Debug)]
pub struct SupplyLineDroop;

impl Effect for SupplyLineDroop {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let gas = &parameters.gas;
        plant.additions.tube = setting.get("line_critical_ratio").map(|critical_ratio| {
            let law = NozzleLaw::with_branch(
                gas.heat_capacity_ratio,
                gas.gas_constant_j_per_kg_k,
                gas.temperature_k,
                critical_ratio,
                Subsonic::Ellipse,
            );
            Box::new(law)
        });
        plant.additions.supply_line = match setting.get("restriction_area_m2") {
            Some(effective_area) => {
                let line = match setting.get("line_volume_m3") {
                    Some(volume) => {
                        let nozzle = plant.additions.tube.as_deref().unwrap_or(&plant.nozzle);
                        Line::Volume(Mouth::new(effective_area, volume, nozzle, gas.rt()), volume)
                    }
                    None => Line::Orifice(Restriction { effective_area }),
                };
                Some(line)
            }
            None => Line::yielding(
                setting.value("regulator_droop_bar_s_per_g"),
                setting.value("regulator_response_s"),
            ),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::description::PA_PER_BAR;
    use crate::{Command, Simulator};

    fn filling_time_s(setting: Option<EffectSetting>) -> f64 {
        let mut plant = PlantParameters::nominal();
        plant.effects.extend(setting);
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        while simulator.state().pressure < 5e5 {
            simulator.advance_to_ns(simulator.time_ns() + 100_000);
        }
        simulator.time_ns() as f64 * 1e-9
    }

    /// A narrow line slows the filling; air stored in it helps at first; without stored air the filling is slowest.
    #[test]
    fn a_narrow_line_slows_the_filling_and_its_volume_helps() {
        let [line, fixed] = [0, 2].map(|n| {
            filling_time_s(Some(EffectSetting::typical_variant(
                &SupplyLineDroop,
                &ABOUT.variants[n],
            )))
        });
        let plain = filling_time_s(None);
        assert!(plain < line && line < fixed, "{plain} {line} {fixed}");
    }

    /// Through a tube, the subsonic flow of ISO 6358 is less than that of a nozzle, and the choked flow is the same.
    #[test]
    fn a_tube_passes_less_than_a_nozzle_once_its_flow_is_subsonic() {
        let tube = EffectSetting::typical_variant(&SupplyLineDroop, &ABOUT.variants[1]);
        let plant = PlantParameters::nominal();
        let line_pressure = &|ratio: f64| {
            let setting = tube.clone().with("line_critical_ratio", ratio);
            let mut plant = plant.with_effect(setting);
            plant.chamber.volume_m3 = 1.0;
            let mut simulator = Simulator::new(&plant);
            simulator.command(Command {
                duty_fill_pct: 100.0,
                duty_vent_pct: 0.0,
            });
            simulator.advance_to_ns(500_000_000);
            let mut states = simulator.effect_states();
            states.find(|state| state.name == "p_line").unwrap().value
        };
        // The choked valve draws C_v p_l, and the line passes C_l p_s sqrt(1 - ((p_l/p_s - b)/(1 - b))^2) (ISO 6358).
        let valve = 0.95 * core::f64::consts::PI * 0.95e-3_f64.powi(2);
        let supply = plant.gas.supply_pressure_pa();
        let balance =
            |r: f64, b: f64| 4e-6 * (1.0 - ((r - b) / (1.0 - b)).powi(2)).sqrt() - valve * r;
        for b in [0.2, 0.35, 0.5] {
            let found = line_pressure(b) / supply;
            assert!(balance(found, b).abs() < 1e-9, "{b}: {found}");
        }
    }

    /// Choked filling of a very large chamber: the flow is constant, and so is the regulator's droop.
    #[test]
    fn a_regulator_loses_its_droop_times_the_flow() {
        let setting = EffectSetting::typical_variant(&SupplyLineDroop, &ABOUT.variants[3])
            .with("regulator_droop_bar_s_per_g", 0.1);
        let mut plant = PlantParameters::nominal().with_effect(setting);
        plant.chamber.volume_m3 = 1.0;
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        let pressure_after = |simulator: &mut Simulator, milliseconds: u64| {
            simulator.advance_to_ns(milliseconds * 1_000_000);
            simulator.state().pressure
        };
        let before = pressure_after(&mut simulator, 400);
        let rise = pressure_after(&mut simulator, 500) - before;
        let grams_per_s = rise / 0.1 / simulator.plant().chamber.pressure_per_mass * 1e3;
        let mut states = simulator.effect_states();
        let line = states.find(|state| state.name == "p_line").unwrap();
        let lost = (simulator.plant().supply_pressure - line.value) / PA_PER_BAR;
        assert!(
            (lost / (0.1 * grams_per_s) - 1.0).abs() < 1e-3,
            "{lost} {grams_per_s}"
        );
    }

    /// A line without volume is the limit of a line with a small volume.
    #[test]
    fn a_small_line_volume_is_the_static_law() {
        let small = EffectSetting::typical(&SupplyLineDroop).with("line_volume_m3", 1e-7);
        let fixed = EffectSetting::typical_variant(&SupplyLineDroop, &ABOUT.variants[2]);
        let (small, fixed) = (filling_time_s(Some(small)), filling_time_s(Some(fixed)));
        assert!((small - fixed).abs() < 0.5e-3, "{small} {fixed}");
    }
}
