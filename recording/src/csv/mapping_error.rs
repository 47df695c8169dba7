//! Errors of mapping files.

use std::ops::Range;

use super::error::Excerpt;
use crate::name::NameError;

/// Maximum size of a mapping file (bytes).
pub(super) const BYTES_MAX: u64 = 1 << 20;

/// Problem with its place in the text.
pub(super) type AtSpan = (Range<usize>, MappingProblem);

/// Refusal of a mapping file: reason and place.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source_name}{}: {problem}", problem.code(), at(*place))]
pub struct MappingError {
    source_name: String,
    place: Option<(usize, usize)>,
    problem: MappingProblem,
}

fn at(place: Option<(usize, usize)>) -> String {
    place.map_or_else(String::new, |(line, column)| {
        format!(", line {line}, column {column}")
    })
}

impl MappingError {
    pub(super) fn new(
        source_name: &str,
        text: &str,
        span: Option<Range<usize>>,
        problem: MappingProblem,
    ) -> Self {
        let place = span.and_then(|span| text.get(..span.start)).map(|before| {
            let line_start = before.rfind('\n').map_or(0, |at| at + 1);
            (
                before.matches('\n').count() + 1,
                before[line_start..].chars().count() + 1,
            )
        });
        Self {
            source_name: source_name.to_owned(),
            place,
            problem,
        }
    }

    /// Returns the stable code, such as `E-MAP-UNIT`.
    pub fn code(&self) -> &'static str {
        self.problem.code()
    }

    /// Returns line and column, both from 1.
    pub fn place(&self) -> Option<(usize, usize)> {
        self.place
    }

    /// Returns the problem.
    pub fn problem(&self) -> &MappingProblem {
        &self.problem
    }
}

/// Problem of a mapping file. Each variant has a stable code.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MappingProblem {
    /// The file cannot be read.
    #[error("{0}; check that the file exists and may be read")]
    Io(std::io::Error),
    /// The file is larger than [`Mapping::BYTES_MAX`](super::Mapping::BYTES_MAX).
    #[error(
        "a mapping has at most {} bytes; leave out what is no mapping",
        BYTES_MAX
    )]
    Long,
    /// The text is no TOML, a key is unknown or missing, or a value has another type.
    #[error("{}; see the example in the documentation of Mapping", Excerpt::of(.0).as_str())]
    Toml(String),
    /// The file has another version of the format.
    #[error("found schema {0}, expected 1; write schema = 1")]
    Schema(i64),
    /// A word is not one of the choices.
    #[error("found {found}, expected one of {choices:?}; choose one")]
    Choice {
        /// Word in the file.
        found: Excerpt,
        /// Allowed choices.
        choices: Vec<&'static str>,
    },
    /// A unit is unknown or leaves the pressure reference open.
    #[error("{0}")]
    Unit(String),
    /// The declared unit of the time is no unit of time.
    #[error("the time needs a unit of time; write s, ms or us")]
    NoTimeUnit,
    /// A signal has the name of the time.
    #[error("the time is no signal; describe it under [time]")]
    TimeAsSignal,
    /// The name of a signal is empty, too long or not printable.
    #[error("{0}; rename the signal")]
    Name(NameError),
    /// A column has the number 0.
    #[error("columns are counted from 1; write a number from 1 or a header field in quotes")]
    ColumnZero,
    /// A scale is zero, NaN or infinite.
    #[error("found {0}, expected a finite number, for a scale other than 0; correct it")]
    Factor(f64),
    /// A range is empty or not finite.
    #[error("found [{least}, {greatest}], expected a smaller and a greater number; correct it")]
    Range {
        /// First number.
        least: f64,
        /// Second number.
        greatest: f64,
    },
    /// The time has a range of its values.
    #[error(
        "the time has neither `plausible` nor `clip`; write [rows] with from_s and until_s to leave out rows"
    )]
    TimeRange,
    /// A constant is no number, or is outside the hard bounds of its quantity.
    #[error("found {found} ({allowed}); correct it")]
    Constant {
        /// Value with its unit.
        found: Excerpt,
        /// Allowed range.
        allowed: String,
    },
    /// No time is between `from_s` and `until_s`.
    #[error("no row is left between from_s and until_s; write a later until_s")]
    WindowEmpty,
    /// The same character separates thousands and decimals.
    #[error("the comma is the decimal separator already; choose another thousands_separator")]
    ThousandsAsDecimal,
}

impl MappingProblem {
    /// Returns the stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Io(_) => "E-MAP-IO",
            Self::Long => "E-MAP-LONG",
            Self::Toml(_) => "E-MAP-TOML",
            Self::Schema(_) => "E-MAP-SCHEMA",
            Self::Choice { .. } => "E-MAP-CHOICE",
            Self::Unit(_) => "E-MAP-UNIT",
            Self::NoTimeUnit => "E-MAP-TIME-UNIT",
            Self::TimeAsSignal => "E-MAP-TIME-SIGNAL",
            Self::Name(_) => "E-MAP-NAME",
            Self::ColumnZero => "E-MAP-COLUMN",
            Self::Factor(_) => "E-MAP-FACTOR",
            Self::TimeRange => "E-MAP-TIME-RANGE",
            Self::Range { .. } => "E-MAP-RANGE",
            Self::Constant { .. } => "E-MAP-CONSTANT",
            Self::WindowEmpty => "E-MAP-ROWS",
            Self::ThousandsAsDecimal => "E-MAP-THOUSANDS",
        }
    }
}
