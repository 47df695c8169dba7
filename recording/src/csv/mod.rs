//! CSV as people have it in, and one clean form of it out.
//!
//! [`read_file`] makes a [`Recording`](crate::Recording); [`Reader`] gives one row after the other in bounded memory;
//! [`Writer`] writes rows. A [`Mapping`] explains files that do not explain themselves.

mod checks;
mod dialect;
mod error;
mod header;
mod limits;
mod mapping;
mod number;
mod plan;
mod reader;
mod record;
mod writer;

pub use dialect::{Delimiter, Dialect};
pub use error::{Budget, CsvError, Excerpt, Place, Problem};
pub use limits::Limits;
pub use mapping::{Mapping, MappingError, MappingProblem};
pub use number::Decimal;
pub use reader::{Column, Options, Reader, Row, read, read_file};
pub use writer::{Decimals, WriteError, Writer, write};
