//! JSON Schemas of all results.

use hil_harness::checks::Verdict;
use model_lab::Comparison;
use model_lab::diagnosis::next_experiment::{DeterminingExperiment, NextExperiment};
use model_lab::diagnosis::{Diagnosis, Estimation, Refinement};
use model_lab::thesis::{Explanation, ThesisTable};
use recording::InspectedLogs;
use schemars::{Schema, schema_for};

use super::black_box::BlackBox;
use super::control::Rigs;
use super::device::Device;
use super::monte_carlo::RigSummary;
use super::simulate::Simulation;
use crate::cli::SchemaName;

/// Returns the schema of a result.
pub(crate) fn of(result: SchemaName) -> Schema {
    match result {
        SchemaName::BlackBox => schema_for!(BlackBox),
        SchemaName::Comparison => Comparison::json_schema(),
        SchemaName::Control => schema_for!(Verdict),
        SchemaName::Device => schema_for!(Device),
        SchemaName::Diagnosis => Diagnosis::json_schema(),
        SchemaName::Estimation => Estimation::json_schema(),
        SchemaName::Inspection => schema_for!(InspectedLogs),
        SchemaName::Refinement => Refinement::json_schema(),
        SchemaName::DeterminingExperiment => DeterminingExperiment::json_schema(),
        SchemaName::NextExperiment => NextExperiment::json_schema(),
        SchemaName::Rigs => schema_for!(Rigs),
        SchemaName::RigSummary => schema_for!(RigSummary),
        SchemaName::Simulation => schema_for!(Simulation),
        SchemaName::Thesis => schema_for!(ThesisTable),
        SchemaName::ThesisExplanation => Explanation::json_schema(),
    }
}
