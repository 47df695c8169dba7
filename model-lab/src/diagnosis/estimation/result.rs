//! Result of an estimation, as in its JSON.

use std::collections::BTreeMap;

use plant_sim::PlantParameters;
use plant_sim::parameters::{Knowledge, ParameterSpec};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::diagnosis::fit::trial::Trial;
use crate::diagnosis::refine::rounded;
use crate::diagnosis::result::{Cost, FoundClock, FoundStart, Step};
use crate::diagnosis::verdict::LITTLE_FLOORS;
use crate::result::{LogDefects, NotCompared};

/// Name and version of the JSON format.
pub const ESTIMATION_SCHEMA: &str = "retarder.estimation/1";

/// Plant with estimated parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimatedPlant {
    /// The plant as given with the estimated values, each with its provenance.
    pub plant: PlantParameters,
    /// Result of the estimation.
    pub estimation: Estimation,
}

/// Estimated ordinary parameters, and the decrease of the error.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Estimation {
    /// Name and version of this format, `retarder.estimation/1`.
    pub schema: String,
    /// Sources of the training logs.
    pub logs: Vec<String>,
    /// Sources of the validation logs; empty where validation uses held-out blocks of the training logs.
    pub check: Vec<String>,
    /// From the source of a log to its signals that are excluded from the fit, with the reasons.
    pub not_compared: BTreeMap<String, Vec<NotCompared>>,
    /// From the source of a log to its gaps and missing cells; absent where no log has any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub defects: BTreeMap<String, LogDefects>,
    /// Validation data, in words.
    pub held_out: String,
    /// The result in words.
    pub sentence: String,
    /// Whether the estimated model leaves no more than the noise.
    pub is_adequate: bool,
    /// Whether the estimated model leaves no more than the noise on the training logs. Where these are explained and the validation
    /// data are not, the training logs do not determine everything that the others need.
    pub explains_fitted_logs: bool,
    /// Whether the fit has converged: a further step from the estimated values gains little.
    pub is_converged: bool,
    /// Error steps, beginning with the plant as given.
    pub steps: Vec<Step>,
    /// Estimated parameters.
    pub parameters: Vec<EstimatedParameter>,
    /// Correlations of the errors of the parameters, -1 to 1, in the order of `parameters`: one row for each. They are those that the noise
    /// and the stated ranges leave. Empty where the covariance cannot be computed.
    #[serde(default)]
    pub correlations: Vec<Vec<f64>>,
    /// Clocks of the loggers, where they differ from that of the ECU.
    pub clocks: Vec<FoundClock>,
    /// Temperatures of the gas where logs begin with a filled chamber.
    pub starts: Vec<FoundStart>,
    /// Cost of the answer.
    pub cost: Cost,
}

impl Estimation {
    /// Returns the JSON Schema of an estimation.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }
}

/// Estimated parameter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct EstimatedParameter {
    /// Name in the plant file.
    pub name: String,
    /// Unit; empty for a pure number.
    pub unit: String,
    /// Value of the plant file.
    pub before: f64,
    /// Estimated value.
    pub after: f64,
    /// Lower end of the 95 % interval.
    pub low: f64,
    /// Upper end of the 95 % interval.
    pub high: f64,
    /// Least and largest value between which the estimation moved it; null where one of them is infinite.
    #[serde(default)]
    pub within: Option<[f64; 2]>,
    /// Determination of the parameter by the logs.
    pub determination: Determination,
    /// Excitation or measurement that determines it; null if the logs do.
    pub determined_by: Option<String>,
    /// Whether the whole interval is outside the usual tolerance of the part around the value of the plant file.
    pub is_beyond_usual: bool,
}

/// Determination of a parameter by the logs.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Determination {
    /// The interval is a small fraction of the width before the logs.
    Determined,
    /// Only a combination with other parameters is determined.
    OnlyTogetherWith {
        /// Names of the others, the closest first.
        parameters: Vec<String>,
    },
    /// The logs hardly depend on the parameter.
    NotExcited,
    /// The parameter ended at the limit of the plant file.
    AtLimit,
}

