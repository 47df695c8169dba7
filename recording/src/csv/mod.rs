//! CSV: a reader for the files of common loggers, and a writer of one defined form.
//!
//! [`read_file`] creates a [`Recording`](crate::Recording); [`Reader`] returns one row after the other in bounded
//! memory; [`Writer`] writes rows. A [`Mapping`] describes files that do not describe themselves.

mod clock;
pub(crate) mod complement;
mod dialect;
mod encoding;
mod error;
pub(crate) mod header;
mod limits;
pub(crate) mod mapping;
mod mapping_error;
mod number;
mod opening;
mod plan;
mod problem;
mod reader;
mod record;
mod row;
pub(crate) mod survey;
pub(crate) mod writer;

pub use dialect::{Delimiter, Dialect};
pub use encoding::Encoding;
pub use error::{CsvError, Excerpt, Place};
pub use limits::Limits;
pub use mapping::Mapping;
pub use mapping_error::{MappingError, MappingProblem};
pub use number::Decimal;
pub use problem::{Budget, Problem};
pub use reader::{Column, Options, Reader, Row, read, read_file};
pub use writer::{Decimals, WriteError, Writer, write};
