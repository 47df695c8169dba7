//! Reader of controller files: it finds every problem before it uses anything.

use std::cell::{Cell, RefCell};

use controller::fixed::types::I16F16;
use controller::{
    Config, ConfigError, Field, Form, LowerLimit, OpeningDuty, SettingSpec, Settings,
};
use plant_sim::toml_file::{TomlFile, key_meant, shown};
use toml_edit::{Item, TableLike, Value};

use super::error::{ControllerFileError, Problem};
use super::keys::{KEYS, Key, may_be_off, tables};

/// Largest relative change of a number by fixed point that is accepted.
const ROUNDING_SHARE_MAX: f64 = 0.01;

pub(super) fn read(text: &str, name: &str) -> Result<Settings, ControllerFileError> {
    let refuse = |problems| Err(ControllerFileError::new(name, problems));
    let file = match TomlFile::parse(text) {
        Ok(file) => file,
        Err(unreadable) => return refuse(vec![Problem::Unreadable(unreadable)]),
    };
    let reader = Reader {
        file: &file,
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
    file: &'a TomlFile<'a>,
    /// Whether the key at this index of [`KEYS`] belongs to the chosen options.
    asked: Vec<Cell<bool>>,
    problems: RefCell<Vec<Problem>>,
}

/// Laws that compute the opening duty cycle at half the supply pressure from the other two.
const LAWS: [(&str, Law); 2] = [
    ("force_balance", OpeningDuty::force_balance),
    ("linear", OpeningDuty::linear),
];

type Law = fn(I16F16, I16F16) -> OpeningDuty;

impl Reader<'_> {
    /// Returns the settings, row by row of the table. Missing or wrong values are noted as problems and replaced by
    /// zero.
    fn settings(&self) -> Settings {
        let mut settings = Settings::recommended();
        let mut laws = Vec::new();
        for field in Field::ALL {
            let SettingSpec {
                form,
                section,
                choices,
                ..
            } = *field.spec();
            // A number that the choices do not use has no key.
            let Some(name) = field.key(&settings) else {
                continue;
            };
            let number = match form {
                Form::Number => match self.law(field, section, name) {
                    Some(law) => {
                        laws.push((field, law));
                        continue;
                    }
                    None => self.number(field, section, name).to_bits(),
                },
                Form::Word => self.word(section, name, choices),
                Form::Index => self.index(section, name, choices.len() as i32),
                Form::NumberOrOff => i32::from(!self.is_off(section, name)),
                Form::Section => i32::from(self.file.root().contains_key(section)),
            };
            field.set(&mut settings, number);
        }
        for (field, law) in laws {
            apply(law, field, &mut settings.duty_min);
        }
        settings
    }

    fn number(&self, field: Field, table: &'static str, name: &'static str) -> I16F16 {
        let Some((key, item)) = self.required(table, name) else {
            return I16F16::ZERO;
        };
        let expected = match field {
            _ if may_be_off(table, name) => "a number or \"off\"",
            Field::DutyHalfFill | Field::DutyHalfVent => {
                "a number, \"force_balance\" or \"linear\""
            }
            _ => "a number",
        };
        self.decimal(key, item, expected)
    }

    /// Returns whether the key is missing or has the word `off` in place of a number.
    fn is_off(&self, table: &'static str, name: &'static str) -> bool {
        self.required(table, name)
            .is_none_or(|(_, item)| item.as_str() == Some("off"))
    }

    /// Returns the law that the file names in place of the number at half the supply pressure.
    fn law(&self, field: Field, table: &'static str, name: &'static str) -> Option<Law> {
        if !matches!(field, Field::DutyHalfFill | Field::DutyHalfVent) {
            return None;
        }
        let word = self.table(table)?.get(name)?.as_str()?;
        let (_, law) = LAWS.into_iter().find(|(known, _)| *known == word)?;
        self.required(table, name);
        Some(law)
    }

    /// Returns the number of the word in the file; 0 if it is missing or wrong.
    fn word(&self, table: &'static str, name: &'static str, choices: &[&str]) -> i32 {
        let Some((key, item)) = self.required(table, name) else {
            return 0;
        };
        let mut numbers = (0..).zip(choices);
        let chosen = numbers.find(|(_, word)| item.as_str() == Some(word));
        chosen.map_or_else(
            || {
                let words: Vec<String> = choices.iter().map(|word| format!("\"{word}\"")).collect();
                self.wrong(key, item, words.join(" or "), 0)
            },
            |(number, _)| number,
        )
    }

    /// Returns the number of a choice in the file; 0 if it is missing or wrong.
    fn index(&self, table: &'static str, name: &'static str, count: i32) -> i32 {
        let Some((key, item)) = self.required(table, name) else {
            return 0;
        };
        let found = item
            .as_integer()
            .and_then(|number| i32::try_from(number).ok());
        match found.filter(|number| (0..count).contains(number)) {
            Some(number) => number,
            None => {
                let numbers: Vec<String> =
                    (0..count - 1).map(|number| number.to_string()).collect();
                let expected = format!("{} or {}", numbers.join(", "), count - 1);
                self.wrong(key, item, expected, 0)
            }
        }
    }

    /// Returns the fixed-point number nearest to the decimal text in the file.
    fn decimal(&self, key: &'static Key, item: &Item, expected: &str) -> I16F16 {
        let text = match item.as_value() {
            Some(Value::Integer(integer)) => integer.value().to_string(),
            Some(Value::Float(float)) if float.value().is_finite() => {
                self.file.source(item).replace('_', "")
            }
            _ => return self.wrong(key, item, expected.to_owned(), I16F16::ZERO),
        };
        let line = self.file.line(item);
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
            let root = self.file.root();
            let is_there = root.contains_key(table);
            let line = is_there.then(|| self.file.line_of_key(root, table));
            self.note(Problem::Missing { line, key });
        }
        found.map(|item| (key, item))
    }

    fn table(&self, table: &str) -> Option<&dyn TableLike> {
        self.file.root().get(table).and_then(Item::as_table_like)
    }

    fn wrong<T>(&self, key: &'static Key, item: &Item, expected: String, fallback: T) -> T {
        let (line, found) = (self.file.line(item), shown(self.file.source(item)));
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
        let root = self.file.root();
        for (table, item) in root.iter() {
            let line = self.file.line_of_key(root, table);
            let known = tables().contains(&table);
            let Some(entries) = item.as_table_like().filter(|_| known) else {
                self.note(Problem::UnknownTable {
                    line,
                    table: shown(table),
                });
                continue;
            };
            for (name, _) in entries.iter() {
                let line = self.file.line_of_key(entries, name);
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
            ConfigError::CoefficientOutOfRange { coefficient, .. } => Problem::Together {
                line: self.place_of(coefficient.factor()).1,
                message: error.to_string(),
            },
        }
    }

    /// Returns the key that the file uses for a number of the controller, and its line.
    fn place_of(&self, field: Field) -> (&'static Key, usize) {
        let keys = || KEYS.iter().filter(|key| key.field == field);
        let used = keys().find_map(|key| {
            let item = self.table(key.table)?.get(key.name)?;
            Some((key, self.file.line(item)))
        });
        // Every number of the table has a key.
        used.unwrap_or_else(|| (keys().next().unwrap_or(&KEYS[0]), 1))
    }

    fn note(&self, problem: Problem) {
        self.problems.borrow_mut().push(problem);
    }
}

/// Replaces the opening duty cycle at half the supply pressure by that of `law` between the other two.
fn apply(law: Law, field: Field, duty_min: &mut LowerLimit) {
    if let LowerLimit::PressureDependent { fill, vent } = duty_min {
        let opening = if field == Field::DutyHalfFill {
            fill
        } else {
            vent
        };
        *opening = law(
            opening.without_pressure_pct,
            opening.with_supply_pressure_pct,
        );
    }
}

/// Returns the key that was probably meant: one of this table, otherwise one of any table.
fn nearest(table: &str, name: &str) -> Option<String> {
    let meant = |is_one: &dyn Fn(&&Key) -> bool| {
        let keys: Vec<&Key> = KEYS.iter().filter(is_one).collect();
        let name = key_meant(name, keys.iter().map(|key| key.name))?;
        keys.into_iter().find(|key| key.name == name).map(Key::path)
    };
    meant(&|key| key.table == table).or_else(|| meant(&|_| true))
}
