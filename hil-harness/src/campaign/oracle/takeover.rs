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
    /// Duty cycles of the previous sample, if it was the first that drove a coil (%), and its factor of the voltage.
    first: Option<First>,
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
        let first = self.first.take().filter(|_| rests);
        let now = First {
            duties_pct: observation.coils,
            by_voltage: observation.voltage_factor(),
        };
        self.excess_pct = first.map_or(0.0, |first| first.excess_pct(&now));
        let was_shut = [0, 1]
            .iter()
            .all(|&valve| memory.coil_settled(valve, |duty| duty == 0.0));
        // A target may have observation a step for some samples before it accepted it.
        let is_first =
            self.rested_for >= bounds::SETTLING && was_shut && observation.coils != [0.0; 2];
        self.first = is_first.then_some(now);
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

/// Duty cycles of a sample (%), and the factor of its supply voltage.
#[derive(Clone, Copy, Debug)]
struct First {
    duties_pct: [f64; 2],
    by_voltage: f64,
}

impl First {
    /// Returns the excess of these duty cycles over those of `second`; a valve that only one of the two drives is not
    /// compared. A voltage that returns changes limits, but not the full duty cycle that empties the chamber, so the
    /// smaller excess counts: of the duty cycles, or of those at nominal voltage.
    fn excess_pct(&self, second: &Self) -> f64 {
        let both = self.duties_pct.into_iter().zip(second.duties_pct);
        let driven = both.filter(|&(_, second)| second > 0.0);
        driven
            .map(|(first, duty)| {
                let at_nominal_v = first / self.by_voltage - duty / second.by_voltage;
                at_nominal_v.min(first - duty)
            })
            .fold(0.0, f64::max)
    }
}
