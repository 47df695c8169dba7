//! Damaged files: whatever a file says, the program ends with an answer or with a reason.
//!
//! ```text
//! originals ──► case: files, damages, command ──► run under limits ──► finding ──► table, folder of failures
//!                 ▲ seed and number
//! ```
//!
//! A case is drawn from a seed and its number alone, so that it comes again. [`originals`] are small valid inputs of every
//! kind that the program reads, [`bytes`] and [`text`] the ways in which they are damaged, [`commands`] who reads them. The
//! [`campaign`] runs many, several at a time, and [`finding`] says what must not come of any.

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
