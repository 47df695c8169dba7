//! Check that a takeover of the loop is bumpless.

use super::condition::Conditions;
use super::memory::Memory;
use super::{CampaignRequirement, Finding, Observation, unless};
use crate::campaign::bounds;

/// First two duty cycles after both valves were shut. While pressure and reference are constant, no valve has time to
/// change the pressure between the two. A larger first duty cycle responds to a change that did not occur.
#[derive(Debug, Default)]
pub(super) struct Takeover {
    /// Shown pressure and reference of the previous sample (bar gauge), if both are plausible.
    before_bar: Option<[f64; 2]>,
    /// Number of consecutive samples in which neither changed.
    rested_for: u32,
    /// Duty cycles of the previous sample, if it was the first that drove a coil (%).
    first_pct: Option<[f64; 2]>,
    /// Excess of the first duty cycle over this sample's, for the valve that both drive (%).
    excess_pct: f64,
}

impl Takeover {
    pub(super) fn look(
        &mut self,
        observation: &Observation,
        memory: &Memory,
        conditions: &Conditions,
    ) {
        let now_bar = believed_bar(observation, conditions);
        let rests = self.before_bar.zip(now_bar).is_some_and(|(then, now)| {
            let [shown, reference] = [0, 1].map(|index| (now[index] - then[index]).abs());
            shown <= bounds::REST_BAR && reference <= bounds::RAMP_BAR_PER_SAMPLE
        });
        self.rested_for = if rests {
            self.rested_for.saturating_add(1)
        } else {
            0
        };
        let first_pct = self.first_pct.take().filter(|_| rests);
        self.excess_pct = first_pct.map_or(0.0, |first| excess_pct(first, observation.coils));
        let was_shut = [0, 1]
            .iter()
            .all(|&valve| memory.coil_settled(valve, |duty| duty == 0.0));
        // A target may have observation a step for some samples before it accepted it.
        let is_first =
            self.rested_for >= bounds::SETTLING && was_shut && observation.coils != [0.0; 2];
        self.first_pct = is_first.then_some(observation.coils);
        self.before_bar = now_bar;
    }

    pub(super) fn broken(&self, observation: &Observation) -> Finding {
        let [fill, vent] = observation.coils;
        let excess_pct = self.excess_pct;
        unless(
            excess_pct <= bounds::KICK_PCT,
            CampaignRequirement::NoKick,
            || {
                format!(
                    "fill {fill:.2} %, vent {vent:.2} %, {excess_pct:.2} % more in the sample before"
                )
            },
        )
    }
}

fn believed_bar(observation: &Observation, conditions: &Conditions) -> Option<[f64; 2]> {
    let shown_bar = observation
        .shown_bar()
        .filter(|_| !conditions.is_in_doubt())?;
    Some([shown_bar, conditions.reference_bar(observation)?])
}

/// Returns the excess of the first duty cycle; a valve that only one of the two drives is not compared.
fn excess_pct(first: [f64; 2], second: [f64; 2]) -> f64 {
    let both = first.into_iter().zip(second);
    let driven = both.filter(|&(_, second)| second > 0.0);
    driven
        .map(|(first, second)| first - second)
        .fold(0.0, f64::max)
}
