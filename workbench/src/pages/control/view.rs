//! View of the closed-loop settings and results.

use hil_harness::controller_file::{self, KEYS};
use hil_harness::scenario::BUILT_IN;
use hil_harness::{SettlingTimes, Verdict};
use serde::Serialize;

use super::REQUIREMENT;
use crate::closed_loop::Profile;
use crate::named_plant::NamedPlant;
use crate::refusal::{Problem, Refusal};
use crate::results::Controlled;
use crate::session::Session;

#[derive(Serialize)]
pub(super) struct ControlView {
    scenarios: Vec<ScenarioView>,
    /// Selected scenario.
    scenario: String,
    profile: Profile,
    /// Whether the profile differs from the scenario's.
    is_edited: bool,
    controller: ControllerView,
    seed: u64,
    rigs: u32,
    plants: Vec<PlantView>,
    /// Reasons why the loop cannot be closed on the plant; empty if it can.
    problems: Vec<Problem>,
    has_result: bool,
    has_batch: bool,
}

#[derive(Serialize)]
struct ScenarioView {
    name: &'static str,
    about: &'static str,
}

#[derive(Serialize)]
struct ControllerView {
    name: String,
    toml: String,
    settings: Vec<SettingView>,
}

#[derive(Serialize)]
struct SettingView {
    table: &'static str,
    name: &'static str,
    about: &'static str,
    /// Value as entered; `None` if the file lacks it.
    value: Option<String>,
}

#[derive(Serialize)]
pub(super) struct PlantView {
    role: &'static str,
    name: String,
    effects: Vec<&'static str>,
}

impl From<&NamedPlant> for PlantView {
    fn from(plant: &NamedPlant) -> Self {
        let effects = plant.parameters.effects.iter();
        Self {
            role: plant.role,
            name: plant.name.clone(),
            effects: effects.map(|effect| effect.id()).collect(),
        }
    }
}

impl ControlView {
    pub(super) fn of(session: &Session) -> Result<Self, Refusal> {
        let project = session.project();
        let request = &project.closed_loop;
        let values = controller_file::values(&request.controller.toml);
        let setting = |key: &'static controller_file::Key| SettingView {
            table: key.table,
            name: key.name,
            about: key.about,
            value: values
                .iter()
                .find(|(there, _)| there.path() == key.path())
                .map(|(_, typed)| typed.clone()),
        };
        let (plants, problems) = match NamedPlant::all_of(&project) {
            Ok(plants) => (plants, Vec::new()),
            Err(refusal) => (Vec::new(), refusal.problems),
        };
        Ok(Self {
            scenarios: BUILT_IN
                .iter()
                .map(|built_in| ScenarioView {
                    name: built_in.name,
                    about: built_in.about,
                })
                .collect(),
            scenario: request.scenario.clone(),
            profile: request.profile()?,
            is_edited: request.profile.is_some(),
            controller: ControllerView {
                name: request.controller.name.clone(),
                toml: request.controller.toml.clone(),
                settings: KEYS.iter().map(setting).collect(),
            },
            seed: request.seed,
            rigs: request.rigs,
            plants: plants.iter().map(PlantView::from).collect(),
            problems,
            has_result: session.controlled.get().is_some(),
            has_batch: session.batch.get().is_some(),
        })
    }
}

#[derive(Serialize)]
pub(super) struct ResultView {
    /// Whether a run now would have the same result.
    is_current: bool,
    scenario: String,
    controller: String,
    requirement: RequirementView,
    runs: Vec<RunView>,
}

/// Values of the requirement that are drawn.
#[derive(Serialize)]
pub(super) struct RequirementView {
    t_req_samples: u32,
    p_tol_bar: f64,
}

impl RequirementView {
    pub(super) const THESIS: Self = Self {
        t_req_samples: REQUIREMENT.t_req_samples,
        p_tol_bar: REQUIREMENT.p_tol_bar,
    };
}

#[derive(Serialize)]
struct RunView {
    plant: PlantView,
    /// Verdict, in the JSON form that `retarder control --json` writes.
    verdict: Verdict,
}

impl ResultView {
    pub(super) fn of(session: &Session, controlled: &Controlled) -> Self {
        let runs = controlled.runs.iter().map(|judged| RunView {
            plant: (&judged.plant).into(),
            verdict: judged.verdict.clone(),
        });
        let first = controlled.runs.first();
        Self {
            is_current: controlled.is_of(&session.project()),
            scenario: first.map_or(String::new(), |judged| judged.verdict.source.clone()),
            controller: controlled.request.controller.name.clone(),
            requirement: RequirementView::THESIS,
            runs: runs.collect(),
        }
    }
}

/// Distribution of settling times for the chart.
#[derive(Serialize)]
pub(super) struct DistributionView {
    count: usize,
    never: usize,
    /// Each time (samples) with the share that has settled by then.
    points: Vec<(u32, f64)>,
    median_samples: Option<u32>,
    within_95_samples: Option<u32>,
    /// Share that settles within T_req.
    share_within_limit: Option<f64>,
}

impl From<SettlingTimes> for DistributionView {
    fn from(times: SettlingTimes) -> Self {
        Self {
            count: times.count(),
            never: times.never,
            points: times.distribution(),
            median_samples: times.quantile(0.5),
            within_95_samples: times.quantile(0.95),
            share_within_limit: times.share_within(REQUIREMENT.t_req_samples),
        }
    }
}
