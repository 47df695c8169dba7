//! Effect: the iron saturates.

use crate::additions::Saturation;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PlantParameters, Variant, effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.iron_saturation":
    FLUX = saturation_flux_wb ["Wb"] 0.001 ..= 10.0, Log 0.14, off f64::INFINITY,
        "flux linkage at which the iron takes as much current as the gap (E44)";
    SHARPNESS = exponent [""] 1.0 ..= 20.0, Log 8.0,
        "how sudden the saturation is (E44): 2 is soft, 10 a knee";
}

static ABOUT: About = About {
    id: "iron_saturation",
    sentence: "Near full current the iron of the magnet is full of flux: the coil has less inductance there and more at low current, so the current ripples differently.",
    source: "E44: two-term magnetisation curve of ferroresonance studies, IEEE Trans. Power Delivery 15 (2000) 255-265",
    acts_on: EntryPoint::Coil,
    variants: &[
        Variant {
            name: "rated",
            about: "the inductances of the plant file were measured near rated current; at low current they are larger",
            parameters: &[&FLUX, &SHARPNESS],
        },
        Variant {
            name: "small_signal",
            about: "the inductances of the plant file were measured at low current; near rated current they are smaller",
            parameters: &[&FLUX, &SHARPNESS],
        },
    ],
    excited_by: "scope log of the coil current at 40 and 75 % duty from rest, supply pressure off",
    confused_with: &["eddy_currents", "flyback_clamp"],
};

/// The effect.
#[derive(Debug)]
pub struct IronSaturation;

impl Effect for IronSaturation {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let (flux, exponent) = (
            setting.value("saturation_flux_wb"),
            setting.value("exponent"),
        );
        // At rated current the chord of the curve is the inductance of the plant file: ratio = 1 + (λ_r/λ_s)^n.
        let coil = &parameters.coil;
        let rated =
            coil.inductance_closed_h * parameters.ecu.supply_voltage_v / coil.resistance_20c_ohm;
        let ratio = match setting.variant().name {
            "small_signal" => 1.0,
            _ => 1.0 + (rated / flux).powf(exponent),
        };
        plant.additions.saturation = Some(Saturation {
            ratio,
            flux,
            exponent,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::steady_current;

    fn saturated(variant: &str) -> PlantParameters {
        let variant = ABOUT.variant(variant).unwrap();
        PlantParameters::nominal()
            .with_effect(EffectSetting::typical_variant(&IronSaturation, variant))
    }

    /// The datasheet's inductance is valid at rated current, and by the same law it is larger below.
    #[test]
    fn the_rated_variant_keeps_the_inductance_at_rated_current() {
        let saturation = saturated("rated").plant().additions.saturation.unwrap();
        let rated = 24.0 / 82.2;
        assert!((saturation.current(0.44 * rated, 0.44) - rated).abs() < 1e-12);
        let small = 1e-4 / saturation.current(1e-4, 0.44);
        assert!((small - 0.44 * saturation.unsaturated_inductance_ratio()).abs() < 1e-9);
        assert!(small > 0.6, "{small}");
    }

    /// Figures 4.3 and 4.4: at 40 % duty cycle a coil with a larger inductance at low current has less ripple. At rest
    /// the mean current follows Ohm's law, independent of the iron.
    #[test]
    fn the_current_ripples_less_at_low_duty() {
        let [plain, saturated] = [PlantParameters::nominal(), saturated("rated")]
            .map(|plant| steady_current(&plant, 40.0));
        let ripple = |[_, least, largest]: [f64; 3]| largest - least;
        assert!(
            ripple(saturated) < 0.8 * ripple(plain),
            "{saturated:?} {plain:?}"
        );
    }

    /// Flux balance at rest: the final current is e/R.
    #[test]
    fn the_steady_current_is_that_of_ohm() {
        for variant in ABOUT.variants {
            let [mean, ..] = steady_current(&saturated(variant.name), 100.0);
            assert!(
                (mean - 24.0 / 82.2).abs() < 1e-4,
                "{}: {mean}",
                variant.name
            );
        }
    }
}
