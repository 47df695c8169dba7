//! References that every candidate follows.

use crate::reference_profile::ReferenceProfile;
use crate::requirement::Requirement;

/// Number of references within the operating range.
const LEVELS: usize = 6;

/// Returns both timed passages of `requirement`, then steps from each of six references of its operating range to each
/// other one, with samples of `sample_time_s` (s). Each reference holds for twice T_req.
pub(super) fn profile(requirement: &Requirement, sample_time_s: f64) -> ReferenceProfile {
    let hold_ms = (2e3 * f64::from(requirement.t_req_samples) * sample_time_s).ceil() as u32;
    let [low, high] = requirement.operating_range_psup;
    let levels: [f64; LEVELS] = std::array::from_fn(|index| {
        let share = low + (high - low) * index as f64 / (LEVELS - 1) as f64;
        requirement.psup(share)
    });
    let passages = [
        requirement.psup(requirement.fill_to_psup),
        0.0,
        requirement.psup(requirement.vent_from_psup),
        requirement.psup(requirement.vent_to_psup),
    ];
    let pairs = (0..LEVELS).flat_map(|one| (0..one).map(move |other| [one, other]));
    let steps = pairs.flatten().map(|index| levels[index]);
    passages.into_iter().chain(steps).fold(
        ReferenceProfile::starting_at(0.0).hold_ms(100),
        |profile, level_bar| profile.step_to(level_bar).hold_ms(hold_ms),
    )
}
