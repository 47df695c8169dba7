//! Target of a campaign: a device under test, with the faults that can be applied to it beyond the wire.

use ecu::{Ecu, EcuConfig, EcuSettings, Inputs, ResetCause};

use super::class::FaultClass;
use super::fault::ecu::EcuFault;
use crate::device::{DutError, plausible};
use crate::wire::{Actuators, Answer, Sensors};

/// Device under test of a campaign.
pub trait Target {
    /// Returns the identity of the device, for the record.
    fn identity(&self) -> String;

    /// Starts the device with these settings, in the state after power-on.
    ///
    /// # Errors
    /// Returns an error if the device cannot be reached, or the settings are out of bounds.
    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError>;

    /// Runs one sample.
    ///
    /// # Errors
    /// Returns an error if the device did not answer.
    fn exchange(&mut self, sensors: &Sensors) -> Result<Reaction, DutError>;

    /// Resets the device, which keeps its settings.
    ///
    /// # Errors
    /// Returns an error if the device did not come back.
    fn restart(&mut self) -> Result<(), DutError>;

    /// Requests the release of a locked ECU, as a mechanic does. Returns whether it was granted.
    ///
    /// # Errors
    /// Returns an error if the device cannot be reached.
    fn release(&mut self) -> Result<bool, DutError>;

    /// Returns whether this target supports this class of faults.
    fn breaks(&self, class: FaultClass) -> bool;

    /// Damages the memory of the ECU. Returns whether the ECU now has to detect the damage.
    ///
    /// # Errors
    /// Returns an error if the device cannot be reached.
    fn damage(&mut self, _: EcuFault) -> Result<bool, DutError> {
        Ok(false)
    }

    /// Applies an accident to the image on its machine.
    ///
    /// # Errors
    /// Returns an error if the device cannot be reached.
    fn suffer(&mut self, _: Accident) -> Result<(), DutError> {
        Ok(())
    }
}

/// Reaction of a target in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// Answer; the actuators are the duty cycles of the coils, not those that the device reports.
    Answer(Answer),
    /// Restart instead of an answer, with the duty cycles of its coils since.
    Reset(Actuators),
}

/// Accident of an image. The number chooses the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accident {
    /// A bit of a static variable flips.
    FlippedVariable(u64),
    /// A bit of the stack flips.
    FlippedStack(u64),
    /// The program stops.
    Hang,
    /// The processor executes an undefined instruction.
    Trap,
}

/// Function that damages an ECU in this process and returns whether it could.
pub type Damage = fn(&mut Ecu, EcuFault) -> bool;

/// ECU in this process, complete or with a removed mechanism.
pub struct InProcessTarget {
    alter: Box<dyn Fn(EcuConfig) -> EcuConfig>,
    damage: Option<Damage>,
    config: EcuConfig,
    ecu: Ecu,
}

impl InProcessTarget {
    /// Creates the complete ECU.
    pub fn whole() -> Self {
        Self::altered(|config| config)
    }

    /// Creates an ECU with `alter`ed configurations, for example without a mechanism.
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

    /// Returns the same target with a function that damages its memory.
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

    fn exchange(&mut self, sensors: &Sensors) -> Result<Reaction, DutError> {
        let actuators = self.ecu.sample(&Inputs::from(*sensors)).into();
        let telemetry = self.ecu.telemetry();
        let sample = sensors.sample;
        let answer = Answer {
            sample,
            actuators,
            telemetry,
        };
        plausible(sensors, answer).map(Reaction::Answer)
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
