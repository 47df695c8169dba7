//! Gains of the PID controller for a kind of rig: two starting points from experiments on the model, and a seeded search
//! over scattered rigs.
//!
//! Every candidate runs the same profile on the same rigs. It passes all references of the operating range and both timed
//! passages of the requirements. [`Quality::cost_samples`] ranks the candidates; all of them are returned, so that a
//! user can prefer another trade-off.

mod gain;
mod profile;
mod quality;
mod search;
mod starting_point;

pub use gain::{GAINS, Gain};
pub use quality::Quality;
pub use search::{Candidate, Found, Name, Search, SearchError, search};
pub use starting_point::{NoStartingPoint, StartingPoint};
