//! Page "Report": the whole session in one HTML file.

mod findings;

use std::sync::{Arc, LazyLock};

use axum::extract::{Path, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_SECURITY_POLICY, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::{get, post};
use axum::{Json, Router};
use model_lab::compare_watched;
use report::{Contents, ControlPart, Input, LogPart, ModelPart, Origin, PlantPart};
use serde::Serialize;
use sha2::{Digest as _, Sha256};

use super::control::REQUIREMENT;
use super::{Begun, Shared, begin_job, session};
use crate::job::{Job, Span};
use crate::project::Project;
use crate::refusal::Refusal;
use crate::results::{Batch, Compared, Controlled};
use crate::session::{OpenLog, Session, Sessions};
use crate::token::{base64, hex};
use findings::Findings;

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/report", post(begin))
        .route("/sessions/{session}/report", get(state))
        .route("/sessions/{session}/report/preview", get(preview))
        .route("/sessions/{session}/report/file", get(file))
}

/// The report may show itself with its one style, in a frame of this page. It may load and run nothing, and has no
/// origin.
static POLICY: LazyLock<String> = LazyLock::new(|| {
    let style = base64(&Sha256::digest(report::style()));
    format!(
        "default-src 'none'; style-src 'sha256-{style}'; base-uri 'none'; form-action 'none'; frame-ancestors 'self'; \
         sandbox; require-trusted-types-for 'script'"
    )
});

/// Contents available for a report.
#[derive(Serialize)]
struct ReportState {
    logs: usize,
    unreadable: usize,
    compared: usize,
    has_diagnosis: bool,
    steps: usize,
    /// Runs of the loop on the current plant.
    runs: usize,
    has_report: bool,
}

