//! Field rigs: ordinary parameters as far off as those of a first plant file, seen through an ordinary logger.
//!
//! | program | reads | writes |
//! |---|---|---|
//! | `field-draw` | a seed | `logs/`: logs, and the plant file that a person would have; `sealed/`: answers |
//! | `field-run` | `logs/` | `found/`: what `retarder refine` says of each rig, and the refined plant |
//! | `field-truth` | `sealed/`, `logs/` | `truth/`: the errors that the true parameters leave |
//! | `field-score` | `sealed/`, `found/`, `truth/` | the table and the verdict |
//!
//! `docs/field-benchmark.md` has the rigs, what counts, and the gates.

pub mod draw;
pub mod finding;
pub mod format;
mod logger;
mod ordinary;
mod plan;
mod removal;
pub mod run;
pub mod score;
pub mod thresholds;
pub mod truth;
