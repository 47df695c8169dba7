//! Detector of a control task that runs too early or too late.

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};

/// Debounce count N of the sample time (samples).
const SAMPLE_TIME_N: u8 = Fault::SampleTime.samples();

/// Detector of a time between samples outside half to twice the sample time. The loop works within this range.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::bench_limits;

    #[test]
    fn n_samples_out_of_time_confirm_and_one_less_does_not() {
        let out_of_time = FaultSet::of(Fault::SampleTime);
        for (samples, late) in [(2, FaultSet::NONE), (3, out_of_time), (4, out_of_time)] {
            for (elapsed_us, expected) in [
                (0, late),
                (4_999, late),
                (5_000, FaultSet::NONE),
                (10_000, FaultSet::NONE),
                (20_000, FaultSet::NONE),
                (20_001, late),
                (u32::MAX, late),
            ] {
                let mut detector = SampleTimeDetector::NEW;
                for _ in 0..samples {
                    detector.sample(&bench_limits(), elapsed_us);
                }
                assert_eq!(detector.faults(), expected, "{elapsed_us} us, {samples}");
            }
        }
    }
}
