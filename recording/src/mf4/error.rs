use std::fmt;

use super::Problem;
use crate::csv::Excerpt;

/// Why an MF4 file was refused, and where.
///
/// Its text is one line: code, place, what was found, what was expected, what to do next.
#[derive(Debug)]
pub struct Mf4Error(Box<Details>);

#[derive(Debug)]
struct Details {
    source_name: String,
    place: Place,
    problem: Problem,
}

/// A place in an MF4 file, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Block by its identifier, such as `##CG`.
    pub block: Option<&'static str>,
    /// Where the block begins, in bytes from the beginning of the file.
    pub offset: Option<u64>,
    /// Channel.
    pub channel: Option<Excerpt>,
}

/// A problem and its place: what the parts of the reader return, before the file is named.
pub(super) type Located = (Place, Problem);

impl Place {
    pub(super) fn block(block: &'static str, offset: u64) -> Self {
        Self {
            block: Some(block),
            offset: Some(offset),
            channel: None,
        }
    }

    pub(super) fn channel(name: &str) -> Self {
        Self {
            channel: Some(Excerpt::of(name)),
            ..Self::default()
        }
    }
}

/// A problem of the file as a whole.
pub(super) fn of_file(problem: Problem) -> Located {
    (Place::default(), problem)
}

impl Mf4Error {
    pub(super) fn new(source_name: &str, (place, problem): Located) -> Self {
        Self(Box::new(Details {
            source_name: source_name.to_owned(),
            place,
            problem,
        }))
    }

    /// The stable code, such as `E-MF4-LENGTH`.
    pub fn code(&self) -> &'static str {
        self.problem().code()
    }

    /// The file, as its reader named it.
    pub fn source_name(&self) -> &str {
        &self.0.source_name
    }

    /// Where in the file.
    pub fn place(&self) -> &Place {
        &self.0.place
    }

    /// What is wrong.
    pub fn problem(&self) -> &Problem {
        &self.0.problem
    }

    /// True if a budget was exceeded, which the caller may raise.
    pub fn is_limit(&self) -> bool {
        matches!(self.problem(), Problem::Limit { .. })
    }
}

impl fmt::Display for Mf4Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Place {
            block,
            offset,
            channel,
        } = self.place();
        let source_name = Excerpt::of(self.source_name());
        write!(f, "{}: {}", self.code(), source_name.as_str())?;
        if let Some(block) = block {
            write!(f, ", block {block}")?;
        }
        if let Some(offset) = offset {
            write!(f, " at byte {offset}")?;
        }
        if let Some(channel) = channel {
            write!(f, ", channel {channel}")?;
        }
        write!(f, ": {}; {}", self.problem(), self.problem().next_step())
    }
}

impl std::error::Error for Mf4Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self.problem() {
            Problem::Io(error) => Some(error),
            _ => None,
        }
    }
}
