//! What a diagnosis says, as it stands in its JSON.

use core::fmt;
use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::words::{significant, spaced};
pub use crate::result::{ClockSource, FoundClock, FoundStart};
use crate::result::{LogDefects, NotCompared, Warning};

/// Name and version of the JSON format.
pub const DIAGNOSIS_SCHEMA: &str = "retarder.diagnosis/1";

/// A figure per signal, such as `p_ch` in bar and `i_fill` in mA.
pub type BySignal = BTreeMap<String, f64>;

/// Which physical effect is missing, and how the error falls when it is added.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Diagnosis {
    /// Name and version of this format, `retarder.diagnosis/1`.
    pub schema: String,
    /// Sources of the logs that were fitted.
    pub logs: Vec<String>,
    /// Sources of the logs that judged; empty where blocks of the fitted logs were held out.
    pub check: Vec<String>,
    /// From the source of a log to its signals that could not be weighed, and why: what only they show was not looked for.
    #[serde(default)]
    pub not_compared: BTreeMap<String, Vec<NotCompared>>,
    /// From the source of a log to its gaps and missing cells; absent where no log has any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub defects: BTreeMap<String, LogDefects>,
    /// From the source of a log to what in it probably is not what it is declared to be.
    #[serde(default)]
    pub warnings: BTreeMap<String, Vec<Warning>>,
    /// Clocks of the loggers, where they are not that of the ECU.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<FoundClock>,
    /// Temperatures of the gas where logs begin with a filled chamber.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub starts: Vec<FoundStart>,
    /// What judged, in words.
    pub held_out: String,
    /// How the errors were made and what they are weighed against, in words.
    pub predictor: String,
    /// One of five answers.
    pub verdict: Verdict,
    /// The answer in words.
    pub sentence: String,
    /// Whether the last fit has converged: a further step gains little.
    pub is_converged: bool,
    /// Ids of the named effects in the order added.
    pub effects: Vec<String>,
    /// Whether a material part of the excess error remains after them.
    pub unexplained: bool,
    /// From each named effect to the effects that these logs cannot tell from it, itself included.
    pub equivalents: BTreeMap<String, Vec<String>>,
    /// From each named effect to every other effect that explains something: by how many standard deviations of the
    /// noise these logs tell it from the named one. Below 3.3 they are swapped in more than one of twenty logs.
    pub distinguishability: BTreeMap<String, BTreeMap<String, f64>>,
    /// The error, step by step: the plant as given, its ordinary parameters refitted, their ranges widened where that was tried,
    /// and one row per added effect.
    pub ladder: Vec<Step>,
    /// Ordinary parameters whose values lie outside of what the plant file admits: together these values explain the error, beside
    /// the named effects where the ladder has a row of widened ranges, in their place where it has none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<OutsideValue>,
    /// Effects that explain the error as well if the values of `outside` are those of the plant file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rival_effects: Vec<String>,
    /// Every effect of the library that acts on a part of the plant, the one that explains most first.
    pub candidates: Vec<Candidate>,
    /// What may differ from rig to rig without any physics missing, as fitted with the named effects.
    pub nuisance: Vec<NuisanceValue>,
    /// Where the excess error is.
    #[serde(rename = "where")]
    pub location: Location,
    /// What the residual looks like after the named effects.
    pub remaining: Remaining,
    /// What the answer cost.
    pub cost: Cost,
}

impl Diagnosis {
    /// The JSON Schema of a diagnosis.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }
}

/// The answers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing detectable is missing.
    Adequate,
    /// No physics is missing: ordinary parameters lie outside of what the plant file admits.
    PlantFileWrong,
    /// These effects, and nothing material remains.
    Found,
    /// The dominant effect is named, but something remains: its law differs, or another effect is missing as well.
    FormWrong,
    /// Something is missing that no effect of the library explains.
    NotInLibrary,
}

/// An ordinary parameter outside of what the plant file admits.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutsideValue {
    /// Its name in the plant file.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Fitted value.
    pub value: f64,
    /// Least value that the plant file admits.
    pub least: f64,
    /// Largest value that the plant file admits.
    pub most: f64,
}

impl OutsideValue {
    /// How far it lies from what the plant file admits, over that.
    pub(crate) fn distance(&self) -> f64 {
        let nearest = self.value.clamp(self.least, self.most);
        (self.value - nearest).abs() / nearest.abs().max(f64::MIN_POSITIVE)
    }
}

