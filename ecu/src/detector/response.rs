//! The pressure against the model of the valve commands.

use crate::config::Limits;
use crate::detector::Debounce;
use crate::fault::{Fault, FaultSet};
use crate::valve::Valves;

/// N \[samples\] with more than [`EXCESS_MAX`].
pub(crate) const RESPONSE_N: u8 = 3;
/// So far the pressure may stay behind, or ahead of, what the commands explain: 0.5 bar, 2⁻¹⁶. More than the noise of a burst of
/// ten times the sensor's, from peak to peak.
pub(crate) const EXCESS_MAX: i32 = 1 << 15;
/// The sums stop a little above, so that what is over is soon forgotten.
const EXCESS_END: i32 = EXCESS_MAX + (EXCESS_MAX >> 3);
/// What a shut chamber may do by itself in a sample: 5 mbar, 2⁻¹⁶. Leaks, and gas that takes the walls' temperature after it was
/// compressed: at most 15 % of a step within about two seconds.
pub(crate) const CREEP: i32 = 328;

/// Two cumulative sums of what no command explains (Page, Biometrika 41, 1954).
///
/// The model gives bounds, not a pressure: a valve that is open for sure moves the pressure by at least half of its rate times the
/// pressure difference across it, since choked and subsonic flow both do; one that is shut for sure moves it by the creep at most;
/// and one that may be either explains everything in its direction. Changes telescope in a sum, so noise adds up to no more than
/// its own height.
///
/// ```text
///   change   │  too little: vent valve shut for sure      too much: fill valve shut for sure
///  bounds    │  least = fill open for sure ? rise : 0       most = vent open for sure ? -fall : 0
///  per sample│  S ← max(0, S + least - creep - change)      S ← max(0, S + change - most - creep)
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct ResponseDetector {
    before: Option<i32>,
    too_little: Excess,
    too_much: Excess,
}

/// One of the sums \[bar\], 2⁻¹⁶, and what it stood for when it was too large.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Excess {
    sum: i32,
    debounce: Debounce,
    fault: Fault,
}

impl Excess {
    const fn new(fault: Fault) -> Self {
        Self {
            sum: 0,
            debounce: Debounce::CLEAR,
            fault,
        }
    }

    /// Adds what this sample leaves unexplained; none if a command explains anything in this direction.
    #[inline(always)]
    fn add(&mut self, unexplained: Option<i32>, fault: Fault, n: u8) {
        self.sum = match unexplained {
            // The sum and what is added are below 2²³.
            Some(unexplained) => self.sum.wrapping_add(unexplained).clamp(0, EXCESS_END),
            None => 0,
        };
        if !self.debounce.is_confirmed() {
            self.fault = fault;
        }
        self.debounce.update(self.sum > EXCESS_MAX, n);
    }

    #[inline(always)]
    fn faults(&self) -> FaultSet {
        FaultSet::when(self.debounce.is_confirmed(), self.fault)
    }
}

impl ResponseDetector {
    pub(crate) const NEW: Self = Self {
        before: None,
        too_little: Excess::new(Fault::NoRise),
        too_much: Excess::new(Fault::NoFall),
    };

    /// `pressure` \[bar\], 2⁻¹⁶; none in a sample whose code is not believed: the sums begin again with the next.
    #[inline(always)]
    pub(crate) fn sample(&mut self, limits: &Limits, valves: &Valves, pressure: Option<i32>) {
        let n = limits.mechanisms.samples(RESPONSE_N);
        let before = self.before;
        self.before = pressure;
        let (Some(before), Some(pressure)) = (before, pressure) else {
            self.too_little.add(None, Fault::NoRise, n);
            self.too_much.add(None, Fault::NoFall, n);
            return;
        };
        let Valves { fill, vent } = *valves;
        let settling = limits.settling;
        let change = pressure.wrapping_sub(before);

        let fill_is_shut = fill.is_shut(settling);
        let least = if fill.is_open(settling) {
            moved(limits.least_rise, limits.supply_min.wrapping_sub(pressure))
        } else {
            0
        };
        let too_little = if fill_is_shut {
            Fault::UncommandedFall
        } else if change < -CREEP {
            Fault::SupplyLost
        } else {
            Fault::NoRise
        };
        let missing = least.wrapping_sub(CREEP).wrapping_sub(change);
        let missing = vent.is_shut(settling).then_some(missing);
        self.too_little.add(missing, too_little, n);

        let vent_is_open = vent.is_open(settling);
        let fall = if vent_is_open {
            moved(limits.least_fall, pressure)
        } else {
            0
        };
        let too_much = if vent_is_open {
            Fault::NoFall
        } else {
            Fault::UncommandedRise
        };
        let surplus = change.wrapping_add(fall).wrapping_sub(CREEP);
        let surplus = fill_is_shut.then_some(surplus);
        self.too_much.add(surplus, too_much, n);
    }

    #[inline(always)]
    pub(crate) fn faults(&self) -> FaultSet {
        self.too_little.faults().union(self.too_much.faults())
    }
}

/// What an open valve moves in a sample, at least: `share` [2⁻³²] of the pressure difference across it.
#[inline(always)]
fn moved(share: i32, difference: i32) -> i32 {
    ((i64::from(share).wrapping_mul(i64::from(difference.max(0)))) >> 32) as i32
}
