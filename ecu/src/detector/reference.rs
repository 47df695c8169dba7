//! Reference of a sample, with a detector of its loss.

use controller::Pressure;

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};

/// Debounce count N of a lost reference (samples).
const REFERENCE_N: u8 = Fault::ReferenceLost.samples();
/// Lowest possible reference: vacuum, 2⁻¹⁶ bar gauge.
pub(crate) const REFERENCE_MIN: i32 = -(1 << 16);

/// Reference input: stores the last valid reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ReferenceInput {
    lost: Debounce,
    last: Pressure,
}

impl ReferenceInput {
    pub(crate) const NEW: Self = Self {
        lost: Debounce::CLEAR,
        last: Pressure::ZERO,
    };

    /// Returns whether this sample's reference is valid; one below vacuum or above the highest supply pressure is not.
    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, reference: Option<Pressure>) -> bool {
        let valid = reference.filter(|reference| {
            reference.to_bits() >= REFERENCE_MIN && reference.to_bits() <= limits.reference_max
        });
        let n = limits.mechanisms.samples(REFERENCE_N);
        self.lost.update(valid.is_none(), n);
        if let Some(reference) = valid {
            self.last = reference;
        }
        valid.is_some()
    }

    /// Returns the last valid reference; zero before the first.
    #[inline(always)]
    pub(crate) const fn last(&self) -> Pressure {
        self.last
    }

    #[inline(always)]
    pub(crate) fn faults(&self) -> FaultSet {
        FaultSet::when(self.lost.is_confirmed(), Fault::ReferenceLost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::bench_limits;

    fn faults_after(reference: Option<i32>, samples: u8) -> FaultSet {
        let mut input = ReferenceInput::NEW;
        for _ in 0..samples {
            input.sample(&bench_limits(), reference.map(Pressure::from_bits));
        }
        input.faults()
    }

    #[test]
    fn n_samples_without_a_valid_reference_confirm_and_one_less_does_not() {
        let lost = FaultSet::of(Fault::ReferenceLost);
        for (samples, expected) in [(4, FaultSet::NONE), (5, lost), (6, lost)] {
            for reference in [None, Some(i32::MAX), Some((10 << 16) + 1), Some(-65_537)] {
                let found = faults_after(reference, samples);
                assert_eq!(found, expected, "{reference:?}, {samples}");
            }
            for reference in [10 << 16, 0, -65_536] {
                assert_eq!(faults_after(Some(reference), samples), FaultSet::NONE);
            }
        }
    }

    #[test]
    fn the_last_valid_reference_is_kept() {
        let mut input = ReferenceInput::NEW;
        assert_eq!(input.last(), Pressure::ZERO);
        for (reference, is_valid, last) in [
            (Some(1 << 16), true, 1 << 16),
            (None, false, 1 << 16),
            (Some(i32::MIN), false, 1 << 16),
            (Some(2 << 16), true, 2 << 16),
        ] {
            let reference = reference.map(Pressure::from_bits);
            assert_eq!(input.sample(&bench_limits(), reference), is_valid);
            assert_eq!(input.last().to_bits(), last);
        }
    }
}