async fn state(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<ReportState>, Refusal> {
    let session = session(&sessions, id)?;
    super::blocking(move || {
        let logs = logs(&session)?;
        let findings = Findings::of(&session);
        Ok(Json(ReportState {
            logs: logs.len(),
            unreadable: logs.iter().filter(|log| log.log.is_err()).count(),
            compared: logs
                .iter()
                .filter(|log| session.comparison(log.number).is_some())
                .count(),
            has_diagnosis: findings.diagnosis.is_some(),
            steps: findings.steps.len(),
            runs: runs_of_now(&session).map_or(0, |controlled| controlled.runs.len()),
            has_report: session.report.get().is_some(),
        }))
    })
    .await
}

/// Begins to write the report; compares logs that were not compared with the plant yet.
async fn begin(State(sessions): Shared, Path(id): Path<String>) -> Result<Json<Begun>, Refusal> {
    let session = session(&sessions, id)?;
    Ok(begin_job(&session, Span::Page, work))
}

fn work(session: &Session, job: &Job) -> Result<(), Refusal> {
    let project = session.project();
    let logs = logs(session)?;
    for (index, log) in logs.iter().enumerate() {
        let goes_on = |share: f64| job.goes_on((index as f64 + share) / logs.len() as f64);
        compare(session, &project, log, &goes_on)?;
        if !goes_on(1.0) {
            return Ok(());
        }
    }
    let html = html(session, &project, &logs)?;
    if !job.is_cancelled() {
        session.report.keep(html);
    }
    Ok(())
}

/// Compares a log that was not compared yet. A log that cannot be read or compared is in the report with the reason.
fn compare(
    session: &Session,
    project: &Project,
    log: &Log,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<(), Refusal> {
    let Ok(read) = &*log.log else { return Ok(()) };
    if session.comparison(log.number).is_some() {
        return Ok(());
    }
    let parameters = project.plant.parameters()?;
    let options = project.strictness.options_for(&read.recording);
    if let Ok(comparison) = compare_watched(&parameters, &read.recording, &options, goes_on) {
        session.keep_comparison(log.number, Compared::new(comparison, parameters));
    }
    Ok(())
}

/// Log of the project.
struct Log {
    number: u32,
    name: String,
    log: Arc<OpenLog>,
}

fn logs(session: &Session) -> Result<Vec<Log>, Refusal> {
    let entries = session.project().logs;
    let log = |entry: &crate::project::LogEntry| {
        Ok(Log {
            number: entry.number,
            name: entry.name.clone(),
            log: session.log(entry.number)?,
        })
    };
    entries.iter().map(log).collect()
}

/// Returns the runs of the loop, if they are those of the current plant.
fn runs_of_now(session: &Session) -> Option<Arc<Controlled>> {
    session
        .controlled
        .get()
        .filter(|controlled| controlled.is_of(&session.project()))
}

fn html(session: &Session, project: &Project, logs: &[Log]) -> Result<String, Refusal> {
    let parameters = project.plant.parameters()?;
    let problems: Vec<Vec<String>> = logs.iter().map(|log| problems(session, log)).collect();
    let log_parts: Vec<LogPart<'_>> = logs
        .iter()
        .zip(&problems)
        .map(|(log, problems)| LogPart {
            name: &log.name,
            recording: log.log.as_ref().as_ref().ok().map(|log| &log.recording),
            problems,
        })
        .collect();
    let compared: Vec<_> = logs
        .iter()
        .filter_map(|log| {
            Some((
                log.log.as_ref().as_ref().ok()?,
                session.comparison(log.number)?,
            ))
        })
        .collect();
    let findings = Findings::of(session);
    let models: Vec<ModelPart<'_>> = compared
        .iter()
        .map(|(log, compared)| ModelPart {
            log: &log.recording,
            comparison: &compared.comparison,
            is_explained: findings.is_explained,
        })
        .collect();
    let controlled = runs_of_now(session);
    let batch = session.batch.get().filter(|batch| batch.is_of(project));
    let control = control(controlled.as_deref(), batch.as_deref());
    let recordings: Vec<_> = compared.iter().map(|(log, _)| &log.recording).collect();
    let runs = findings.before_and_after(&recordings);
    let names: Vec<&str> = logs.iter().map(|log| log.name.as_str()).collect();
    let inputs = inputs(project, logs);
    Ok(report::html(&Contents {
        title: &title(&project.plant.name, &names),
        logs: &log_parts,
        plant: Some(PlantPart {
            name: &project.plant.name,
            parameters: &parameters,
        }),
        models: &models,
        diagnosis: findings.diagnosis_part(runs.as_ref()),
        history: findings.history_part(),
        control: &control,
        origin: Origin {
            command_line: "",
            inputs: &inputs,
            versions: &[("workbench".to_owned(), env!("CARGO_PKG_VERSION").to_owned())],
        },
        ..Contents::default()
    }))
}

fn title(plant: &str, logs: &[&str]) -> String {
    match logs {
        [] => plant.to_owned(),
        [first, rest @ ..] if rest.len() > 2 => {
            format!("{plant} and {first} with {} more logs", rest.len())
        }
        logs => format!("{plant} and {}", logs.join(", ")),
    }
}

/// Returns the reasons why a log was not read, or not compared.
fn problems(session: &Session, log: &Log) -> Vec<String> {
    match &*log.log {
        Err(problem) => {
            let line = problem.line.map(|line| format!("line {line}: "));
            vec![format!("{}{}", line.unwrap_or_default(), problem.message)]
        }
        Ok(_) if session.comparison(log.number).is_some() => Vec::new(),
        Ok(_) => vec!["not compared: page \"Compare\" says why".to_owned()],
    }
}

fn control<'a>(
    controlled: Option<&'a Controlled>,
    batch: Option<&'a Batch>,
) -> Vec<ControlPart<'a>> {
    let runs = controlled.into_iter().flat_map(|all| {
        let controller = all.request.controller.name.as_str();
        all.runs.iter().map(move |judged| (judged, controller))
    });
    runs.map(|(judged, controller)| ControlPart {
        recording: &judged.run.recording,
        requirement: &REQUIREMENT,
        verdict: &judged.verdict,
        plant: &judged.plant.name,
        controller,
        conditions: "",
        rigs: batch
            .and_then(|batch| batch.rigs_of(&judged.plant))
            .unwrap_or_default(),
    })
    .collect()
}

fn inputs(project: &Project, logs: &[Log]) -> Vec<Input> {
    let text = |role: &str, name: &str, text: &str| Input {
        role: role.to_owned(),
        name: name.to_owned(),
        identity: Some((text.len() as u64, hex(&Sha256::digest(text)))),
    };
    let controller = &project.closed_loop.controller;
    logs.iter()
        .filter_map(|log| {
            let log = log.log.as_ref().as_ref().ok()?;
            Some(Input::of_recording("log", log.recording.provenance()))
        })
        .chain([
            text("plant", &project.plant.name, &project.plant.toml),
            text("controller", &controller.name, &controller.toml),
        ])
        .collect()
}

fn written(session: &Session) -> Result<Arc<String>, Refusal> {
    session
        .report
        .get()
        .ok_or_else(|| Refusal::too_early("the report is not written yet; write it first"))
}

/// Returns the report for a frame of the page.
async fn preview(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Refusal> {
    let html = written(session(&sessions, id)?.as_ref())?;
    let headers = [
        (CONTENT_TYPE, "text/html; charset=utf-8"),
        (CONTENT_SECURITY_POLICY, POLICY.as_str()),
    ];
    Ok((headers, html.as_ref().clone()))
}

/// Returns the report as a file.
async fn file(sessions: Shared, id: Path<String>) -> Result<impl IntoResponse, Refusal> {
    let name = (CONTENT_DISPOSITION, "attachment; filename=\"report.html\"");
    Ok(([name], preview(sessions, id).await?))
}
