//! What was computed for a project, as long as it is of use.

mod compared;
mod controlled;
mod diagnosed;

use std::collections::HashMap;

pub(crate) use compared::Compared;
pub(crate) use controlled::{Batch, Controlled, Judged};
pub(crate) use diagnosed::{Chosen, Diagnosed, Findings};

use crate::history::StepError;

/// Errors of plants by log and plant file: rungs of the ladder that a slider does not touch are not simulated again.
pub(crate) type ErrorsOfPlants = HashMap<(u32, String), Vec<StepError>>;
