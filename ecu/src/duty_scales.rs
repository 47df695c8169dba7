//! Factors of the duty limits in a sample.

use controller::{DutyScale, ReleaseShift};

/// Factors of the duty limits of both valves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DutyScales {
    pub(crate) fill: DutyScale,
    pub(crate) vent: DutyScale,
    /// Shift in place of the factor of a normally open vent valve.
    pub(crate) release: ReleaseShift,
}

impl DutyScales {
    pub(crate) const ONE: Self = Self {
        fill: DutyScale::ONE,
        vent: DutyScale::ONE,
        release: ReleaseShift::NONE,
    };
}
