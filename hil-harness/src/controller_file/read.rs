//! Reader of controller files: it finds every problem before it uses anything.

use core::ops::Range;
use std::cell::{Cell, RefCell};

use controller::fixed::types::I16F16;
use controller::{
    AntiWindup, Boost, Coefficient, Config, ConfigError, Distributor, Field, IntegralAtReference,
    LowerLimit, OpeningDuty, Prediction, PredictionBasis, Settings, SwitchOff,
};
use toml_edit::{Document, Item, TableLike, Value};

use super::error::{ControllerFileError, Problem};
use super::keys::{KEYS, Key, tables};

/// Size beyond which a file is certainly no controller file (bytes).
const BYTES_MAX: usize = 1 << 20;

/// Largest relative change of a number by fixed point that is accepted.
const ROUNDING_SHARE_MAX: f64 = 0.01;

pub(super) fn read(text: &str, name: &str) -> Result<Settings, ControllerFileError> {
    let refuse = |problems| Err(ControllerFileError::new(name, problems));
    if text.len() > BYTES_MAX {
        return refuse(vec![Problem::Size {
            bytes: text.len(),
            bytes_max: BYTES_MAX,
        }]);
    }
    let document = match Document::parse(text) {
        Ok(document) => document,
        Err(error) => {
            let message = error.message().trim().replace('\n', ", ");
            return refuse(vec![Problem::Syntax {
                line: line_of(text, error.span()),
                message,
            }]);
        }
    };
    let reader = Reader {
        text,
        document: &document,
        asked: KEYS.iter().map(|_| Cell::new(false)).collect(),
        problems: RefCell::default(),
    };
    let settings = reader.settings();
    reader.refuse_the_rest();
    let problems = reader.problems.take();
    if !problems.is_empty() {
        return refuse(problems);
    }
    match Config::new(&settings) {
        Ok(_) => Ok(settings),
        Err(error) => refuse(vec![reader.explain(&error)]),
    }
}

struct Reader<'a> {
    text: &'a str,
    document: &'a Document<&'a str>,
    /// Whether the key at this index of [`KEYS`] belongs to the chosen options.
    asked: Vec<Cell<bool>>,
    problems: RefCell<Vec<Problem>>,
}

