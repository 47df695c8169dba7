//! Blind benchmark of the diagnosis: four programs that share only file formats.
//!
//! | program | reads | writes |
//! |---|---|---|
//! | `blind-draw` | a seed | `logs/`: bench logs; `sealed/`: what each rig hides |
//! | `blind-run` | `logs/` | `found/`: result of `retarder diagnose` for each rig |
//! | `blind-pairs` | `sealed/`, `logs/` | `alone/`: for each of two hidden effects, the error of a model with that
//! effect alone |
//! | `blind-score` | `sealed/`, `found/`, optionally `alone/`, and `logs/` for two of the rules | the table and the
//! verdict |
//!
//! `docs/blind-benchmark.md` describes the kinds of rigs, right and wrong names, gates and seeds.

use std::fmt::Display;
use std::process::ExitCode;

pub mod draw;
pub mod field;
pub mod format;
pub mod kinds;
pub mod pairs;
pub mod run;
pub mod score;

/// Ends the line of the progress of a program. Reports the error of its work, which has exit status 2.
pub fn ended(done: Result<ExitCode, impl Display>) -> ExitCode {
    eprintln!();
    done.unwrap_or_else(|error| {
        eprintln!("{error}");
        ExitCode::from(2)
    })
}
