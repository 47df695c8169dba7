use std::fs::File;
use std::io::{self, Chain, Cursor, Read};
use std::path::Path;

use super::checks::{Watch, judge_time};
use super::dialect::{DecimalVote, check_encoding, find_delimiter};
use super::error::{Budget, CsvError, Excerpt, Place, Problem};
use super::header::is_units_row;
use super::number::{self, NumberError, Style};
use super::plan::{FieldPlan, Head, Plan, resolve};
use super::record::{AtLine, BYTE_ORDER_MARK, Record, Records};
use super::{Decimal, Delimiter, Dialect, Limits, Mapping};
use crate::{Converter, Note, Provenance, Recording, TimeBase, Unit};

/// The head of a file decides its dialect [bytes].
const HEAD_BYTES: usize = 64 << 10;
/// The size of values is judged each time so many rows were read.
const ROWS_PER_JUDGEMENT: u64 = 1 << 16;

/// What to know before a file is read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// What the columns are, where the file does not say it.
    pub mapping: Mapping,
    /// Budgets.
    pub limits: Limits,
}

/// A signal of a CSV file: its base name and its unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Base name, such as `p_ch`.
    pub name: String,
    /// Unit of the values.
    pub unit: Unit,
}

/// Reads a CSV file row by row. Memory does not grow with the length of the file.
pub struct Reader<R: Read> {
    source_name: String,
    records: Records<Chain<Cursor<Vec<u8>>, R>>,
    plan: Plan,
    dialect: Dialect,
    columns: Vec<Column>,
    rows: RowParser,
    state: State,
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    Reading,
    Ended,
    Failed,
}

/// One row: a time and one value per column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Line in the file, from 1.
    pub line: u64,
    /// Time [s].
    pub time_s: f64,
    /// Values in the order and the units of [`Reader::columns`], NaN where missing.
    pub values: &'a [f64],
}

impl Row<'_> {
    /// The value of column `index`; none if it is missing.
    pub fn get(&self, index: usize) -> Option<f64> {
        self.values
            .get(index)
            .copied()
            .filter(|value| !value.is_nan())
    }
}

impl<R: Read> Reader<R> {
    /// Reads the head of `input` and decides on its dialect and its columns. `source_name` is for messages.
    ///
    /// # Errors
    /// [`CsvError`] if the head is not that of a CSV log.
    pub fn new(source_name: &str, mut input: R, options: &Options) -> Result<Self, CsvError> {
        let fail = |(place, problem)| CsvError::new(source_name, place, problem);
        let fail_at_line = |error| fail(at_line(error));
        let Options { mapping, limits } = options;
        let (head, head_is_all) = read_head(&mut input, *limits)
            .map_err(|error| fail_at_line((None, Problem::Io(error))))?;
        check_encoding(&head).map_err(fail_at_line)?;
        let delimiter = match mapping.delimiter {
            Some(delimiter) => delimiter,
            None => find_delimiter(&head, mapping.skip_lines).map_err(fail_at_line)?,
        };
        let opening =
            Opening::read(&head, head_is_all, delimiter, options).map_err(fail_at_line)?;
        let plan = resolve(&opening.head(), mapping).map_err(fail)?;
        let decimal = match mapping.decimal {
            Some(decimal) => decimal,
            None => opening
                .vote(&head, head_is_all, &plan, options)
                .map_err(fail)?,
        };
        let dialect = Dialect {
            delimiter,
            decimal,
            header: opening.is_header,
            units_row: opening.units.is_some(),
            byte_order_mark: head.starts_with(BYTE_ORDER_MARK),
        };
        let mut records = Records::new(Cursor::new(head).chain(input), delimiter, *limits);
        opening.skip(&mut records, mapping).map_err(fail_at_line)?;
        let columns = plan
            .signals
            .iter()
            .map(|signal| Column {
                name: signal.name.clone(),
                unit: signal.unit,
            })
            .collect();
        let rows = RowParser::new(&plan, decimal, options)
            .map_err(|problem| fail((Place::default(), problem)))?;
        let source_name = source_name.to_owned();
        Ok(Self {
            source_name,
            records,
            plan,
            dialect,
            columns,
            rows,
            state: State::Reading,
        })
    }

    /// The signals, in the order of their columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// How the file is written.
    pub fn dialect(&self) -> Dialect {
        self.dialect
    }

