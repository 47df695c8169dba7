//! Fields of `retarder refine --json` that the scores read.

use serde::Deserialize;
use serde_json::Value;

use super::super::score::finding::BySignal;

/// Estimation.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Estimated {
    /// Errors, from the given plant on.
    pub steps: Vec<EstimatedStep>,
    /// Parameters.
    pub parameters: Vec<EstimatedParameter>,
}

/// Refinement with added effects.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct WithEffects {
    /// Errors, from the plant without the effects on.
    error_steps: Vec<EstimatedStep>,
}

impl WithEffects {
    /// Returns the free-run check error after the last step (noise floors).
    pub fn free_run(&self) -> Option<Worst> {
        let last = self.error_steps.last()?;
        worst(&last.free_run_check_rms, &last.noise_floor)
    }
}

/// Errors of one step.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EstimatedStep {
    /// One-step-ahead rms error on the check log.
    pub check_rms: BySignal,
    /// Noise floor of the signal.
    pub noise_floor: BySignal,
    /// Free-run rms error on the check log.
    pub free_run_check_rms: BySignal,
}

/// Estimated parameter.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EstimatedParameter {
    /// Name in a plant file.
    pub name: String,
    /// Estimated value.
    pub after: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// `"determined"`, or another class.
    pub determination: Value,
}

/// Error in noise floors, of the signal with the largest one.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// Signal.
    pub signal: String,
    /// Error.
    pub floors: f64,
}

impl Estimated {
    /// Returns the one-step-ahead check error after the last step.
    pub fn check_error(&self) -> Option<Worst> {
        let errors = self.steps.last()?;
        worst(&errors.check_rms, &errors.noise_floor)
    }

    /// Returns the free-run check error after the last step, in the noise floors of `floor`.
    pub fn free_run(&self, floor: &Self) -> Option<Worst> {
        let floor = &floor.steps.last()?.noise_floor;
        worst(&self.steps.last()?.free_run_check_rms, floor)
    }
}

fn worst(rms: &BySignal, floor: &BySignal) -> Option<Worst> {
    let all = rms.iter().filter_map(|(signal, rms)| {
        Some(Worst {
            signal: signal.clone(),
            floors: rms / floor.get(signal)?,
        })
    });
    all.max_by(|a, b| a.floors.total_cmp(&b.floors))
}

impl EstimatedParameter {
    /// Returns whether the estimation calls it determined.
    pub fn is_determined(&self) -> bool {
        self.determination == "determined"
    }

    /// Returns the distance of the true value, in half widths of the interval on its side; up to 1 it is within the
    /// interval.
    pub fn half_widths_off(&self, truth: f64) -> f64 {
        let half = if truth > self.after {
            self.high - self.after
        } else {
            self.after - self.low
        };
        if truth == self.after {
            0.0
        } else {
            (truth - self.after).abs() / half
        }
    }
}
