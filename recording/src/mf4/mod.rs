//! MF4 (ASAM MDF 4) as loggers write it in, and one clean form of it out.
//!
//! [`read_file`] makes a [`Recording`](crate::Recording) with one time base for each rate; [`list_file`] tells what
//! there is to choose from. [`write()`] and [`Writer`] write sorted files of 64-bit floats.

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
mod text;
mod writer;

pub use error::{Mf4Error, Place};
pub use limits::Limits;
pub use listing::{Channel, Group, Listing, list, list_file};
pub use notes::READER_NOTE;
pub use problem::{Budget, Problem};
pub use reader::{Options, read, read_file};
pub use writer::{Writer, write};
