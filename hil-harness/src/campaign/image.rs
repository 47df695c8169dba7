//! Faults of the running image: its memory, its program, resets of the machine.

use super::chance::{Chance, chance};
use super::fault::image::ImageFault;
use super::injection::Injection;
use super::injector::{Injector, Now};
use super::target::{Accident, Target};
use crate::device::DutError;
use crate::random::Random;

/// Image with one fault.
pub(super) struct Broken {
    fault: ImageFault,
    random: Random,
}

impl Broken {
    pub(super) fn new(fault: ImageFault, injection: &Injection) -> Self {
        Self {
            fault,
            random: chance(injection.seed, Chance::Fault),
        }
    }
}

impl Injector for Broken {
    fn is_powered(&self, now: Now) -> bool {
        self.fault != ImageFault::WarmReset || now.age.is_none()
    }

    fn disturb(&mut self, now: Now, target: &mut dyn Target) -> Result<bool, DutError> {
        let draw = self.random.bits(now.sample.into());
        let accident = match self.fault {
            ImageFault::FlipVariables => Accident::FlippedVariable(draw),
            ImageFault::FlipStack => Accident::FlippedStack(draw),
            ImageFault::Hang => Accident::Hang,
            ImageFault::Trap => Accident::Trap,
            ImageFault::WarmReset => return Ok(false),
        };
        if now.age == Some(0) {
            target.suffer(accident)?;
        }
        Ok(false)
    }
}
