//! Effect: the pressure sensor shows too much or too little.

use crate::additions::WarmUp;
use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PA_PER_BAR, PlantParameters, Variant,
    effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.sensor_offset":
    OFFSET = offset_bar ["bar"] -2.0 ..= 2.0, Linear 0.05, off 0.0,
        "what the sensor shows too much (E55)";
    DRIFT = drift_bar ["bar"] -2.0 ..= 2.0, Linear 0.02, off 0.0,
        "what comes to the offset while the sensor warms up (E55)";
    WARM_UP = warm_up_s ["s"] 0.5 ..= 1000.0, Log 10.0,
        "time constant of the warm-up, counted from the beginning of a log (E55)";
    GAIN = gain_error_pct ["%"] -20.0 ..= 20.0, Linear 1.0, off 0.0,
        "what the sensor shows too much, in percent of the gauge pressure (E55)";
}

static ABOUT: About = About {
    id: "sensor_offset",
    sentence: "The sensor's zero or its span is off, so the pressure is shown too high or too low all the time.",
    source: "E55: straight line, and a first-order warm-up",
    acts_on: EntryPoint::Sensor,
    variants: &[
        Variant {
            name: "offset",
            about: "the same at all pressures",
            parameters: &[&OFFSET],
        },
        Variant {
            name: "span",
            about: "zero and span",
            parameters: &[&OFFSET, &GAIN],
        },
        Variant {
            name: "drift",
            about: "an offset that comes while the sensor warms up",
            parameters: &[&OFFSET, &DRIFT, &WARM_UP],
        },
    ],
    excited_by: "a hold at ambient pressure and one at supply pressure",
    confused_with: &[
        "drain_back_pressure",
        "regulating_valve_volume",
        "critical_ratio",
    ],
};

/// The effect.
#[derive(Debug)]
pub struct SensorOffset;

impl Effect for SensorOffset {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.sensor_offset = setting.value("offset_bar") * PA_PER_BAR;
        plant.additions.sensor_gain = setting.get("gain_error_pct").unwrap_or(0.0) / 100.0;
        plant.additions.sensor_drift = setting.get("drift_bar").map(|drift| WarmUp {
            in_the_end: drift * PA_PER_BAR,
            time_constant: setting.value("warm_up_s"),
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Simulator;

    #[test]
    fn the_sensor_shows_offset_and_span() {
        let setting = EffectSetting::typical_variant(&SensorOffset, &ABOUT.variants[1])
            .with("offset_bar", -0.1)
            .with("gain_error_pct", 2.0);
        let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
        simulator.set_chamber_pressure(101_325.0 + 5e5);
        let sample = simulator.sample();
        assert_eq!(sample.pressure, 101_325.0 + 5e5);
        assert!((sample.measured_pressure - (101_325.0 + 5.1e5 - 0.1e5)).abs() < 1e-6);
    }

    /// 63 % of the drift after one time constant.
    #[test]
    fn the_drift_comes_with_its_time_constant() {
        let setting = EffectSetting::typical_variant(&SensorOffset, &ABOUT.variants[2])
            .with("offset_bar", 0.01)
            .with("drift_bar", 0.04)
            .with("warm_up_s", 5.0);
        let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
        let shown = |simulator: &mut Simulator| simulator.sample().measured_pressure - 101_325.0;
        assert_eq!(shown(&mut simulator), 1e3);
        simulator.advance_to_ns(5_000_000_000);
        let expected = 1e3 + 4e3 * (1.0 - (-1.0_f64).exp());
        let drifted = shown(&mut simulator);
        assert!((drifted - expected).abs() < 1e-6, "{drifted} {expected}");
    }
}
