//! Result of a diagnosis, as in its JSON.

pub(crate) mod alternatives;
pub(crate) mod view;
pub(crate) mod words;

use core::fmt;
use std::collections::BTreeMap;

use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::conditions::LogConditions;
pub use crate::result::{ClockSource, FoundClock, FoundStart, Horizon};
use crate::result::{LogDefects, NotCompared, Warning};
use words::{significant, spaced};

/// Name and version of the JSON format.
pub const DIAGNOSIS_SCHEMA: &str = "retarder.diagnosis/2";

/// Value per signal, such as `p_ch` in bar and `i_fill` in mA.
pub type BySignal = BTreeMap<String, f64>;

/// Diagnosis: the missing physical effects, and the decrease of the error when they are added.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Diagnosis {
    /// Name and version of this format, `retarder.diagnosis/2`.
    pub schema: String,
    /// Sources of the training logs.
    pub logs: Vec<String>,
    /// Sources of the validation logs; empty where validation uses held-out blocks of the training logs.
    pub check: Vec<String>,
    /// From the source of a log to its signals that were excluded, with the reasons; effects that only they show were not searched.
    #[serde(default)]
    pub not_compared: BTreeMap<String, Vec<NotCompared>>,
    /// From the source of a log to its gaps and missing cells; absent where no log has any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub defects: BTreeMap<String, LogDefects>,
    /// From the source of a log to the properties that probably differ from their declaration.
    #[serde(default)]
    pub warnings: BTreeMap<String, Vec<Warning>>,
    /// Clocks of the loggers, where they differ from that of the ECU.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub clocks: Vec<FoundClock>,
    /// Temperatures of the gas where logs begin with a filled chamber.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub starts: Vec<FoundStart>,
    /// From the source of a log to the conditions under which it was fitted; empty for a diagnosis read from JSON.
    #[serde(skip)]
    pub conditions: BTreeMap<String, FittedConditions>,
    /// Validation data, in words.
    pub held_out: String,
    /// Horizon of the fitted and judged errors: one step ahead, or free run where errors within the noise one step ahead add up.
    pub horizon: Horizon,
    /// Whether errors that are within the noise one step ahead add up in free run to more than those of a correct model, unexplained.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub adds_up: bool,
    /// Prediction that gives the errors, and their reference, in words.
    pub predictor: String,
    /// Verdict, one of five.
    pub verdict: Verdict,
    /// The answer in words.
    pub sentence: String,
    /// Whether the last fit has converged: a further step gains little.
    pub is_converged: bool,
    /// Ids of the named effects in the order added.
    pub effects: Vec<String>,
    /// Whether a material part of the excess error remains after them.
    pub unexplained: bool,
    /// From each named effect to the effects that these logs cannot distinguish from it, including itself.
    pub equivalents: BTreeMap<String, Vec<String>>,
    /// From each named effect to every other effect that explains something: the distance of the two in these logs, in standard
    /// deviations of the noise. Below 3.3 they are confused in more than one of twenty logs.
    pub distinguishability: BTreeMap<String, BTreeMap<String, f64>>,
    /// Error steps: the plant as given, its ordinary parameters refitted, their ranges widened where that was tried,
    /// and one row per added effect.
    pub error_steps: Vec<Step>,
    /// Ordinary parameters with values outside the range of the plant file; together these values explain the error: in addition to
    /// the named effects where the error steps have a row of widened ranges, instead of them where they have none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outside: Vec<OutsideValue>,
    /// Effects that explain the error as well if the parameters of `outside` have the values of the plant file.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub rival_effects: Vec<String>,
    /// Every effect of the library that acts on a part of the plant, by falling explained share.
    pub candidates: Vec<Candidate>,
    /// Part of the proportional valves that lags, `spool` or `opening`, where the plant file leaves it open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lag_of: Option<String>,
    /// Parameters that may differ from rig to rig without missing physics, as fitted with the named effects.
    pub nuisance: Vec<NuisanceValue>,
    /// Location of the excess error.
    #[serde(rename = "where")]
    pub location: Location,
    /// Unexplained residual after the named effects.
    pub remaining: Remaining,
    /// Cost of the answer.
    pub cost: Cost,
}

impl Diagnosis {
    /// Returns the JSON Schema of a diagnosis.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }

    /// Returns whether it explains the error of the diagnosed plant: with the named effects, nothing material remains.
    pub fn explains(&self) -> bool {
        matches!(self.verdict, Verdict::Found | Verdict::Adequate)
            && !self.unexplained
            && !self.adds_up
    }
}

/// Conditions under which a log was made, as fitted together with the plants of [`Diagnosis::plain_and_refined`].
#[derive(Debug, Clone, PartialEq)]
pub struct FittedConditions {
    /// With the ordinary parameters refitted.
    pub plain: LogConditions,
    /// With the named effects as well.
    pub refined: LogConditions,
}

