//! Damaged files: the program ends with an answer or with a reason for any content of a file.
//!
//! ```text
//! originals ──► case: files, damages, command ──► run under limits ──► finding ──► table, folder of failures
//!                 ▲ seed and number
//! ```
//!
//! A case is drawn from a seed and its number alone, so that it can be repeated. [`originals`] are small valid inputs
//! of every kind that the program reads, [`bytes`] and [`text`] the kinds of damage, [`commands`] the commands that
//! read them. The [`campaign`] runs many cases in parallel, and [`finding`] defines the forbidden results.

pub mod bytes;
pub mod campaign;
pub mod case;
pub mod commands;
pub mod finding;
pub mod limits;
pub mod originals;
mod served;
pub mod table;
pub mod text;
mod values;
