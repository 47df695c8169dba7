//! What a campaign breaks: a device under test, and what can be done to it beyond the wire.

use ecu::{Ecu, EcuConfig, EcuSettings, Inputs, ResetCause};

use super::class::FaultClass;
use super::ecu::EcuFault;
use crate::device::{DutError, plausible};
use crate::wire::{Answer, Sensors};

/// A device under test of a campaign.
pub trait Target {
    /// What it is; for the record.
    fn identity(&self) -> String;

    /// With these settings, in the state after power-on.
    ///
    /// # Errors
    /// The device cannot be reached, or the settings are out of bounds.
    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError>;

    /// One sample; the actuators are what the coils get, whatever the device says of them.
    ///
    /// # Errors
    /// The device did not answer.
    fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError>;

    /// After a reset, with the settings that it had.
    ///
    /// # Errors
    /// The device did not come back.
    fn restart(&mut self) -> Result<(), DutError>;

    /// A mechanic asks for the release of a locked ECU. Whether it was granted.
    ///
    /// # Errors
    /// The device cannot be reached.
    fn release(&mut self) -> Result<bool, DutError>;

    /// Whether this target can be broken in this way.
    fn breaks(&self, class: FaultClass) -> bool;

    /// Damages what the ECU remembers. Whether it now has to know that its memory is damaged.
    ///
    /// # Errors
    /// The device cannot be reached.
    fn damage(&mut self, _: EcuFault) -> Result<bool, DutError> {
        Ok(false)
    }

    /// Flips one bit of its memory, which `draw` chooses.
    ///
    /// # Errors
    /// The device cannot be reached.
    fn flip(&mut self, _: Region, _draw: &dyn Fn(u64) -> u64) -> Result<(), DutError> {
        Ok(())
    }
}

/// A part of an image's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Region {
    /// Static variables.
    Variables,
    /// The stack.
    Stack,
    /// The stored settings.
    Settings,
}

/// Damages an ECU in this process; whether it could.
pub type Damage = fn(&mut Ecu, EcuFault) -> bool;

/// The ECU in this process, whole or with something taken away.
pub struct InProcessTarget {
    alter: Box<dyn Fn(EcuConfig) -> EcuConfig>,
    damage: Option<Damage>,
    config: EcuConfig,
    ecu: Ecu,
}

impl InProcessTarget {
    /// The ECU as it is.
    pub fn whole() -> Self {
        Self::altered(|config| config)
    }

    /// The ECU with `alter`ed configurations: one that has lost a mechanism.
    pub fn altered(alter: impl Fn(EcuConfig) -> EcuConfig + 'static) -> Self {
        let config = alter(BENCH);
        let ecu = Ecu::new(config, ResetCause::PowerOn);
        Self {
            alter: Box::new(alter),
            damage: None,
            config,
            ecu,
        }
    }

    /// The same with a way to damage its memory.
    #[must_use]
    pub fn damaged_by(self, damage: Damage) -> Self {
        Self {
            damage: Some(damage),
            ..self
        }
    }
}

const BENCH: EcuConfig = match EcuConfig::new(&EcuSettings::bench()) {
    Ok(config) => config,
    Err(_) => panic!("the settings of the bench are impossible"),
};

impl Target for InProcessTarget {
    fn identity(&self) -> String {
        concat!("ecu ", env!("CARGO_PKG_VERSION"), " in process").to_owned()
    }

    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError> {
        self.config = (self.alter)(EcuConfig::new(settings)?);
        self.ecu = Ecu::new(self.config, ResetCause::PowerOn);
        Ok(())
    }

    fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError> {
        let actuators = self.ecu.sample(&Inputs::from(*sensors)).into();
        let telemetry = self.ecu.telemetry();
        plausible(
            sensors,
            Answer {
                sample: sensors.sample,
                actuators,
                telemetry,
            },
        )
    }

    fn restart(&mut self) -> Result<(), DutError> {
        self.ecu = Ecu::new(self.config, ResetCause::Watchdog);
        Ok(())
    }

    fn release(&mut self) -> Result<bool, DutError> {
        Ok(self.ecu.release().is_ok())
    }

    fn breaks(&self, class: FaultClass) -> bool {
        match class {
            FaultClass::Image(_) => false,
            FaultClass::Ecu(fault) if EcuFault::DAMAGES.contains(&fault) => self.damage.is_some(),
            _ => true,
        }
    }

    fn damage(&mut self, fault: EcuFault) -> Result<bool, DutError> {
        Ok(self
            .damage
            .is_some_and(|damage| damage(&mut self.ecu, fault)))
    }
}
