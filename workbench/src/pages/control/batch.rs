//! Closed loop on many rigs with scattered parameters (robustness, Monte Carlo).

use std::sync::Arc;

use axum::Json;
use axum::extract::{Path, State};
use hil_harness::rigs::{self, RigVerdict};
use hil_harness::{SettlingTimes, Verdict};
use serde::Serialize;

use super::REQUIREMENT;
use super::view::{DistributionView, PlantView, RequirementView};
use crate::job::Span;
use crate::named_plant::NamedPlant;
use crate::pages::{Begun, Shared, begin_job, session};
use crate::refusal::Refusal;
use crate::results::Batch;

/// Largest number of listed failing rigs.
const NAMED_MAX: usize = 20;

/// Begins a batch; it can be stopped after each rig.
pub(super) async fn begin(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<Begun>, Refusal> {
    let session = session(&sessions, id)?;
    let project = session.project();
    let plants = NamedPlant::all_of(&project)?;
    Ok(begin_job(&session, Span::Page, move |session, job| {
        let request = project.closed_loop;
        let all = f64::from(request.rigs) * plants.len() as f64;
        let mut done = 0.0;
        let mut judged = Vec::with_capacity(plants.len());
        for plant in plants {
            let scenario = request.scenario_on(&plant.parameters)?;
            let mut rigs = Vec::with_capacity(request.rigs as usize);
            for rig in rigs::verdicts(&scenario, &REQUIREMENT, request.rigs) {
                rigs.push(rig?);
                done += 1.0;
                if !job.goes_on(done / all) {
                    return Ok(());
                }
            }
            judged.push((plant, rigs));
        }
        session.batch.keep(Batch {
            request,
            plants: judged,
        });
        Ok(())
    }))
}

#[derive(Serialize)]
pub(super) struct BatchView {
    /// Whether a batch now would have the same result.
    is_current: bool,
    requirement: RequirementView,
    plants: Vec<RigsView>,
}

#[derive(Serialize)]
struct RigsView {
    plant: PlantView,
    rigs: usize,
    /// Rigs that meet every binding requirement.
    hold: usize,
    /// The first rigs that do not.
    failing: Vec<FailingView>,
    /// Settling times of all steps in the operating range.
    steps: DistributionView,
    /// Settling times of the slowest step of each rig.
    slowest: DistributionView,
}

#[derive(Serialize)]
struct FailingView {
    rig: u32,
    seed: u64,
    /// Binding requirements that are not met.
    requirements: Vec<String>,
}

fn not_kept(verdict: &Verdict) -> Vec<String> {
    let checks = verdict.checks.iter();
    checks
        .filter(|check| check.binding && !check.holds)
        .map(|check| check.requirement.clone())
        .collect()
}

impl RigsView {
    fn of(plant: &NamedPlant, rigs: &[RigVerdict]) -> Self {
        let failing = || rigs.iter().filter(|rig| !rig.verdict.holds);
        Self {
            plant: plant.into(),
            rigs: rigs.len(),
            hold: rigs.len() - failing().count(),
            failing: failing()
                .take(NAMED_MAX)
                .map(|rig| FailingView {
                    rig: rig.rig,
                    seed: rig.seed,
                    requirements: not_kept(&rig.verdict),
                })
                .collect(),
            steps: SettlingTimes::of_steps(rigs).into(),
            slowest: SettlingTimes::of_rigs(rigs).into(),
        }
    }
}

pub(super) async fn result(
    State(sessions): Shared,
    Path(id): Path<String>,
) -> Result<Json<BatchView>, Refusal> {
    let session = session(&sessions, id)?;
    let batch: Arc<Batch> = session
        .batch
        .get()
        .ok_or_else(|| Refusal::too_early("no batch was run yet; run one first"))?;
    let plants = batch.plants.iter();
    Ok(Json(BatchView {
        is_current: batch.is_of(&session.project()),
        requirement: RequirementView::THESIS,
        plants: plants
            .map(|(plant, rigs)| RigsView::of(plant, rigs))
            .collect(),
    }))
}