/// Verdict of a diagnosis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verdict {
    /// Nothing detectable is missing, or too little is left to say so.
    Adequate,
    /// No physics is missing: ordinary parameters lie outside the range of the plant file.
    PlantFileWrong,
    /// The named effects explain the error; nothing material remains.
    Found,
    /// The dominant effect is named, but something remains: its law differs, or another effect is missing as well.
    FormWrong,
    /// Something is missing that no effect of the library explains.
    NotInLibrary,
}

/// Ordinary parameter outside the range of the plant file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OutsideValue {
    /// Its name in the plant file.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Fitted value.
    pub value: f64,
    /// Lower end of the range of the plant file.
    pub least: f64,
    /// Upper end of the range of the plant file.
    pub most: f64,
}

impl OutsideValue {
    /// Returns the distance from the nearest end of the plant file's range, relative to that end.
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

/// Kind of an error step.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StepKind {
    /// Plant as given, with the loggers' clocks found.
    PlantAsGiven,
    /// Fit of the ordinary parameters within the ranges of the plant file.
    ParametersRefitted,
    /// Fit of the ordinary parameters beyond the ends at which they stopped.
    RangesWidened,
    /// Addition of an effect, and a new fit of all parameters.
    EffectAdded,
}

impl StepKind {
    /// Returns the step in words.
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

/// Error step: one row of the error_steps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Step {
    /// Kind of the step.
    pub kind: StepKind,
    /// Id of the effect that this row adds; null for the others.
    pub added: Option<String>,
    /// Form of its law; null for the others.
    pub variant: Option<String>,
    /// Rms error on the training data.
    pub fit_rms: BySignal,
    /// Rms error on the validation data.
    pub check_rms: BySignal,
    /// Rms error of a perfect model on the validation data: the noise of the measurement, after the predictor.
    pub noise_floor: BySignal,
    /// Rms error of the free-run simulation, driven by the commands alone, on the validation data.
    pub free_run_check_rms: BySignal,
    /// Share of the excess error of the plant with refitted parameters that is explained, at most 1; below 0 where the error is
    /// larger. The smaller of two shares, on training and on validation data, as far as the excess shows there.
    pub explained_share: f64,
    /// Number of fitted parameters.
    pub free_parameters: usize,
}

impl Step {
    /// Returns the step in words: the added effect with the form of its law, or the change of the parameters.
    #[must_use]
    pub fn name(&self) -> String {
        match (&self.added, &self.variant) {
            (Some(id), Some(variant)) => format!("+ {} ({})", spaced(id), spaced(variant)),
            _ => self.kind.name().to_owned(),
        }
    }

    /// Returns the rms error on the validation data, in noise floors; `signal` is one of the step's.
    #[must_use]
    pub fn in_noise(&self, signal: &str) -> f64 {
        self.check_rms[signal] / self.noise_floor[signal]
    }

    /// Returns the largest rms error of any signal, in noise floors; 0 without signals.
    #[must_use]
    pub fn worst_in_noise(&self) -> f64 {
        let signals = self.check_rms.keys();
        signals
            .map(|signal| self.in_noise(signal))
            .fold(0.0, f64::max)
    }

    /// Returns the largest rms error of any signal in free run on the validation data, in noise floors; 0 without signals.
    #[must_use]
    pub fn worst_free_run_in_noise(&self) -> f64 {
        let signals = self.free_run_check_rms.iter();
        signals
            .map(|(signal, rms)| rms / self.noise_floor[signal])
            .fold(0.0, f64::max)
    }
}

/// Plain model with one effect, refitted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Candidate {
    /// Id of the effect.
    pub effect: String,
    /// Form of its law that explains most.
    pub variant: String,
    /// Rms error on the training data.
    pub fit_rms: BySignal,
    /// Rms error on the validation data.
    pub check_rms: BySignal,
    /// Share of the plain model's excess error that it explains alone, as in the error steps.
    pub explained_share: f64,
    /// Evidence for the effect against the plain model: difference of the information criterion of Schwarz, corrected for
    /// correlated errors. Above 10 it is strong, below 0 it speaks against the effect.
    pub evidence: f64,
    /// Number of fitted parameters.
    pub free_parameters: usize,
    /// Parameters of the effect; of a named effect, those fitted together with all named ones.
    pub parameters: Vec<FittedParameter>,
    /// Plausibility of the fitted size in practice, in words.
    pub plausibility: String,
    /// Detection limit: the least size of the effect that these logs show.
    pub detection_limit: DetectionLimit,
    /// Description in one sentence for the workshop.
    pub physics: String,
    /// Number in `docs/equations.md`, and the source.
    pub source: String,
}

/// Fitted parameter of an effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FittedParameter {
    /// Key in the plant file.
    pub key: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Best value.
    pub value: f64,
    /// Lower end of the 95 % interval: noise, and the difference between correct programs of one plant.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Size that occurs in practice, on a rig of this volume and of these pressures; null where none is known.
    pub typical: Option<f64>,
    /// Whether it reached the end of its range: physics is missing, or the logs do not show it.
    pub at_bound: bool,
}