impl fmt::Display for OutsideValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, value, .. } = self;
        let [value, least, most] =
            [*value, self.least, self.most].map(|value| significant(value, 3));
        let unit = match self.unit.is_empty() {
            true => String::new(),
            false => format!(" {}", self.unit),
        };
        write!(f, "`{name}` is {value}{unit}, and not ")?;
        if self.least == self.most {
            write!(f, "{least}{unit}")
        } else {
            write!(f, "{least} to {most}{unit}")
        }
    }
}

/// What a step changes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StepKind {
    /// Nothing: the plant as it was given, with the loggers' clocks found.
    PlantAsGiven,
    /// The ordinary parameters are fitted within what the plant file admits.
    ParametersRefitted,
    /// The same beyond the ends at which they stopped.
    RangesWidened,
    /// An effect is added, and everything is fitted again.
    EffectAdded,
}

impl StepKind {
    /// The step in words.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::PlantAsGiven => "plant as given",
            Self::ParametersRefitted => "ordinary parameters refitted",
            Self::RangesWidened => "ordinary parameters refitted beyond their tolerances",
            Self::EffectAdded => "effect added",
        }
    }
}

/// One row of the ladder.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// What it changes.
    pub kind: StepKind,
    /// Id of the effect that this row adds; null for the others.
    pub added: Option<String>,
    /// Form of its law; null for the others.
    pub variant: Option<String>,
    /// Rms error on the fitted logs.
    pub fit_rms: BySignal,
    /// Rms error on what was held out.
    pub check_rms: BySignal,
    /// What a perfect model would have there: the noise of the measurement, seen through the predictor.
    pub noise_floor: BySignal,
    /// Rms error on what was held out of the model driven by the commands alone.
    pub free_run_check_rms: BySignal,
    /// Share of the excess error of the plant with refitted parameters that is explained, at most 1; below 0 where the error is
    /// larger. The less of two shares: that of the fitted logs and that of what was held out, as far as the excess shows there.
    pub explained_share: f64,
    /// Number of fitted parameters.
    pub free_parameters: usize,
}

impl Step {
    /// What it is, in words: the effect that it adds with the form of its law, or what it does to the parameters.
    #[must_use]
    pub fn name(&self) -> String {
        match (&self.added, &self.variant) {
            (Some(id), Some(variant)) => format!("+ {} ({})", spaced(id), spaced(variant)),
            _ => self.kind.name().to_owned(),
        }
    }

    /// Rms error on what was held out, in noise floors; the signal is one of the step's.
    #[must_use]
    pub fn in_noise(&self, signal: &str) -> f64 {
        self.check_rms[signal] / self.noise_floor[signal]
    }

    /// The same of the signal in which it is largest; 0 without signals.
    #[must_use]
    pub fn worst_in_noise(&self) -> f64 {
        let signals = self.check_rms.keys();
        signals
            .map(|signal| self.in_noise(signal))
            .fold(0.0, f64::max)
    }
}

/// The plain model with one effect, refitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Candidate {
    /// Its id.
    pub effect: String,
    /// The form of its law that explains most.
    pub variant: String,
    /// Rms error on the fitted logs.
    pub fit_rms: BySignal,
    /// Rms error on what was held out.
    pub check_rms: BySignal,
    /// Share of the plain model's excess error that it explains by itself, as in the ladder.
    pub explained_share: f64,
    /// Evidence for it against the plain model: difference of the information criterion of Schwarz, corrected for
    /// correlated errors. Above 10 it is strong, below 0 it speaks against the effect.
    pub evidence: f64,
    /// Number of fitted parameters.
    pub free_parameters: usize,
    /// The effect's own parameters; of a named effect, those fitted together with all named ones.
    pub parameters: Vec<FittedParameter>,
    /// Whether the fitted size is one that is met in practice, in words.
    pub plausibility: String,
    /// What size these logs would have shown.
    pub detection_limit: DetectionLimit,
    /// One sentence for the workshop.
    pub physics: String,
    /// Number in `docs/equations.md`, and the source.
    pub source: String,
}

/// A fitted parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FittedParameter {
    /// Its key in the plant file.
    pub key: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Best value.
    pub value: f64,
    /// Lower end of the 95 % interval: noise, and what correct programs of one plant differ by.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// A size that is met in practice, on a rig of this volume and of these pressures; null where none is known.
    pub typical: Option<f64>,
    /// Whether it ran to the end of its range: physics is missing, or the logs do not show it.
    pub at_bound: bool,
}

