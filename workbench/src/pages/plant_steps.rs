//! Steps of the session's plant, for the pages that change it: they share one history.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::refine::measure;
use super::session;
use crate::history::{History, Step, StepError};
use crate::job::Job;
use crate::project::Project;
use crate::refusal::Refusal;
use crate::results::Chosen;
use crate::session::{Session, Sessions};

/// Returns the history of the session's plant; it begins again if another page changed the plant.
pub(super) fn history(session: &Session) -> Result<History, Refusal> {
    let project = session.project();
    if project.history.is_of(&project.plant) {
        return Ok(project.history);
    }
    History::begin(&project.plant)
}

fn of_plant(project: &mut Project) -> Result<&mut History, Refusal> {
    if !project.history.is_of(&project.plant) {
        project.history = History::begin(&project.plant)?;
    }
    Ok(&mut project.history)
}

/// Stores the errors of the current step, and of the one before it, on a log.
pub(super) fn note_errors(session: &Session, log: u32) -> Result<(), Refusal> {
    let mut measured = history(session)?;
    let at = measured.at();
    // A change may add two steps.
    if let Some(before) = at.checked_sub(1) {
        measured.go_to(before)?;
        measure(session, log, &mut measured)?;
        measured.go_to(at)?;
    }
    measure(session, log, &mut measured)?;
    session.change(|project| {
        // Another request may have changed the plant in the meantime.
        if measured.is_of(&project.plant) {
            project.history = measured;
        }
        Ok(())
    })
}

/// Step as a page lists it.
#[derive(Serialize)]
pub(super) struct StepView {
    done: String,
    log: String,
    errors: Vec<StepError>,
}

/// Changes the plant of the session by a step that `change` adds, and returns the history with its errors on `log`.
pub(super) fn change_plant(
    session: &Session,
    log: u32,
    change: impl FnOnce(&mut History) -> Result<(), Refusal>,
) -> Result<History, Refusal> {
    session.project().log(log)?;
    note_errors(session, log)?;
    session.change(|project| {
        let history = of_plant(project)?;
        change(history)?;
        project.plant = project.history.now().plant.clone();
        Ok(())
    })?;
    session.forget_comparisons();
    note_errors(session, log)?;
    history(session)
}

impl StepView {
    /// Returns all steps of `history`, including the undone ones.
    pub(super) fn all_of(history: &History) -> Vec<Self> {
        let view = |step: &Step| Self {
            done: step.done.clone(),
            log: step.log.clone(),
            errors: step.errors.clone(),
        };
        history.steps().iter().map(view).collect()
    }
}

/// Log on which a page shows the plant.
#[derive(Deserialize)]
pub(super) struct OnLog {
    /// Log whose errors are stored with the step.
    pub(super) log: u32,
}

/// Request for a fit: its logs, and the log on which the page shows the plant.
#[derive(Deserialize)]
pub(super) struct Fitting {
    pub(super) log: u32,
    #[serde(flatten)]
    pub(super) chosen: Chosen,
}

/// Returns the session `id` with its history, if it has the logs that `request` requests.
pub(super) fn fitting(
    sessions: &Sessions,
    id: String,
    request: &Fitting,
) -> Result<(Arc<Session>, History), Refusal> {
    let session = session(sessions, id)?;
    request.chosen.check(&session.project())?;
    session.project().log(request.log)?;
    let history = history(&session)?;
    Ok((session, history))
}

/// Adds `step`, which was computed from the step `now`.
pub(super) fn add_fitted(
    session: &Session,
    job: &Job,
    now: &Step,
    step: Step,
) -> Result<(), Refusal> {
    if job.is_cancelled() {
        return Ok(());
    }
    session.change(|project| {
        if project.plant != now.plant {
            return Err(Refusal::too_early(
                "the plant was changed while it was fitted; fit again",
            ));
        }
        project.plant = step.plant.clone();
        project.history.push(step);
        Ok(())
    })?;
    session.clear_comparisons();
    Ok(())
}
