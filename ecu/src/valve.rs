//! Estimated state of the valves, from their commands.

use controller::{Duty, Output};

use crate::config::OpenDuties;
use crate::history::{History, Window};

/// Command history of a valve.
///
/// The valve is certainly shut after the settling time without a command, and certainly open after the settling time at
/// its open duty cycle or more. In between its state is unknown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Valve {
    shut: History,
    open: History,
}

impl Valve {
    /// History after a reset: earlier commands are unknown.
    pub(crate) const UNKNOWN: Self = Self {
        shut: History::UNKNOWN,
        open: History::UNKNOWN,
    };

    /// Records the duty cycle that was just commanded; `open` is the valve's open duty cycle (%), 2⁻¹⁶.
    #[inline(always)]
    fn record(&mut self, opening: Duty, open: i32) {
        self.shut.push(opening.is_off());
        self.open.push(opening.to_bits() >= open);
    }

    #[inline(always)]
    pub(crate) const fn is_shut(self, settling: Window) -> bool {
        self.shut.held_through(settling)
    }

    #[inline(always)]
    pub(crate) const fn is_open(self, settling: Window) -> bool {
        self.open.held_through(settling)
    }
}

/// Fill and vent valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Valves {
    pub(crate) fill: Valve,
    pub(crate) vent: Valve,
}

impl Valves {
    pub(crate) const UNKNOWN: Self = Self {
        fill: Valve::UNKNOWN,
        vent: Valve::UNKNOWN,
    };

    /// Records the commands that were just given to the valves.
    #[inline(always)]
    pub(crate) fn record(&mut self, open: OpenDuties, opening: Output) {
        self.fill.record(opening.duty_fill, open.fill);
        self.vent.record(opening.duty_vent, open.vent);
    }
}

#[cfg(test)]
mod tests {
    use controller::fixed::types::I16F16;

    use super::*;

    const OPEN: i32 = I16F16::lit("70").to_bits();

    fn after(commands: &[(&str, usize)]) -> Valve {
        let mut valve = Valve::UNKNOWN;
        for &(percent, samples) in commands {
            let duty = Duty::from_percent(percent.parse().unwrap()).unwrap();
            for _ in 0..samples {
                valve.record(duty, OPEN);
            }
        }
        valve
    }

    #[test]
    fn a_valve_is_shut_or_open_for_sure_after_the_settling_time_and_not_before() {
        let settling = Window::last(5);
        for (samples, expected) in [(4, false), (5, true), (6, true), (1000, true)] {
            let (shut, open) = (after(&[("0", samples)]), after(&[("70", samples)]));
            assert_eq!(shut.is_shut(settling), expected, "{samples}");
            assert_eq!(open.is_open(settling), expected, "{samples}");
            assert!(!shut.is_open(settling) && !open.is_shut(settling));
        }
    }

    #[test]
    fn below_its_open_duty_a_valve_is_neither_shut_nor_open() {
        for percent in ["0.00002", "69.9999"] {
            let valve = after(&[("0", 20), ("100", 20), (percent, 1)]);
            let last = Window::last(1);
            assert!(!valve.is_shut(last) && !valve.is_open(last), "{percent}");
        }
    }
}
