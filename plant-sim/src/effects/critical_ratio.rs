//! Effect: real orifices choke at a smaller pressure ratio than an ideal nozzle.

use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::orifice::{NozzleLaw, Subsonic};
use crate::plant::Plant;
use crate::subsonic_curves::SubsonicCurves;

effect_parameters! { "effects.critical_ratio":
    REDUCTION = reduction [""] 0.001 ..= 0.5, Log 0.2, off 0.0,
        "what the critical pressure ratio is less than flow.critical_ratio (E57): 0.528 - b of a datasheet";
}

static ABOUT: About = About {
    id: "critical_ratio",
    sentence: "Edges and bends of a real valve throttle the flow early, so the last bar before the supply pressure takes longer than an ideal nozzle says.",
    source: "E57: ISO 6358-1:2013, critical back-pressure ratio b",
    acts_on: EntryPoint::Flow,
    variants: &[
        Variant {
            name: "stretched",
            about: "the ideal nozzle's curve over the ratios that are left (E10)",
            parameters: &[&REDUCTION],
        },
        Variant {
            name: "iso6358",
            about: "the quarter ellipse of the standard",
            parameters: &[&REDUCTION],
        },
    ],
    excited_by: "filling up to the supply pressure and venting down to ambient",
    confused_with: &[
        "supply_line_droop",
        "series_restriction",
        "drain_back_pressure",
    ],
};

/// The effect.
#[derive(Debug)]
pub struct CriticalRatio;

/// Smallest critical ratio after a reduction.
const LEAST: f64 = 0.01;

impl Effect for CriticalRatio {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let gas = &parameters.gas;
        let branch = match setting.variant().name {
            "iso6358" => Subsonic::Ellipse,
            _ => Subsonic::Isentropic,
        };
        let nozzle = NozzleLaw::with_branch(
            gas.heat_capacity_ratio,
            gas.gas_constant_j_per_kg_k,
            gas.temperature_k,
            (parameters.flow.critical_ratio - setting.value("reduction")).max(LEAST),
            branch,
        );
        // A valve with a conductance has a critical ratio of its own.
        let valves = plant.valves.iter_mut();
        for valve in valves.filter(|valve| !valve.function.has_conductance()) {
            valve.nozzle = nozzle.clone();
        }
        plant.nozzle = nozzle;
        let [fill, vent] = &plant.valves;
        plant.subsonic = SubsonicCurves::new([&fill.nozzle, &vent.nozzle]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ISO 6358-1: q/q* = √(1 - ((r - b)/(1 - b))²).
    #[test]
    fn the_ellipse_is_that_of_the_standard() {
        let setting = EffectSetting::typical_variant(&CriticalRatio, &ABOUT.variants[1])
            .with("reduction", 0.228);
        let nozzle = PlantParameters::nominal()
            .with_effect(setting)
            .plant()
            .nozzle;
        for ratio in [0.1, 0.3, 0.5, 0.8, 0.99] {
            let q = f64::max(ratio - 0.3, 0.0) / 0.7;
            let expected = nozzle.choked_factor() * (1.0 - q * q).sqrt();
            let found = nozzle.flow_function(ratio);
            assert!(
                (found / expected - 1.0).abs() < 1e-6,
                "{ratio}: {found} {expected}"
            );
        }
    }

    #[test]
    fn the_flow_is_never_more_than_that_of_the_plain_orifice() {
        let plain = PlantParameters::nominal().plant().nozzle;
        for variant in ABOUT.variants {
            let setting = EffectSetting::typical_variant(&CriticalRatio, variant);
            let nozzle = PlantParameters::nominal()
                .with_effect(setting)
                .plant()
                .nozzle;
            for step in 0..=1000 {
                let ratio = f64::from(step) / 1000.0;
                let (less, more) = (nozzle.flow_function(ratio), plain.flow_function(ratio));
                assert!(
                    less <= more * (1.0 + 1e-9),
                    "{} {ratio}: {less} {more}",
                    variant.name
                );
            }
        }
    }
}
