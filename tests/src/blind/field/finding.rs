//! What the scores read of `retarder refine --json`.

use serde::Deserialize;
use serde_json::Value;

use super::super::score::finding::BySignal;

/// An estimation.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Estimated {
    /// The errors, from the plant as given on.
    pub steps: Vec<EstimatedStep>,
    /// The parameters.
    pub parameters: Vec<EstimatedParameter>,
}

/// A refinement with added effects.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct WithEffects {
    /// The errors, from the plant without the effects on.
    ladder: Vec<EstimatedStep>,
}

impl WithEffects {
    /// Check error in free run after the last step (noise floors).
    pub fn free_run(&self) -> Option<Worst> {
        let last = self.ladder.last()?;
        worst(&last.free_run_check_rms, &last.noise_floor)
    }
}

/// The errors of one step.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct EstimatedStep {
    /// Rms error on the check log, one step ahead.
    pub check_rms: BySignal,
    /// What the signal scatters by itself.
    pub noise_floor: BySignal,
    /// Rms error on the check log, in free run.
    pub free_run_check_rms: BySignal,
}

/// One estimated parameter.
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

/// An error in noise floors, of the signal in which it is worst.
#[derive(Debug, Clone, PartialEq)]
pub struct Worst {
    /// The signal.
    pub signal: String,
    /// The error.
    pub floors: f64,
}

impl Estimated {
    /// Check error one step ahead after the last step.
    pub fn check_error(&self) -> Option<Worst> {
        let errors = self.steps.last()?;
        worst(&errors.check_rms, &errors.noise_floor)
    }

    /// Check error in free run after the last step, in the noise floors of `floor`.
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
    /// Whether the estimation calls it determined.
    pub fn is_determined(&self) -> bool {
        self.determination == "determined"
    }

    /// Distance of the true value, in half widths of the interval on its side: within the interval up to 1.
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
