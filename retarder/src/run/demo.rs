//! Demo: a bench log, the model beside it, and the loop on the model.

use std::sync::atomic::AtomicBool;

use model_lab::CompareOptions;

use super::compare::{self, Compared};
use super::control::{self, Controlled};
use super::thesis::{self, Figures};
use crate::failure::Failure;
use crate::input::{self, NamedPlant, NamedScenario};

/// Scenarios of the demo: the staircase (thesis figure 6.5), and the two steps of section 1.4.
const SCENARIOS: [&str; 3] = ["figure-6.5", "fill-requirement", "vent-requirement"];

/// Results of the demo.
pub(crate) struct Demo {
    pub(crate) compared: Compared,
    /// Closed loops, in the order of [`SCENARIOS`].
    pub(crate) loops: Vec<Controlled>,
    pub(crate) figures: Figures,
}

/// Runs the demo.
pub(crate) fn run() -> Result<Demo, Failure> {
    let log = input::tour_log()?;
    let compared = compare::run(
        NamedPlant::nominal(),
        log,
        &CompareOptions::default(),
        Some("p_ch"),
    )?;
    let loops = SCENARIOS
        .into_iter()
        .filter_map(NamedScenario::built_in)
        .map(|scenario| control::run(scenario, 0, &AtomicBool::new(false)))
        .collect::<Result<_, _>>()?;
    let figures = thesis::run(NamedPlant::nominal());
    Ok(Demo {
        compared,
        loops,
        figures,
    })
}
