use std::fmt;

use super::Problem;
use crate::csv::Excerpt;

/// Refusal of an MF4 file: reason and place.
///
/// Its text is one line: code, place, found value, expected value, next step.
#[derive(Debug)]
pub struct Mf4Error(Box<Details>);

#[derive(Debug)]
struct Details {
    source_name: String,
    place: Place,
    problem: Problem,
}

/// Place in an MF4 file, as far as it is known.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// Block by its identifier, such as `##CG`.
    pub block: Option<&'static str>,
    /// Position of the block, in bytes from the beginning of the file.
    pub offset: Option<u64>,
    /// Name of the channel.
    pub channel: Option<Excerpt>,
}

/// Problem with its place, as returned by the parts of the reader before the file is named.
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

/// Creates a problem of the file as a whole.
pub(super) fn of_file(problem: Problem) -> Located {
    (Place::default(), problem)
}

impl Mf4Error {
    pub(crate) fn new(source_name: &str, (place, problem): Located) -> Self {
        Self(Box::new(Details {
            source_name: source_name.to_owned(),
            place,
            problem,
        }))
    }

    /// Returns the stable code, such as `E-MF4-LENGTH`.
    pub fn code(&self) -> &'static str {
        self.problem().code()
    }

    /// Returns the name of the file, as given to its reader.
    pub fn source_name(&self) -> &str {
        &self.0.source_name
    }

    /// Returns the place in the file.
    pub fn place(&self) -> &Place {
        &self.0.place
    }

    /// Returns the problem.
    pub fn problem(&self) -> &Problem {
        &self.0.problem
    }

    /// Returns whether a budget was exceeded, which the caller may raise.
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