/// Returns the result in words.
pub(super) fn sentence(
    left: Left,
    is_converged: bool,
    parameters: &[EstimatedParameter],
) -> String {
    let determined = |one: &&EstimatedParameter| one.determination == Determination::Determined;
    let count = parameters.iter().filter(determined).count();
    let are = if count == 1 { "is" } else { "are" };
    let known = match parameters.len() {
        0 => "nothing was estimated, since every parameter is fixed".to_owned(),
        all => format!("{count} of {all} parameters {are} determined"),
    };
    match left {
        Left::Noise => format!("the estimated model leaves no more than the noise; {known}"),
        Left::MoreOnCheck => format!(
            "the estimated model explains the fitted logs and not the validation logs, which need values that the fitted logs leave open, or something changed between them: give all of them with --log; {known}"
        ),
        Left::More if !is_converged => {
            "the fit has not converged: the estimated model leaves more than the noise, and other values would leave less; estimate again from the written file, or state narrower ranges"
                .to_owned()
        }
        Left::Little(floors) => format!(
            "the estimated model leaves {floors:.2} times the noise: too little to say whether physics is missing; {known}"
        ),
        Left::More => format!(
            "the estimated model leaves more than the noise, so physics is missing and its error biases the estimates; {known}"
        ),
    }
}

/// Errors of an estimated model relative to the noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Left {
    Noise,
    /// More than the noise, but only on validation data.
    MoreOnCheck,
    /// Slightly more than the noise: its largest error over the noise floor, at most [`LITTLE_FLOORS`].
    Little(f64),
    More,
}

impl Left {
    pub(super) fn of(trial: &Trial, has_check: bool) -> Self {
        match (trial.fitted.is_material(), trial.checked.is_material()) {
            (false, false) => Self::Noise,
            (false, true) if has_check => Self::MoreOnCheck,
            _ => {
                let floors = trial.fitted.most_floors().max(trial.checked.most_floors());
                match floors <= LITTLE_FLOORS {
                    true => Self::Little(floors),
                    false => Self::More,
                }
            }
        }
    }
}

/// Least tolerance that a refined file states (%), because another day and another log give other values.
const TOLERANCE_MIN_PCT: f64 = 0.5;
/// Number of significant digits of a tolerance in a file.
const TOLERANCE_DIGITS: usize = 2;

/// States in `plant` the tolerance of each estimated value, for the next fit and for readers. A model that leaves more than the noise
/// determines no tolerances: its parameters keep the range that they had in the plant `before`, within which a diagnosis may move them.
pub(super) fn state_knowledge(
    plant: &mut PlantParameters,
    before: &PlantParameters,
    estimation: &Estimation,
) {
    for parameter in &estimation.parameters {
        let name = &parameter.name;
        let half = (parameter.high - parameter.after).max(parameter.after - parameter.low);
        if let Some(origin) = plant.provenance.get_mut(name) {
            *origin += &format!("; 95 %: {:.4e} to {:.4e}", parameter.low, parameter.high);
        }
        // The size of an effect stays free unless the plant file states otherwise: leaks and friction change from day to day.
        let is_kept = |spec: &&ParameterSpec| {
            spec.effect_id().is_none() || before.knowledge.contains_key(name)
        };
        let Some(spec) = plant.any_spec(name).filter(is_kept) else {
            continue;
        };
        let is_at_limit = parameter.determination == Determination::AtLimit;
        if !estimation.is_adequate || is_at_limit || parameter.after == 0.0 {
            if let Some(&stated) = before.knowledge.get(name) {
                let (least, most) = stated.bounds(spec, parameter.before);
                let value = plant.get(name).unwrap_or(parameter.after);
                let range = Knowledge::Range(rounded(least).min(value), rounded(most).max(value));
                plant.knowledge.insert(name.clone(), range);
            }
            continue;
        }
        let percent = (100.0 * half / parameter.after.abs()).max(TOLERANCE_MIN_PCT);
        if let Ok(percent) = format!("{percent:.*e}", TOLERANCE_DIGITS - 1).parse() {
            plant
                .knowledge
                .insert(name.clone(), Knowledge::TolerancePct(percent));
        }
    }
}
