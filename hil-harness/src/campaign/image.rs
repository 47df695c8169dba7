//! Faults of the running image: its memory, and resets of the machine.

use super::chance::{Chance, chance};
use super::class::named;
use super::injection::Injection;
use super::injector::{Injector, Now};
use super::target::{Region, Target};
use crate::device::DutError;
use crate::random::Random;

named! {
    /// A fault of the image on its machine.
    ImageFault {
        /// A bit of the variables flips.
        FlipVariables = "flip-variables",
        /// A bit of the stack flips.
        FlipStack = "flip-stack",
        /// A bit of the stored settings flips, and the machine starts again.
        FlipSettings = "flip-settings",
        /// The machine is reset while its memory stays.
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

    fn restarts(&self) -> bool {
        matches!(self.fault, ImageFault::FlipSettings | ImageFault::WarmReset)
    }
}

impl Injector for Broken {
    fn is_powered(&self, now: Now) -> bool {
        !(self.restarts() && now.age.is_some())
    }

    fn disturb(&mut self, now: Now, target: &mut dyn Target) -> Result<bool, DutError> {
        let region = match self.fault {
            ImageFault::FlipVariables => Region::Variables,
            ImageFault::FlipStack => Region::Stack,
            ImageFault::FlipSettings => Region::Settings,
            ImageFault::WarmReset => return Ok(false),
        };
        if now.age == Some(0) {
            target.flip(region, &|counter| self.random.bits(counter))?;
        }
        Ok(false)
    }
}
