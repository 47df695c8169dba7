//! Pressure of a sample, with its plausibility check.

use controller::{Output, Pressure};

use crate::config::Limits;
use crate::detector::Debounce;
use crate::detector::jump::jumped;
use crate::detector::range::out_of_range;
use crate::detector::stuck::StuckDetector;
use crate::fault::{Fault, FaultSet};
use crate::sensor::{PressureSensor, SensorCode};

/// Debounce count N of an implausible code (samples), common to all reasons: a loose plug causes all of them in turn.
const DOUBT_N: u8 = Fault::SensorOpen.samples();

/// Plausibility check of the pressure: missing codes, codes out of range, jumps, and stuck codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct PressureInput {
    doubt: Debounce,
    /// Reason of the implausible sample that confirmed the fault.
    reason: Fault,
    /// Last plausible pressure; `None` before the first.
    believed: Option<Pressure>,
    stuck: StuckDetector,
}

impl PressureInput {
    pub(crate) const NEW: Self = Self {
        doubt: Debounce::CLEAR,
        reason: Fault::SensorMissing,
        believed: None,
        stuck: StuckDetector::NEW,
    };

    /// Returns the pressure, if this sample's code is plausible. `opening` is the last command to the valves.
    #[inline(always)]
    pub(crate) fn sample(
        &mut self,
        limits: &Limits,
        opening: Output,
        code: Option<SensorCode>,
    ) -> Option<Pressure> {
        let Some(code) = code else {
            self.judge(limits, Some(Fault::SensorMissing));
            return None;
        };
        let pressure = PressureSensor::pressure(code);
        self.stuck.sample(limits, opening, code, pressure);
        let outside = out_of_range(limits, code, pressure);
        let wrong = outside.or_else(|| jumped(limits, self.believed, pressure));
        self.judge(limits, wrong);
        // After a confirmed jump the new pressure is the starting point; a code out of range is not a valid starting
        // point.
        if wrong.is_none() || self.doubt.is_confirmed() && outside.is_none() {
            self.believed = Some(pressure);
        }
        wrong.is_none().then_some(pressure)
    }

    #[inline(always)]
    fn judge(&mut self, limits: &Limits, wrong: Option<Fault>) {
        if let Some(reason) = wrong
            && !self.doubt.is_confirmed()
        {
            self.reason = reason;
        }
        let n = limits.mechanisms.samples(DOUBT_N);
        self.doubt.update(wrong.is_some(), n);
    }

    #[inline(always)]
    pub(crate) fn faults(&self, limits: &Limits) -> FaultSet {
        let doubt = FaultSet::when(self.doubt.is_confirmed(), self.reason);
        doubt.union(self.stuck.faults(limits))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detector::bench_limits;

    fn shown(input: &mut PressureInput, bits: Option<u16>) -> Option<Pressure> {
        let code = bits.map(|bits| SensorCode::from_bits(bits).unwrap());
        input.sample(&bench_limits(), Output::OFF, code)
    }

    fn faults(input: &PressureInput) -> FaultSet {
        input.faults(&bench_limits())
    }

    /// Returns an input whose last plausible code is 1000.
    fn sound() -> PressureInput {
        let mut input = PressureInput::NEW;
        assert!(shown(&mut input, Some(1000)).is_some());
        input
    }

    #[test]
    fn n_doubtful_samples_confirm_their_reason_and_one_less_does_not() {
        for (bits, fault) in [
            (None, Fault::SensorMissing),
            (Some(0), Fault::SensorOpen),
            (Some(20), Fault::SensorBelowRange),
            (Some(3000), Fault::SensorAboveRange),
            (Some(4095), Fault::SensorShort),
            (Some(1800), Fault::SensorJump),
        ] {
            let mut input = sound();
            for sample in 1..=5 {
                assert_eq!(shown(&mut input, bits), None, "{fault:?} is believed");
                let expected = FaultSet::when(sample >= 5, fault);
                assert_eq!(faults(&input), expected, "{fault:?}, {sample}");
            }
            shown(&mut input, bits);
            assert_eq!(faults(&input), FaultSet::of(fault), "{fault:?}, 6");
        }
    }

    #[test]
    fn different_doubts_in_a_row_are_one_fault_named_after_the_last() {
        let mut input = sound();
        for bits in [None, Some(0), Some(4095), None] {
            shown(&mut input, bits);
            assert_eq!(faults(&input), FaultSet::NONE);
        }
        shown(&mut input, Some(20));
        assert_eq!(faults(&input), FaultSet::of(Fault::SensorBelowRange));
        shown(&mut input, None);
        assert_eq!(faults(&input), FaultSet::of(Fault::SensorBelowRange));
    }

    #[test]
    fn n_sound_samples_and_the_fault_is_gone() {
        let mut input = sound();
        for _ in 0..20 {
            shown(&mut input, None);
        }
        for sample in 1..=5 {
            assert!(shown(&mut input, Some(1000)).is_some());
            assert_eq!(faults(&input).is_empty(), sample == 5, "{sample}");
        }
    }

    #[test]
    fn after_a_reported_jump_the_new_pressure_is_where_it_goes_on() {
        let mut input = sound();
        for _ in 0..5 {
            assert_eq!(shown(&mut input, Some(1800)), None);
        }
        assert!(shown(&mut input, Some(1800)).is_some());
        assert!(faults(&input).contains(Fault::SensorJump));
        assert_eq!(shown(&mut input, Some(1000)), None);
    }

    #[test]
    fn a_code_out_of_range_is_never_where_it_goes_on() {
        let mut input = sound();
        for _ in 0..20 {
            shown(&mut input, Some(0));
        }
        assert!(shown(&mut input, Some(1001)).is_some());
        for _ in 0..20 {
            shown(&mut input, Some(4095));
        }
        assert!(shown(&mut input, Some(1002)).is_some());
    }

    #[test]
    fn a_single_spike_is_not_believed_and_what_follows_is() {
        let mut input = sound();
        assert_eq!(shown(&mut input, Some(1800)), None);
        assert!(shown(&mut input, Some(1003)).is_some());
        assert_eq!(faults(&input), FaultSet::NONE);
    }
}
