//! Closed loop on many rigs, into a table with one row for each.

use core::num::NonZero;
use core::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use hil_harness::monte_carlo::{
    Batch, Journal, MergeError, MonteCarloError, Shard, Summary, complete, finished, merge,
};
use schemars::JsonSchema;
use serde::Serialize;

use crate::failure::Failure;
use crate::input::NamedScenario;
use crate::interrupt;
use crate::progress::Progress;
use crate::targets::Existing;

/// Batch of rigs and its table.
pub(crate) struct Task {
    pub(crate) scenario: NamedScenario,
    /// Number of rigs of the whole batch.
    pub(crate) rigs: u32,
    pub(crate) shard: Shard,
    /// Number of threads.
    pub(crate) jobs: NonZero<usize>,
    /// The table.
    pub(crate) out: PathBuf,
    pub(crate) existing: Existing,
    /// Command that runs the same batch, without the options of the table.
    pub(crate) command: String,
}

/// Tables of shards, and the table that they give together.
pub(crate) struct MergeTask {
    pub(crate) shards: Vec<PathBuf>,
    pub(crate) out: PathBuf,
    pub(crate) existing: Existing,
}

/// Written table.
pub(crate) struct RigTable {
    pub(crate) summary: Summary,
    pub(crate) out: PathBuf,
    /// Batch and its cost; `None` after a merge.
    pub(crate) batch: Option<RunBatch>,
}

/// Batch that was run here.
pub(crate) struct RunBatch {
    /// Scenario, controller and plant.
    pub(crate) title: String,
    pub(crate) command: String,
    pub(crate) cost: Cost,
}

/// Time that the rigs took.
pub(crate) struct Cost {
    /// Number of rigs that were run now; others were in the unfinished part.
    pub(crate) rigs: u32,
    /// Simulated time of one rig (s), without the lead-in.
    pub(crate) rig_s: f64,
    pub(crate) elapsed_s: f64,
    /// Number of threads.
    pub(crate) jobs: NonZero<usize>,
}

impl Cost {
    /// Returns the simulated time of all rigs per elapsed second.
    pub(crate) fn rig_seconds_per_s(&self) -> f64 {
        f64::from(self.rigs) * self.rig_s / self.elapsed_s
    }
}

/// Runs the rigs that neither the table nor its unfinished part has, and writes the table.
pub(crate) fn run(task: Task) -> Result<RigTable, Failure> {
    let scenario = &task.scenario;
    let batch = Batch {
        scenario: scenario.scenario.clone(),
        requirement: scenario.requirements.requirement,
        conditions: scenario.scatter(),
        rigs: task.rigs,
    };
    let rigs = task.shard.rigs(task.rigs);
    let done = finished(&task.out, &batch.settings(), rigs, &|rig| batch.row(rig))?;
    let (summary, rigs_run, elapsed_s) = match done {
        Some(summary) => (summary, 0, 0.0),
        None => computed(&task, &batch)?,
    };
    let plant = &batch.scenario.plant;
    Ok(RigTable {
        summary,
        batch: Some(RunBatch {
            title: format!(
                "{}: {} on {}",
                batch.scenario.name, scenario.controller, scenario.plant
            ),
            command: task.command,
            cost: Cost {
                rigs: rigs_run,
                rig_s: f64::from(batch.scenario.duration_samples) * plant.ecu.sample_time_s,
                elapsed_s,
                jobs: task.jobs,
            },
        }),
        out: task.out,
    })
}

/// Runs the rigs that the unfinished part lacks, and writes the table; returns its summary, the number of rigs that were run
/// and their time (s).
fn computed(task: &Task, batch: &Batch) -> Result<(Summary, u32, f64), Failure> {
    let is_interrupted = interrupt::flag()?;
    let part = Journal::path_of(&task.out);
    let rigs = task.shard.rigs(task.rigs);
    let mut journal = Journal::open(part, &batch.settings(), rigs)?;
    let missing = journal.rigs() - journal.done();
    let progress = Progress::of_count("rigs", journal.rigs().into());
    progress.skip(journal.done().into());
    let begin = Instant::now();
    complete(&mut journal, task.jobs, &|rig| batch.row(rig), &mut |_| {
        progress.step();
        match interrupt::check(is_interrupted) {
            Ok(()) => ControlFlow::Continue(()),
            Err(_) => ControlFlow::Break(()),
        }
    })?;
    let elapsed_s = begin.elapsed().as_secs_f64();
    let failed = |error| Failure::write(Some(&task.out), error);
    let file = task.existing.begin(&task.out).map_err(failed)?;
    let (file, summary) = journal.write(file).map_err(|error| match error {
        MonteCarloError::Write(error) => failed(error),
        other => other.into(),
    })?;
    file.commit().map_err(failed)?;
    journal.remove()?;
    Ok((summary, missing, elapsed_s))
}

/// Merges the tables of shards.
pub(crate) fn merged(task: MergeTask) -> Result<RigTable, Failure> {
    let failed = |error| Failure::write(Some(&task.out), error);
    let file = task.existing.begin(&task.out).map_err(failed)?;
    let (file, summary) = merge(&task.shards, file).map_err(|error| match error {
        MergeError::Write(error) => failed(error),
        other => other.into(),
    })?;
    file.commit().map_err(failed)?;
    Ok(RigTable {
        summary,
        out: task.out,
        batch: None,
    })
}

/// Name and version of the JSON form of [`RigSummary`].
pub(crate) const RIG_SUMMARY_SCHEMA: &str = "retarder.rig-summary/1";

/// Summary of a table of rigs.
#[derive(Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct RigSummary<'a> {
    /// Name and version of this format, `retarder.rig-summary/1`.
    pub(crate) schema: &'static str,
    /// The table.
    pub(crate) table: &'a Path,
    /// Whether every binding check passes on every rig.
    pub(crate) holds: bool,
    /// Summary of its rows.
    pub(crate) summary: &'a Summary,
}

impl RigTable {
    /// Returns the JSON form of the summary.
    pub(crate) fn summary(&self) -> RigSummary<'_> {
        RigSummary {
            schema: RIG_SUMMARY_SCHEMA,
            table: &self.out,
            holds: self.summary.holds(),
            summary: &self.summary,
        }
    }
}
