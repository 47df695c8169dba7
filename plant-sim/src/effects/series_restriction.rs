//! Effect: a fixed orifice in series with a valve.

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
        Variant {
            name: "combined",
            about: "one opening together with each valve, near enough for no volume between to fill",
            parameters: &[&FILL_RATIO, &VENT_RATIO],
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
        let additions = &mut plant.additions;
        let slots = match setting.variant().name {
            "combined" => &mut additions.combined,
            _ => &mut additions.restrictions,
        };
        for (index, key) in [(FILL, "fill_area_ratio"), (VENT, "vent_area_ratio")] {
            let ratio = setting.get(key).unwrap_or(0.0);
            if ratio > 0.0 {
                let bore = plant.valves[index].orifice.effective_area(f64::INFINITY);
                let restriction = Restriction {
                    effective_area: bore / ratio,
                };
                slots[index] = Some(restriction.in_series_with(slots[index]));
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

    /// Two equal orifices have the flow of one with 1/√2 of their area, choked or not.
    #[test]
    fn one_opening_has_the_combined_area() {
        let variant = ABOUT.variant("combined").unwrap();
        let combined = EffectSetting::typical_variant(&SeriesRestriction, variant)
            .with("fill_area_ratio", 1.0)
            .with("vent_area_ratio", 1.0);
        let plant = PlantParameters::nominal();
        let rate = |plant: &PlantParameters, command: Command, pressure: f64| {
            let mut simulator = Simulator::new(plant);
            simulator.command(command);
            simulator.advance_to_ns(100_000_000);
            simulator.set_chamber_pressure(pressure);
            simulator.advance_to_ns(100_100_000);
            simulator.state().pressure - pressure
        };
        for (command, pressure) in [
            (
                Command {
                    duty_fill_pct: 100.0,
                    duty_vent_pct: 0.0,
                },
                3e5,
            ),
            (
                Command {
                    duty_fill_pct: 100.0,
                    duty_vent_pct: 0.0,
                },
                8e5,
            ),
            (
                Command {
                    duty_fill_pct: 0.0,
                    duty_vent_pct: 100.0,
                },
                1.5e5,
            ),
        ] {
            let ratio = rate(&plant.with_effect(combined.clone()), command, pressure)
                / rate(&plant, command, pressure);
            assert!((ratio - 0.5_f64.sqrt()).abs() < 2e-3, "{pressure}: {ratio}");
        }
    }
}
