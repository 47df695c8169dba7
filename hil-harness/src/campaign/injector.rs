//! Effect of a fault on the signals around the target.

use super::target::Target;
use crate::device::DutError;
use crate::wire::{Actuators, Sensors};
use crate::world::World;

/// Present sample and age of the fault.
#[derive(Clone, Copy, Debug)]
pub(super) struct Now {
    /// Number of the sample.
    pub(super) sample: u32,
    /// Age of the fault (samples), from 0; `None` while it is absent.
    pub(super) age: Option<u32>,
}

/// Active fault. Each method does nothing unless the fault needs it.
pub(super) trait Injector {
    /// Returns whether the ECU has its supply in this sample.
    fn is_powered(&self, _: Now) -> bool {
        true
    }

    /// Changes the sensors that the target gets.
    fn sense(&mut self, _: Now, _: &mut Sensors) {}

    /// Acts on the target itself, before the sample. Returns whether its memory is damaged from now on.
    ///
    /// # Errors
    /// Returns an error if the target cannot be reached.
    fn disturb(&mut self, _: Now, _: &mut dyn Target) -> Result<bool, DutError> {
        Ok(false)
    }

    /// Applies the duty cycles of the coils to the plant until the next sample; a fault may change them.
    fn actuate(&mut self, _: Now, world: &mut World<'_>, actuators: Actuators) {
        world.actuate(actuators);
    }
}
