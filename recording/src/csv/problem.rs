use std::fmt;
use std::io;

use super::{Delimiter, Excerpt};
use crate::name::NameError;
use crate::plausibility::Code;
use crate::{Bounds, Implausible, Quantity, Unit};

/// Budget of [`Limits`](super::Limits).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Budget {
    /// Size of the file (bytes).
    FileBytes,
    /// Length of a record (bytes).
    RecordBytes,
    /// Length of a field (bytes).
    FieldBytes,
    /// Number of columns.
    Columns,
    /// Number of samples per signal.
    Samples,
}

/// Problem of a CSV file. Each variant has a stable code.
#[derive(Debug)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be read.
    Io(io::Error),
    /// Reading continued after an error.
    ReadAfterError,
    /// The file has no record.
    Empty,
    /// The file is no text in a known encoding.
    Encoding {
        /// Probable encoding.
        guess: &'static str,
        /// Whether the file is a text nevertheless.
        is_text: bool,
    },
    /// Lines end with a bare carriage return.
    LineEnd,
    /// A budget is exceeded.
    Limit {
        /// Exceeded budget.
        budget: Budget,
        /// Bound of the budget.
        bound: u64,
    },
    /// The first record has no column separator.
    NoDelimiter {
        /// First record.
        found: Excerpt,
    },
    /// The first record has numbers instead of names.
    NoHeader {
        /// First field of the record.
        found: Excerpt,
    },
    /// A header field cannot be the name of a signal.
    Name {
        /// Header field.
        found: Excerpt,
        /// Problem of the name.
        problem: NameError,
    },
    /// A column has no unit.
    UnitMissing {
        /// Header field.
        found: Excerpt,
    },
    /// A unit is unknown to this crate.
    UnitUnknown {
        /// Text in place of a unit.
        found: Excerpt,
        /// Token that differs from it in letter case only.
        meant: Option<Unit>,
    },
    /// Header and units row contain different units.
    UnitConflict {
        /// Unit in the header.
        header: Unit,
        /// Unit in the units row.
        units_row: Unit,
    },
    /// A pressure is neither declared as gauge nor as absolute.
    PressureReference {
        /// Text of the unit, such as `bar`.
        found: Excerpt,
    },
    /// Two columns give the same signal.
    DuplicateName {
        /// Base name of both columns.
        name: String,
        /// Number of the first column, from 1.
        first_column: usize,
    },
    /// Two columns give the time.
    TwoTimeColumns {
        /// Number of the first column, from 1.
        first_column: usize,
    },
    /// No column gives the time.
    NoTimeColumn {
        /// Header fields.
        found: Excerpt,
    },
    /// The time column is the only column.
    NoSignal,
    /// The file has a header, but no row of numbers.
    NoData,
    /// The mapping keeps no row of the file.
    NoRowKept {
        /// First time of the file (s).
        first_s: f64,
        /// Last time of the file (s).
        last_s: f64,
    },
    /// A signal is constant in the mapping, and the file contains it.
    ConstantLogged {
        /// Name of the signal.
        name: String,
    },
    /// The mapping names a missing column.
    MappedColumnMissing {
        /// Column as named by the mapping.
        wanted: String,
        /// Header fields, or the number of columns.
        found: Excerpt,
    },
    /// The mapping names a column by a header field that occurs twice.
    MappedColumnTwice {
        /// Header field.
        wanted: String,
    },
    /// Neither a header nor the mapping describes a column.
    Unmapped {
        /// First field of the column.
        found: Excerpt,
    },
    /// A row has more or fewer fields than the header.
    Ragged {
        /// Number of fields in the header.
        expected: usize,
        /// Number of fields in this row.
        found: usize,
    },
    /// The file ends within its last row.
    Truncated {
        /// Part of the last field.
        found: Excerpt,
    },
    /// A field has text in place of a number.
    NotANumber {
        /// Text of the field.
        found: Excerpt,
        /// Decimal separator of this file.
        decimal: char,
    },
    /// A time column of clock times has another text.
    NotAClock {
        /// Text of the field.
        found: Excerpt,
    },
    /// A number is NaN, infinite, or too large for a 64-bit float.
    NotFinite {
        /// Text of the field.
        found: Excerpt,
    },
    /// A number has separators between its thousands, or a separator that could be one.
    Thousands {
        /// Text of the field.
        found: Excerpt,
    },
    /// Every number with a comma could be decimal or grouped by thousands.
    DecimalAmbiguous {
        /// First such field.
        found: Excerpt,
    },
    /// Some numbers have a decimal comma and some a decimal point.
    DecimalMixed {
        /// First field with the other separator.
        found: Excerpt,
    },
    /// A row has no time.
    TimeMissing,
    /// Time repeats or runs backwards.
    TimeOrder {
        /// Text of the time field.
        found: Excerpt,
        /// Time of the previous row (s).
        previous_s: f64,
        /// Time of this row (s).
        time_s: f64,
    },
    /// A time is beyond the range of any logger's clock.
    TimeBounds {
        /// Text of the time field.
        found: Excerpt,
        /// Time (s).
        time_s: f64,
    },
    /// The time steps are too long for the declared unit.
    TimeScale {
        /// Mean step (s) if the time is in the declared unit.
        mean_step_s: f64,
        /// Declared unit.
        declared: Unit,
        /// Line for a mapping file with a plausible unit.
        proposal: String,
    },
    /// No signal of this unit has such values.
    Implausible(Implausible),
}