    /// The next row; none at the end of the file.
    ///
    /// # Errors
    /// The first thing that is wrong; there is nothing to read after it.
    pub fn next_row(&mut self) -> Result<Option<Row<'_>>, CsvError> {
        let error = match self.state {
            State::Ended => return Ok(None),
            State::Failed => (Place::default(), Problem::ReadAfterError),
            State::Reading => match self.advance() {
                Ok(true) => {
                    let RowParser {
                        line,
                        time_s,
                        values,
                        ..
                    } = &self.rows;
                    return Ok(Some(Row {
                        line: *line,
                        time_s: *time_s,
                        values,
                    }));
                }
                Ok(false) => {
                    self.state = State::Ended;
                    return Ok(None);
                }
                Err(error) => error,
            },
        };
        self.state = State::Failed;
        Err(CsvError::new(&self.source_name, error.0, error.1))
    }

    /// Source, notes, and the size and hash of what was read so far: of the whole file once it has ended.
    pub fn provenance(&mut self) -> Provenance {
        let (producer, notes): (Vec<Note>, _) = self
            .records
            .take_notes()
            .into_iter()
            .partition(|note| note.key == "producer");
        Provenance {
            source: self.source_name.clone(),
            producer: producer.into_iter().next().map(|note| note.value),
            notes,
            input: Some(self.records.input_file()),
        }
    }

    fn advance(&mut self) -> Result<bool, (Place, Problem)> {
        match self.records.next().map_err(at_line)? {
            Some(record) => {
                self.rows.parse(record, &self.plan)?;
                Ok(true)
            }
            None => {
                self.rows.finish(&self.plan)?;
                Ok(false)
            }
        }
    }
}

fn at_line((line, problem): AtLine) -> (Place, Problem) {
    (
        Place {
            line,
            ..Place::default()
        },
        problem,
    )
}

/// Enough of the file to decide on its dialect: one head, and more only if that holds no two lines.
fn read_head(input: &mut impl Read, limits: Limits) -> io::Result<(Vec<u8>, bool)> {
    let mut head = Vec::new();
    let mut bytes = HEAD_BYTES;
    loop {
        input
            .by_ref()
            .take((bytes - head.len()) as u64)
            .read_to_end(&mut head)?;
        if head.len() < bytes {
            return Ok((head, true));
        }
        if memchr::memchr_iter(b'\n', &head).nth(2).is_some() || bytes > limits.record_bytes {
            return Ok((head, false));
        }
        bytes *= 2;
    }
}

/// The records before the data.
struct Opening {
    line: u64,
    first: Vec<String>,
    is_header: bool,
    units: Option<Vec<String>>,
}

impl Opening {
    fn read(
        head: &[u8],
        head_is_all: bool,
        delimiter: Delimiter,
        options: &Options,
    ) -> Result<Self, AtLine> {
        let Options { mapping, limits } = options;
        let mut records = Records::new(head, delimiter, *limits);
        records.skip_lines(mapping.skip_lines)?;
        let owned = |record: Record<'_>| record.iter().map(str::to_owned).collect::<Vec<_>>();
        let first = records.next()?.ok_or((None, Problem::Empty))?;
        if first.at_end_of_file && !head_is_all {
            let bound = limits.record_bytes as u64;
            return Err((
                Some(first.line),
                Problem::Limit {
                    budget: Budget::RecordBytes,
                    bound,
                },
            ));
        }
        let (line, first) = (first.line, owned(first));
        let number = first.iter().find(|field| number::is_number_like(field));
        let is_header = mapping.header.unwrap_or(number.is_none());
        let is_explained = mapping.header.is_some() || mapping.time.is_some();
        if let Some(number) = number.filter(|_| !is_explained) {
            return Err((
                Some(line),
                Problem::NoHeader {
                    found: Excerpt::of(number),
                },
            ));
        }
        let mut units = None;
        if is_header
            && mapping.units_row != Some(false)
            // A damaged second record is reported when it is read as data.
            && let Ok(Some(second)) = records.next()
            && (mapping.units_row == Some(true) || is_units_row(second.iter()))
        {
            units = Some(owned(second));
        }
        Ok(Self {
            line,
            first,
            is_header,
            units,
        })
    }

