//! MF4 (ASAM MDF 4): a reader for the files of common loggers, and a writer of one defined form.
//!
//! [`read_file`] creates a [`Recording`](crate::Recording) with one time base for each rate; [`list_file`] lists the
//! channels to choose from. [`write()`] and [`Writer`] write sorted files of 64-bit floats.

mod blocks;
mod candidates;
mod choice;
mod conversion;
mod data;
mod error;
mod head;
mod layout;
mod limits;
mod listing;
mod notes;
mod problem;
mod reader;
mod samples;
mod structure;
pub(crate) mod survey;
mod text;
mod writer;

pub use crate::provenance::READER_NOTE;
pub use error::{Mf4Error, Place};
pub use limits::Limits;
pub use listing::{Channel, Group, Listing, list, list_file};
pub use problem::{Budget, Problem};
pub use reader::{Options, read, read_file};
pub use writer::{Writer, write};
