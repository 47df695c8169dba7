//! The command that merges tables of rigs.

use std::path::PathBuf;

use clap::{Args, ValueHint};

use super::JsonArg;

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  retarder control --rigs 10000 --shard 1/2 --rigs-out one.parquet
  retarder control --rigs 10000 --shard 2/2 --rigs-out two.parquet
  retarder merge-rigs one.parquet two.parquet --out rigs.parquet

The result has the bytes of the file of `control --rigs 10000 --rigs-out rigs.parquet`. Rigs that are
in no file or in two, and files of another run, are refused.
Exit status: 0 every rig meets every binding requirement, 1 at least one does not, 2 could not run.")]
pub(crate) struct MergeRigsArgs {
    /// Files of all shards, in any order
    #[arg(value_name = "FILE", value_hint = ValueHint::FilePath, required = true)]
    pub(crate) shards: Vec<PathBuf>,
    /// Write the rows of all rigs to this Parquet file
    #[arg(long, value_name = "FILE", value_hint = ValueHint::FilePath)]
    pub(crate) out: PathBuf,
    #[command(flatten)]
    pub(crate) json: JsonArg,
}