impl Problem {
    /// Returns whether the problem concerns one row, without which the others can be read.
    pub(super) fn is_of_row(&self) -> bool {
        matches!(
            self,
            Self::Ragged { .. }
                | Self::Truncated { .. }
                | Self::Unmapped { .. }
                | Self::NotANumber { .. }
                | Self::NotAClock { .. }
                | Self::NotFinite { .. }
                | Self::Thousands { .. }
                | Self::TimeMissing
                | Self::TimeOrder { .. }
                | Self::TimeBounds { .. }
                | Self::Implausible(Implausible::DutyRange { .. })
        )
    }

    /// Returns the stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Io(_) => "E-CSV-IO",
            Self::ReadAfterError => "E-CSV-AFTER-ERROR",
            Self::Empty => "E-CSV-EMPTY",
            Self::Encoding { .. } => "E-CSV-ENCODING",
            Self::LineEnd => "E-CSV-LINE-END",
            Self::Limit { budget, .. } => match budget {
                Budget::FileBytes => "E-CSV-LIMIT-FILE",
                Budget::RecordBytes => "E-CSV-LIMIT-RECORD",
                Budget::FieldBytes => "E-CSV-LIMIT-FIELD",
                Budget::Columns => "E-CSV-LIMIT-COLUMNS",
                Budget::Samples => "E-CSV-LIMIT-SAMPLES",
            },
            Self::NoDelimiter { .. } => "E-CSV-DELIMITER",
            Self::NoHeader { .. } => "E-CSV-HEADER",
            Self::Name { .. } => "E-CSV-NAME",
            Self::UnitMissing { .. } => "E-CSV-UNIT-MISSING",
            Self::UnitUnknown { .. } => "E-CSV-UNIT-UNKNOWN",
            Self::UnitConflict { .. } => "E-CSV-UNIT-CONFLICT",
            Self::PressureReference { .. } => "E-CSV-PRESSURE-REFERENCE",
            Self::DuplicateName { .. } => "E-CSV-NAME-DUPLICATE",
            Self::TwoTimeColumns { .. } => "E-CSV-TIME-TWO-COLUMNS",
            Self::NoTimeColumn { .. } => "E-CSV-TIME-NO-COLUMN",
            Self::NoSignal => "E-CSV-NO-SIGNAL",
            Self::NoData => "E-CSV-NO-DATA",
            Self::NoRowKept { .. } => "E-CSV-NO-ROW-KEPT",
            Self::ConstantLogged { .. } => "E-CSV-CONSTANT-LOGGED",
            Self::MappedColumnMissing { .. } => "E-CSV-MAPPED-COLUMN",
            Self::MappedColumnTwice { .. } => "E-CSV-MAPPED-COLUMN-TWICE",
            Self::Unmapped { .. } => "E-CSV-UNMAPPED",
            Self::Ragged { .. } => "E-CSV-RAGGED",
            Self::Truncated { .. } => "E-CSV-TRUNCATED",
            Self::NotANumber { .. } => "E-CSV-NUMBER",
            Self::NotAClock { .. } => "E-CSV-CLOCK",
            Self::NotFinite { .. } => "E-CSV-NOT-FINITE",
            Self::Thousands { .. } => "E-CSV-THOUSANDS",
            Self::DecimalAmbiguous { .. } => "E-CSV-DECIMAL-AMBIGUOUS",
            Self::DecimalMixed { .. } => "E-CSV-DECIMAL-MIXED",
            Self::TimeMissing => "E-CSV-TIME-MISSING",
            Self::TimeOrder { .. } => "E-CSV-TIME-ORDER",
            Self::TimeBounds { .. } => "E-CSV-TIME-BOUNDS",
            Self::TimeScale { .. } => "E-CSV-TIME-SCALE",
            Self::Implausible(implausible) => match implausible.code() {
                Code::DutyRange => "E-CSV-DUTY-RANGE",
                Code::BelowVacuum => "E-CSV-BELOW-VACUUM",
                Code::Bounds => "E-CSV-BOUNDS",
                Code::Scale => "E-CSV-SCALE",
            },
        }
    }

    /// Returns the next step, as an instruction.
    pub fn next_step(&self) -> String {
        let fixed = match self {
            Self::Io(_) => "check that the file exists and may be read",
            Self::ReadAfterError => "stop at the first error",
            Self::Empty => "check that the logger wrote the file to its end",
            Self::Encoding { is_text: true, .. } => "save the file as UTF-8",
            Self::Encoding { is_text: false, .. } => "export the log as CSV, or as MF4",
            Self::LineEnd => "save the file with line feeds (LF or CR LF)",
            Self::Limit { budget, .. } => match budget {
                Budget::RecordBytes | Budget::FieldBytes => {
                    "look for a quote that is not closed, or raise the limit if the line is meant"
                }
                _ => "split the file, or raise the limit",
            },
            Self::NoDelimiter { .. } => {
                "separate columns by comma, semicolon or tab, or name the delimiter in a mapping"
            }
            Self::NoHeader { .. } => {
                "add a header such as time_s,p_ch_bar_gauge or name the columns in a mapping"
            }
            Self::Name { .. } => "rename the column, or name the signal in a mapping",
            Self::UnitMissing { .. } => {
                "add the unit as a suffix such as _bar_gauge or _mA, or map the column"
            }
            Self::UnitUnknown {
                meant: Some(unit), ..
            } => return format!("write {}", unit.token()),
            Self::UnitUnknown { .. } => {
                "use a unit of the table in the documentation, or map the column with a scale"
            }
            Self::UnitConflict { .. } => "correct one of the two",
            Self::PressureReference { found } => {
                return format!(
                    "write {0}_gauge, {0}_abs, or {0}_diff for a difference",
                    found.as_str()
                );
            }
            Self::DuplicateName { .. } => {
                "rename one of them, or leave one out by `ignore` in a mapping"
            }
            Self::TwoTimeColumns { .. } => {
                "choose one by [time] and leave the other out by `ignore` in a mapping"
            }
            Self::NoTimeColumn { .. } => "name it time_s, or choose it by [time] in a mapping",
            Self::NoSignal => "add a column with a signal, such as p_ch_bar_gauge",
            Self::NoData => "check that the logger wrote rows",
            Self::NoRowKept { .. } => "correct from_s and until_s under [rows] in the mapping",
            Self::ConstantLogged { .. } => {
                "take it out of [constant] in the mapping, or list the column under `ignore`"
            }
            Self::MappedColumnMissing { .. } => {
                "use a header field as it stands in the file, or a number from 1"
            }
            Self::MappedColumnTwice { .. } => "name the column by its number, from 1",
            Self::Unmapped { .. } => {
                "map the column under [signal.NAME], or list its number under `ignore`"
            }
            Self::Ragged { .. } => {
                "check the line for missing or stray separators (a decimal comma?)"
            }
            Self::Truncated { .. } => {
                "log again, delete the last row, or end it with a line feed if it is whole"
            }
            Self::NotANumber { .. } => {
                "correct the field, leave it empty if the sample is missing, or list the word under `missing` in a mapping"
            }
            Self::NotAClock { .. } => {
                "correct the field; a date has the form 23.11.2026 or 2026-11-23, and every row has the form of the first"
            }
            Self::NotFinite { .. } => {
                "leave the field empty, or list the word under `missing` in a mapping"
            }
            Self::Thousands { .. } => "name the thousands_separator of this column in a mapping",
            Self::DecimalAmbiguous { .. } => {
                "say in a mapping: dialect.decimal = \",\" or a thousands_separator"
            }
            Self::DecimalMixed { .. } => {
                "export with one decimal separator, or name it by dialect.decimal in a mapping"
            }
            Self::TimeMissing => "delete the row or restore its time",
            Self::TimeOrder {
                previous_s, time_s, ..
            } => return time_order_advice(*previous_s, *time_s),
            Self::TimeBounds { .. } => {
                "correct the unit of the time, or scale and offset under [time] in the mapping"
            }
            Self::TimeScale { proposal, .. } => return format!("say in a mapping: {proposal}"),
            Self::Implausible(implausible) => return implausible.next_step(),
        };
        fixed.to_owned()
    }
}

