//! CSV as people have it in, and one clean form of it out.
//!
//! [`read_file`] makes a [`Recording`](crate::Recording); [`Reader`] gives one row after the other in bounded memory;
//! [`Writer`] writes rows. A [`Mapping`] explains files that do not explain themselves.

pub(crate) mod complement;
mod dialect;
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
pub(crate) mod writer;

pub use dialect::{Delimiter, Dialect};
pub use error::{CsvError, Excerpt, Place};
pub use limits::Limits;
pub use mapping::Mapping;
pub use mapping_error::{MappingError, MappingProblem};
pub use number::Decimal;
pub use problem::{Budget, Problem};
pub use reader::{Column, Options, Reader, Row, read, read_file};
pub use writer::{Decimals, WriteError, Writer, write};
