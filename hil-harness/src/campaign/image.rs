//! Faults of the running image: its memory, its program, resets of the machine.

use super::chance::{Chance, chance};
use super::class::named;
use super::injection::Injection;
use super::injector::{Injector, Now};
use super::target::{Accident, Target};
use crate::device::DutError;
use crate::random::Random;

named! {
    /// A fault of the image on its machine.
    ImageFault {
        /// A bit of the static variables flips.
        FlipVariables = "flip-variables",
        /// A bit of the stack flips, where the ECU's state is as well.
        FlipStack = "flip-stack",
        /// The main loop stands still, until the watchdog bites.
        Hang = "hang",
        /// An instruction that there is not.
        Trap = "trap",
        /// The machine is reset while its memory stays, and is without current for the time of the fault.
        WarmReset = "warm-reset",
    }
}

/// An image with one thing broken.
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
