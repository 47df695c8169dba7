//! Settings of a project's closed loop: profile, controller, seed.

use std::time::Duration;

use hil_harness::reference_profile::Change;
use hil_harness::{ReferenceProfile, Scenario, controller_file};
use plant_sim::PlantParameters;
use serde::{Deserialize, Serialize};

use crate::refusal::Refusal;

/// Largest number of reference changes in a profile of the page.
const CHANGES_MAX: usize = 1000;
/// Longest profile of the page: a hundred runs of it fit into memory.
const LONGEST: Duration = Duration::from_secs(600);
/// Largest number of rigs in a batch of the page.
const RIGS_MAX: u32 = 1000;

/// Settings of the closed loop, stored with the project.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ClosedLoop {
    /// Built-in scenario whose profile is used, or was edited.
    pub(crate) scenario: String,
    /// Profile, if it was edited or read from a file.
    pub(crate) profile: Option<Profile>,
    pub(crate) controller: ControllerFile,
    /// Seed of sensor noise and rigs.
    pub(crate) seed: u64,
    /// Number of rigs in a batch.
    pub(crate) rigs: u32,
}

/// Controller file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ControllerFile {
    pub(crate) name: String,
    pub(crate) toml: String,
}

/// Reference profile as a table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Profile {
    pub(crate) name: String,
    /// Chamber pressure at time 0 (bar gauge).
    pub(crate) start_pressure_bar: f64,
    /// Reference at time 0 (bar gauge).
    pub(crate) start_bar: f64,
    pub(crate) changes: Vec<Step>,
    pub(crate) end_s: f64,
}

/// Change of the reference: a step, or a ramp if it has a duration.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Step {
    pub(crate) time_s: f64,
    pub(crate) to_bar: f64,
    pub(crate) within_s: f64,
}

impl ControllerFile {
    pub(crate) fn recommended() -> Self {
        Self {
            name: "recommended controller".to_owned(),
            toml: controller_file::RECOMMENDED_TOML.to_owned(),
        }
    }

    pub(crate) fn thesis() -> Self {
        Self {
            name: "thesis controller".to_owned(),
            toml: controller_file::THESIS_TOML.to_owned(),
        }
    }
}

impl Default for ClosedLoop {
    fn default() -> Self {
        Self {
            scenario: "figure-6.5".to_owned(),
            profile: None,
            controller: ControllerFile::recommended(),
            seed: 1,
            rigs: 50,
        }
    }
}

impl Profile {
    /// Returns the profile of a scenario.
    pub(crate) fn of(scenario: &Scenario) -> Self {
        let seconds = |ns: u64| ns as f64 / 1e9;
        let step = |change: &Change| Step {
            time_s: seconds(change.time_ns),
            to_bar: change.to_bar,
            within_s: seconds(change.within_ns),
        };
        Self {
            name: scenario.name.clone(),
            start_pressure_bar: scenario.start_pressure_bar,
            start_bar: scenario.reference.start_bar(),
            changes: scenario.reference.changes().iter().map(step).collect(),
            end_s: seconds(scenario.reference.end_ns()),
        }
    }

    fn reference(&self) -> Result<ReferenceProfile, Refusal> {
        if self.changes.len() > CHANGES_MAX {
            return Err(Refusal::value(format!(
                "the profile has {} changes (at most {CHANGES_MAX} on this page); shorten it, or use `retarder control`",
                self.changes.len()
            )));
        }
        let change = |step: &Step| {
            Ok(Change {
                time_ns: nanoseconds("the time of a change", step.time_s)?,
                to_bar: step.to_bar,
                within_ns: nanoseconds("the duration of a ramp", step.within_s)?,
            })
        };
        let changes: Vec<Change> = self
            .changes
            .iter()
            .map(change)
            .collect::<Result<_, Refusal>>()?;
        let end_ns = nanoseconds("the end of a profile", self.end_s)?;
        Ok(ReferenceProfile::from_changes(
            self.start_bar,
            &changes,
            end_ns,
        )?)
    }
}

fn nanoseconds(what: &str, seconds: f64) -> Result<u64, Refusal> {
    let most_s = LONGEST.as_secs();
    if (0.0..=most_s as f64).contains(&seconds) {
        Ok((seconds * 1e9).round() as u64)
    } else {
        Err(Refusal::value(format!(
            "{what} is {seconds} s (0 to {most_s} s on this page); enter a value in this range"
        )))
    }
}

impl ClosedLoop {
    /// Returns the scenario on a plant.
    pub(crate) fn scenario_on(&self, plant: &PlantParameters) -> Result<Scenario, Refusal> {
        let base = self.base()?;
        let mut scenario = match &self.profile {
            None => base,
            Some(profile) => Scenario {
                start_pressure_bar: profile.start_pressure_bar,
                ..Scenario::new(profile.name.clone(), profile.reference()?)
            },
        };
        if !(1..=RIGS_MAX).contains(&self.rigs) {
            return Err(Refusal::value(format!(
                "the batch has {} rigs (1 to {RIGS_MAX} on this page); use `retarder control --rigs` for more",
                self.rigs
            )));
        }
        scenario = scenario
            .on(plant.clone())
            .controlled_by(controller_file::read(
                &self.controller.toml,
                &self.controller.name,
            )?)
            .seeded(self.seed);
        scenario.check()?;
        Ok(scenario)
    }

    fn base(&self) -> Result<Scenario, Refusal> {
        Scenario::built_in(&self.scenario).ok_or_else(|| Refusal::not_found("scenario"))
    }

    /// Returns the profile of the next run.
    pub(crate) fn profile(&self) -> Result<Profile, Refusal> {
        match &self.profile {
            Some(profile) => Ok(profile.clone()),
            None => Ok(Profile::of(&self.base()?)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hil_harness::scenario::BUILT_IN;

    #[test]
    fn the_table_of_a_built_in_profile_runs_as_the_profile_does() {
        let nominal = PlantParameters::nominal();
        for built_in in BUILT_IN {
            let unedited = ClosedLoop {
                scenario: built_in.name.to_owned(),
                ..ClosedLoop::default()
            };
            let edited = ClosedLoop {
                profile: Some(unedited.profile().unwrap()),
                ..unedited.clone()
            };
            let [one, other] =
                [&unedited, &edited].map(|request| request.scenario_on(&nominal).unwrap());
            assert_eq!(
                one.duration_samples, other.duration_samples,
                "{}",
                built_in.name
            );
            assert_eq!(one.start_pressure_bar, other.start_pressure_bar);
            for sample in 0..u64::from(one.duration_samples) {
                let time_ns = sample * 10_000_000;
                assert_eq!(one.reference.at_ns(time_ns), other.reference.at_ns(time_ns));
            }
        }
    }
}
