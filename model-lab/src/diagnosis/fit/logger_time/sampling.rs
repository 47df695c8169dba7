//! Choice whether the currents of a logger are means since the row before or instantaneous values.
//!
//! Means look like instantaneous values half a row earlier, and so does a missing effect of a coil. One choice applies to all logs of a
//! logger, and a diagnosis that leaves an error of the currents tries the other one.

use plant_sim::PlantParameters;
use plant_sim::replay::CurrentSampling;

use super::pwm_lead::find_pwm_lead;
use super::{DELAY_STEP_S, Delay, Tries};
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::log::Log;

/// Chooses the sampling with the smaller loss, for all logs in `evidence` that leave it open.
pub(crate) fn find_sampling(plant: &PlantParameters, evidence: &mut Evidence, delay: Delay) {
    let mut found: Option<(f64, _, _)> = None;
    for sampling in [CurrentSampling::MeanOfInterval, CurrentSampling::Instant] {
        if !take_sampling(plant, evidence, sampling, delay) {
            return;
        }
        let open = evidence.logs.iter().filter(|log| log.is_sampling_open());
        let of_log = |log: &Log| {
            let clock = [log.conditions.clock];
            let delays_s = delay.candidates_s(plant, DELAY_STEP_S);
            Tries::on(plant, log).best(&clock, &delays_s).whole.loss
        };
        let loss: f64 = open.map(of_log).sum();
        if found.as_ref().is_none_or(|&(least, ..)| loss < least) {
            found = Some((loss, sampling, evidence.conditions()));
        }
    }
    if let Some((_, sampling, conditions)) = found {
        evidence.set_open_sampling(sampling);
        evidence.set_conditions(&conditions, plant);
    }
}

/// Sets the sampling of each log that leaves it open to `sampling`, and finds the sample of a PWM period at which the log then begins,
/// because the pulses of one choice lie half a row from those of the other. Returns whether there is such a log.
pub(crate) fn take_sampling(
    plant: &PlantParameters,
    evidence: &mut Evidence,
    sampling: CurrentSampling,
    delay: Delay,
) -> bool {
    let is_open = evidence.set_open_sampling(sampling);
    for log in evidence
        .logs
        .iter_mut()
        .filter(|log| log.is_sampling_open())
    {
        find_pwm_lead(plant, log, delay);
    }
    is_open
}
