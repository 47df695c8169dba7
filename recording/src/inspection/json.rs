//! JSON form of an inspection.

use schemars::JsonSchema;
use serde::Serialize;

use super::{InspectedColumn, Inspection, OpenPoint};
use crate::PressureReference;

/// Name and version of the JSON form of [`InspectedLogs`].
pub const INSPECTION_SCHEMA: &str = "retarder.inspection/2";

/// Inspections of logs, for JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InspectedLogs {
    /// Name and version of this format, `retarder.inspection/2`.
    pub schema: &'static str,
    /// Inspected logs, in the given order.
    pub logs: Vec<InspectedLog>,
}

impl InspectedLogs {
    /// Creates the JSON form of these inspections.
    pub fn of<'a>(inspections: impl IntoIterator<Item = &'a Inspection>) -> Self {
        Self {
            schema: INSPECTION_SCHEMA,
            logs: inspections.into_iter().map(InspectedLog::of).collect(),
        }
    }
}

/// Inspection of one log, for JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InspectedLog {
    /// Name of the file.
    pub source: String,
    /// Format of the file.
    pub format: &'static str,
    /// Layout of the file, in words.
    pub layout: String,
    /// Dialect of a CSV file; null for other formats.
    pub dialect: Option<InspectedDialect>,
    /// Number of rows; of a file with several rates, of its longest group.
    pub rows: u64,
    /// Time from the first to the last row (s); null if unknown.
    pub duration_s: Option<f64>,
    /// Columns or channels, in the order of the file.
    pub columns: Vec<ColumnView>,
    /// Needed signals that were found.
    pub found: Vec<&'static str>,
    /// Needed signals that were not found.
    pub missing: Vec<&'static str>,
    /// Open questions, each with the line or option that answers it.
    pub open: Vec<QuestionView>,
    /// Whether a question is the reference of pressures, which `--pressure` answers.
    pub asks_reference: bool,
    /// Reference that the values suggest for pressures that state none: gauge or absolute.
    pub suggested: Option<&'static str>,
    /// Assumptions of the mapping, to be checked.
    pub assumed: Vec<String>,
    /// Cells and rows that are no numbers.
    pub remarks: Vec<String>,
    /// Number of rows with another number of fields, or with texts among the numbers.
    pub bad_rows: u64,
    /// Spellings of missing samples.
    pub missing_words: Vec<String>,
    /// Proposed mapping (TOML); null if the file needs none.
    pub mapping: Option<String>,
    /// Proposed mapping that also states the given reference of pressures; null if the file needs no reference.
    pub mapping_with_reference: Option<String>,
    /// Whether the log can be read, has every needed signal, and leaves no question open.
    pub is_ready: bool,
    /// Signals that were read with the mapping.
    pub signals: Vec<String>,
    /// Gaps and missing cells that were found then.
    pub defects: Vec<String>,
    /// Reason why the log cannot be read with the mapping; null if it can.
    pub problem: Option<ProblemView>,
}

/// Column or channel of a log with one of its signals, for JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ColumnView {
    /// Position in the file, from 1; the same for two signals of one column.
    pub number: u32,
    /// Name in a mapping.
    pub key: String,
    /// Unit as the file states it; may be empty.
    pub unit_in_file: String,
    /// Rate (Hz); null if unknown.
    pub rate_hz: Option<f64>,
    /// Number of cells with a number.
    pub count: u64,
    /// Number of cells without a number.
    pub empty: u64,
    /// Whether the column has a lower rate than the rows: its empty cells are not missing.
    pub is_slower: bool,
    /// Least number, in the unit of the file; null without numbers.
    pub least: Option<f64>,
    /// Greatest number, in the unit of the file; null without numbers.
    pub greatest: Option<f64>,
    /// Signal, `time`, or the own name of a column that the model does not use; null if it is ignored.
    pub signal: Option<String>,
    /// Unit in the notation of a mapping; null if unknown.
    pub unit: Option<String>,
    /// Reason of the guess.
    pub reason: String,
    /// Whether the signal is that of the header alone, without a mapping.
    pub is_by_header: bool,
    /// Factor for the numbers; null for 1.
    pub scale: Option<f64>,
    /// Number added after the factor; null for 0.
    pub offset: Option<f64>,
    /// Range to which the values are limited; null if there is none.
    pub clip: Option<[f64; 2]>,
    /// Separator of thousands; null if there is none.
    pub thousands_separator: Option<char>,
    /// Range outside which values count as missing, in the unit; null if there is none.
    pub plausible: Option<[f64; 2]>,
}

