//! Settings that are possible.

use crate::config::EcuConfig;
use crate::error::EcuConfigError;
use crate::settings::EcuSettings;

/// Settings that passed every check, with the configuration that they lead to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CheckedSettings {
    settings: EcuSettings,
    config: EcuConfig,
}

impl CheckedSettings {
    /// Checks them; also at compile time, where wrong ones are a compile error.
    ///
    /// # Errors
    /// The first field that is out of bounds, with its value and the bound.
    pub const fn new(settings: &EcuSettings) -> Result<Self, EcuConfigError> {
        match EcuConfig::new(settings) {
            Ok(config) => Ok(Self {
                settings: *settings,
                config,
            }),
            Err(error) => Err(error),
        }
    }

    /// The settings.
    pub const fn settings(&self) -> &EcuSettings {
        &self.settings
    }

    /// What they lead to.
    pub const fn config(&self) -> EcuConfig {
        self.config
    }
}
