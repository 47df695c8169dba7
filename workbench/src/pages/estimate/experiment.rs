//! Planning of the experiment that determines the ordinary parameters of the estimated plant.

use std::sync::Arc;

use axum::Json;
use axum::extract::{Path, State};
use axum::http::header::{CONTENT_DISPOSITION, CONTENT_TYPE};
use axum::response::IntoResponse;
use model_lab::diagnosis::next_experiment::{DeterminingExperiment, determining_experiment};
use serde::Deserialize;

use crate::job::Span;
use crate::pages::experiment_limits::RequestedLimits;
use crate::pages::plant_steps::{Fitting, fitting};
use crate::pages::{Begun, Shared, begin_job, session};
use crate::refusal::Refusal;
use crate::results::Determining;
use crate::session::Session;

/// Request for an experiment.
#[derive(Deserialize)]
pub(super) struct Request {
    #[serde(flatten)]
    fitting: Fitting,
    limits: RequestedLimits,
}

/// Begins to plan, with the current plant and the noise of the training logs.
pub(super) async fn plan(
    State(sessions): Shared,
    Path(id): Path<String>,
    Json(request): Json<Request>,
) -> Result<Json<Begun>, Refusal> {
    let (session, history) = fitting(&sessions, id, &request.fitting)?;
    if history.estimation().is_none() {
        return Err(Refusal::too_early(
            "the ordinary parameters are not estimated yet; estimate them first",
        ));
    }
    let plant = history.now().plant.clone();
    let parameters = plant.parameters()?;
    let limits = request.limits.of(&parameters)?;
    Ok(begin_job(&session, Span::Tab, move |session, job| {
        let logs = session.recordings(&request.fitting.chosen.logs)?;
        let watch = |seen| job.watch(seen);
        let next = determining_experiment(&parameters, &logs, &["all"], limits, &watch)?;
        if !job.is_cancelled() {
            let determining = Arc::new(Determining { next, plant });
            session.change_findings(|findings| findings.determining = Some(determining))?;
        }
        Ok(())
    }))
}

/// Returns the planned experiment; null if none was planned for the current plant.
pub(super) async fn planned(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<Option<DeterminingExperiment>>, Refusal> {
    let session = session(&sessions, id)?;
    let next = of_plant(&session).map(|found| found.next.clone());
    Ok(Json(next))
}

/// Returns its duty cycles for a rig.
pub(super) async fn export_csv(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Refusal> {
    let session = session(&sessions, id)?;
    let found = of_plant(&session).ok_or_else(|| {
        Refusal::too_early("no experiment is planned for this plant yet; plan one first")
    })?;
    let headers = [
        (CONTENT_TYPE, "text/csv; charset=utf-8"),
        (
            CONTENT_DISPOSITION,
            "attachment; filename=\"determining-experiment.csv\"",
        ),
    ];
    Ok((headers, found.next.csv()))
}

fn of_plant(session: &Session) -> Option<Arc<Determining>> {
    let found = session.findings().determining?;
    (found.plant == session.project().plant).then_some(found)
}
