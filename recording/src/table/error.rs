//! Errors of Parquet and MATLAB files.

use std::fmt;

use crate::Implausible;
use crate::csv::Excerpt;
use crate::plausibility::Code;

/// Refusal of a Parquet or MATLAB file: reason and place.
///
/// Its text is one line: code, file, column, found value, expected value, next step.
#[derive(Debug)]
pub struct TableError(Box<Details>);

#[derive(Debug)]
struct Details {
    source_name: String,
    column: Option<Excerpt>,
    problem: TableProblem,
}

/// Problem with its column, before the file is named.
pub(super) type Located = (Option<Excerpt>, TableProblem);

/// Creates a problem of the file as a whole.
pub(super) fn of_file(problem: TableProblem) -> Located {
    (None, problem)
}

/// Creates a problem of a damaged file.
pub(super) fn damaged(reason: impl fmt::Display) -> Located {
    of_file(TableProblem::Damaged {
        reason: Excerpt::of(&reason.to_string()),
    })
}

/// Problem of a Parquet or MATLAB file. Each variant has a stable code.
#[derive(Debug)]
#[non_exhaustive]
pub enum TableProblem {
    /// The input cannot be read.
    Io(std::io::Error),
    /// The bytes are not those of the format, or of a variant that is not supported.
    Damaged {
        /// First contradiction.
        reason: Excerpt,
    },
    /// A budget is exceeded.
    Limit {
        /// Exceeded budget.
        budget: &'static str,
        /// Value required by the file.
        found: u64,
        /// Bound of the budget.
        bound: u64,
    },
    /// No column is the time.
    NoTime {
        /// Names of the columns.
        found: Excerpt,
    },
    /// The times do not increase, are missing or out of bounds.
    Time {
        /// Reason.
        reason: String,
    },
    /// The mapping names a missing column.
    MappedColumnMissing {
        /// Column as named by the mapping.
        wanted: Excerpt,
        /// Names of the columns.
        found: Excerpt,
    },
    /// The mapping names a column that has no numbers.
    NotNumbers {
        /// Reason.
        reason: String,
    },
    /// The mapping reads dates from texts, which these formats do not have.
    Clock,
    /// No column becomes a signal.
    NoSignal {
        /// First left-out columns, with their reasons.
        left_out: String,
    },
    /// The time window of the mapping leaves no row.
    NoRowKept,
    /// The mapping declares a signal as constant that the file has.
    ConstantLogged {
        /// Name of the signal.
        name: Excerpt,
    },
    /// A value cannot belong to a signal of its unit.
    Implausible {
        /// Row, from 1.
        row: u64,
        /// Value and unit.
        implausible: Implausible,
    },
}

impl TableProblem {
    /// Returns the stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Io(_) => "E-TAB-IO",
            Self::Damaged { .. } => "E-TAB-DAMAGED",
            Self::Limit { .. } => "E-TAB-LIMIT",
            Self::NoTime { .. } => "E-TAB-TIME-NO-COLUMN",
            Self::Time { .. } => "E-TAB-TIME",
            Self::MappedColumnMissing { .. } => "E-TAB-MAPPED-COLUMN",
            Self::NotNumbers { .. } => "E-TAB-NO-NUMBERS",
            Self::Clock => "E-TAB-CLOCK",
            Self::NoSignal { .. } => "E-TAB-NO-SIGNAL",
            Self::NoRowKept => "E-TAB-NO-ROW-KEPT",
            Self::ConstantLogged { .. } => "E-TAB-CONSTANT-LOGGED",
            Self::Implausible { implausible, .. } => match implausible.code() {
                Code::DutyRange => "E-TAB-DUTY-RANGE",
                Code::BelowVacuum => "E-TAB-BELOW-VACUUM",
                Code::Bounds => "E-TAB-BOUNDS",
                Code::Scale => "E-TAB-SCALE",
            },
        }
    }

    /// Returns the next step, as an instruction.
    pub fn next_step(&self) -> String {
        match self {
            Self::Io(_) => "check that the file exists and may be read",
            Self::Damaged { .. } => {
                "save it again: Parquet with snappy or zstd, MATLAB with -v7 or -v7.3"
            }
            Self::Limit { .. } => "save fewer columns or a shorter part of the log",
            Self::NoTime { .. } => {
                "say in a mapping: [time] with column and unit; `retarder inspect` lists the columns"
            }
            Self::Time { .. } => "correct the time column, or name another one under [time]",
            Self::MappedColumnMissing { .. } => "correct the name in the mapping",
            Self::NotNumbers { .. } => "map a column of numbers",
            Self::Clock => "save the time as numbers, or export the log as CSV",
            Self::NoSignal { .. } => "name columns in a mapping; `retarder inspect` proposes one",
            Self::NoRowKept => "correct from_s and until_s in the mapping",
            Self::ConstantLogged { .. } => {
                "take the constant out of the mapping, or add where_absent = true"
            }
            Self::Implausible { implausible, .. } => return implausible.next_step(),
        }
        .to_owned()
    }
}

impl fmt::Display for TableProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "{error}"),
            Self::Damaged { reason } => {
                write!(
                    f,
                    "the file is damaged or of an unknown variant: {}",
                    reason.as_str()
                )
            }
            Self::Limit {
                budget,
                found,
                bound,
            } => write!(f, "the file needs {found} {budget} (at most {bound})"),
            Self::NoTime { found } => write!(f, "no column is the time; the columns are {found}"),
            Self::Time { reason } => f.write_str(reason),
            Self::MappedColumnMissing { wanted, found } => {
                write!(f, "the mapping names {wanted}, the columns are {found}")
            }
            Self::NotNumbers { reason } => {
                write!(f, "the column has no numbers over time: {reason}")
            }
            Self::Clock => f.write_str("the mapping reads dates from texts, expected numbers"),
            Self::NoSignal { left_out } => write!(f, "no column is a signal{left_out}"),
            Self::NoRowKept => f.write_str("[rows] in the mapping leaves no row"),
            Self::ConstantLogged { name } => {
                write!(f, "{name} is constant in the mapping, but the file has it")
            }
            Self::Implausible { row, implausible } => write!(f, "row {row}: {implausible}"),
        }
    }
}

impl TableError {
    pub(crate) fn new(
        source_name: &str,
        (column, problem): (Option<Excerpt>, TableProblem),
    ) -> Self {
        Self(Box::new(Details {
            source_name: source_name.to_owned(),
            column,
            problem,
        }))
    }

    /// Returns the stable code, such as `E-TAB-TIME`.
    pub fn code(&self) -> &'static str {
        self.problem().code()
    }

    /// Returns the problem.
    pub fn problem(&self) -> &TableProblem {
        &self.0.problem
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let source_name = Excerpt::of(&self.0.source_name);
        write!(f, "{}: {}", self.code(), source_name.as_str())?;
        if let Some(column) = &self.0.column {
            write!(f, ", column {column}")?;
        }
        write!(f, ": {}; {}", self.problem(), self.problem().next_step())
    }
}

impl std::error::Error for TableError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self.problem() {
            TableProblem::Io(error) => Some(error),
            _ => None,
        }
    }
}
