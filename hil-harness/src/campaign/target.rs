//! What a campaign breaks: a device under test, and what can be done to it beyond the wire.

use ecu::{Ecu, EcuConfig, EcuSettings, Inputs, ResetCause};

use super::class::FaultClass;
use super::fault::ecu::EcuFault;
use crate::device::{DutError, plausible};
use crate::wire::{Actuators, Answer, Sensors};

/// A device under test of a campaign.
pub trait Target {
    /// What it is; for the record.
    fn identity(&self) -> String;

    /// With these settings, in the state after power-on.
    ///
    /// # Errors
    /// The device cannot be reached, or the settings are out of bounds.
    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError>;

    /// One sample.
    ///
    /// # Errors
    /// The device did not answer.
    fn exchange(&mut self, sensors: &Sensors) -> Result<Reaction, DutError>;

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

    /// Something happens to the image on its machine.
    ///
    /// # Errors
    /// The device cannot be reached.
    fn suffer(&mut self, _: Accident) -> Result<(), DutError> {
        Ok(())
    }
}

/// What a target does in a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reaction {
    /// It answers; the actuators are what the coils get, whatever the device says of them.
    Answer(Answer),
    /// It has started again instead; this is what its coils got since.
    Reset(Actuators),
}

/// What can happen to an image. The number chooses the bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accident {
    /// A bit of a static variable flips.
    FlippedVariable(u64),
    /// A bit of the stack flips.
    FlippedStack(u64),
    /// The program stands still.
    Hang,
    /// The processor finds no instruction.
    Trap,
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
