//! Classes of faults.

use core::fmt;
use core::str::FromStr;

use super::fault::Survival;
use super::fault::ecu::EcuFault;
use super::fault::image::ImageFault;
use super::fault::link::LinkFault;
use super::fault::plant::PlantFault;
use super::fault::sensor::SensorFault;

/// Fault class, as family and member: `sensor/stuck`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum FaultClass {
    /// Fault of valves, coils, chamber or supply.
    Plant(PlantFault),
    /// Fault of the pressure sensor.
    Sensor(SensorFault),
    /// Fault of the messages with the reference.
    Link(LinkFault),
    /// Fault of battery, task, reset or memory.
    Ecu(EcuFault),
    /// Fault in the running image's memory; only an emulated target has one.
    Image(ImageFault),
}

impl FaultClass {
    /// Returns all classes, family by family.
    pub fn all() -> impl Iterator<Item = Self> {
        let plant = PlantFault::ALL.iter().copied().map(Self::Plant);
        let sensor = SensorFault::ALL.iter().copied().map(Self::Sensor);
        let link = LinkFault::ALL.iter().copied().map(Self::Link);
        let ecu = EcuFault::ALL.iter().copied().map(Self::Ecu);
        let image = ImageFault::ALL.iter().copied().map(Self::Image);
        plant.chain(sensor).chain(link).chain(ecu).chain(image)
    }

    fn names(self) -> (&'static str, &'static str) {
        match self {
            Self::Plant(fault) => ("plant", fault.name()),
            Self::Sensor(fault) => ("sensor", fault.name()),
            Self::Link(fault) => ("link", fault.name()),
            Self::Ecu(fault) => ("ecu", fault.name()),
            Self::Image(fault) => ("image", fault.name()),
        }
    }

    /// Returns the expected behaviour of a loop with this fault for `duration` samples.
    pub(super) fn survival(self, duration: u32) -> Survival {
        match self {
            Self::Sensor(fault) => fault.survival(duration),
            Self::Link(fault) => fault.survival(duration),
            Self::Ecu(fault) => fault.survival(duration),
            Self::Plant(_) | Self::Image(_) => Survival::NotClaimed,
        }
    }

    /// Returns whether the fault shows as exactly one row of the table, so that the reaction can be checked sample by
    /// sample.
    pub(super) fn is_plain(self) -> bool {
        match self {
            Self::Sensor(fault) => fault.is_plain(),
            Self::Link(_) => true,
            Self::Ecu(fault) => fault.is_plain(),
            Self::Plant(_) | Self::Image(_) => false,
        }
    }

    /// Returns whether the vent valve can empty the chamber during the fault.
    pub(super) fn leaves_venting(self) -> bool {
        match self {
            Self::Plant(fault) => !fault.hinders_venting(),
            // Below its window a battery may be unable to open a valve.
            Self::Ecu(fault) => fault != EcuFault::BatteryLow,
            Self::Sensor(_) | Self::Link(_) | Self::Image(_) => true,
        }
    }
}

impl fmt::Display for FaultClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (family, member) = self.names();
        f.pad(&format!("{family}/{member}"))
    }
}

/// Error: the class does not exist.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no fault class {found:?}; a class is one of {}", known())]
pub struct ClassError {
    /// Text that was read.
    pub found: String,
}

fn known() -> String {
    let names: Vec<String> = FaultClass::all().map(|class| class.to_string()).collect();
    names.join(", ")
}

impl FromStr for FaultClass {
    type Err = ClassError;

    fn from_str(text: &str) -> Result<Self, ClassError> {
        Self::all()
            .find(|class| class.to_string() == text)
            .ok_or_else(|| ClassError {
                found: text.to_owned(),
            })
    }
}
