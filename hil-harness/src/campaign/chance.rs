//! Chance of a campaign: one seed, a stream for each use.

use crate::random::{Random, Stream};

/// What numbers are drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chance {
    /// The injections of a campaign.
    Campaign,
    /// What the driver asks for.
    Driver,
    /// What a fault does from sample to sample.
    Fault,
}

/// The numbers of one use under `seed`.
pub(super) fn chance(seed: u64, of: Chance) -> Random {
    Random::new(
        Random::new(seed, Stream::RigSeed).bits(of as u64),
        Stream::RigSeed,
    )
}

/// Number `counter`, uniform over 0 ..= 1.
pub(super) fn uniform(random: &Random, counter: u64) -> f64 {
    0.5 + 0.5 * random.symmetric(counter)
}
