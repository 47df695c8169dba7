//! Next experiment, as in its JSON.

use core::fmt::Write as _;

use plant_sim::PlantParameters;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

/// Name and version of the JSON format.
pub const NEXT_EXPERIMENT_SCHEMA: &str = "retarder.next-experiment/2";

/// Limits of the commands to the rig.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Limits {
    /// Longest duration (s).
    pub duration_s: f64,
    /// Highest chamber pressure (bar gauge), in the model of every rival.
    pub max_bar: f64,
    /// Highest duty cycle (%).
    pub max_duty_pct: f64,
}

impl Limits {
    /// Longest experiment that is planned (s).
    pub const LONGEST_S: f64 = 600.0;
    /// Highest pressure that may be requested (bar gauge): that of the highest supply that a plant file may state.
    pub const HIGHEST_BAR: f64 = 40.0;
    /// Largest share of the supply pressure in an experiment without a requested limit.
    const OF_SUPPLY: f64 = 0.9;

    /// Returns the highest pressure of an experiment without a requested limit (bar gauge).
    pub fn usual_max_bar(plant: &PlantParameters) -> f64 {
        Self::OF_SUPPLY * plant.gas.supply_pressure_bar_gauge
    }
}

/// Experiment that distinguishes rival effects, or that shows one.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NextExperiment {
    /// Name and version of this format, `retarder.next-experiment/2`.
    pub schema: String,
    /// Sources of the logs to which the rivals were fitted.
    pub logs: Vec<String>,
    /// Effects to be distinguished.
    pub rivals: Vec<RivalEffect>,
    /// Limits that every excitation satisfies.
    pub limits: Limits,
    /// Interval of the commands (s): the sample time of the plant's ECU.
    pub sample_time_s: f64,
    /// Distance of the closest two rivals on the logs, in standard deviations of the noise.
    pub distance_now: f64,
    /// Distance from which on two effects are confused in less than one of twenty logs.
    pub distinguishable_from: f64,
    /// The answer in words.
    pub sentence: String,
    /// Excitations that could be simulated, the best first.
    pub ranking: Vec<TestSignal>,
    /// Duty cycles of the best excitation.
    pub sequence: Vec<Phase>,
    /// Sensors that the logs lack and that would distinguish the rivals, the best first.
    pub sensors: Vec<Sensor>,
}

/// Effect to be distinguished from others.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RivalEffect {
    /// Id of the effect; null for the plain model.
    pub effect: Option<String>,
    /// Form of its law; null for the plain model.
    pub variant: Option<String>,
}

/// Excitation that the rig can run.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TestSignal {
    /// Name of the excitation.
    pub name: String,
    /// Effects that it shows.
    pub about: String,
    /// Duration (s).
    pub duration_s: f64,
    /// Highest chamber pressure in the model of any rival (bar gauge).
    pub highest_bar: f64,
    /// Predicted distance of the closest two rivals, in standard deviations of the noise, after all free parameters
    /// were refitted.
    pub distance: f64,
}

/// Interval of constant commands.
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

/// Sensor that the rig lacks.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Sensor {
    /// Measured quantity.
    pub quantity: String,
    /// Unit of the quantity.
    pub unit: String,
    /// Rms difference of the closest two rivals with the best excitation, in that unit.
    pub difference_rms: f64,
    /// The difference over the noise of a usual sensor.
    pub in_noise: f64,
}

impl NextExperiment {
    /// Returns the JSON Schema of a next experiment.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }

    /// Returns whether the best excitation distinguishes the rivals.
    pub fn distinguishes(&self) -> bool {
        self.ranking
            .first()
            .is_some_and(|best| best.distance >= self.distinguishable_from)
    }

    /// Returns the best excitation as a log of commands, one row per ECU sample: `time_s,duty_fill_pct,duty_vent_pct`.
    pub fn csv(&self) -> String {
        let end_s = self.ranking.first().map_or(0.0, |best| best.duration_s);
        rows(&self.sequence, end_s, self.sample_time_s)
    }
}

/// Returns the commands of `sequence` until `end_s` (s), one row per `interval_s` (s).
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

/// Largest number of decimals of a time (s): nanoseconds.
const DECIMALS_MAX: usize = 9;

/// Returns the number of decimals that every multiple of `interval_s` needs.
fn decimals(interval_s: f64) -> usize {
    let is_enough = |decimals: &usize| {
        let units = interval_s * 10_f64.powi(*decimals as i32);
        (units - units.round()).abs() < 1e-6
    };
    (2..DECIMALS_MAX).find(is_enough).unwrap_or(DECIMALS_MAX)
}
