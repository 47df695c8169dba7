//! Settings, checked once and multiplied out.

use controller::Config;

use crate::error::EcuConfigError;
use crate::settings::{EcuSettings, VentValve};

/// An ECU that can run: the proof that its [`EcuSettings`] are within bounds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EcuConfig {
    pub(crate) controller: Config,
    pub(crate) vent_valve: VentValve,
}

impl EcuConfig {
    /// Checks every field; also at compile time.
    ///
    /// # Errors
    /// The first field that is out of bounds, with its value and the bound.
    pub const fn new(settings: &EcuSettings) -> Result<Self, EcuConfigError> {
        let controller = match Config::new(&settings.controller) {
            Ok(controller) => controller,
            Err(error) => return Err(EcuConfigError::Controller(error)),
        };
        Ok(Self {
            controller,
            vent_valve: settings.vent_valve,
        })
    }
}
