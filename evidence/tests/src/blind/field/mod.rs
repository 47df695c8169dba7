//! Field rigs: ordinary parameters as far off as in a first plant file, recorded by an ordinary logger.
//!
//! | program | reads | writes |
//! |---|---|---|
//! | `field-draw` | a seed | `logs/`: logs, and the plant file that a user would have; `sealed/`: answers |
//! | `field-run` | `logs/` | `found/`: result of `retarder refine` for each rig, and the refined plant |
//! | `field-run --names` | the same | also `named/`: diagnosis of the refined plant; `fitted/`: that plant with the named effects |
//! | `field-truth` | `sealed/`, `logs/` | `truth/`: the errors of the true parameters |
//! | `field-score` | `sealed/`, `found/`, `truth/` | the table and the verdict on the refined plants |
//! | `field-score --names` | `sealed/`, `found/`, `named/`, `fitted/` | the table and the verdict on the names |
//!
//! `docs/field-benchmark.md` describes the rigs, the scores and the gates.

pub mod draw;
pub mod finding;
pub mod format;
mod logger;
pub mod names;
mod ordinary;
mod plan;
mod removal;
pub mod run;
pub mod score;
pub mod thresholds;
pub mod truth;

pub(super) use plan::{gaps, logarithmic};
