//! The pressure of a sample, and whether it can be believed.

use controller::{Output, Pressure};

use crate::config::EcuConfig;
use crate::detector::Debounce;
use crate::detector::jump::jumped;
use crate::detector::range::out_of_range;
use crate::detector::stuck::{STUCK_N, StuckDetector};
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
        config: &EcuConfig,
        opening: Output,
        code: Option<SensorCode>,
    ) -> Option<Pressure> {
        let Some(code) = code else {
            self.judge(config, Some(Fault::SensorMissing));
            return None;
        };
        let limits = &config.limits;
        let pressure = PressureSensor::pressure(code);
        let stuck_limit = config.mechanisms.limit(STUCK_N);
        self.stuck
            .sample(limits, opening, code, pressure, stuck_limit);
        let outside = out_of_range(limits, code, pressure);
        let wrong = outside.or_else(|| jumped(limits, self.believed, pressure));
        let is_confirmed = self.judge(config, wrong);
        // A jump that was reported is where the pressure comes back from; a code out of range is no pressure to come from.
        if wrong.is_none() || is_confirmed && outside.is_none() {
            self.believed = Some(pressure);
        }
        wrong.is_none().then_some(pressure)
    }

    #[inline(always)]
    fn judge(&mut self, config: &EcuConfig, wrong: Option<Fault>) -> bool {
        let limit = config.mechanisms.limit(DOUBT_N);
        if let Some(reason) = wrong
            && !self.doubt.is_confirmed(limit)
        {
            self.reason = reason;
        }
        self.doubt.update(wrong.is_some(), limit);
        self.doubt.is_confirmed(limit)
    }

    #[inline(always)]
    pub(crate) fn faults(&self, config: &EcuConfig) -> FaultSet {
        let mechanisms = config.mechanisms;
        FaultSet::when(
            self.doubt.is_confirmed(mechanisms.limit(DOUBT_N)),
            self.reason,
        )
        .union(self.stuck.faults(mechanisms.limit(STUCK_N)))
    }
}