impl Reader<'_> {
    /// Returns the settings; missing or wrong values are noted as problems and replaced by zero.
    fn settings(&self) -> Settings {
        Settings {
            sample_time_ms: self.number("sample", "sample_time_ms"),
            gain_pct_per_bar: self.number("pid", "gain_pct_per_bar"),
            integral_time_ms: self.number_or_off("pid", "integral_time_ms"),
            derivative_time_ms: self.number_or_off("pid", "derivative_time_ms"),
            integral_max_pct: self.number("pid", "integral_max_pct"),
            integral_at_reference: self.word(
                "pid",
                "integral_at_reference",
                &[
                    ("hold", IntegralAtReference::Hold),
                    ("clear", IntegralAtReference::Clear),
                ],
            ),
            anti_windup: self.anti_windup(),
            tolerance_bar: self.number("tolerance", "tolerance_bar"),
            prediction: self.horizon(),
            prediction_basis: self.word(
                "prediction",
                "basis",
                &[
                    ("error", PredictionBasis::Error),
                    ("pressure", PredictionBasis::Pressure),
                ],
            ),
            switch_off: self.word(
                "prediction",
                "switch_off",
                &[
                    ("inside_tolerance", SwitchOff::InsideTolerance),
                    ("inside_or_beyond", SwitchOff::InsideOrBeyond),
                ],
            ),
            boost: self.document.contains_key("boost").then(|| Boost {
                rate_pct_per_bar_s: self.number("boost", "rate_pct_per_bar_s"),
                max_pct: self.number("boost", "max_pct"),
                response_bar: self.number("boost", "response_bar"),
            }),
            distributor: self.distributor(),
            duty_min: self.duty_min(),
            duty_max_fill_pct: self.number("distributor", "duty_max_fill_pct"),
            duty_max_vent_pct: self.number("distributor", "duty_max_vent_pct"),
            supply_pressure_bar: self.number("distributor", "supply_pressure_bar"),
        }
    }

    fn anti_windup(&self) -> AntiWindup {
        let off = AntiWindup::Off;
        let tracking = AntiWindup::BackCalculation {
            tracking_time_ms: I16F16::ZERO,
        };
        let choices = [
            ("off", off),
            (
                "conditional_integration",
                AntiWindup::ConditionalIntegration,
            ),
            ("back_calculation", tracking),
        ];
        match self.word("pid", "anti_windup", &choices) {
            AntiWindup::BackCalculation { .. } => AntiWindup::BackCalculation {
                tracking_time_ms: self.number("pid", "tracking_time_ms"),
            },
            other => other,
        }
    }

    fn horizon(&self) -> Prediction {
        let Some((key, item)) = self.required("prediction", "horizon_samples") else {
            return Prediction::Off;
        };
        match item.as_integer() {
            Some(0) => Prediction::Off,
            Some(1) => Prediction::OneStep,
            Some(2) => Prediction::TwoStep,
            _ => self.wrong(key, item, "0, 1 or 2".to_owned(), Prediction::Off),
        }
    }

    fn distributor(&self) -> Distributor {
        let both = Distributor::Scheme2 {
            middle_fill_pct: I16F16::ZERO,
            middle_vent_pct: I16F16::ZERO,
        };
        let choices = [
            ("traditional", Distributor::Traditional),
            ("scheme_1", Distributor::Scheme1),
            ("scheme_2", both),
        ];
        match self.word("distributor", "scheme", &choices) {
            Distributor::Scheme2 { .. } => Distributor::Scheme2 {
                middle_fill_pct: self.number("distributor", "middle_fill_pct"),
                middle_vent_pct: self.number("distributor", "middle_vent_pct"),
            },
            other => other,
        }
    }

    fn duty_min(&self) -> LowerLimit {
        if self.word(
            "duty_min",
            "law",
            &[("constant", false), ("pressure_dependent", true)],
        ) {
            LowerLimit::PressureDependent {
                fill: self.opening([
                    "fill_without_pressure_pct",
                    "fill_at_half_supply_pressure_pct",
                    "fill_with_supply_pressure_pct",
                ]),
                vent: self.opening([
                    "vent_without_pressure_pct",
                    "vent_at_half_supply_pressure_pct",
                    "vent_with_supply_pressure_pct",
                ]),
            }
        } else {
            LowerLimit::Constant {
                fill_pct: self.number("duty_min", "fill_pct"),
                vent_pct: self.number("duty_min", "vent_pct"),
            }
        }
    }

    fn opening(&self, [without, at_half, with]: [&'static str; 3]) -> OpeningDuty {
        let ends = (
            self.number("duty_min", without),
            self.number("duty_min", with),
        );
        let Some((key, item)) = self.required("duty_min", at_half) else {
            return OpeningDuty::linear(ends.0, ends.1);
        };
        match item.as_str() {
            Some("force_balance") => OpeningDuty::force_balance(ends.0, ends.1),
            Some("linear") => OpeningDuty::linear(ends.0, ends.1),
            _ => OpeningDuty {
                at_half_pct: self.decimal(key, item, "a number, \"force_balance\" or \"linear\""),
                ..OpeningDuty::linear(ends.0, ends.1)
            },
        }
    }

    fn number(&self, table: &'static str, name: &'static str) -> I16F16 {
        self.required(table, name)
            .map_or(I16F16::ZERO, |(key, item)| {
                self.decimal(key, item, "a number")
            })
    }

    fn number_or_off(&self, table: &'static str, name: &'static str) -> Option<I16F16> {
        let (key, item) = self.required(table, name)?;
        (item.as_str() != Some("off")).then(|| self.decimal(key, item, "a number or \"off\""))
    }

    /// Returns the value of the word in the file; the first choice if it is missing or wrong.
    fn word<T: Copy>(&self, table: &'static str, name: &'static str, choices: &[(&str, T)]) -> T {
        let fallback = choices[0].1;
        let Some((key, item)) = self.required(table, name) else {
            return fallback;
        };
        let chosen = item
            .as_str()
            .and_then(|word| choices.iter().find(|choice| choice.0 == word));
        match chosen {
            Some(&(_, value)) => value,
            None => {
                let words: Vec<String> = choices
                    .iter()
                    .map(|(word, _)| format!("\"{word}\""))
                    .collect();
                self.wrong(key, item, words.join(" or "), fallback)
            }
        }
    }

    /// Returns the fixed-point number nearest to the decimal text in the file.
    fn decimal(&self, key: &'static Key, item: &Item, expected: &str) -> I16F16 {
        let text = match item.as_value() {
            Some(Value::Integer(integer)) => integer.value().to_string(),
            Some(Value::Float(float)) if float.value().is_finite() => {
                self.source(item).replace('_', "")
            }
            _ => return self.wrong(key, item, expected.to_owned(), I16F16::ZERO),
        };
        let line = self.line(item.span());
        let found = shown(&text);
        let Ok(kept) = text.trim_start_matches('+').parse::<I16F16>() else {
            self.note(Problem::NotHeld { line, key, found });
            return I16F16::ZERO;
        };
        let exact = item
            .as_float()
            .or(item.as_integer().map(|integer| integer as f64))
            .unwrap_or(0.0);
        if (kept.to_num::<f64>() - exact).abs() > ROUNDING_SHARE_MAX * exact.abs() {
            self.note(Problem::TooFine {
                line,
                key,
                found,
                kept: kept.to_string(),
            });
        }
        kept
    }

    fn required(&self, table: &'static str, name: &'static str) -> Option<(&'static Key, &Item)> {
        let (place, key) = KEYS
            .iter()
            .enumerate()
            .find(|(_, key)| key.table == table && key.name == name)?;
        self.asked[place].set(true);
        let found = self.table(table).and_then(|table| table.get(name));
        if found.is_none() {
            let line = self.document.key(table).map(|key| self.line(key.span()));
            self.note(Problem::Missing { line, key });
        }
        found.map(|item| (key, item))
    }

    fn table(&self, table: &str) -> Option<&dyn TableLike> {
        self.document.get(table).and_then(Item::as_table_like)
    }

    fn wrong<T>(&self, key: &'static Key, item: &Item, expected: String, fallback: T) -> T {
        let (line, found) = (self.line(item.span()), shown(self.source(item)));
        self.note(Problem::WrongValue {
            line,
            key,
            found,
            expected,
        });
        fallback
    }

    /// Notes every table and key that was not read.
    fn refuse_the_rest(&self) {
        for (table, item) in self.document.iter() {
            let line = self.line(self.document.key(table).and_then(toml_edit::Key::span));
            let known = tables().contains(&table);
            let Some(entries) = item.as_table_like().filter(|_| known) else {
                self.note(Problem::UnknownTable {
                    line,
                    table: shown(table),
                });
                continue;
            };
            for (name, _) in entries.iter() {
                let line = self.line(entries.key(name).and_then(toml_edit::Key::span));
                match KEYS
                    .iter()
                    .position(|key| key.table == table && key.name == name)
                {
                    None => {
                        let path = shown(&format!("{table}.{name}"));
                        self.note(Problem::UnknownKey {
                            line,
                            path,
                            nearest: nearest(table, name),
                        });
                    }
                    Some(place) if !self.asked[place].get() => {
                        self.note(Problem::NoEffect {
                            line,
                            key: &KEYS[place],
                        });
                    }
                    Some(_) => {}
                }
            }
        }
    }

    /// Converts the controller's refusal into the words and lines of the file.
    fn explain(&self, error: &ConfigError) -> Problem {
        let out_of_range = |field: Field, value: I16F16, min: I16F16, max: I16F16, why| {
            let (key, line) = self.place_of(field);
            let [found, min, max] = [value, min, max].map(|number| number.to_string());
            Problem::OutOfRange {
                line,
                key,
                found,
                min,
                max,
                unit: field.unit(),
                why,
            }
        };
        let path = |field| self.place_of(field).0.path();
        match *error {
            ConfigError::OutOfRange {
                field,
                value,
                min,
                max,
            } => out_of_range(field, value, min, max, None),
            ConfigError::BelowOther {
                field,
                value,
                other,
                min,
                max,
            }
            | ConfigError::AboveOther {
                field,
                value,
                other,
                min,
                max,
            } => {
                let is_least = matches!(error, ConfigError::BelowOther { .. });
                let bound = if is_least { "least" } else { "most" };
                let by = format!("where `{}` is the {bound}", path(other));
                out_of_range(field, value, min, max, Some(by))
            }
            ConfigError::CoefficientOutOfRange { coefficient, .. } => {
                let field = match coefficient {
                    Coefficient::Integral => Field::IntegralTime,
                    Coefficient::Derivative => Field::DerivativeTime,
                    Coefficient::Boost => Field::BoostRate,
                };
                Problem::Together {
                    line: self.place_of(field).1,
                    message: error.to_string(),
                }
            }
        }
    }

    /// Returns the key that the file uses for a number of the controller, and its line.
    fn place_of(&self, field: Field) -> (&'static Key, usize) {
        let keys = || KEYS.iter().filter(|key| key.field == Some(field));
        let used = keys().find_map(|key| {
            let item = self.table(key.table)?.get(key.name)?;
            Some((key, self.line(item.span())))
        });
        // Every field of the controller has a key, as a test checks.
        used.unwrap_or_else(|| (keys().next().unwrap_or(&KEYS[0]), 1))
    }

    fn note(&self, problem: Problem) {
        self.problems.borrow_mut().push(problem);
    }

    fn source(&self, item: &Item) -> &str {
        item.span()
            .and_then(|span| self.text.get(span))
            .unwrap_or_default()
    }

    fn line(&self, span: Option<Range<usize>>) -> usize {
        line_of(self.text, span)
    }
}

fn line_of(text: &str, span: Option<Range<usize>>) -> usize {
    let end = span.map_or(0, |span| span.start.min(text.len()));
    1 + text.as_bytes()[..end]
        .iter()
        .filter(|byte| **byte == b'\n')
        .count()
}

/// Returns text of a file in a form that an error may show: short, and without characters that change a terminal's
/// display.
fn shown(text: &str) -> String {
    let is_plain =
        |c: char| !c.is_control() && !('\u{200b}'..='\u{206f}').contains(&c) && c != '\u{feff}';
    text.chars()
        .take(60)
        .map(|c| if is_plain(c) { c } else { '\u{fffd}' })
        .collect()
}

/// Returns the known key that has the most words in common with an unknown one, such as the same number in another
/// unit.
fn nearest(table: &str, name: &str) -> Option<String> {
    let words = |text: &str| text.split('_').map(str::to_owned).collect::<Vec<_>>();
    let wanted = words(name);
    let common = |key: &Key| {
        let own = words(key.name);
        let shared = wanted.iter().filter(|word| own.contains(word)).count();
        (shared, usize::from(key.table == table))
    };
    KEYS.iter()
        .max_by_key(|key| common(key))
        .filter(|key| common(key).0 > 0)
        .map(Key::path)
}