    fn head(&self) -> Head<'_> {
        Head {
            line: self.line,
            first: &self.first,
            is_header: self.is_header,
            units: self.units.as_deref(),
        }
    }

    fn skip<R: Read>(&self, records: &mut Records<R>, mapping: &Mapping) -> Result<(), AtLine> {
        records.skip_lines(mapping.skip_lines)?;
        for _ in 0..usize::from(self.is_header) + usize::from(self.units.is_some()) {
            records.next()?;
        }
        Ok(())
    }

    /// The decimal separator that all numbers in the head agree on.
    fn vote(
        &self,
        head: &[u8],
        head_is_all: bool,
        plan: &Plan,
        options: &Options,
    ) -> Result<Decimal, (Place, Problem)> {
        let mut vote = DecimalVote::default();
        let delimiter = options.mapping.delimiter;
        let delimiter = match delimiter {
            Some(delimiter) => delimiter,
            None => find_delimiter(head, options.mapping.skip_lines).map_err(at_line)?,
        };
        let mut records = Records::new(head, delimiter, options.limits);
        self.skip(&mut records, &options.mapping).map_err(at_line)?;
        let voters: Vec<usize> = std::iter::once(&plan.time)
            .chain(&plan.signals)
            .filter(|column| column.thousands.is_none())
            .map(|column| column.field)
            .collect();
        // A damaged record is reported when it is read as data; the last one may be cut by the end of the head.
        while let Ok(Some(record)) = records.next() {
            if record.at_end_of_file && !head_is_all {
                break;
            }
            if record.len() == plan.fields {
                voters
                    .iter()
                    .for_each(|&field| vote.add(record.line, field, record.get(field)));
            }
        }
        vote.result()
            .map_err(|(ballot, problem)| (plan.place(ballot.line, ballot.field), problem))
    }
}

/// Turns records into rows, and refuses what is no row.
struct RowParser {
    line: u64,
    time_s: f64,
    first_time_s: f64,
    values: Vec<f64>,
    rows: u64,
    rows_max: u64,
    decimal: Decimal,
    missing: Vec<String>,
    to_seconds: Converter,
    watches: Vec<Watch>,
    last_field: LastField,
    scratch: String,
}

impl RowParser {
    fn new(plan: &Plan, decimal: Decimal, options: &Options) -> Result<Self, Problem> {
        let to_seconds = plan
            .time
            .unit
            .converter(Unit::Second)
            .map_err(|_| Problem::NoSignal)?;
        Ok(Self {
            line: 0,
            time_s: f64::NEG_INFINITY,
            first_time_s: f64::NAN,
            values: vec![f64::NAN; plan.signals.len()],
            rows: 0,
            rows_max: options.limits.samples,
            decimal,
            missing: options.mapping.missing.clone(),
            to_seconds,
            watches: plan.signals.iter().map(Watch::new).collect(),
            last_field: LastField::default(),
            scratch: String::new(),
        })
    }

    fn parse(&mut self, record: Record<'_>, plan: &Plan) -> Result<(), (Place, Problem)> {
        let line = record.line;
        self.check_shape(record, plan)?;
        let time = &plan.time;
        let logged = self.number(record, time, plan)?;
        let time_s = logged
            .map(|logged| self.to_seconds.apply(time.value(logged)))
            .ok_or_else(|| (plan.place(line, time.field), Problem::TimeMissing))?;
        if time_s <= self.time_s || !time_s.is_finite() {
            let found = Excerpt::of(record.get(time.field));
            let problem = Problem::TimeOrder {
                found,
                previous_s: self.time_s,
                time_s,
            };
            return Err((plan.place(line, time.field), problem));
        }
        if self.rows == 0 {
            self.first_time_s = time_s;
        }
        (self.line, self.time_s, self.rows) = (line, time_s, self.rows + 1);
        for (index, signal) in plan.signals.iter().enumerate() {
            self.values[index] = match self.number(record, signal, plan)? {
                None => f64::NAN,
                Some(logged) => {
                    let value = signal.value(logged);
                    let place = |problem| (plan.place(line, signal.field), problem);
                    if !value.is_finite() {
                        return Err(place(Problem::NotFinite {
                            found: Excerpt::of(record.get(signal.field)),
                        }));
                    }
                    self.watches[index].take(value, line).map_err(place)?;
                    value
                }
            };
        }
        if self.rows.is_multiple_of(ROWS_PER_JUDGEMENT) {
            self.judge(plan, false)?;
        }
        Ok(())
    }

    fn finish(&self, plan: &Plan) -> Result<(), (Place, Problem)> {
        if self.rows == 0 {
            return Err((Place::default(), Problem::NoData));
        }
        judge_time(plan, self.first_time_s, self.time_s, self.rows)
            .map_err(|problem| (plan.place(self.line, plan.time.field), problem))?;
        self.judge(plan, true)
    }

    fn judge(&self, plan: &Plan, at_end: bool) -> Result<(), (Place, Problem)> {
        for (watch, signal) in self.watches.iter().zip(&plan.signals) {
            watch
                .judge(plan, signal, at_end)
                .map_err(|(line, problem)| (plan.place(line, signal.field), problem))?;
        }
        Ok(())
    }

