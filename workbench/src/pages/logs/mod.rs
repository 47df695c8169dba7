//! Page "Logs and plant": open files and their problems.

mod preview;
mod view;

use std::sync::Arc;

use axum::body::Body;
use axum::extract::{Path, Query, State};
use axum::http::StatusCode;
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::{delete, get, post, put};
use axum::{Json, Router};
use recording::PressureReference;
use recording::csv::Mapping;
use serde::{Deserialize, Serialize};

use super::{Shared, blocking, session};
use crate::calculated::{self, Calculated};
use crate::examples;
use crate::log_reader;
use crate::mapping::Form;
use crate::project::{AcceptanceLimits, LOGS_MAX, PlantFile, Project};
use crate::refusal::{Problem, Refusal};
use crate::session::{Session, Sessions};
use view::ProjectView;

/// Longest stored file name (characters).
const NAME_MAX: usize = 120;

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/project", get(project))
        .route("/sessions/{session}/project", delete(begin_anew))
        .route("/sessions/{session}/examples/{example}", post(open_example))
        .route("/sessions/{session}/logs", post(add_log))
        .route("/sessions/{session}/logs/{log}", delete(remove_log))
        .route("/sessions/{session}/logs/{log}/preview", get(preview_log))
        .route("/sessions/{session}/logs/{log}/mapping", put(map_columns))
        .route("/sessions/{session}/logs/{log}/offset", put(shift_log))
        .route("/sessions/{session}/plant", put(set_plant))
        .route("/sessions/{session}/plant", get(plant_file))
        .route("/sessions/{session}/strictness", put(set_strictness))
        .route("/sessions/{session}/calculated", put(set_calculated))
}

/// Returns the project for the page. Logs that are not in memory yet are read.
async fn project(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<ProjectView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || view(&session)).await
}

fn view(session: &Session) -> Result<Json<ProjectView>, Refusal> {
    ProjectView::of(session).map(Json)
}

async fn begin_anew(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<ProjectView>, Refusal> {
    let session = session(&sessions, id)?;
    replace_project(&session, |project| {
        *project = Project {
            mappings: std::mem::take(&mut project.mappings),
            ..Project::default()
        };
        Ok(())
    })?;
    blocking(move || view(&session)).await
}

/// Changes the project and drops all computed results.
fn replace_project(
    session: &Session,
    change: impl FnOnce(&mut Project) -> Result<(), Refusal>,
) -> Result<(), Refusal> {
    let before = session.project().logs;
    session.change(change)?;
    session.forget_comparisons();
    session.report.forget();
    for log in before {
        session.forget_log(log.number);
    }
    Ok(())
}

#[derive(Deserialize)]
struct OpenExample {
    /// Whether open logs stay.
    keep: bool,
}

async fn open_example(
    State(sessions): Shared,
    Path((id, example)): Path<(String, String)>,
    Json(request): Json<OpenExample>,
) -> Result<Json<ProjectView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let files = examples::files(&example).ok_or_else(|| Refusal::not_found("example"))?;
        let logs = files
            .logs
            .iter()
            .map(|log| Ok((log, session.store.keep(log.bytes)?)))
            .collect::<Result<Vec<_>, Refusal>>()?;
        replace_project(&session, |project| {
            if !request.keep {
                project.logs.clear();
            }
            if project.logs.len() + logs.len() > LOGS_MAX {
                return Err(too_many());
            }
            for (log, file) in logs {
                project.add(log.name.to_owned(), file, log.mapping.map(str::to_owned));
            }
            project.plant = files.plant.unwrap_or_else(PlantFile::nominal);
            project.strictness = AcceptanceLimits {
                tolerances: files.tolerances,
                ..AcceptanceLimits::default()
            };
            Ok(())
        })?;
        view(&session)
    })
    .await
}

#[derive(Deserialize)]
struct Named {
    name: String,
}

/// Returns a file name for display: without folders, printable, shortened.
pub(super) fn shown_name(name: &str) -> String {
    let last = name.rsplit(['/', '\\']).next().unwrap_or(name);
    let printable = last.chars().filter(|character| !character.is_control());
    let short: String = printable.take(NAME_MAX).collect();
    if short.is_empty() {
        "log".to_owned()
    } else {
        short
    }
}

fn too_many() -> Refusal {
    Refusal::new(
        StatusCode::CONFLICT,
        "E-WEB-TOO-MANY",
        format!("a project has at most {LOGS_MAX} logs; remove one first"),
    )
}

#[derive(Serialize)]
struct Added {
    /// Number of the new log.
    log: u32,
    project: ProjectView,
}

async fn add_log(
    State(sessions): Shared,
    Path(id): Path<String>,
    Query(file): Query<Named>,
    body: Body,
) -> Result<Json<Added>, Refusal> {
    let session = session(&sessions, id)?;
    if session.project().logs.len() >= LOGS_MAX {
        return Err(too_many());
    }
    let file_hash = session.store.receive(body).await?;
    blocking(move || {
        let name = shown_name(&file.name);
        let path = session.store.log_path(&file_hash);
        let mapping = remembered(&session, &name, &path);
        let log = session.change(|project| {
            if project.logs.len() >= LOGS_MAX {
                return Err(too_many());
            }
            Ok(project.add(name, file_hash, mapping))
        })?;
        let project = ProjectView::of(&session)?;
        Ok(Json(Added { log, project }))
    })
    .await
}

