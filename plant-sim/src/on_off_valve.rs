//! On/off valve without a coil: a command moves it after a delay, and it opens and closes along a ramp (E62).

use crate::description::OnOffValveParameters;

/// Switching of an on/off valve: what moves it, and when.
///
/// A command must stand for the opening delay until the valve begins to open, and a pause for the closing delay until it begins to close.
/// Shorter pulses and pauses change nothing.
#[derive(Debug, Clone, PartialEq)]
pub struct Switching {
    /// Opening and closing delay (ns).
    delays_ns: [u64; 2],
    /// Time of the whole way open and closed (s).
    ramps_s: [f64; 2],
    is_opening: bool,
    is_commanded: bool,
    /// Instant at which the valve turns to what is commanded, if it does not yet (ns).
    turns_ns: Option<u64>,
}

impl Switching {
    /// Creates a valve that is closed.
    pub(crate) fn new(parameters: &OnOffValveParameters) -> Self {
        Self {
            delays_ns: parameters.delays_ns(),
            ramps_s: [parameters.opening_ramp_s, parameters.closing_ramp_s],
            is_opening: false,
            is_commanded: false,
            turns_ns: None,
        }
    }

    /// Takes over the output at `now_ns`; returns the velocity of a valve that turns now, in its whole way per second: positive if it
    /// opens.
    pub(crate) fn update(&mut self, now_ns: u64, is_commanded: bool) -> Option<f64> {
        if is_commanded != self.is_commanded {
            self.is_commanded = is_commanded;
            let delay_ns = self.delays_ns[usize::from(!is_commanded)];
            self.turns_ns = (is_commanded != self.is_opening).then(|| now_ns + delay_ns);
        }
        self.turns_ns.take_if(|turns_ns| *turns_ns <= now_ns)?;
        self.is_opening = is_commanded;
        Some(match is_commanded {
            true => self.ramps_s[0].recip(),
            false => -self.ramps_s[1].recip(),
        })
    }

    /// Returns the instant at which the valve turns next, if the output does not change before (ns).
    pub(crate) fn next_turn_ns(&self) -> Option<u64> {
        self.turns_ns
    }
}
