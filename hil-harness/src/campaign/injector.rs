//! What a fault does to the signals around the target.

use super::target::Target;
use crate::device::DutError;
use crate::wire::{Actuators, Sensors};
use crate::world::World;

/// When and how a fault acts.
#[derive(Clone, Copy, Debug)]
pub(super) struct Now {
    /// The sample.
    pub(super) sample: u32,
    /// How long the fault has been there \[samples\], from 0; none while it is not.
    pub(super) age: Option<u32>,
}

/// A fault at work. Each part does nothing unless the fault needs it.
pub(super) trait Injector {
    /// Whether the ECU has its supply in this sample.
    fn is_powered(&self, _: Now) -> bool {
        true
    }

    /// What the target gets instead of these sensors.
    fn sense(&mut self, _: Now, _: &mut Sensors) {}

    /// Acts on the target itself, before the sample. Whether its memory is damaged from now on.
    ///
    /// # Errors
    /// The target cannot be reached.
    fn disturb(&mut self, _: Now, _: &mut dyn Target) -> Result<bool, DutError> {
        Ok(false)
    }

    /// Until the next sample the plant gets what the coils get, unless something is broken.
    fn actuate(&mut self, _: Now, world: &mut World<'_>, actuators: Actuators) {
        world.actuate(actuators);
    }
}
