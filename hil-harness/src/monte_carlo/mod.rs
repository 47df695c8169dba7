//! Robustness of the loop on many rigs (Monte Carlo): one row of figures for each rig, as a Parquet file.
//!
//! [`Batch`] computes the row of a rig. [`complete()`] computes all rows of a [`Shard`] on several threads, and a
//! [`Journal`] beside the output keeps those that are done: a killed run continues there. Rows go to the output in the
//! order of the rigs, so its bytes depend on neither the threads nor the kills. [`merge()`] joins the files of all shards
//! to the file of a run without shards.

mod batch;
mod columns;
mod complete;
mod error;
mod journal;
mod merge;
mod row;
mod settings;
mod shard;
mod summary;
mod table;
#[cfg(test)]
mod tests;

pub use batch::Batch;
pub use columns::{COLUMNS, Column};
pub use complete::{complete, finished};
pub use error::MonteCarloError;
pub use journal::Journal;
pub use merge::{MergeError, merge};
pub use row::RigRow;
pub use settings::{Difference, RunSettings};
pub use shard::{Shard, ShardError};
pub use summary::{Extent, FigureSummary, Summary};
pub use table::{RowReader, RowWriter, TableError};
