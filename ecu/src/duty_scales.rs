//! Factors of the duty limits in a sample.

use controller::DutyScale;

/// Factors of the duty limits of both valves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct DutyScales {
    pub(crate) fill: DutyScale,
    pub(crate) vent: DutyScale,
}

impl DutyScales {
    pub(crate) const ONE: Self = Self {
        fill: DutyScale::ONE,
        vent: DutyScale::ONE,
    };
}
