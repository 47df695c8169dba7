//! Mapping: describes the columns of a file where the file itself does not.

use std::collections::BTreeMap;
use std::ops::{Range, RangeInclusive};
use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::complement::{
    Constant, ConstantToml, Window, WindowToml, resolve_constants, resolve_window,
};
use super::error::Excerpt;
use super::header::{Reference, parse_unit};
use super::mapping_error::{AtSpan, BYTES_MAX, MappingError, MappingProblem};
use super::{Decimal, Delimiter};
use crate::name::{check_name, is_time_column};
use crate::{PressureReference, Quantity, Unit};

/// Word in place of the unit of a time column with dates or times of day.
pub(crate) const CLOCK: &str = "clock";

/// Columns, units and dialect of files that do not define them. Read from TOML:
///
/// ```
/// let mapping = recording::csv::Mapping::parse("wild.toml", r#"
///     schema = 1
///     ignore = ["comment"]              # columns to leave out, by header field or number from 1
///     missing = ["NaN", "---"]          # words that mean: no sample here
///
///     [dialect]                         # each found out from the file if not given
///     delimiter = "semicolon"           # or "comma", "tab"
///     decimal = ","                     # or "."
///     header = true
///     skip_lines = 2                    # lines before the header
///
///     [time]
///     column = "Zeit"
///     unit = "us"                       # or "clock": dates or times of day, such as 23.11.2026 14:05:06,125
///     thousands_separator = "."
///
///     [signal.p_ch]
///     column = 3
///     unit = "bar_gauge"
///     scale = 2.0                       # bar per logged volt
///     offset = -1.0                     # added after the scale
///     check_scale = false               # accept values of unusual size
///     plausible = [-1, 12]              # values outside, such as glitches, count as missing; in bar_gauge
///
///     [signal.duty_fill]                # a column with -1, 0 and 1 commands both valves
///     column = "state"
///     unit = "frac"
///     clip = [0, 1]                     # limits the values after scale and offset
///
///     [signal.duty_vent]
///     column = "state"
///     unit = "frac"
///     scale = -1.0
///     clip = [0, 1]
///
///     [constant.u_bat]                  # not in the file, since it stayed as it was
///     value = 24
///     unit = "V"
///
///     [constant.p_amb]                  # for those of several logs that do not have it
///     value = 1.013
///     unit = "bar_abs"
///     where_absent = true
///
///     [rows]                            # the others are left out
///     from_s = 6.2
///     until_s = 140
///     instants_of = "duty_fill"         # of a log with several rates: all signals at the instants of this one
/// "#)?;
/// # Ok::<(), recording::csv::MappingError>(())
/// ```
///
/// MF4 files have channels, which `column` and `ignore` name. There the dialect and `missing` have no effect, and the
/// time is that of the group. Columns that are neither mapped nor ignored are interpreted by their header, or refused.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mapping {
    /// Reference of pressures whose unit states none.
    pub(crate) reference: Reference,
    pub(crate) delimiter: Option<Delimiter>,
    pub(crate) decimal: Option<Decimal>,
    pub(crate) header: Option<bool>,
    pub(crate) units_row: Option<bool>,
    pub(crate) skip_lines: u32,
    pub(crate) ignore: Vec<ColumnKey>,
    pub(crate) missing: Vec<String>,
    pub(crate) time: Option<MappedColumn>,
    pub(crate) signals: BTreeMap<String, MappedColumn>,
    pub(crate) constants: BTreeMap<String, Constant>,
    pub(crate) rows: Window,
    pub(crate) instants_of: Option<String>,
}

/// Column as named by a mapping.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(untagged)]
pub(crate) enum ColumnKey {
    /// Position of the column, from 1.
    Number(u32),
    /// Header field of the column.
    Header(String),
}

impl ColumnKey {
    /// Returns whether this is the column with that number, from 1, and header field.
    pub(crate) fn is(&self, number: u32, header: &str) -> bool {
        match self {
            Self::Number(wanted) => *wanted == number,
            Self::Header(wanted) => wanted == header,
        }
    }
}

/// Conversion of a logged number to the value of a signal: number * scale + offset, limited to a range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Conversion {
    pub(crate) scale: f64,
    pub(crate) offset: f64,
    /// Least and greatest value; a value outside becomes the nearer one.
    pub(crate) clip: Option<[f64; 2]>,
}

impl Conversion {
    /// Conversion that keeps every number.
    pub(crate) const NONE: Self = Self {
        scale: 1.0,
        offset: 0.0,
        clip: None,
    };

    /// Returns the value of a logged number; without scale and offset every bit of a number in the range is unchanged.
    pub(crate) fn value(&self, logged: f64) -> f64 {
        let value = match (self.scale, self.offset) {
            (1.0, 0.0) => logged,
            (scale, offset) => logged * scale + offset,
        };
        match self.clip {
            // The sum makes -0 to 0.
            Some([least, greatest]) => value.clamp(least, greatest) + 0.0,
            None => value,
        }
    }
}

