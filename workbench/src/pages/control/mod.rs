//! Page "Control": closed loop on the plant, its requirements, and its robustness on scattered rigs.

mod batch;
mod traces;
mod view;

use std::sync::Arc;

use axum::extract::{Path, Query, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::{get, post, put};
use axum::{Json, Router};
use core::ops::ControlFlow;
use hil_harness::controller_file::{self, KEYS};
use hil_harness::{InProcess, ReferenceProfile, Requirement, Run, RunError, Scenario, run_watched};
use recording::LogOptions;
use recording::csv::Decimals;
use serde::Deserialize;

use super::{Begun, Shared, begin_job, blocking, session};
use crate::closed_loop::{ClosedLoop, ControllerFile, Profile};
use crate::job::Span;
use crate::named_plant::NamedPlant;
use crate::refusal::{Problem, Refusal};
use crate::results::{Controlled, Judged};
use crate::session::{Session, Sessions};

/// Requirement of the verdict, as in `retarder control`.
pub(super) const REQUIREMENT: Requirement = Requirement::THESIS;
/// Comment of a setting that was entered here.
const TYPED: &str = "typed in the workbench";

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/control", get(show))
        .route("/sessions/{session}/control", put(request))
        .route("/sessions/{session}/control/controller", put(settings))
        .route("/sessions/{session}/control/controller", get(controller))
        .route("/sessions/{session}/control/reference", put(reference))
        .route("/sessions/{session}/control/run", post(begin))
        .route("/sessions/{session}/control/result", get(result))
        .route("/sessions/{session}/control/traces", get(show_traces))
        .route("/sessions/{session}/control/csv", get(export_csv))
        .route("/sessions/{session}/control/batch", post(batch::begin))
        .route("/sessions/{session}/control/batch", get(batch::result))
}

async fn show(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<view::ControlView>, Refusal> {
    let session = session(&sessions, id)?;
    view::ControlView::of(&session).map(Json)
}

/// Choices other than the settings of the controller.
#[derive(Deserialize)]
struct Request {
    scenario: String,
    /// Reference profile; `None` takes that of the scenario.
    profile: Option<Profile>,
    seed: u64,
    rigs: u32,
}

async fn request(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(request): Json<Request>,
) -> Result<Json<view::ControlView>, Refusal> {
    let session = session(&sessions, id)?;
    change(&session, |closed_loop| {
        *closed_loop = ClosedLoop {
            scenario: request.scenario,
            profile: request.profile,
            seed: request.seed,
            rigs: request.rigs,
            controller: closed_loop.controller.clone(),
        };
        Ok(())
    })
}

/// Stores settings that can be run.
fn change(
    session: &Session,
    change: impl FnOnce(&mut ClosedLoop) -> Result<(), Refusal>,
) -> Result<Json<view::ControlView>, Refusal> {
    session.change(|project| {
        change(&mut project.closed_loop)?;
        for plant in NamedPlant::all_of(project)? {
            project.closed_loop.scenario_on(&plant.parameters)?;
        }
        Ok(())
    })?;
    view::ControlView::of(session).map(Json)
}

/// Change of the controller.
#[derive(Deserialize)]
#[serde(tag = "from", rename_all = "snake_case")]
enum Settings {
    /// Recommended controller.
    Recommended,
    /// Controller of the thesis.
    Thesis,
    /// Controller file.
    File { name: String, toml: String },
    /// Current controller with other values, by `table.key`; `None` removes a key.
    Values {
        values: Vec<(String, Option<String>)>,
    },
}

async fn settings(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(settings): Json<Settings>,
) -> Result<Json<view::ControlView>, Refusal> {
    let session = session(&sessions, id)?;
    change(&session, |closed_loop| {
        closed_loop.controller = match settings {
            Settings::Recommended => ControllerFile::recommended(),
            Settings::Thesis => ControllerFile::thesis(),
            Settings::File { name, toml } => ControllerFile {
                name: super::logs::shown_name(&name),
                toml,
            },
            Settings::Values { values } => with_values(&closed_loop.controller, &values)?,
        };
        Ok(())
    })
}

fn with_values(
    controller: &ControllerFile,
    values: &[(String, Option<String>)],
) -> Result<ControllerFile, Refusal> {
    let change = |(path, typed): &(String, Option<String>)| {
        let key = KEYS.iter().find(|key| key.path() == *path);
        let key = key.ok_or_else(|| Refusal::not_found("setting of a controller"))?;
        Ok((key, typed.clone()))
    };
    let changes: Vec<_> = values.iter().map(change).collect::<Result<_, Refusal>>()?;
    let changes: Vec<_> = changes
        .iter()
        .map(|(key, typed)| (*key, typed.as_deref()))
        .collect();
    let changed = ", changed";
    let name = controller.name.strip_suffix(changed);
    Ok(ControllerFile {
        name: format!("{}{changed}", name.unwrap_or(&controller.name)),
        toml: controller_file::with_values(&controller.toml, &changes, TYPED),
    })
}

async fn controller(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Refusal> {
    let toml = session(&sessions, id)?
        .project()
        .closed_loop
        .controller
        .toml;
    let headers = [
        (CONTENT_TYPE, "text/plain; charset=utf-8"),
        (
            CONTENT_DISPOSITION,
            "attachment; filename=\"controller.toml\"",
        ),
    ];
    Ok((headers, toml))
}

#[derive(Deserialize)]
struct Reference {
    name: String,
    /// File, CSV with the columns `time_s` and `p_ref_bar_gauge`.
    csv: String,
}

/// Reads a profile from a file, as `retarder control --reference` does.
async fn reference(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(file): Json<Reference>,
) -> Result<Json<view::ControlView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let name = super::logs::shown_name(&file.name);
        let read = recording::read_log(&name, file.csv.as_bytes(), &LogOptions::default());
        let recording = read.map_err(|error| Problem::from(&error))?;
        let profile = ReferenceProfile::from_recording(&recording)?;
        let profile = Profile::of(&Scenario::new(name, profile));
        change(&session, |closed_loop| {
            closed_loop.profile = Some(profile);
            Ok(())
        })
    })
    .await
}

