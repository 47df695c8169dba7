//! Fields of a diagnosis that the score reads.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::super::format::Hidden;
use super::judge::Named;

/// Number per signal.
pub type BySignal = BTreeMap<String, f64>;

/// Result of `retarder diagnose --json` for a rig.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Finding {
    /// `adequate`, `found`, `form_wrong` or `not_in_library`.
    pub verdict: String,
    /// Named effects.
    pub effects: Vec<String>,
    /// Ids that the log cannot distinguish from each named effect.
    #[serde(default)]
    pub equivalents: BTreeMap<String, Vec<String>>,
    /// One row per step.
    pub error_steps: Vec<Step>,
    /// All effects that were tried alone.
    #[serde(default)]
    pub candidates: Vec<Candidate>,
}

/// Error step of a diagnosis.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Step {
    /// Kind of change.
    #[serde(default)]
    pub kind: String,
    /// Effect that it adds, if any.
    #[serde(default)]
    pub added: Option<String>,
    /// Form of its law.
    #[serde(default)]
    pub variant: Option<String>,
    /// Rms error on the id log.
    pub fit_rms: BySignal,
    /// Rms error on the check log.
    pub check_rms: BySignal,
    /// Noise floor of the signal.
    pub noise_floor: BySignal,
    /// Share of the excess error of the refitted plain model that is explained.
    #[serde(default)]
    pub explained_share: Option<f64>,
    /// Number of fitted parameters.
    #[serde(default)]
    pub free_parameters: usize,
}

/// Model with one effect, refitted.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Candidate {
    /// Id.
    pub effect: String,
    /// Rms error on the id log.
    pub fit_rms: BySignal,
    /// Rms error on the check log.
    pub check_rms: BySignal,
    /// Number of fitted parameters.
    #[serde(default)]
    pub free_parameters: usize,
    /// Parameters of the effect.
    #[serde(default)]
    pub parameters: Vec<Fitted>,
}

/// A fitted parameter with its 95 % interval.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Fitted {
    /// Key of the parameter in the plant file.
    pub key: String,
    /// Best value.
    pub value: f64,
    /// Lower end of the interval.
    pub low: f64,
    /// Upper end of the interval.
    pub high: f64,
}

impl Fitted {
    /// Returns whether the interval contains a value.
    pub fn contains(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

impl Finding {
    /// Returns the names.
    pub fn named(&self) -> Named {
        Named {
            effects: self.effects.clone(),
            equivalents: self.equivalents.clone(),
        }
    }

    /// Returns the named effects, each with the form of its law, in the notation of `retarder refine --add`.
    pub fn forms(&self) -> Vec<String> {
        let form = |effect: &String| {
            let mut steps = self.error_steps.iter();
            let step = steps.find(|step| step.added.as_ref() == Some(effect));
            let variant = step.and_then(|step| step.variant.as_ref());
            variant.map_or_else(|| effect.clone(), |variant| format!("{effect}:{variant}"))
        };
        self.effects.iter().map(form).collect()
    }

    /// Returns fitted and true value of the parameter of a hidden effect, if it is named by its own id and the library
    /// has the parameter.
    pub fn size_of<'a>(&'a self, hidden: &'a Hidden) -> Option<(&'a Fitted, f64)> {
        let (key, truth) = hidden.parameter.as_ref()?;
        let fitted = self.fitted(&hidden.effect, key)?;
        let is_named = self.effects.contains(&hidden.effect);
        is_named.then_some((fitted, *truth))
    }

    /// Returns the plain model, refitted.
    pub fn plain(&self) -> Option<&Step> {
        let mut steps = self.error_steps.iter();
        steps.find(|step| step.kind != "plant_as_given")
    }

    /// Returns the excess of the refitted plain model, in units of the noise, of the signal with the largest one.
    pub fn excess(&self) -> f64 {
        self.plain().map_or(f64::NAN, |plain| {
            excess(&plain.check_rms, &plain.noise_floor)
        })
    }

    /// Returns the fit of a parameter of an effect.
    pub fn fitted(&self, effect: &str, key: &str) -> Option<&Fitted> {
        let mut candidates = self.candidates.iter();
        let candidate = candidates.find(|candidate| candidate.effect == effect)?;
        candidate.parameters.iter().find(|fitted| fitted.key == key)
    }

    /// Returns the number of ids that a named effect stands for, including its own.
    pub fn set_size(&self, effect: &str) -> usize {
        self.equivalents
            .get(effect)
            .map_or(1, |ids| ids.len().max(1))
    }

    /// Returns the check error of the last step relative to the noise, of the signal with the largest one.
    pub fn last_over_floor(&self) -> f64 {
        self.error_steps.last().map_or(f64::NAN, |last| {
            ratios(&last.check_rms, &last.noise_floor).fold(0.0, f64::max)
        })
    }
}

/// Errors of a model with one given effect, from `retarder refine --json`.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Alone {
    error_steps: Vec<Step>,
}

impl Alone {
    /// Returns the excess in units of the noise, of the signal with the largest one.
    pub fn excess(&self) -> f64 {
        let last = self.error_steps.last();
        last.map_or(f64::NAN, |last| excess(&last.check_rms, &last.noise_floor))
    }
}

/// Returns √((rms/floor)² - 1), of the signal with the largest one.
pub fn excess(rms: &BySignal, floor: &BySignal) -> f64 {
    ratios(rms, floor)
        .map(|ratio| (ratio * ratio - 1.0).max(0.0).sqrt())
        .fold(0.0, f64::max)
}

fn ratios<'a>(rms: &'a BySignal, floor: &'a BySignal) -> impl Iterator<Item = f64> + 'a {
    rms.iter()
        .filter_map(|(signal, rms)| Some(rms / floor.get(signal)?))
}
