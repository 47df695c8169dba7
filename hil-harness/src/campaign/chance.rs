//! Random numbers of a campaign: one seed, a stream for each use.

use crate::random::{Random, Stream};

/// Use of random numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Chance {
    /// Injections of a campaign.
    Campaign,
    /// References of the driver.
    Driver,
    /// Behaviour of a fault from sample to sample.
    Fault,
}

/// Returns the random numbers of one use under `seed`.
pub(super) fn chance(seed: u64, of: Chance) -> Random {
    Random::new(
        Random::new(seed, Stream::RigSeed).bits(of as u64),
        Stream::RigSeed,
    )
}

/// Returns number `counter`, uniform over 0 ..= 1.
pub(super) fn uniform(random: &Random, counter: u64) -> f64 {
    0.5 + 0.5 * random.symmetric(counter)
}
