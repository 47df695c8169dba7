//! Figures of a candidate: counted over the trace, and proved from the linked code for any input.

use super::candidate::{Candidate, Duty};
use super::code::Code;
use super::counted::Counted;
use super::longest_path::longest_path;
use super::reach::{Reach, reach};
use super::stack_bound::stack_bound;
use super::unbounded::Unbounded;

/// Figures of one candidate.
#[derive(Debug)]
pub(crate) struct Figures {
    pub(crate) candidate: &'static Candidate,
    pub(crate) counted: Counted,
    /// Largest number of instructions of a call.
    pub(crate) proved: Result<u32, Unbounded>,
    /// Largest stack of a call (bytes).
    pub(crate) stack: Result<u32, Unbounded>,
    pub(crate) reach: Reach,
}

impl Figures {
    /// Returns the figures for the bench's counts; `None` for an unknown candidate.
    pub(crate) fn of(code: &Code, counted: Counted) -> Option<Self> {
        Some(Self {
            candidate: Candidate::named(&counted.name)?,
            proved: longest_path(code, counted.entry),
            stack: stack_bound(code, counted.entry),
            reach: reach(code, counted.entry),
            counted,
        })
    }

    /// Returns the largest difference of a duty cycle from the project's own controller (%); both should have the same
    /// output.
    pub(crate) fn deviation_pct(&self) -> Option<f64> {
        let comparable = self.candidate.duty == Duty::FullStep;
        comparable.then(|| f64::from(self.counted.deviation) / 65_536.0)
    }
}
