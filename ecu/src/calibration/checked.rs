//! Checked settings.

use crate::config::EcuConfig;
use crate::error::EcuConfigError;
use crate::settings::EcuSettings;

/// Settings that passed every check, with the configuration computed from them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CheckedSettings {
    settings: EcuSettings,
    config: EcuConfig,
}

impl CheckedSettings {
    /// Checks the settings; also at compile time, where wrong settings are a compile error.
    ///
    /// # Errors
    /// Returns the first field that is out of bounds, with its value and the bound.
    pub const fn new(settings: &EcuSettings) -> Result<Self, EcuConfigError> {
        match EcuConfig::new(settings) {
            Ok(config) => Ok(Self {
                settings: *settings,
                config,
            }),
            Err(error) => Err(error),
        }
    }

    /// Returns the settings.
    pub const fn settings(&self) -> &EcuSettings {
        &self.settings
    }

    /// Returns the configuration computed from the settings.
    pub const fn config(&self) -> EcuConfig {
        self.config
    }
}
