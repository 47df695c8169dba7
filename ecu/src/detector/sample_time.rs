//! Whether the control task runs when it should.

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};

/// N \[samples\].
pub(crate) const SAMPLE_TIME_N: u8 = 3;

/// Time between samples outside half to twice the sample time. Inside, the loop works.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct SampleTimeDetector(Debounce);

impl SampleTimeDetector {
    pub(crate) const NEW: Self = Self(Debounce::CLEAR);

    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, elapsed_us: u32) {
        let in_time = elapsed_us >= limits.elapsed_min_us && elapsed_us <= limits.elapsed_max_us;
        let n = limits.mechanisms.samples(SAMPLE_TIME_N);
        self.0.update(!in_time, n);
    }

    #[inline(always)]
    pub(crate) fn faults(&self) -> FaultSet {
        FaultSet::when(self.0.is_confirmed(), Fault::SampleTime)
    }
}
