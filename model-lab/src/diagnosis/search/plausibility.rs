//! Plausibility of a fitted size in practice: a leak relative to the volume that it empties, the error of a sensor relative to the
//! pressures that it shows.

use plant_sim::PlantParameters;
use plant_sim::effects::About;
use plant_sim::parameters::ParameterSpec;

use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::result::FittedParameter;
use crate::diagnosis::result::words::significant;

/// Factor above or below the typical size beyond which a size does not occur in practice.
const IMPLAUSIBLE: f64 = 20.0;

/// Size of a rig relative to the nominal one, for which the typical sizes of the library apply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Practice {
    /// Volume of the chamber over the nominal one.
    volume: f64,
    /// Largest measured pressure over the nominal supply pressure, both gauge.
    pressure: f64,
}

impl Practice {
    pub(crate) fn new(plant: &PlantParameters, evidence: &Evidence) -> Self {
        let nominal = PlantParameters::nominal();
        let measured = evidence.logs.iter().filter_map(|log| log.pressure());
        let values = measured.flat_map(|channel| channel.values.iter().copied());
        let largest_bar = values.map(f64::abs).fold(0.0, f64::max);
        Self {
            volume: plant.chamber.volume_m3 / nominal.chamber.volume_m3,
            pressure: largest_bar / nominal.gas.supply_pressure_bar_gauge,
        }
    }

    /// Returns the typical value of a parameter on this rig; none where it is not the size of an effect.
    pub(crate) fn typical(&self, spec: &ParameterSpec) -> Option<f64> {
        let typical = spec.size?.typical;
        Some(match (spec.effect_id(), spec.unit) {
            (Some("chamber_leak" | "supply_seat_leak"), "m2") => {
                in_two_digits(typical * self.volume)
            }
            (Some("sensor_offset"), "bar") => in_two_digits(typical * self.pressure),
            _ => typical,
        })
    }
}

fn in_two_digits(value: f64) -> f64 {
    format!("{value:.1e}").parse().unwrap_or(value)
}

/// Returns the plausibility of the fitted `parameters` of an effect, in words. A strength may be arbitrarily small.
pub(crate) fn plausibility(about: &About, parameters: &[FittedParameter]) -> String {
    if parameters.is_empty() {
        return "explains nothing at any size that was tried".to_owned();
    }
    let of_typical = |parameter: &FittedParameter| {
        let typical = parameter.typical.filter(|&typical| typical != 0.0)?;
        Some((parameter.value / typical).abs())
    };
    let off = |parameter: &FittedParameter| {
        let mut specs = about.parameters();
        specs.find(|spec| spec.key == parameter.key)?.size?.off
    };
    let is_odd = |parameter: &&FittedParameter| {
        let [mut least, mut most] = [1.0 / IMPLAUSIBLE, IMPLAUSIBLE];
        match off(parameter) {
            Some(0.0) => least = 0.0,
            Some(_) => most = f64::INFINITY,
            None => {}
        }
        let is_usual = |ratio| (least..=most).contains(&ratio);
        parameter.at_bound || of_typical(parameter).is_some_and(|ratio| !is_usual(ratio))
    };
    let Some(odd) = parameters.iter().find(is_odd) else {
        return "plausible: within what is met in practice".to_owned();
    };
    match of_typical(odd) {
        Some(ratio) if !odd.at_bound => format!(
            "implausible: {} is {} times the size that is typical of such a rig",
            odd.key,
            significant(ratio, 2)
        ),
        _ => format!("implausible: {} ran to the end of its range", odd.key),
    }
}

#[cfg(test)]
mod tests {
    use plant_sim::effects::by_id;

    use super::*;
    use crate::bench::Bench;
    use crate::diagnosis::fit::gather::gather;

    fn on_a_rig(volume_m3: f64) -> Practice {
        let mut bench = Bench::default();
        bench.plant.chamber.volume_m3 = volume_m3;
        let evidence = gather(&bench.plant, &[bench.measure()]).unwrap();
        Practice::new(&bench.plant, &evidence)
    }

    fn said(practice: &Practice, name: &str, value: f64) -> String {
        let spec = ParameterSpec::by_name(name).unwrap();
        let id = spec.effect_id().unwrap();
        let fitted = FittedParameter {
            key: spec.key.to_owned(),
            unit: spec.unit.to_owned(),
            value,
            low: value,
            high: value,
            typical: practice.typical(spec),
            at_bound: false,
        };
        plausibility(by_id(id).unwrap().about(), &[fitted])
    }

    #[test]
    fn a_leak_is_plausible_beside_the_volume_that_it_empties() {
        let area = "effects.chamber_leak.area_m2";
        assert!(
            said(&on_a_rig(75e-6), area, 2e-6).starts_with("implausible: area_m2 is 100 times")
        );
        assert!(said(&on_a_rig(750e-6), area, 2e-6).starts_with("plausible"));
        assert!(said(&on_a_rig(75e-6), area, 1e-11).starts_with("plausible"));
    }

    /// Defect seen: a drift of 14 % of the reading was called plausible.
    #[test]
    fn the_drift_of_a_sensor_is_plausible_beside_what_it_shows() {
        let practice = on_a_rig(75e-6);
        let drift = "effects.sensor_offset.drift_bar";
        let reading_bar = 8.4 * practice.pressure;
        assert!(said(&practice, drift, 0.14 * reading_bar).starts_with("implausible"));
        assert!(said(&practice, drift, 0.03 * reading_bar).starts_with("plausible"));
    }
}