/// Returns the mapping of an earlier log with the same header, if this one needs a mapping.
fn remembered(session: &Session, name: &str, path: &std::path::Path) -> Option<String> {
    let project = session.project();
    if project.mappings.is_empty() || log_reader::read(name, path, None).is_ok() {
        return None;
    }
    let head = preview::head_key(path)?;
    project.mappings.get(&head).cloned()
}

async fn remove_log(
    State(sessions): Shared,
    Path((id, number)): Path<(String, u32)>,
) -> Result<Json<ProjectView>, Refusal> {
    let session = session(&sessions, id)?;
    session.change(|project| {
        project.log(number)?;
        project.logs.retain(|log| log.number != number);
        Ok(())
    })?;
    session.cancel();
    session.forget_log(number);
    blocking(move || view(&session)).await
}

#[derive(Deserialize)]
struct Asked {
    /// Reference of pressures whose unit states none.
    pressure: Option<Reference>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Reference {
    Gauge,
    Absolute,
}

impl From<Reference> for PressureReference {
    fn from(reference: Reference) -> Self {
        match reference {
            Reference::Gauge => Self::Gauge,
            Reference::Absolute => Self::Absolute,
        }
    }
}

async fn preview_log(
    State(sessions): Shared,
    Path((id, number)): Path<(String, u32)>,
    Query(asked): Query<Asked>,
) -> Result<Json<preview::Preview>, Refusal> {
    let session = session(&sessions, id)?;
    let reference = asked.pressure.map(PressureReference::from);
    blocking(move || preview::Preview::of(&session, number, reference).map(Json)).await
}

async fn map_columns(
    State(sessions): Shared,
    Path((id, number)): Path<(String, u32)>,
    Json(form): Json<Form>,
) -> Result<Json<ProjectView>, Refusal> {
    let session = session(&sessions, id)?;
    blocking(move || {
        let mapping = form.toml()?;
        if let Some(mapping) = &mapping {
            Mapping::parse("mapping", mapping).map_err(|error| Problem::from(&error))?;
        }
        let entry = session.project().log(number)?.clone();
        let head = preview::head_key(&session.store.log_path(&entry.file));
        session.change(|project| {
            project.log_mut(number)?.mapping.clone_from(&mapping);
            if let (Some(head), Some(mapping)) = (head, mapping) {
                project.mappings.insert(head, mapping);
            }
            Ok(())
        })?;
        session.cancel();
        session.forget_log(number);
        view(&session)
    })
    .await
}

#[derive(Deserialize)]
struct Offset {
    offset_s: f64,
}

async fn shift_log(
    State(sessions): Shared,
    Path((id, number)): Path<(String, u32)>,
    Json(Offset { offset_s }): Json<Offset>,
) -> Result<(), Refusal> {
    let session = session(&sessions, id)?;
    // One day: logs with a larger offset are unrelated.
    if !(-86_400.0..=86_400.0).contains(&offset_s) {
        return Err(Refusal::value(format!(
            "the time offset is {offset_s} s (-86400 s to 86400 s); enter a value in this range"
        )));
    }
    session.change(|project| {
        project.log_mut(number)?.offset_s = offset_s;
        Ok(())
    })
}

#[derive(Deserialize)]
struct Plant {
    name: String,
    /// Plant file; `None` takes the thesis model.
    toml: Option<String>,
}

async fn set_plant(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(plant): Json<Plant>,
) -> Result<Json<ProjectView>, Refusal> {
    let session = session(&sessions, id)?;
    let plant = match plant.toml {
        Some(toml) => PlantFile {
            name: shown_name(&plant.name),
            toml,
        },
        None => PlantFile::nominal(),
    };
    plant.parameters()?;
    session.change(|project| {
        project.plant = plant;
        Ok(())
    })?;
    session.forget_comparisons();
    blocking(move || view(&session)).await
}

async fn plant_file(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Refusal> {
    let plant = session(&sessions, id)?.project().plant;
    let headers = [
        (CONTENT_TYPE, "text/plain; charset=utf-8"),
        (CONTENT_DISPOSITION, "attachment; filename=\"plant.toml\""),
    ];
    Ok((headers, plant.toml))
}

async fn set_strictness(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(strictness): Json<AcceptanceLimits>,
) -> Result<(), Refusal> {
    let session = session(&sessions, id)?;
    strictness.check()?;
    let is_judged_anew = session.change(|project| {
        let is_judged_anew = strictness.judges_otherwise(&project.strictness);
        project.strictness = strictness;
        Ok(is_judged_anew)
    })?;
    if is_judged_anew {
        session.forget_comparisons();
    }
    Ok(())
}

/// Sets the calculated channels of all logs, and drops results that were computed with others.
async fn set_calculated(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(channels): Json<Vec<Calculated>>,
) -> Result<Json<ProjectView>, Refusal> {
    let session = session(&sessions, id)?;
    calculated::check(&channels)?;
    blocking(move || {
        replace_project(&session, |project| {
            project.calculated = channels;
            Ok(())
        })?;
        view(&session)
    })
    .await
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_name_is_shown_without_folders_and_control_characters() {
        for (name, shown) in [
            ("a.csv", "a.csv"),
            ("../../etc/passwd", "passwd"),
            ("C:\\temp\\b.csv", "b.csv"),
            ("x\u{1b}[31m\n.csv", "x[31m.csv"),
            ("", "log"),
            ("..\u{0}/", "log"),
        ] {
            assert_eq!(shown_name(name), shown);
        }
        assert_eq!(shown_name(&"ä".repeat(500)).chars().count(), NAME_MAX);
    }
}
