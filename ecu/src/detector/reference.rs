//! The reference of a sample, and for how long there was none.

use controller::Pressure;

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};

/// N \[samples\].
pub(crate) const REFERENCE_N: u8 = 5;
/// Lowest reference that somebody can mean: vacuum, 2⁻¹⁶ bar gauge.
pub(crate) const REFERENCE_MIN: i32 = -(1 << 16);

/// Keeps the last valid reference.
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

    /// Whether this sample's reference is valid; one that no supply could give is not.
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

    /// The last valid reference; zero before the first.
    #[inline(always)]
    pub(crate) const fn last(&self) -> Pressure {
        self.last
    }

    #[inline(always)]
    pub(crate) fn faults(&self) -> FaultSet {
        FaultSet::when(self.lost.is_confirmed(), Fault::ReferenceLost)
    }
}