async fn begin(State(sessions): Shared, Path(id): Path<String>) -> Result<Json<Begun>, Refusal> {
    let session = session(&sessions, id)?;
    let project = session.project();
    let plants = NamedPlant::all_of(&project)?;
    Ok(begin_job(&session, Span::Page, move |session, job| {
        let request = project.closed_loop;
        let count = plants.len();
        let mut runs = Vec::with_capacity(count);
        for (index, plant) in plants.into_iter().enumerate() {
            let scenario = request.scenario_on(&plant.parameters)?;
            let goes_on = |share: f64| job.goes_on((index as f64 + share) / count as f64);
            let Some(run) = run(&scenario, &goes_on)? else {
                return Ok(());
            };
            let verdict = run.verdict(&REQUIREMENT)?;
            runs.push(Judged {
                plant,
                run,
                verdict,
            });
        }
        if !job.is_cancelled() {
            session.controlled.keep(Controlled { request, runs });
        }
        Ok(())
    }))
}

/// Runs the loop as `retarder control --plant` does with this plant; `None` if it was stopped.
fn run(scenario: &Scenario, goes_on: &dyn Fn(f64) -> bool) -> Result<Option<Run>, Refusal> {
    let samples = f64::from(scenario.duration_samples);
    let sample_s = scenario.plant.ecu.sample_time_s;
    let mut watch = |moment: hil_harness::run::Moment<'_>| {
        let share = (moment.time_s / sample_s / samples).clamp(0.0, 1.0);
        if goes_on(share) {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        }
    };
    match run_watched(scenario, &mut InProcess::new(), &mut watch) {
        Ok(run) => Ok(Some(run)),
        Err(RunError::Stopped { .. }) => Ok(None),
        Err(error) => Err(error.into()),
    }
}

fn controlled(session: &Session) -> Result<Arc<Controlled>, Refusal> {
    session
        .controlled
        .get()
        .ok_or_else(|| Refusal::too_early("the loop was not run yet; run it first"))
}

async fn result(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<view::ResultView>, Refusal> {
    let session = session(&sessions, id)?;
    let controlled = controlled(&session)?;
    Ok(Json(view::ResultView::of(&session, &controlled)))
}

async fn show_traces(
    State(sessions): Shared,
    Path(id): Path<String>,
    Query(view): Query<traces::View>,
) -> Result<Json<traces::Traces>, Refusal> {
    let controlled = controlled(session(&sessions, id)?.as_ref())?;
    blocking(move || traces::traces(&controlled, &view).map(Json)).await
}

#[derive(Deserialize)]
struct Which {
    /// Index of the run.
    run: usize,
}

/// Exports the recording of a run, as `retarder control --out` writes it.
async fn export_csv(
    State(sessions): Shared,
    Path(id): Path<String>,
    Query(which): Query<Which>,
) -> Result<impl IntoResponse, Refusal> {
    let controlled = controlled(session(&sessions, id)?.as_ref())?;
    let csv = blocking(move || {
        let judged = controlled.runs.get(which.run);
        let judged = judged.ok_or_else(|| Refusal::not_found("run"))?;
        let recording = &judged.run.recording;
        let (base, _) = recording
            .time_bases()
            .next()
            .ok_or_else(|| Refusal::not_found("time base"))?;
        recording::csv::write(Vec::new(), recording, base, &Decimals::shortest())
            .map_err(|error| Refusal::value(error.to_string()))
    })
    .await?;
    let headers = [
        (CONTENT_TYPE, "text/csv; charset=utf-8"),
        // The page names the file by scenario and plant.
        (CONTENT_DISPOSITION, "attachment"),
    ];
    Ok((headers, csv))
}
