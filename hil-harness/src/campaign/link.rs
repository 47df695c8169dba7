//! Faults of the messages with the reference, as the ECU's receiver passes them on.
//!
//! A message with a wrong checksum counts as missing. The robustness of the frames between harness and target is tested
//! in `hil-protocol`.

use super::chance::{Chance, chance, uniform};
use super::fault::link::LinkFault;
use super::injection::Injection;
use super::injector::{Injector, Now};
use crate::random::Random;
use crate::wire::{Sensors, reference_bits};

/// Longest delay of a message (samples).
const LATE_MAX: f64 = 20.0;

/// Link with one fault.
pub(super) struct Broken {
    fault: LinkFault,
    severity: f64,
    random: Random,
    /// All messages sent so far.
    sent: Vec<Option<i32>>,
}

impl Broken {
    pub(super) fn new(fault: LinkFault, injection: &Injection) -> Self {
        Self {
            fault,
            severity: injection.severity(),
            random: chance(injection.seed, Chance::Fault),
            sent: Vec::new(),
        }
    }

    /// Returns the message of some samples ago.
    fn earlier(&self, samples: usize) -> Option<i32> {
        let last = self.sent.len().checked_sub(1 + samples)?;
        *self.sent.get(last)?
    }
}

impl Injector for Broken {
    fn sense(&mut self, now: Now, sensors: &mut Sensors) {
        self.sent.push(sensors.reference);
        let Some(age) = now.age else { return };
        let draw = uniform(&self.random, u64::from(now.sample));
        sensors.reference = match self.fault {
            LinkFault::Lost if draw > self.severity => sensors.reference,
            LinkFault::Lost | LinkFault::Silent => None,
            LinkFault::Corrupt => {
                let far = if draw < 0.5 {
                    -2.0 - 20.0 * draw
                } else {
                    20.0 * (1.0 + draw)
                };
                Some(reference_bits(far))
            }
            LinkFault::Duplicate => self.earlier((age % 2) as usize),
            // The second message of each pair arrives in its own period, the first in the next one.
            LinkFault::Reordered => self.earlier(if age % 2 == 1 { 0 } else { 2 }),
            LinkFault::Late => self.earlier(1 + (LATE_MAX * self.severity) as usize),
        };
    }
}