/// Returns advice for a backward step. A step of nearly a power of two of microseconds or milliseconds is a counter
/// overflow.
fn time_order_advice(previous_s: f64, time_s: f64) -> String {
    let back_s = previous_s - time_s;
    for (bits, tick, tick_s) in [
        (16, "ms", 1e-3),
        (32, "ms", 1e-3),
        (16, "µs", 1e-6),
        (32, "µs", 1e-6),
    ] {
        let span_s = 2f64.powi(bits) * tick_s;
        if back_s > 0.98 * span_s && back_s <= span_s {
            return format!(
                "the logger's {bits}-bit counter of {tick} ran over: unwrap it before the import"
            );
        }
    }
    "cut the file there; rows are never sorted, because then nobody would see what happened"
        .to_owned()
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "{error}"),
            Self::ReadAfterError => write!(f, "an error came before, its rest was not read"),
            Self::Empty => write!(f, "there is nothing in it, expected a header and rows"),
            Self::Encoding { guess, .. } => {
                write!(
                    f,
                    "found {guess}, expected text in UTF-8, UTF-16 or Windows-1252"
                )
            }
            Self::LineEnd => write!(
                f,
                "lines end with a bare carriage return, expected a line feed"
            ),
            Self::Limit { budget, bound } => match budget {
                Budget::FileBytes => write!(f, "the file is longer than {bound} bytes"),
                Budget::RecordBytes => write!(f, "the record is longer than {bound} bytes"),
                Budget::FieldBytes => write!(f, "the field is longer than {bound} bytes"),
                Budget::Columns => write!(f, "there are more than {bound} columns"),
                Budget::Samples => write!(f, "there are more than {bound} rows"),
            },
            Self::NoDelimiter { found } => {
                let known = Delimiter::ALL.map(Delimiter::name).join(", ");
                write!(f, "found {found}, expected columns separated by {known}")
            }
            Self::NoHeader { found } => write!(
                f,
                "found the number {found}, expected a header with names and units"
            ),
            Self::Name { found, problem } => {
                write!(f, "found {found}, expected the name of a signal: {problem}")
            }
            Self::UnitMissing { found } => write!(f, "found {found}, expected a name with a unit"),
            Self::UnitUnknown { found, .. } => write!(f, "found {found}, expected a unit"),
            Self::UnitConflict { header, units_row } => {
                write!(
                    f,
                    "the units row says {units_row}, expected {header} as in the header"
                )
            }
            Self::PressureReference { found } => {
                write!(f, "found {found}, expected gauge or absolute as well")
            }
            Self::DuplicateName { name, first_column } => {
                write!(
                    f,
                    "{} is column {first_column} already, expected each signal once",
                    Excerpt::of(name)
                )
            }
            Self::TwoTimeColumns { first_column } => {
                write!(
                    f,
                    "column {first_column} is the time already, expected one time column"
                )
            }
            Self::NoTimeColumn { found } => write!(f, "found {found}, expected a time column"),
            Self::NoSignal => write!(f, "the time is the only column, expected a signal"),
            Self::NoData => write!(f, "there is no row of numbers, expected at least one"),
            Self::NoRowKept { first_s, last_s } => write!(
                f,
                "the rows from {first_s} s to {last_s} s are all left out, expected at least one to keep"
            ),
            Self::ConstantLogged { name } => write!(
                f,
                "found {} in the file, expected it in the mapping alone, where it is constant",
                Excerpt::of(name)
            ),
            Self::MappedColumnMissing { wanted, found } => {
                write!(
                    f,
                    "found {found}, expected the column {} of the mapping",
                    Excerpt::of(wanted)
                )
            }
            Self::MappedColumnTwice { wanted } => {
                write!(f, "found two columns {}, expected one", Excerpt::of(wanted))
            }
            Self::Unmapped { found } => write!(
                f,
                "found {found}, expected a header or a mapping to say what this column is"
            ),
            Self::Ragged { expected, found } => {
                write!(f, "found {found} fields, expected {expected}")
            }
            Self::Truncated { found } => {
                write!(
                    f,
                    "the file ends without a line feed at {found}, expected a whole last row"
                )
            }
            Self::NotANumber { found, decimal } => {
                write!(
                    f,
                    "found {found}, expected a number with the decimal separator {decimal:?}"
                )
            }
            Self::NotAClock { found } => write!(
                f,
                "found {found}, expected a date with a time or a time of day, such as 23.11.2026 14:05:06,125"
            ),
            Self::NotFinite { found } => write!(f, "found {found}, expected a finite number"),
            Self::Thousands { found } => write!(
                f,
                "found {found}, expected a number without thousands separators"
            ),
            Self::DecimalAmbiguous { found } => {
                write!(
                    f,
                    "found {found}, expected a number that cannot also be one with a thousands separator"
                )
            }
            Self::DecimalMixed { found } => {
                write!(
                    f,
                    "found {found}, expected the decimal separator of the fields before it"
                )
            }
            Self::TimeMissing => write!(f, "found no time, expected one in each row"),
            Self::TimeBounds { found, time_s } => {
                let most = Bounds::of(Quantity::Time).most;
                write!(
                    f,
                    "found {found}, which is {time_s} s (allowed: {} to {most} s)",
                    -most
                )
            }
            Self::TimeOrder {
                found,
                previous_s,
                time_s,
            } => {
                write!(
                    f,
                    "found {found} ({time_s} s), expected a time after {previous_s} s"
                )
            }
            Self::TimeScale {
                mean_step_s,
                declared,
                ..
            } => {
                write!(
                    f,
                    "rows are {mean_step_s} s apart if the time is in {declared}, expected less than 10 s"
                )
            }
            Self::Implausible(implausible) => implausible.fmt(f),
        }
    }
}
