//! Whether the currents of a logger are means since the row before or values of the instant.
//!
//! Means look like values of an instant half a row earlier, and so does what is missing in a coil: one choice holds for all logs of a
//! logger, and a diagnosis that leaves an error of the currents tries the other one.

use plant_sim::PlantParameters;
use plant_sim::replay::CurrentSampling;

use super::super::evidence::Evidence;
use super::super::log::Log;
use super::{DELAY_STEP_S, Delay, best};

/// Chooses for all logs in `evidence` that leave it open: what leaves less.
pub(crate) fn find_sampling(plant: &PlantParameters, evidence: &mut Evidence, delay: Delay) {
    let mut loss = |sampling| {
        if !evidence.set_open_sampling(sampling) {
            return f64::INFINITY;
        }
        let open = evidence.logs.iter().filter(|log| log.is_sampling_open());
        let of_log = |log: &Log| {
            let clock = [log.conditions.clock];
            best(plant, log, &clock, delay.candidates_s(plant, DELAY_STEP_S)).loss
        };
        open.map(of_log).sum()
    };
    let of_instants: f64 = loss(CurrentSampling::Instant);
    if of_instants < loss(CurrentSampling::MeanOfInterval) {
        evidence.set_open_sampling(CurrentSampling::Instant);
    }
}
