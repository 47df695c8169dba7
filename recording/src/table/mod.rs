//! Files of whole columns: Parquet, MATLAB v5 and v7, MATLAB v7.3 (HDF5).
//!
//! [`read()`] assigns the columns to signals on one time base; a column that cannot be a signal is left out with a
//! reason. [`write_parquet`], [`write_matlab`] and [`write_matlab_hdf5`] write the signals of one time base.

mod columns;
mod error;
mod hdf5;
mod limits;
mod matlab;
mod numeric;
mod pages;
mod parquet;
mod reader;
mod writer;

pub(crate) use columns::Columns;
pub use error::{TableError, TableProblem};
pub use limits::Limits;
pub(crate) use reader::read_columns;
pub use reader::{Options, read};
pub use writer::{write_matlab, write_matlab_hdf5, write_parquet};
