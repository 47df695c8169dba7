//! The blind benchmark of the diagnosis: four programs that share file formats and nothing else.
//!
//! | program | reads | writes |
//! |---|---|---|
//! | `blind-draw` | a seed | `logs/`: bench logs; `sealed/`: what each rig hides |
//! | `blind-run` | `logs/` | `found/`: what the command `retarder diagnose` said of each rig |
//! | `blind-pairs` | `sealed/`, `logs/` | `alone/`: for each of two hidden effects, what a model that has it alone leaves |
//! | `blind-score` | `sealed/`, `found/`, `alone/` if it is there, for two of the rules `logs/` | the table and the verdict |
//!
//! `docs/blind-benchmark.md` has the rules of the game: kinds of rigs, what counts as right, gates, seeds.

pub mod draw;
pub mod field;
pub mod format;
pub mod pairs;
pub mod run;
pub mod score;
