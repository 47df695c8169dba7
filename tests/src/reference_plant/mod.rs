//! A second plant, for evidence: rigs whose truth the simulator and the diagnosis have never seen.
//!
//! It shares values with the simulator through `data/nominal-plant.toml` and nothing else. What is different on
//! purpose, so that a fit of the simulator never reproduces it to the last bit:
//!
//! | | here | in `plant-sim` |
//! |---|---|---|
//! | coil | flux linkage, reluctance linear in the position | current, inductance linear in the position |
//! | magnet | force by the square of the flux | by the square of current over gap |
//! | end stops | stiff springs with dampers | events |
//! | gas | mass and internal energy | pressure |
//! | flow | nozzle from first principles | tabulated flow function with a laminar zone |
//! | area | smooth passage from curtain to bore | kink |
//! | sensor | anti-alias filter | none |
//! | solution | Runge-Kutta of order 4, fixed steps, restarted at PWM edges | event-driven, adaptive, closed forms |
//!
//! [`Departures`] is everything that a rig may have beyond that; all zero is the plain plant. [`catalogue`] names
//! the physical effects in it by the ids of the library, in laws of their own, and further ones that no library has.

pub mod catalogue;
mod coil;
mod contact;
mod datasheet;
mod departures;
mod friction;
mod gas;
mod nozzle;
mod plant;
mod pulses;
mod rig;
mod sensor;
mod state;

pub use datasheet::Datasheet;
pub use departures::Departures;
pub use nozzle::{Nozzle, Subsonic};
pub use plant::{ReferencePlant, replay};
pub use rig::{Rig, SCATTERED, Scatter};
pub use sensor::Reading;
