//! Configuration: checked settings, converted into coefficients.

use crate::anti_windup::Tracking;
use crate::boost::Boost;
use crate::compensation::SupplyCompensation;
use crate::distributor::Distributor;
use crate::error::ConfigError;
use crate::pid::Pid;
use crate::pulses::PulseConfig;
use crate::range::propagate;
use crate::settings::Settings;
use crate::structure::Structure;
use crate::tolerance::Tolerance;

/// Runnable controller: the proof that its [`Settings`] are within bounds, and the coefficients computed from them.
///
/// It consists of integers only; a sample contains no division.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Config {
    pub(crate) structure: Structure,
    pub(crate) coefficients: Coefficients,
    compensation: Option<SupplyCompensation>,
    pulses: Option<PulseConfig>,
}

/// Numeric coefficients of a controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Coefficients {
    pub(crate) tolerance: Tolerance,
    pub(crate) boost: Boost,
    pub(crate) pid: Pid,
    pub(crate) tracking: Tracking,
    pub(crate) distributor: Distributor,
}

impl Config {
    /// Checks every field and every coefficient.
    ///
    /// It also runs at compile time: a wrong setting is then a compile error, and the compiler removes mechanisms that
    /// are not chosen:
    /// ```
    /// use controller::{Config, Settings};
    /// const CONFIG: Config = match Config::new(&Settings::thesis()) {
    ///     Ok(config) => config,
    ///     Err(_) => panic!("settings out of bounds"),
    /// };
    /// ```
    ///
    /// # Errors
    /// Returns the first field that is out of bounds, with its value and the bound ([`ConfigError`]).
    pub const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        Ok(Self {
            structure: Structure::of(settings),
            coefficients: Coefficients {
                pid: propagate!(Pid::new(settings)),
                tracking: propagate!(Tracking::new(settings)),
                tolerance: propagate!(Tolerance::new(settings)),
                boost: propagate!(Boost::new(settings)),
                distributor: propagate!(Distributor::new(settings)),
            },
            compensation: propagate!(SupplyCompensation::new(settings)),
            pulses: propagate!(PulseConfig::new(settings)),
        })
    }

    /// Returns the compensation of the duty limits for supply voltage and coil resistance; `None`: off.
    ///
    /// The caller, who knows both, applies it to each output ([`Output::scaled`](crate::Output::scaled)).
    #[inline(always)]
    pub const fn compensation(&self) -> Option<&SupplyCompensation> {
        self.compensation.as_ref()
    }

    /// Returns the model-based pulses; `None`: the PID controller drives the valves.
    ///
    /// The caller, who knows the conditions of the coils, runs them ([`pulse_step`](crate::pulse_step)).
    #[inline(always)]
    pub const fn pulses(&self) -> Option<&PulseConfig> {
        self.pulses.as_ref()
    }
}
