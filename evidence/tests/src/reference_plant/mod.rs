//! Second plant for tests: rigs whose equations differ from those of the simulator and the diagnosis.
//!
//! It shares only values with the simulator, through `data/nominal-plant.toml`. These parts differ on purpose, so that
//! a fit of the simulator never reproduces it exactly:
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
//! [`Departures`] contains all departures of a rig; if all are zero, it is the plain plant. [`catalogue`] names its
//! physical effects by the ids of the library, in laws of its own, and further effects outside any library.

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

pub use datasheet::{Datasheet, Gas};
pub use departures::Departures;
pub use nozzle::{Nozzle, Subsonic};
pub use plant::{ReferencePlant, replay};
pub use rig::{Rig, SCATTERED, Scatter};
pub use sensor::Reading;