/// Detection limit of an effect in these logs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum DetectionLimit {
    /// An effect of this size or above would have been named.
    Size {
        /// Key of the parameter in the plant file.
        key: String,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: String,
    },
    /// No size that occurs in practice shows in these logs.
    NotExcited {
        /// Excitation that would show the effect.
        test_signal: String,
    },
}

/// Nuisance parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NuisanceValue {
    /// Name in the plant file.
    pub name: String,
    /// Its unit; empty for a pure number.
    pub unit: String,
    /// Value of the plant file.
    pub datasheet: f64,
    /// Allowed distance from the value of the plant file.
    pub tolerance: f64,
    /// Value fitted to the plain model.
    pub plain: f64,
    /// Value fitted with the named effects.
    pub fitted: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Set where the value reached the end of its tolerance, in the plain model or with the named effects: physics may be missing.
    pub alarm: Option<String>,
}

/// Location of the excess error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Location {
    /// Reason why `compare`, which uses the plant as given, places the error elsewhere; empty where it does not.
    pub of_compare: Vec<String>,
    /// Regimes with the plain model.
    pub before: Vec<Regime>,
    /// Regimes with the named effects; the same as `before` where none is named.
    pub after: Vec<Regime>,
}

/// Regime with most of the excess error of one signal.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Regime {
    /// Source of the log.
    pub log: String,
    /// Name of the signal.
    pub signal: String,
    /// The regime in words; null where there is no excess to place.
    pub regime: Option<String>,
    /// Its share of the excess.
    pub excess_share: Option<f64>,
    /// Its share of the samples.
    pub sample_share: Option<f64>,
    /// The regime and its shares in one sentence.
    pub sentence: String,
}

/// Unexplained residual.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Remaining {
    /// The leading shapes in words, the most informative first; empty where nothing material remains.
    pub sentences: Vec<String>,
    /// Missing flow as a function of quantities on which it may depend; positive fills the chamber.
    pub missing_flow: Vec<FlowCurve>,
    /// Sharp lines in the spectrum of a residual.
    pub spectral_lines: Vec<SpectralLine>,
    /// Single instants at which much more or less air entered than a pulse delivers.
    pub lost_pulses: Vec<LostPulse>,
}

/// Missing flow as a function of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlowCurve {
    /// Quantity on the abscissa, such as `p_ch`.
    pub against: String,
    /// Unit of the quantity.
    pub unit: String,
    /// Condition of the samples: `both valves shut`, `filling`, `venting`.
    pub condition: String,
    /// Share of the missing flow's variance that the curve explains, 0 to 1.
    pub explained_share: f64,
    /// Points of the curve, by rising quantity.
    pub points: Vec<FlowPoint>,
}

/// Point of a missing flow.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FlowPoint {
    /// Value of the quantity.
    pub at: f64,
    /// Mean missing rate of the pressure (bar/s).
    pub bar_per_s: f64,
    /// Standard error of the rate (bar/s).
    pub standard_error: f64,
    /// Number of samples.
    pub samples: usize,
}

/// Line in a spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SpectralLine {
    /// Name of the signal.
    pub signal: String,
    /// Condition of the samples: `filling`, `venting`, `both valves shut`, `always`.
    pub condition: String,
    /// Frequency (Hz).
    pub frequency_hz: f64,
    /// Approximate amplitude of the oscillation that would cause it.
    pub amplitude: f64,
    /// Oscillating quantity: `bar of supply pressure`, `of the flow`, `bar/s` of missing flow, `mA` of a coil current.
    pub unit: String,
    /// Probability of as strong a line in noise.
    pub p_value: f64,
}

/// Instant at which the residual jumped.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LostPulse {
    /// Source of the log.
    pub log: String,
    /// Instant (s).
    pub time_s: f64,
    /// Jump of the measured pressure relative to the model (bar).
    pub jump_bar: f64,
    /// The jump in standard deviations of the usual scatter there.
    pub in_noise: f64,
}

/// Cost of an answer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Cost {
    /// Number of simulations of all logs.
    pub simulations: usize,
    /// Logged time that one simulation covers (s).
    pub log_s: f64,
    /// Wall time (s), with several simulations in parallel on all cores.
    pub elapsed_s: f64,
    /// Computing time of one simulation (ms).
    pub per_simulation_ms: f64,
}

impl Cost {
    /// Returns the cost of several searches and estimations on the same logs, which took `elapsed_s` together: simulations are summed, the rest
    /// is that of the last one.
    ///
    /// # Panics
    /// Panics if there is none.
    pub(super) fn sum(of: &[Self], elapsed_s: f64) -> Self {
        let last = of.last().expect("a diagnosis searches at least once");
        Self {
            simulations: of.iter().map(|cost| cost.simulations).sum(),
            elapsed_s,
            ..last.clone()
        }
    }
}
