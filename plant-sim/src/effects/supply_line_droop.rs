//! The supply pressure falls while the fill valve is open.

use crate::additions::SupplyLine;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;
use crate::restriction::Restriction;

effect_parameters! { "effects.supply_line_droop":
    AREA = restriction_area_m2 ["m2"] 1e-8 ..= 1e-3, Log 4e-6, off f64::INFINITY,
        "effective area of the narrowest place between reservoir and fill valve (E51)";
    VOLUME = line_volume_m3 ["m3"] 1e-7 ..= 1e-2, Log 5e-5,
        "volume of the line between that place and the fill valve (E51)";
}

static ABOUT: About = About {
    id: "supply_line_droop",
    sentence: "The line to the fill valve is narrow: its pressure falls while the valve is open and recovers afterwards, so long fillings take longer than short pulses suggest.",
    source: "E51: ISO 6358-1 and the mass balance of the line",
    acts_on: EntryPoint::AirSupply,
    variants: &[
        Variant {
            name: "line_volume",
            about: "air stored in the line feeds the first milliseconds",
            parameters: &[&AREA, &VOLUME],
        },
        Variant {
            name: "static",
            about: "no air stored: an orifice in series with the valve",
            parameters: &[&AREA],
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

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.supply_line = Some(SupplyLine {
            restriction: Restriction {
                effective_area: setting.value("restriction_area_m2"),
            },
            volume: setting.get("line_volume_m3"),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
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

    /// A narrow line slows the filling; air stored in it helps at first; without stored air it is the slowest.
    #[test]
    fn a_narrow_line_slows_the_filling_and_its_volume_helps() {
        let [line, fixed] = [0, 1].map(|n| {
            filling_time_s(Some(EffectSetting::typical_variant(
                &SupplyLineDroop,
                &ABOUT.variants[n],
            )))
        });
        let plain = filling_time_s(None);
        assert!(plain < line && line < fixed, "{plain} {line} {fixed}");
    }

    /// A line without volume is the limit of a small one.
    #[test]
    fn a_small_line_volume_is_the_static_law() {
        let small = EffectSetting::typical(&SupplyLineDroop).with("line_volume_m3", 1e-7);
        let fixed = EffectSetting::typical_variant(&SupplyLineDroop, &ABOUT.variants[1]);
        let (small, fixed) = (filling_time_s(Some(small)), filling_time_s(Some(fixed)));
        assert!((small - fixed).abs() < 0.5e-3, "{small} {fixed}");
    }
}
