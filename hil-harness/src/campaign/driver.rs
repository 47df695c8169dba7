//! References of a run: a drive, the fault during it, and then the recovery.
//!
//! ```text
//!  bar │      ┌─┐ ┌──── random steps and ramps ──┐                                      ┌──── level
//!      │   ┌──┘ └─┘          fault               └─┐ level, held                         │
//!    0 └───┘                                                └──── reference taken back ───┘
//!      power-on   onset                    end  +20    +320            +380 or +1300       +160
//! ```

use super::chance::{Chance, chance, uniform};
use super::fault::Survival;
use super::injection::Injection;
use super::injection::survival;
use crate::lead_in::LeadIn;
use crate::reference_profile::ReferenceProfile;
use crate::requirement::Requirement;

/// Returns the time from power-on to the first reference above zero (samples).
pub(super) fn lead_in_samples() -> u32 {
    LeadIn::to(0.0, f64::from(SAMPLE_MS) * 1e-3).samples()
}

/// Time from the end of the fault until the level that the loop has to reach without intervention (samples).
const BACK_AFTER: u32 = 20;
/// Duration of this level (samples): up the ramp from zero to the highest level, and T_req twice.
const HELD: u32 = 300;
/// Duration of the following reference of zero (samples), in which every reaction ends.
const ZERO: u32 = 1000;
/// Duration of the reference of zero if no reaction is expected (samples).
const ZERO_SHORT: u32 = 60;
/// Time before the end of the reference of zero at which the mechanic releases a locked ECU (samples).
const RELEASE_BEFORE: u32 = 20;
/// Duration of the last level (samples).
const LAST: u32 = 160;
/// Length of the end of a level in which the loop has to be at the reference (samples).
const JUDGED: u32 = 50;
const SAMPLE_MS: u32 = 10;

/// Instants of a run (samples).
#[derive(Clone, Copy, Debug)]
pub(super) struct Drive {
    /// Whether the loop has to recover without intervention.
    pub(super) resumes: bool,
    level_until: u32,
    zero_until: u32,
}

impl Drive {
    pub(super) fn of(injection: &Injection) -> Self {
        let resumes = survival(injection) != Survival::NotClaimed;
        let level_until = injection.end() + BACK_AFTER + HELD;
        let zero = if resumes { ZERO_SHORT } else { ZERO };
        Self {
            resumes,
            level_until,
            zero_until: level_until + zero,
        }
    }

    /// Returns the length of the run (samples).
    pub(super) fn samples(&self) -> u32 {
        self.zero_until + LAST
    }

    /// Returns the instant at which the mechanic tries to release the ECU.
    pub(super) fn release_at(&self) -> u32 {
        self.zero_until - RELEASE_BEFORE
    }

    /// Returns whether the loop must have recovered without intervention by this sample.
    pub(super) fn has_to_have_resumed(&self, sample: u32) -> bool {
        self.resumes && (self.level_until - JUDGED..self.level_until).contains(&sample)
    }

    /// Returns whether the loop has to be live again in this sample.
    pub(super) fn has_to_be_live(&self, sample: u32) -> bool {
        sample >= self.samples() - JUDGED
    }

    /// Returns the driver's reference, from the end of the lead-in on.
    pub(super) fn reference(&self, injection: &Injection) -> ReferenceProfile {
        let chance = chance(injection.seed, Chance::Driver);
        let mut draw = 0;
        let mut next = || {
            draw += 1;
            uniform(&chance, draw)
        };
        let lead_in_ms = SAMPLE_MS * lead_in_samples();
        let until_ms = |sample: u32| (SAMPLE_MS * sample).saturating_sub(lead_in_ms);
        let back_ms = until_ms(injection.end() + BACK_AFTER);
        let mut profile = ReferenceProfile::starting_at(0.0).step_to(level(next()));
        while let Some(left_ms) = back_ms
            .checked_sub(ms(&profile))
            .filter(|&left_ms| left_ms > 0)
        {
            let rest_ms = 50 + (4000.0 * next() * next()) as u32;
            let target_bar = match (8.0 * next()) as u32 {
                0 => 0.0,
                1 => HIGHEST_BAR * next(),
                _ => level(next()),
            };
            let ramp_ms = if next() < 0.3 {
                (1500.0 * next()) as u32
            } else {
                0
            };
            profile = profile.hold_ms(rest_ms.min(left_ms));
            let left_ms = back_ms - ms(&profile);
            profile = profile.ramp_to(target_bar, ramp_ms.min(left_ms));
        }
        let samples_ms = |samples: u32| SAMPLE_MS * samples;
        profile
            .step_to(level(next()))
            .hold_ms(samples_ms(HELD))
            .step_to(0.0)
            .hold_ms(samples_ms(self.zero_until - self.level_until))
            .step_to(level(next()))
            .hold_ms(samples_ms(LAST))
    }
}

/// Highest reference of the drive (bar gauge); a scattered supply is above.
const HIGHEST_BAR: f64 = 8.0;

/// Returns a reference within the range in which the loop has to meet its requirement (bar gauge).
fn level(chance: f64) -> f64 {
    let requirement = Requirement::THESIS;
    let [low, high] = requirement
        .operating_range_psup
        .map(|share| requirement.psup(share));
    low + (high - low) * chance
}

fn ms(profile: &ReferenceProfile) -> u32 {
    // A run is shorter than a day, so its length (ms) fits into 32 bits.
    (profile.end_ns() / 1_000_000) as u32
}