/// Mapping of one column.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct MappedColumn {
    pub(crate) column: ColumnKey,
    pub(crate) unit: Unit,
    pub(crate) conversion: Conversion,
    pub(crate) thousands: Option<char>,
    pub(crate) check_scale: bool,
    /// Range of the converted values, in `unit`; values outside count as missing.
    pub(crate) plausible: Option<RangeInclusive<f64>>,
    /// Whether the column has dates or times of day; its unit is then the second.
    pub(crate) is_clock: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct MappingToml {
    schema: Spanned<i64>,
    #[serde(default)]
    ignore: Vec<ColumnKey>,
    #[serde(default)]
    missing: Vec<String>,
    #[serde(default)]
    dialect: DialectToml,
    time: Option<ColumnToml>,
    #[serde(default)]
    signal: BTreeMap<Spanned<String>, ColumnToml>,
    #[serde(default)]
    constant: BTreeMap<Spanned<String>, ConstantToml>,
    #[serde(default)]
    rows: WindowToml,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct DialectToml {
    delimiter: Option<Spanned<String>>,
    decimal: Option<Spanned<String>>,
    header: Option<bool>,
    units_row: Option<bool>,
    #[serde(default)]
    skip_lines: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ColumnToml {
    column: Spanned<ColumnKey>,
    unit: Spanned<String>,
    scale: Option<Spanned<f64>>,
    offset: Option<Spanned<f64>>,
    thousands_separator: Option<Spanned<String>>,
    #[serde(default = "yes")]
    check_scale: bool,
    plausible: Option<Spanned<[f64; 2]>>,
    clip: Option<Spanned<[f64; 2]>>,
}

fn yes() -> bool {
    true
}

impl Mapping {
    /// Maximum size of a mapping file (bytes).
    pub const BYTES_MAX: u64 = BYTES_MAX;

    /// Parses the TOML text of the mapping file `source_name`.
    ///
    /// # Errors
    /// Returns a [`MappingError`] with file, line and column.
    pub fn parse(source_name: &str, text: &str) -> Result<Self, MappingError> {
        Self::parse_with_reference(source_name, text, None)
    }

    /// Returns the mapping with the reference of pressures whose unit in the log states none, such as `bar`. A unit
    /// that states its reference keeps it.
    #[must_use]
    pub fn with_reference(mut self, reference: Option<PressureReference>) -> Self {
        self.reference = reference;
        self
    }

    /// Parses the TOML text of the mapping file `source_name`, with the reference of pressures whose unit, in the
    /// mapping or in the log, states none.
    ///
    /// # Errors
    /// Returns a [`MappingError`] with file, line and column.
    pub fn parse_with_reference(
        source_name: &str,
        text: &str,
        reference: Option<PressureReference>,
    ) -> Result<Self, MappingError> {
        let error = |span: Option<Range<usize>>, problem| {
            MappingError::new(source_name, text, span, problem)
        };
        if text.len() as u64 > Self::BYTES_MAX {
            return Err(error(None, MappingProblem::Long));
        }
        let raw: MappingToml = toml::from_str(text).map_err(|failure| {
            error(
                failure.span(),
                MappingProblem::Toml(failure.message().to_owned()),
            )
        })?;
        resolve(raw, reference).map_err(|(span, problem)| error(Some(span), problem))
    }

    /// Reads a mapping from a TOML file.
    ///
    /// # Errors
    /// Returns a [`MappingError`] with file, line and column.
    pub fn read_file(path: impl AsRef<Path>) -> Result<Self, MappingError> {
        Self::read_file_with_reference(path, None)
    }

    /// Reads a mapping from a TOML file, with the reference of pressures whose unit, in the mapping or in the log,
    /// states none.
    ///
    /// # Errors
    /// Returns a [`MappingError`] with file, line and column.
    pub fn read_file_with_reference(
        path: impl AsRef<Path>,
        reference: Option<PressureReference>,
    ) -> Result<Self, MappingError> {
        let path = path.as_ref();
        let source_name = path.display().to_string();
        let error = |problem| MappingError::new(&source_name, "", None, problem);
        let mut text = String::new();
        let file =
            std::fs::File::open(path).map_err(|failure| error(MappingProblem::Io(failure)))?;
        std::io::Read::read_to_string(
            &mut std::io::Read::take(file, Self::BYTES_MAX + 1),
            &mut text,
        )
        .map_err(|failure| error(MappingProblem::Io(failure)))?;
        Self::parse_with_reference(&source_name, &text, reference)
    }
}

fn resolve(mut raw: MappingToml, reference: Reference) -> Result<Mapping, AtSpan> {
    if *raw.schema.get_ref() != 1 {
        return Err((
            raw.schema.span(),
            MappingProblem::Schema(*raw.schema.get_ref()),
        ));
    }
    let delimiter = choice(
        raw.dialect.delimiter,
        &[
            ("comma", Delimiter::Comma),
            (",", Delimiter::Comma),
            ("semicolon", Delimiter::Semicolon),
            (";", Delimiter::Semicolon),
            ("tab", Delimiter::Tab),
            ("\t", Delimiter::Tab),
        ],
    )?;
    let decimal = choice(
        raw.dialect.decimal,
        &[(".", Decimal::Point), (",", Decimal::Comma)],
    )?;
    let time = raw
        .time
        .map(|column| resolve_time(column, decimal))
        .transpose()?;
    if let Some((_, unit_span)) = time
        .as_ref()
        .filter(|(time, _)| time.unit.quantity() != Quantity::Time)
    {
        return Err((unit_span.clone(), MappingProblem::NoTimeUnit));
    }
    let mut signals = BTreeMap::new();
    for (name, column) in raw.signal {
        let (span, name) = (name.span(), name.into_inner());
        check_name(&name).map_err(|problem| (span.clone(), MappingProblem::Name(problem)))?;
        let (column, _) = resolve_column(column, decimal, reference)?;
        if is_time_column(&name, column.unit) {
            return Err((span, MappingProblem::TimeAsSignal));
        }
        signals.insert(name, column);
    }
    Ok(Mapping {
        reference,
        delimiter,
        decimal,
        header: raw.dialect.header,
        units_row: raw.dialect.units_row,
        skip_lines: raw.dialect.skip_lines,
        ignore: raw.ignore,
        missing: raw.missing,
        time: time.map(|(column, _)| column),
        signals,
        constants: resolve_constants(raw.constant, reference)?,
        instants_of: raw.rows.instants_of.take(),
        rows: resolve_window(raw.rows)?,
    })
}

/// Resolves the time column, which may have a clock in place of a unit.
fn resolve_time(
    mut raw: ColumnToml,
    decimal: Option<Decimal>,
) -> Result<(MappedColumn, Range<usize>), AtSpan> {
    if let Some(range) = raw.plausible.as_ref().or(raw.clip.as_ref()) {
        return Err((range.span(), MappingProblem::TimeRange));
    }
    if raw.unit.get_ref() != CLOCK {
        return resolve_column(raw, decimal, None);
    }
    raw.unit = Spanned::new(raw.unit.span(), Unit::Second.token().to_owned());
    let (column, span) = resolve_column(raw, decimal, None)?;
    let column = MappedColumn {
        is_clock: true,
        // A clock has no unit that could be wrong.
        check_scale: false,
        ..column
    };
    Ok((column, span))
}

fn resolve_column(
    raw: ColumnToml,
    decimal: Option<Decimal>,
    reference: Reference,
) -> Result<(MappedColumn, Range<usize>), AtSpan> {
    if *raw.column.get_ref() == ColumnKey::Number(0) {
        return Err((raw.column.span(), MappingProblem::ColumnZero));
    }
    let unit_span = raw.unit.span();
    let unit = parse_unit(raw.unit.get_ref(), reference).map_err(|problem| {
        (
            unit_span.clone(),
            MappingProblem::Unit(format!("{problem}; {}", problem.next_step())),
        )
    })?;
    let number = |value: Option<Spanned<f64>>, default: f64, zero_allowed: bool| match value {
        None => Ok(default),
        Some(value) if value.get_ref().is_finite() && (zero_allowed || *value.get_ref() != 0.0) => {
            Ok(*value.get_ref())
        }
        Some(value) => Err((value.span(), MappingProblem::Factor(*value.get_ref()))),
    };
    let plausible = resolve_range(raw.plausible)?;
    let clip = resolve_range(raw.clip)?;
    let thousands_span = raw.thousands_separator.as_ref().map(Spanned::span);
    let thousands = choice(
        raw.thousands_separator,
        &[(".", '.'), (",", ','), (" ", ' '), ("'", '\''), ("_", '_')],
    )?;
    if let (Some(thousands), Some(decimal), Some(span)) = (thousands, decimal, thousands_span)
        && thousands == decimal.symbol()
        && decimal == Decimal::Comma
    {
        return Err((span, MappingProblem::ThousandsAsDecimal));
    }
    let column = MappedColumn {
        column: raw.column.into_inner(),
        unit,
        conversion: Conversion {
            scale: number(raw.scale, 1.0, false)?,
            offset: number(raw.offset, 0.0, true)?,
            clip,
        },
        thousands,
        check_scale: raw.check_scale,
        plausible: plausible.map(|[least, greatest]| least..=greatest),
        is_clock: false,
    };
    Ok((column, unit_span))
}

fn resolve_range(range: Option<Spanned<[f64; 2]>>) -> Result<Option<[f64; 2]>, AtSpan> {
    let Some(range) = range else { return Ok(None) };
    let [least, greatest] = *range.get_ref();
    // Also false for NaN.
    if !(least < greatest && least.is_finite() && greatest.is_finite()) {
        return Err((range.span(), MappingProblem::Range { least, greatest }));
    }
    Ok(Some([least, greatest]))
}

fn choice<T: Copy>(
    text: Option<Spanned<String>>,
    choices: &[(&'static str, T)],
) -> Result<Option<T>, AtSpan> {
    let Some(text) = text else { return Ok(None) };
    match choices.iter().find(|(word, _)| word == text.get_ref()) {
        Some(&(_, chosen)) => Ok(Some(chosen)),
        None => Err((
            text.span(),
            MappingProblem::Choice {
                found: Excerpt::of(text.get_ref()),
                choices: choices.iter().map(|(word, _)| *word).collect(),
            },
        )),
    }
}
