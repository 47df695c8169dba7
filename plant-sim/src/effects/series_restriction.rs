//! A fixed orifice in series with a valve.

use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::{FILL, Plant, VENT};
use crate::restriction::Restriction;

effect_parameters! { "effects.series_restriction":
    FILL_RATIO = fill_area_ratio [""] 0.01 ..= 50.0, Log 1.0, off 0.0,
        "effective area of the fill valve's bore over that of the orifice behind it (E46); 0: none, 1: equal";
    VENT_RATIO = vent_area_ratio [""] 0.01 ..= 50.0, Log 1.0, off 0.0,
        "the same of the vent valve (E46)";
}

static ABOUT: About = About {
    id: "series_restriction",
    sentence: "A second narrow place, such as a fitting, a filter or an inserted orifice, throttles the flow that the valve would let through.",
    source: "E46: ISO 6358-3, components in series; thesis, figure 4.12",
    acts_on: EntryPoint::Flow,
    variants: &[
        Variant {
            name: "both",
            about: "behind both valves",
            parameters: &[&FILL_RATIO, &VENT_RATIO],
        },
        Variant {
            name: "fill",
            about: "behind the fill valve",
            parameters: &[&FILL_RATIO],
        },
        Variant {
            name: "vent",
            about: "behind the vent valve",
            parameters: &[&VENT_RATIO],
        },
    ],
    excited_by: "100 % duty of each valve over the whole range, and single short pulses",
    confused_with: &["supply_line_droop", "critical_ratio", "drain_back_pressure"],
};

/// The effect.
#[derive(Debug)]
pub struct SeriesRestriction;

impl Effect for SeriesRestriction {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        for (index, key) in [(FILL, "fill_area_ratio"), (VENT, "vent_area_ratio")] {
            let ratio = setting.get(key).unwrap_or(0.0);
            if ratio > 0.0 {
                let bore = plant.valves[index].orifice.effective_area(f64::INFINITY);
                let restriction = Restriction {
                    effective_area: bore / ratio,
                };
                let slot = &mut plant.additions.restrictions[index];
                *slot = Some(restriction.in_series_with(*slot));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    /// An orifice ten times as narrow as the valve: choked filling at its own rate.
    #[test]
    fn a_narrow_orifice_decides_the_filling() {
        let setting = EffectSetting::typical_variant(&SeriesRestriction, &ABOUT.variants[1])
            .with("fill_area_ratio", 10.0);
        let plant = PlantParameters::nominal().with_effect(setting);
        let mut simulator = Simulator::new(&plant);
        simulator.command(Command {
            duty_fill_pct: 100.0,
            duty_vent_pct: 0.0,
        });
        let mut pressure_at = |ms: u64| {
            simulator.advance_to_ns(ms * 1_000_000);
            simulator.state().pressure
        };
        let (early, late) = (pressure_at(100), pressure_at(200));
        let slope = (late - early) / 0.1;
        let physics = plant.plant();
        let area = physics.valves[FILL].orifice.effective_area(1.0) / 10.0;
        let expected = physics.pressure_rate([area, 0.0], 2e5);
        assert!((slope / expected - 1.0).abs() < 0.01, "{slope} {expected}");
    }
}
