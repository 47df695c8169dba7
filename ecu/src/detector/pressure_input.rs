//! The pressure of a sample, and whether it can be believed.

use controller::{Output, Pressure};

use crate::config::Limits;
use crate::detector::Debounce;
use crate::detector::jump::jumped;
use crate::detector::range::out_of_range;
use crate::detector::stuck::StuckDetector;
use crate::fault::{Fault, FaultSet};
use crate::sensor::{PressureSensor, SensorCode};

/// N \[samples\] that cannot be believed, for whatever reason: a loose plug gives all of them in turn.
pub(crate) const DOUBT_N: u8 = 5;

/// Missing codes, codes out of range, jumps, and codes that are stuck.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct PressureInput {
    doubt: Debounce,
    /// Why the sample was not believed that confirmed the fault.
    reason: Fault,
    /// The last pressure that was believed; none before the first.
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

    /// The pressure, if this sample's code can be believed. `opening` is what the valves were told last.
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
        // A jump that was reported is where the pressure comes back from; a code out of range is no pressure to come from.
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