/// The size of an effect that these logs would have shown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DetectionLimit {
    /// At this size and above it would have been named.
    Size {
        /// Key of the parameter in the plant file.
        key: String,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// No size that is met in practice shows in these logs.
    NotExcited {
        /// What would show it.
        manoeuvre: String,
    },
}

/// A nuisance parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NuisanceValue {
    /// Name in the plant file.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Value of the plant file.
    pub datasheet: f64,
    /// Allowed distance from it.
    pub tolerance: f64,
    /// Value fitted to the plain model.
    pub plain: f64,
    /// Value fitted with the named effects.
    pub fitted: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Set where it ran to the end of its tolerance, in the plain model or with the named effects: physics may be missing.
    pub alarm: Option<String>,
}

/// Where the excess error is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Location {
    /// Why `compare`, which judges the plant as given, places the error elsewhere; empty where it does not.
    pub of_compare: Vec<String>,
    /// With the plain model.
    pub before: Vec<Regime>,
    /// With the named effects; the same as `before` where none is named.
    pub after: Vec<Regime>,
}

/// The regime that holds most of the excess error of one signal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Regime {
    /// Source of the log.
    pub log: String,
    /// The signal.
    pub signal: String,
    /// The regime in words; null where there is no excess to place.
    pub regime: Option<String>,
    /// Its share of the excess.
    pub excess_share: Option<f64>,
    /// Its share of the samples.
    pub sample_share: Option<f64>,
    /// All of it in one sentence.
    pub sentence: String,
}

/// What the residual looks like.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Remaining {
    /// The leading shapes in words, the most telling first; empty where nothing material remains.
    pub sentences: Vec<String>,
    /// The flow that is missing, against what it may depend on; positive fills the chamber.
    pub missing_flow: Vec<FlowCurve>,
    /// Sharp lines in the spectrum of a residual.
    pub spectral_lines: Vec<SpectralLine>,
    /// Single instants at which far more or less air came than a pulse delivers.
    pub lost_pulses: Vec<LostPulse>,
}

/// Missing flow against one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlowCurve {
    /// The quantity, such as `p_ch`.
    pub against: String,
    /// Its unit.
    pub unit: String,
    /// When it was looked at: `both valves shut`, `filling`, `venting`.
    pub condition: String,
    /// Share of the missing flow's variance that the curve explains, 0 to 1.
    pub explained_share: f64,
    /// The curve, rising in its quantity.
    pub points: Vec<FlowPoint>,
}

/// One point of a missing flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlowPoint {
    /// The quantity.
    pub at: f64,
    /// Mean rate at which the pressure is missing (bar/s).
    pub bar_per_s: f64,
    /// Standard error of it (bar/s).
    pub standard_error: f64,
    /// Samples.
    pub samples: usize,
}

/// A line in a spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpectralLine {
    /// The signal.
    pub signal: String,
    /// When it was looked at: `filling`, `venting`, `both valves shut`, `always`.
    pub condition: String,
    /// Its frequency (Hz).
    pub frequency_hz: f64,
    /// Amplitude of what would have to swing to make it, about.
    pub amplitude: f64,
    /// What that is: `bar of supply pressure`, `of the flow`, `bar/s` of missing flow, `mA` of a coil current.
    pub unit: String,
    /// Probability of such a line in noise.
    pub p_value: f64,
}

/// One instant at which the residual jumped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LostPulse {
    /// Source of the log.
    pub log: String,
    /// Instant (s).
    pub time_s: f64,
    /// By how much the measured pressure jumped beside the model (bar).
    pub jump_bar: f64,
    /// The same in standard deviations of what is usual there.
    pub in_noise: f64,
}

/// What an answer cost.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Simulations of all logs.
    pub simulations: usize,
    /// Logged time that one simulation covers (s).
    pub log_s: f64,
    /// Wall time that it took, with several simulations at once on as many cores (s).
    pub elapsed_s: f64,
    /// Computing time of one simulation (ms).
    pub per_simulation_ms: f64,
}

impl Cost {
    /// Adds the simulations and the time of further work on the same logs.
    pub(super) fn add(&mut self, further: &Self) {
        self.simulations += further.simulations;
        self.elapsed_s += further.elapsed_s;
    }
}
