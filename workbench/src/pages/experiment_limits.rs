//! Limits of an experiment that a page plans.

use model_lab::diagnosis::next_experiment::Limits;
use plant_sim::PlantParameters;
use serde::Deserialize;

use crate::refusal::Refusal;

/// Limits as a page sends them.
#[derive(Clone, Copy, Deserialize)]
pub(super) struct RequestedLimits {
    duration_s: f64,
    /// Highest chamber pressure (bar gauge); `None` stays below 90 % of the supply pressure.
    max_bar: Option<f64>,
    max_duty_pct: f64,
}

impl RequestedLimits {
    /// Returns the limits for an experiment with `plant`, or refuses a value that is out of range.
    pub(super) fn of(self, plant: &PlantParameters) -> Result<Limits, Refusal> {
        let within = |what: &str, value: f64, most: f64, unit: &str| {
            if value > 0.0 && value <= most {
                Ok(value)
            } else {
                Err(Refusal::value(format!(
                    "{what} is {value} {unit} (above 0, at most {most} {unit}); enter a value in this range"
                )))
            }
        };
        let max_bar = self.max_bar.unwrap_or(Limits::usual_max_bar(plant));
        let longest_s = Limits::LONGEST_S;
        Ok(Limits {
            duration_s: within("the experiment's duration", self.duration_s, longest_s, "s")?,
            max_bar: within("the highest pressure", max_bar, Limits::HIGHEST_BAR, "bar")?,
            max_duty_pct: within("the highest duty cycle", self.max_duty_pct, 100.0, "%")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_experiment_stays_below_the_supply_and_within_its_bounds() {
        let plant = PlantParameters::nominal();
        let limits = |duration_s, max_bar| {
            let requested = RequestedLimits {
                duration_s,
                max_bar,
                max_duty_pct: 100.0,
            };
            requested.of(&plant).ok()
        };
        let usual = limits(600.0, None).unwrap();
        assert!(usual.max_bar < plant.gas.supply_pressure_bar_gauge);
        assert_eq!(limits(20.0, Some(40.0)).unwrap().max_bar, 40.0);
        assert_eq!(limits(20.0, Some(40.1)), None);
        assert_eq!(limits(600.1, None), None);
    }
}
