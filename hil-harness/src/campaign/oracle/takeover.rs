//! Whether a loop that takes over begins as one that was in charge all along.

use super::condition::Conditions;
use super::memory::Memory;
use super::{Finding, Promise, Seen, unless};
use crate::campaign::bounds;

/// The first two duty cycles after both valves were shut. While pressure and reference rest, no valve has had the time to move
/// anything between the two: a first one that is larger answers to a change that was none.
#[derive(Debug, Default)]
pub(super) struct Takeover {
    /// What the sample before showed and asked for [bar gauge], where both can be believed.
    before_bar: Option<[f64; 2]>,
    /// Samples in a row in which neither moved.
    rested_for: u32,
    /// What the coils got in the sample before, if it was the first that drove one \[%\].
    first_pct: Option<[f64; 2]>,
    /// By how much the first was above this sample's, of the valve that both drive \[%\].
    excess_pct: f64,
}

impl Takeover {
    pub(super) fn look(&mut self, seen: &Seen, memory: &Memory, conditions: &Conditions) {
        let now_bar = believed_bar(seen, conditions);
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
        self.excess_pct = first_pct.map_or(0.0, |first| excess_pct(first, seen.coils));
        let was_shut = [0, 1]
            .iter()
            .all(|&valve| memory.coil_settled(valve, |duty| duty == 0.0));
        // A target may have looked at a step for some samples before it believed it.
        let is_first = self.rested_for >= bounds::SETTLING && was_shut && seen.coils != [0.0; 2];
        self.first_pct = is_first.then_some(seen.coils);
        self.before_bar = now_bar;
    }

    pub(super) fn broken(&self, seen: &Seen) -> Finding {
        let [fill, vent] = seen.coils;
        let excess_pct = self.excess_pct;
        unless(excess_pct <= bounds::KICK_PCT, Promise::NoKick, || {
            format!(
                "fill {fill:.2} %, vent {vent:.2} %, {excess_pct:.2} % more in the sample before"
            )
        })
    }
}

fn believed_bar(seen: &Seen, conditions: &Conditions) -> Option<[f64; 2]> {
    let shown_bar = seen.shown_bar().filter(|_| !conditions.is_in_doubt())?;
    Some([shown_bar, conditions.reference_bar(seen)?])
}

/// Where only one of the two drives a valve, it was decided otherwise.
fn excess_pct(first: [f64; 2], second: [f64; 2]) -> f64 {
    let both = first.into_iter().zip(second);
    let driven = both.filter(|&(_, second)| second > 0.0);
    driven
        .map(|(first, second)| first - second)
        .fold(0.0, f64::max)
}
