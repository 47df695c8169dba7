//! Conversion of records into rows, with their checks.

use std::iter;

use super::clock::Clock;
use super::complement::Window;
use super::error::{Excerpt, Located, Place};
use super::number::{self, NumberError, Style};
use super::plan::{FieldPlan, Plan};
use super::problem::{Budget, Problem};
use super::record::Record;
use super::{Decimal, Options};
use crate::plausibility::Watch;
use crate::{Bounds, OutOfBounds, Quantity, StartTime, Unit};

/// Number of rows after which the size of the values is checked again.
const ROWS_PER_JUDGEMENT: u64 = 1 << 16;
/// Mean distance of rows at which seconds look like milliseconds.
const STEP_MAX_S: f64 = 10.0;

/// Converter of records into rows; it refuses invalid ones.
pub(super) struct RowParser {
    pub(super) line: u64,
    pub(super) time_s: f64,
    first_time_s: f64,
    pub(super) values: Vec<f64>,
    rows: u64,
    window: Window,
    rows_kept: u64,
    rows_max: u64,
    decimal: Decimal,
    missing: Vec<String>,
    watches: Vec<Watch>,
    last_field: LastField,
    scratch: String,
    clock: Clock,
}

impl RowParser {
    pub(super) fn new(plan: &Plan, decimal: Decimal, options: &Options) -> Self {
        Self {
            line: 0,
            time_s: f64::NEG_INFINITY,
            first_time_s: f64::NAN,
            values: {
                let constants = plan.constants.iter().map(|(_, constant)| constant.value);
                let logged = iter::repeat_n(f64::NAN, plan.signals.len());
                logged.chain(constants).collect()
            },
            rows: 0,
            window: options.mapping.rows,
            rows_kept: 0,
            rows_max: options.limits.samples,
            decimal,
            missing: options.mapping.missing.clone(),
            watches: plan
                .signals
                .iter()
                .map(|signal| {
                    let column = Some(signal.field + 1);
                    Watch::new(&signal.name, signal.unit, signal.check_scale, column)
                        .narrowed_to(signal.plausible.as_ref())
                })
                .collect(),
            last_field: LastField::default(),
            scratch: String::new(),
            clock: Clock::default(),
        }
    }

    /// Parses a record and returns whether its row is kept.
    pub(super) fn parse(&mut self, record: Record<'_>, plan: &Plan) -> Result<bool, Located> {
        let line = record.line;
        self.check_shape(record, plan)?;
        let time = &plan.time;
        let logged = match time.is_clock {
            true => self.clock(record, time, plan)?,
            false => self.number(record, time, plan)?,
        };
        let time_s = logged
            .map(|logged| plan.to_seconds.apply(time.conversion.value(logged)))
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
        if time_s.abs() > Bounds::of(Quantity::Time).most {
            let found = Excerpt::of(record.get(time.field));
            let problem = Problem::TimeBounds { found, time_s };
            return Err((plan.place(line, time.field), problem));
        }
        if self.rows == 0 {
            self.first_time_s = time_s;
        }
        let is_kept = self.window.contains(time_s);
        (self.line, self.time_s, self.rows) = (line, time_s, self.rows + 1);
        for (index, signal) in plan.signals.iter().enumerate() {
            self.values[index] = match self.number(record, signal, plan)? {
                None => f64::NAN,
                Some(logged) => {
                    let value = signal.conversion.value(logged);
                    if is_kept {
                        let taken = self.watches[index].take(value, line);
                        taken.map_err(|problem| {
                            let place = plan.place(line, signal.field);
                            (place, Problem::Implausible(problem))
                        })?
                    } else {
                        value
                    }
                }
            };
        }
        if self.rows.is_multiple_of(ROWS_PER_JUDGEMENT) {
            self.judge(plan, false)?;
        }
        self.rows_kept += u64::from(is_kept);
        Ok(is_kept)
    }

    pub(super) fn finish(&self, plan: &Plan) -> Result<(), Located> {
        if self.rows == 0 {
            return Err((Place::default(), Problem::NoData));
        }
        if self.rows_kept == 0 {
            let problem = Problem::NoRowKept {
                first_s: self.first_time_s,
                last_s: self.time_s,
            };
            return Err((Place::default(), problem));
        }
        judge_time(plan, self.first_time_s, self.time_s, self.rows)
            .map_err(|problem| (plan.place(self.line, plan.time.field), problem))?;
        self.judge(plan, true)
    }

    /// Returns the cells read so far that were out of bounds, signal by signal.
    pub(super) fn out_of_bounds(&self) -> impl Iterator<Item = &OutOfBounds> {
        self.watches.iter().filter_map(Watch::outside)
    }

    fn judge(&self, plan: &Plan, at_end: bool) -> Result<(), Located> {
        for (watch, signal) in self.watches.iter().zip(&plan.signals) {
            watch
                .judge(&signal.name, || plan.column_key(signal.field), at_end)
                .map_err(|(line, problem)| {
                    let place = plan.place(line, signal.field);
                    (place, Problem::Implausible(problem))
                })?;
        }
        Ok(())
    }

    fn check_shape(&mut self, record: Record<'_>, plan: &Plan) -> Result<(), Located> {
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
            let found = Excerpt::of(last);
            return Err((
                plan.place(line, plan.fields - 1),
                Problem::Unmapped { found },
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

    /// Returns the instant of the first row, if its time column has a date.
    pub(super) fn start(&self) -> Option<StartTime> {
        self.clock.start()
    }

    fn clock(
        &mut self,
        record: Record<'_>,
        time: &FieldPlan,
        plan: &Plan,
    ) -> Result<Option<f64>, Located> {
        let cell = record.get(time.field);
        if cell.is_empty() {
            return Ok(None);
        }
        let refused = || {
            let found = Excerpt::of(cell);
            (
                plan.place(record.line, time.field),
                Problem::NotAClock { found },
            )
        };
        self.clock.read(cell).map(Some).ok_or_else(refused)
    }

    fn number(
        &mut self,
        record: Record<'_>,
        column: &FieldPlan,
        plan: &Plan,
    ) -> Result<Option<f64>, Located> {
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

/// Refuses a time whose steps are too long for a log of a brake.
fn judge_time(plan: &Plan, first_s: f64, last_s: f64, rows: u64) -> Result<(), Problem> {
    let mean_step_s = (last_s - first_s) / (rows.max(2) - 1) as f64;
    if !plan.time.check_scale || rows < 3 || mean_step_s < STEP_MAX_S {
        return Ok(());
    }
    let key = plan.column_key(plan.time.field);
    let (unit, accepted) = match plan.time.unit {
        Unit::Second => ("ms", ""),
        unit => (unit.token(), ", check_scale = false"),
    };
    let proposal = format!("time = {{ column = {key}, unit = \"{unit}\"{accepted} }}");
    Err(Problem::TimeScale {
        mean_step_s,
        declared: plan.time.unit,
        proposal,
    })
}

/// Check whether a last number without a line feed is complete: only if all numbers before it had the same number of
/// decimals.
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
