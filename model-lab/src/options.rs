use std::collections::BTreeMap;

use plant_sim::Tolerance;

use crate::error::CompareError;
use crate::measured::Measured;

/// Options of a comparison.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareOptions {
    /// Largest free-run rms over the noise floor that is within tolerance; positive.
    pub allowed_noise_multiples: f64,
    /// Largest free-run rms that is within tolerance for a signal, instead of the multiple of its noise floor: name and value in the unit
    /// of its errors (bar, mA, mm); positive.
    pub tolerances: BTreeMap<String, f64>,
    /// Gain L of the one-step-ahead predictor, above 0 up to 1: its memory is about 1/L samples.
    pub predictor_gain: f64,
    /// Accuracy of the simulation.
    pub tolerance: Tolerance,
}

impl Default for CompareOptions {
    /// Returns 1.5 noise floors, no tolerances and gain 0.3.
    fn default() -> Self {
        Self {
            allowed_noise_multiples: 1.5,
            tolerances: BTreeMap::new(),
            predictor_gain: 0.3,
            tolerance: Tolerance::default(),
        }
    }
}

impl CompareOptions {
    pub(crate) fn check(&self) -> Result<(), CompareError> {
        let refuse = |option: &str, value, range| {
            Err(CompareError::Option {
                option: option.to_owned(),
                value,
                range,
            })
        };
        if !(self.allowed_noise_multiples > 0.0 && self.allowed_noise_multiples.is_finite()) {
            return refuse(
                "allowed_noise_multiples",
                self.allowed_noise_multiples,
                "positive and finite",
            );
        }
        if !(self.predictor_gain > 0.0 && self.predictor_gain <= 1.0) {
            return refuse(
                "predictor_gain",
                self.predictor_gain,
                "above 0 and at most 1",
            );
        }
        let impossible = self
            .tolerances
            .iter()
            .find(|(_, value)| !(**value > 0.0 && value.is_finite()));
        match impossible {
            Some((name, &value)) => {
                refuse(&format!("tolerances.{name}"), value, "positive and finite")
            }
            None => Ok(()),
        }
    }

    pub(crate) fn check_tolerances(&self, measured: &[Measured]) -> Result<(), CompareError> {
        let unused = self
            .tolerances
            .keys()
            .find(|name| measured.iter().all(|signal| signal.name != **name));
        unused.map_or(Ok(()), |name| {
            Err(CompareError::UnusedTolerance {
                name: name.clone(),
                compared: measured
                    .iter()
                    .map(|signal| signal.name.to_owned())
                    .collect(),
            })
        })
    }
}
