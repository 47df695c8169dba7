//! Third plant for tests: rigs of other kinds, whose valves are known by their conductance and switching times.
//!
//! It shares no code with the simulator and only the nozzle with the [reference plant](crate::reference_plant). These
//! parts differ from the simulator on purpose:
//!
//! | | here | in `plant-sim` |
//! |---|---|---|
//! | gas | mass and internal energy | pressure |
//! | hose | pressure from the energy by Newton's method | derivative of the volume |
//! | proportional valve | lag of the spool, before the characteristic | lag of the open share, behind it |
//! | opening delay with pressure and voltage | a coil that charges up to the force balance | straight line, power |
//! | actuator | position as a function of the time | constant velocity from row to row |
//! | heat of the second chamber | a value of its own | by the area of the wall |
//! | solution | Runge-Kutta of order 4, fixed steps, restarted where a valve switches | event-driven, adaptive |
//!
//! [`HiddenEffects`] contains what a rig hides; without them, it is the plain plant.

mod gas;
mod hidden;
mod hose;
mod inputs;
mod on_off_valve;
mod orifice;
mod plant;
mod proportional_valve;
mod rig;
mod sensor;
#[cfg(test)]
mod tests;
mod valve;

pub use hidden::{HiddenEffects, PullIn, SupplyLine};
pub use hose::Walls;
pub use inputs::{NOMINAL_V, Swing};
pub use on_off_valve::SwitchingTimes;
pub use orifice::Conductance;
pub use plant::{KindPlant, KindReading};
pub use proportional_valve::Characteristic;
pub use rig::{KindRig, SecondChamber, ValvePart};
pub use sensor::SensorErrors;
pub use valve::Drive;
