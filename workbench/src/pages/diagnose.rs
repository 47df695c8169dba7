//! Page "Diagnose": the missing physical effect, and the experiment that would provide more information.

use std::sync::Arc;

use axum::extract::{Path, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use axum::routing::{get, post};
use axum::{Json, Router};
use model_lab::diagnosis::next_experiment::{NextExperiment, Question, next_experiment};
use model_lab::diagnosis::{Diagnosis, diagnose};
use serde::{Deserialize, Serialize};

use super::experiment_limits::RequestedLimits;
use super::{Begun, Shared, begin_job, session};
use crate::effects::{self, EffectView};
use crate::job::Span;
use crate::refusal::Refusal;
use crate::results::{Chosen, Diagnosed};
use crate::session::{Session, Sessions};

pub(super) fn routes() -> Router<Arc<Sessions>> {
    Router::new()
        .route("/sessions/{session}/effects", get(list_effects))
        .route("/sessions/{session}/diagnose", post(begin))
        .route("/sessions/{session}/diagnosis", get(result))
        .route("/sessions/{session}/diagnosis/json", get(export_json))
        .route("/sessions/{session}/next-experiment", post(plan))
        .route("/sessions/{session}/next-experiment", get(planned))
        .route("/sessions/{session}/next-experiment/csv", get(export_csv))
}

/// Returns the effects that the plant of the session may have.
async fn list_effects(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<Vec<EffectView>>, Refusal> {
    let plant = session(&sessions, id)?.project().plant.parameters()?;
    Ok(Json(effects::all(&plant)))
}

/// Begins a diagnosis; a running diagnosis or fit of the same tab ends.
async fn begin(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(chosen): Json<Chosen>,
) -> Result<Json<Begun>, Refusal> {
    let session = session(&sessions, id)?;
    chosen.check(&session.project())?;
    let plant = session.project().plant;
    let parameters = plant.parameters()?;
    Ok(begin_job(&session, Span::Tab, move |session, job| {
        let logs = session.recordings(&chosen.logs)?;
        let check = session.recordings(&chosen.check)?;
        let diagnosis = diagnose(&parameters, &logs, &check, &|seen| job.watch(seen))?;
        if !job.is_cancelled() {
            let diagnosed = Diagnosed {
                diagnosis,
                plant,
                chosen,
            };
            session.change_findings(|findings| {
                findings.diagnosed = Some(Arc::new(diagnosed));
                findings.next = None;
            })?;
        }
        Ok(())
    }))
}

fn diagnosed(session: &Session) -> Result<Arc<Diagnosed>, Refusal> {
    session.findings().diagnosed.ok_or_else(|| {
        Refusal::too_early("there is no diagnosis of these logs yet; diagnose first")
    })
}

#[derive(Serialize)]
struct DiagnosisView {
    /// Name of the diagnosed plant.
    plant: String,
    /// Whether it is still the session's plant.
    is_of_plant: bool,
    /// Whether it explains the error of the session's plant.
    explains_plant: bool,
    chosen: Chosen,
    diagnosis: Diagnosis,
    /// Other explanations of each named effect, in words.
    alternatives: Vec<String>,
}

/// Returns the result; null before the first diagnosis.
async fn result(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<Option<DiagnosisView>>, Refusal> {
    let session = session(&sessions, id)?;
    let view = |found: Arc<Diagnosed>| DiagnosisView {
        plant: found.plant.name.clone(),
        is_of_plant: found.plant == session.project().plant,
        explains_plant: found.explains(&session.project()),
        chosen: found.chosen.clone(),
        diagnosis: found.diagnosis.clone(),
        alternatives: found.diagnosis.alternatives(),
    };
    Ok(Json(session.findings().diagnosed.map(view)))
}

/// Returns the same JSON that `retarder diagnose --json` writes.
async fn export_json(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Refusal> {
    let session = session(&sessions, id)?;
    let found = diagnosed(&session)?;
    let json = serde_json::to_string_pretty(&found.diagnosis)
        .map_err(|error| Refusal::value(error.to_string()))?;
    let headers = [
        (CONTENT_TYPE, "application/json"),
        (
            CONTENT_DISPOSITION,
            "attachment; filename=\"diagnosis.json\"",
        ),
    ];
    Ok((headers, json + "\n"))
}

/// Request for an experiment.
#[derive(Deserialize)]
struct Request {
    /// One effect to detect, or several to distinguish.
    effects: Vec<String>,
    limits: RequestedLimits,
}

/// Begins to plan an experiment for the plant and the logs of the diagnosis.
async fn plan(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(request): Json<Request>,
) -> Result<Json<Begun>, Refusal> {
    let session = session(&sessions, id)?;
    let found = diagnosed(&session)?;
    let parameters = found.plant.parameters()?;
    let limits = request.limits.of(&parameters)?;
    if request.effects.is_empty() {
        return Err(Refusal::value(
            "no effect is selected; select one to detect, or two or more to distinguish",
        ));
    }
    Ok(begin_job(&session, Span::Tab, move |session, job| {
        let logs = session.recordings(&found.chosen.logs)?;
        let ids: Vec<&str> = request.effects.iter().map(String::as_str).collect();
        let question = match ids[..] {
            [id] => Question::For(id),
            _ => Question::Between(&ids),
        };
        let watch = |seen| job.watch(seen);
        let next = next_experiment(&parameters, &logs, question, limits, &watch)?;
        if !job.is_cancelled() {
            session.change_findings(|findings| findings.next = Some(Arc::new(next)))?;
        }
        Ok(())
    }))
}

fn next(session: &Session) -> Result<Arc<NextExperiment>, Refusal> {
    session
        .findings()
        .next
        .ok_or_else(|| Refusal::too_early("no experiment is planned yet; plan one first"))
}

/// Returns the planned experiment; null before the first one.
async fn planned(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<Option<NextExperiment>>, Refusal> {
    let session = session(&sessions, id)?;
    Ok(Json(
        session.findings().next.map(|next| next.as_ref().clone()),
    ))
}

/// Returns the duty cycles for a rig.
async fn export_csv(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Refusal> {
    let session = session(&sessions, id)?;
    let headers = [
        (CONTENT_TYPE, "text/csv; charset=utf-8"),
        (
            CONTENT_DISPOSITION,
            "attachment; filename=\"next-experiment.csv\"",
        ),
    ];
    Ok((headers, next(&session)?.csv()))
}
