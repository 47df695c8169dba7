//! Rigs of other kinds: a pair of on/off valves without coils, a hose, a second chamber, proportional valves.
//!
//! | program | reads | writes |
//! |---|---|---|
//! | `kinds-draw` | a seed | `logs/`: logs, and the plate with what a user knows of the rig; `sealed/`: answers |
//! | `kinds-run` | `logs/` | `found/`: plant file and result of `retarder diagnose` for each rig |
//! | `kinds-score` | `sealed/`, `found/` | a table with one line for each rig |

pub mod draw;
mod effects;
pub mod format;
mod known;
mod logger;
mod plan;
mod plate;
mod profile;
pub mod run;
pub mod score;
