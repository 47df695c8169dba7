//! Settings, checked once and multiplied out.

use crate::anti_windup::AntiWindup;
use crate::boost::Boost;
use crate::distributor::Distributor;
use crate::error::ConfigError;
use crate::pid::Pid;
use crate::prediction::Prediction;
use crate::settings::{IntegralAtReference, Settings};
use crate::tolerance::Tolerance;

/// A controller that can run: the proof that its [`Settings`] are within bounds, and the coefficients they lead to.
///
/// Only whole words; no division is left for the sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    pub(crate) tolerance: Tolerance,
    pub(crate) prediction: Prediction,
    pub(crate) boost: Boost,
    pub(crate) pid: Pid,
    pub(crate) anti_windup: AntiWindup,
    pub(crate) clears_integral: bool,
    pub(crate) distributor: Distributor,
}

impl Config {
    /// Checks every field and every coefficient.
    ///
    /// # Errors
    /// The first field that is out of bounds, with its value and the bound ([`ConfigError`]).
    pub fn new(settings: &Settings) -> Result<Self, ConfigError> {
        Ok(Self {
            pid: Pid::new(settings)?,
            anti_windup: AntiWindup::new(settings)?,
            tolerance: Tolerance::new(settings)?,
            prediction: Prediction::new(settings),
            boost: Boost::new(settings)?,
            clears_integral: matches!(settings.integral_at_reference, IntegralAtReference::Clear),
            distributor: Distributor::new(settings)?,
        })
    }
}
