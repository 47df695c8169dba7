//! Effect: the reading of the pressure sensor depends on the previous direction of the pressure.

use crate::description::{
    About, Effect, EffectSetting, EntryPoint, PA_PER_BAR, PlantParameters, Variant,
    effect_parameters,
};
use crate::plant::Plant;

effect_parameters! { "effects.sensor_hysteresis":
    HYSTERESIS = hysteresis_bar ["bar"] 1e-4 ..= 2.0, Log 0.02, off 0.0,
        "difference of the readings at one pressure, reached from above and from below (E62)";
}

static ABOUT: About = About {
    id: "sensor_hysteresis",
    sentence: "At the same pressure the sensor shows more after venting than after filling.",
    source: "E62: play operator; hysteresis is a figure of the datasheet of pressure sensors (IEC 61298-2)",
    acts_on: EntryPoint::Sensor,
    variants: &[Variant::only(&[&HYSTERESIS])],
    excited_by: "the same pressure reached by filling and by venting, each with a hold",
    confused_with: &["sensor_lag", "dead_volume", "drain_back_pressure"],
};

/// The effect.
#[derive(Debug)]
pub struct SensorHysteresis;

impl Effect for SensorHysteresis {
    fn about(&self) -> &'static About {
        &ABOUT
    }

    fn install(&self, setting: &EffectSetting, _: &PlantParameters, plant: &mut Plant) {
        plant.additions.sensor_hysteresis = setting.value("hysteresis_bar") * PA_PER_BAR;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Command, Simulator};

    /// The reading follows a pressure that moves by more than the hysteresis at a distance of half of it. If the
    /// pressure turns back by less than the hysteresis, the reading does not change.
    #[test]
    fn the_reading_follows_at_half_the_hysteresis() {
        let hysteresis_bar = 1.0;
        let setting =
            EffectSetting::typical(&SensorHysteresis).with("hysteresis_bar", hysteresis_bar);
        let mut simulator = Simulator::new(&PlantParameters::nominal().with_effect(setting));
        let mut after = |duty_fill_pct: f64, duty_vent_pct: f64, ms: u64| {
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct,
            });
            let until_ns = simulator.sample().time_ns + ms * 1_000_000;
            simulator.advance_to_ns(until_ns);
            let sample = simulator.sample();
            (sample.pressure, sample.measured_pressure)
        };
        let half = 0.5 * hysteresis_bar * PA_PER_BAR;
        after(50.0, 0.0, 200);
        let (filled, shown) = after(0.0, 0.0, 100);
        assert!((filled - half - shown).abs() < 1e-6, "{filled} {shown}");
        after(0.0, 60.0, 10);
        let (turned, held) = after(0.0, 0.0, 50);
        assert!(
            filled - turned > 10.0 && filled - turned < 2.0 * half,
            "{filled} {turned}"
        );
        assert_eq!(held, shown);
        after(0.0, 60.0, 150);
        let (vented, shown) = after(0.0, 0.0, 100);
        assert!((vented + half - shown).abs() < 1e-6, "{vented} {shown}");
    }
}
