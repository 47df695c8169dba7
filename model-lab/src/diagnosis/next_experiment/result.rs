//! The next experiment, as it stands in its JSON.

use core::fmt::Write as _;

use plant_sim::PlantParameters;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

/// Name and version of the JSON format.
pub const NEXT_EXPERIMENT_SCHEMA: &str = "retarder.next-experiment/1";

/// What the rig may be told to do.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Longest time (s).
    pub duration_s: f64,
    /// Highest chamber pressure (bar gauge), in the model of every rival.
    pub max_bar: f64,
    /// Highest duty cycle (%).
    pub max_duty_pct: f64,
}

impl Limits {
    /// The longest experiment that is planned (s).
    pub const LONGEST_S: f64 = 600.0;
    /// The highest pressure that may be asked for (bar gauge): that of the highest supply that a plant file may give.
    pub const HIGHEST_BAR: f64 = 40.0;
    /// Without a wish, an experiment stays below this share of the supply pressure.
    const OF_SUPPLY: f64 = 0.9;

    /// The highest pressure of an experiment for which nobody gave one (bar gauge).
    pub fn usual_max_bar(plant: &PlantParameters) -> f64 {
        Self::OF_SUPPLY * plant.gas.supply_pressure_bar_gauge
    }
}

/// The experiment that tells rival effects apart, or that shows one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NextExperiment {
    /// Name and version of this format, `retarder.next-experiment/1`.
    pub schema: String,
    /// Sources of the logs that the rivals were fitted to.
    pub logs: Vec<String>,
    /// What is to be told apart.
    pub rivals: Vec<RivalEffect>,
    /// The limits that every manoeuvre keeps.
    pub limits: Limits,
    /// Interval of the commands (s): the sample time of the plant's ECU.
    pub sample_time_s: f64,
    /// Distance of the closest two rivals on the logs, in standard deviations of the noise.
    pub distance_now: f64,
    /// Distance from which on two effects are swapped in less than one of twenty logs.
    pub distinguishable_from: f64,
    /// The answer in words.
    pub sentence: String,
    /// Manoeuvres that could be simulated, the best first.
    pub ranking: Vec<Manoeuvre>,
    /// Duty cycles of the best one.
    pub sequence: Vec<Phase>,
    /// Sensors that the logs do not have and that would tell the rivals apart, the best first.
    pub sensors: Vec<Sensor>,
}

/// An effect to be told from others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RivalEffect {
    /// Its id; null for the plain model.
    pub effect: Option<String>,
    /// Form of its law; null for the plain model.
    pub variant: Option<String>,
}

/// What the rig could do.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Manoeuvre {
    /// Its name.
    pub name: String,
    /// What it shows.
    pub about: String,
    /// Its length (s).
    pub duration_s: f64,
    /// Highest chamber pressure in the model of any rival (bar gauge).
    pub highest_bar: f64,
    /// Predicted distance of the closest two rivals, in standard deviations of the noise, when all that can be refitted
    /// has been.
    pub distance: f64,
}

/// Constant commands for a while.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Phase {
    /// Time at which it begins (s).
    pub time_s: f64,
    /// Duty cycle of the fill valve (%).
    pub duty_fill_pct: f64,
    /// Duty cycle of the vent valve (%).
    pub duty_vent_pct: f64,
}

/// A sensor that is not there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// What it would measure.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// Rms difference of the closest two rivals on the best manoeuvre, in that unit.
    pub difference_rms: f64,
    /// The same over the noise of a usual sensor.
    pub in_noise: f64,
}

impl NextExperiment {
    /// The JSON Schema of a next experiment.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }

    /// Whether the best manoeuvre tells the rivals apart.
    pub fn tells_apart(&self) -> bool {
        self.ranking
            .first()
            .is_some_and(|best| best.distance >= self.distinguishable_from)
    }

    /// The best manoeuvre as a log of commands, one row per ECU sample: `time_s,duty_fill_pct,duty_vent_pct`.
    pub fn csv(&self) -> String {
        let end_s = self.ranking.first().map_or(0.0, |best| best.duration_s);
        rows(&self.sequence, end_s, self.sample_time_s)
    }
}

/// The commands of `sequence` until `end_s` (s), one row per `interval_s` (s).
pub(super) fn rows(sequence: &[Phase], end_s: f64, interval_s: f64) -> String {
    let mut csv = String::from("time_s,duty_fill_pct,duty_vent_pct\n");
    let rows = (end_s / interval_s).round() as usize;
    let decimals = decimals(interval_s);
    let mut phases = sequence.iter().peekable();
    let mut duties = (0.0, 0.0);
    for row in 0..rows {
        let time_s = row as f64 * interval_s;
        let has_begun = |phase: &&Phase| phase.time_s < time_s + 0.5 * interval_s;
        while let Some(phase) = phases.next_if(has_begun) {
            duties = (phase.duty_fill_pct, phase.duty_vent_pct);
        }
        writeln!(csv, "{time_s:.decimals$},{:.1},{:.1}", duties.0, duties.1)
            .expect("a string takes all");
    }
    csv
}

/// Most decimals of a time (s): nanoseconds.
const DECIMALS_MAX: usize = 9;

/// Decimals that every multiple of `interval_s` needs.
fn decimals(interval_s: f64) -> usize {
    let is_enough = |decimals: &usize| {
        let units = interval_s * 10_f64.powi(*decimals as i32);
        (units - units.round()).abs() < 1e-6
    };
    (2..DECIMALS_MAX).find(is_enough).unwrap_or(DECIMALS_MAX)
}