/// Dialect of a CSV file, in the words of a mapping.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InspectedDialect {
    /// Column separator: comma, semicolon or tab.
    pub delimiter: &'static str,
    /// Decimal separator.
    pub decimal: char,
    /// Whether the first record names the columns.
    pub header: bool,
    /// Whether a row of units follows the header.
    pub units_row: bool,
    /// Number of lines before the header.
    pub skip_lines: u32,
}

/// Open question, for JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct QuestionView {
    /// Question.
    pub question: String,
    /// Line of a mapping, or option, that answers it.
    pub answer: String,
}

/// Refusal of a log, for JSON.
#[derive(Clone, Debug, Serialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ProblemView {
    /// Stable code, such as `E-CSV-TIME-ORDER`.
    pub code: &'static str,
    /// Place, cause and what to do.
    pub message: String,
}

impl InspectedLog {
    /// Creates the JSON form of an inspection.
    pub fn of(log: &Inspection) -> Self {
        let (signals, defects, problem) = match &log.trial {
            Ok(trial) => (trial.signals.clone(), trial.defects.clone(), None),
            Err(error) => {
                let problem = ProblemView {
                    code: error.code(),
                    message: error.to_string(),
                };
                (Vec::new(), Vec::new(), Some(problem))
            }
        };
        Self {
            source: log.source.clone(),
            format: log.format.name(),
            layout: log.layout.clone(),
            dialect: log.dialect.map(|(dialect, skip_lines)| InspectedDialect {
                delimiter: dialect.delimiter.name(),
                decimal: dialect.decimal.symbol(),
                header: dialect.header,
                units_row: dialect.units_row,
                skip_lines,
            }),
            rows: log.rows,
            duration_s: log.duration_s,
            columns: log.columns.iter().map(ColumnView::of).collect(),
            found: log.found.clone(),
            missing: log.missing.clone(),
            open: log.open.iter().map(QuestionView::of).collect(),
            asks_reference: log.asks_reference,
            suggested: log.suggested.map(|reference| match reference {
                PressureReference::Gauge => "gauge",
                PressureReference::Absolute => "absolute",
            }),
            assumed: log.assumed.clone(),
            remarks: log.remarks.clone(),
            bad_rows: log.bad_rows,
            missing_words: log.missing_words.clone(),
            mapping: log.mapping.clone(),
            mapping_with_reference: log.mapping_with_reference.clone(),
            is_ready: log.is_ready(),
            signals,
            defects,
            problem,
        }
    }
}

impl ColumnView {
    fn of(column: &InspectedColumn) -> Self {
        let number = |value: f64| (column.values.count > 0).then_some(value);
        Self {
            number: column.number,
            key: column.key.clone(),
            unit_in_file: column.unit_in_file.clone(),
            rate_hz: column.rate_hz,
            count: column.values.count,
            empty: column.values.missing,
            is_slower: column.values.has_own_rate(),
            least: number(column.values.least),
            greatest: number(column.values.greatest),
            signal: column.signal.clone(),
            unit: column.unit.clone(),
            reason: column.reason.clone(),
            is_by_header: column.is_by_header,
            scale: column.scale,
            offset: column.offset,
            clip: column.clip,
            thousands_separator: column.thousands,
            plausible: column
                .plausible
                .as_ref()
                .map(|range| [*range.start(), *range.end()]),
        }
    }
}

impl QuestionView {
    fn of(point: &OpenPoint) -> Self {
        Self {
            question: point.question.clone(),
            answer: point.answer.clone(),
        }
    }
}
