//! Everything known about a candidate: counted over the trace, and proved from the linked code for any input.

use super::candidate::{Candidate, Duty};
use super::code::Code;
use super::counted::Counted;
use super::longest_path::longest_path;
use super::reach::{Reach, reach};
use super::stack_bound::stack_bound;
use super::unbounded::Unbounded;

/// The figures of one candidate.
#[derive(Debug)]
pub(crate) struct Figures {
    pub(crate) candidate: &'static Candidate,
    pub(crate) counted: Counted,
    /// The most instructions of a call.
    pub(crate) proved: Result<u32, Unbounded>,
    /// The most stack of a call (bytes).
    pub(crate) stack: Result<u32, Unbounded>,
    pub(crate) reach: Reach,
}

impl Figures {
    /// Of what the bench counted; nothing if nobody knows the candidate.
    pub(crate) fn of(code: &Code, counted: Counted) -> Option<Self> {
        Some(Self {
            candidate: Candidate::named(&counted.name)?,
            proved: longest_path(code, counted.entry),
            stack: stack_bound(code, counted.entry),
            reach: reach(code, counted.entry),
            counted,
        })
    }

    /// Largest difference of a duty cycle from the project's own controller [%], where both should be the same.
    pub(crate) fn deviation_pct(&self) -> Option<f64> {
        let comparable = self.candidate.duty == Duty::FullStep;
        comparable.then(|| f64::from(self.counted.deviation) / 65_536.0)
    }
}