    fn check_shape(&mut self, record: Record<'_>, plan: &Plan) -> Result<(), (Place, Problem)> {
        let last = record.get(record.len().saturating_sub(1));
        let line = record.line;
        let is_whole = record.len() == plan.fields;
        if record.at_end_of_file && !(is_whole && self.last_field.vouches_for(last, self.decimal)) {
            let place = plan.place(line, record.len().saturating_sub(1));
            return Err((
                place,
                Problem::Truncated {
                    found: Excerpt::of(last),
                },
            ));
        }
        if !is_whole {
            return Err((
                Place::line(line),
                Problem::Ragged {
                    expected: plan.fields,
                    found: record.len(),
                },
            ));
        }
        if plan.empty_last && !last.is_empty() {
            let place = plan.place(line, plan.fields - 1);
            return Err((
                place,
                Problem::UnitMissing {
                    found: Excerpt::of(""),
                },
            ));
        }
        if self.rows == self.rows_max {
            return Err((
                Place::line(line),
                Problem::Limit {
                    budget: Budget::Samples,
                    bound: self.rows_max,
                },
            ));
        }
        self.last_field.see(last, self.decimal);
        Ok(())
    }

    fn number(
        &mut self,
        record: Record<'_>,
        column: &FieldPlan,
        plan: &Plan,
    ) -> Result<Option<f64>, (Place, Problem)> {
        let cell = record.get(column.field);
        if cell.is_empty() || self.missing.iter().any(|word| word == cell) {
            return Ok(None);
        }
        let style = Style {
            decimal: self.decimal,
            thousands: column.thousands,
        };
        number::parse(cell, style, &mut self.scratch)
            .map(Some)
            .map_err(|error| {
                let found = Excerpt::of(cell);
                let problem = match error {
                    NumberError::Text => Problem::NotANumber {
                        found,
                        decimal: self.decimal.symbol(),
                    },
                    NumberError::NotFinite => Problem::NotFinite { found },
                    NumberError::Thousands => Problem::Thousands { found },
                };
                (plan.place(record.line, column.field), problem)
            })
    }
}

/// Tells whether a last number without a line feed is whole: only if all before it had as many decimals.
#[derive(Debug, Default)]
struct LastField {
    decimals: Option<usize>,
    differ: bool,
}

impl LastField {
    fn see(&mut self, field: &str, decimal: Decimal) {
        let decimals = decimals(field, decimal);
        self.differ |= self.decimals.is_some_and(|seen| seen != decimals);
        self.decimals = Some(decimals);
    }

    fn vouches_for(&self, field: &str, decimal: Decimal) -> bool {
        let decimals = decimals(field, decimal);
        !self.differ && decimals > 0 && self.decimals == Some(decimals)
    }
}

fn decimals(field: &str, decimal: Decimal) -> usize {
    field
        .find(decimal.symbol())
        .map_or(0, |at| field.len() - at - 1)
}

/// Reads all of `input` into a recording. `source_name` is for messages and the provenance.
///
/// # Errors
/// The first thing that is wrong with the file.
pub fn read<R: Read>(
    source_name: &str,
    input: R,
    options: &Options,
) -> Result<Recording, CsvError> {
    let mut reader = Reader::new(source_name, input, options)?;
    let mut times_s = Vec::new();
    let mut samples: Vec<Vec<f64>> = vec![Vec::new(); reader.columns().len()];
    while let Some(row) = reader.next_row()? {
        times_s.push(row.time_s);
        for (samples, &value) in samples.iter_mut().zip(row.values) {
            samples.push(value);
        }
    }
    let mut recording = Recording::new(reader.provenance());
    let time_base = TimeBase::new(times_s)
        .expect("the reader refuses times that do not increase, and files without rows");
    let time_base = recording.add_time_base(time_base);
    for (column, samples) in reader.columns().iter().zip(samples) {
        recording
            .add_signal(column.name.clone(), column.unit, time_base, samples)
            .expect("the reader refuses names that are taken or impossible, and values that are infinite");
    }
    Ok(recording)
}

/// Reads a CSV file into a recording.
///
/// # Errors
/// The first thing that is wrong with the file.
pub fn read_file(path: impl AsRef<Path>, options: &Options) -> Result<Recording, CsvError> {
    let path = path.as_ref();
    let source_name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy();
    let file = File::open(path).map_err(|error| {
        CsvError::new(
            &path.display().to_string(),
            Place::default(),
            Problem::Io(error),
        )
    })?;
    read(&source_name, file, options)
}
