//! Results that were computed for a project, as long as they are valid.

mod compared;
mod controlled;
mod diagnosed;

use std::collections::HashMap;

pub(crate) use compared::Compared;
pub(crate) use controlled::{Batch, Controlled, Judged};
pub(crate) use diagnosed::{Chosen, Determining, Diagnosed, Findings};

use crate::history::StepError;

/// Errors of plants by log and plant file: error steps that a slider does not affect are not simulated again.
pub(crate) type ErrorsOfPlants = HashMap<(u32, String), Vec<StepError>>;
