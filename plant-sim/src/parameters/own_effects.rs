//! Reader of the definitions of a user's own effects: the tables `[own_effects.*]`.

use toml_edit::{Item, TableLike};

use super::error::Problem;
use super::knowledge::number;
use crate::own_effects::{
    ABOUT, ACTS_ON, Definition, EXCITED_BY, EXPRESSION, OWN_EFFECTS, OwnEffect, OwnParameter,
    PARAMETERS, RANGE, Reason, SENTENCE, SOURCE, TYPICAL, UNIT,
};
use crate::toml_file::{TomlFile, key_meant, shown};

/// Keys of a definition and of a parameter.
const KEYS: [&str; 6] = [
    SENTENCE, ACTS_ON, EXPRESSION, EXCITED_BY, SOURCE, PARAMETERS,
];
const PARAMETER_KEYS: [&str; 4] = [TYPICAL, RANGE, UNIT, ABOUT];

/// Keys that a definition needs, with their meaning and an example.
const NEEDED: [(&str, &str, &str); 3] = [
    (
        SENTENCE,
        "the effect in one sentence, by which a diagnosis names it",
        "sentence = \"Air escapes through the shaft seal.\"",
    ),
    (
        ACTS_ON,
        "the point of the plant that it changes",
        "acts_on = \"leak_flow\"",
    ),
    (
        EXPRESSION,
        "its law, in SI units",
        "expression = \"k * max(p - p_ambient, 0)\"",
    ),
];

/// Reads `[own_effects]`; every problem of a definition is added to `problems`.
pub(super) fn read(
    file: &TomlFile,
    table: &dyn TableLike,
    problems: &mut Vec<Problem>,
) -> Vec<&'static OwnEffect> {
    let one = |(name, item): (&str, &Item)| {
        let mut reader = DefinitionReader {
            file,
            section: format!("{OWN_EFFECTS}.{}", shown(name)),
            line: file.line_of_key(table, name),
            problems: Vec::new(),
        };
        let effect = reader.effect(name, item);
        problems.append(&mut reader.problems);
        effect
    };
    table.iter().filter_map(one).collect()
}

struct DefinitionReader<'a> {
    file: &'a TomlFile<'a>,
    section: String,
    line: usize,
    problems: Vec<Problem>,
}

impl DefinitionReader<'_> {
    fn effect(&mut self, name: &str, item: &Item) -> Option<&'static OwnEffect> {
        let Some(table) = item.as_table_like() else {
            self.wrong_type("", self.line, item, "a table");
            return None;
        };
        let definition = self.definition(name, table);
        if !self.problems.is_empty() {
            return None;
        }
        match definition.effect() {
            Ok(effect) => Some(effect),
            Err(faults) => {
                for fault in faults {
                    let line = self.line_of(table, &fault.key);
                    self.refuse(line, &fault.key, fault.reason);
                }
                None
            }
        }
    }

    /// Returns the line of a key such as `parameters.k.range`: that of its nearest table with a line.
    fn line_of(&self, table: &dyn TableLike, key: &str) -> usize {
        let mut words = key.split('.');
        let (first, second) = (words.next().unwrap_or_default(), words.next());
        let parameters = table.get(PARAMETERS).and_then(Item::as_table_like);
        match (second, parameters) {
            (Some(second), Some(parameters)) => self.file.line_of_key(parameters, second),
            _ if table.contains_key(first) => self.file.line_of_key(table, first),
            _ => self.line,
        }
    }

    fn refuse(&mut self, line: usize, key: &str, reason: Reason) {
        let key = self.full(key);
        self.problems.push(Problem::OwnEffect { line, key, reason });
    }

    fn full(&self, key: &str) -> String {
        match key {
            "" => self.section.clone(),
            key => format!("{}.{}", self.section, shown(key)),
        }
    }

    fn wrong_type(&mut self, key: &str, line: usize, item: &Item, expected: &'static str) {
        let key = self.full(key);
        self.problems.push(Problem::WrongType {
            line,
            key,
            found: item.type_name(),
            expected,
        });
    }

    fn unknown_key(&mut self, line: usize, key: &str, keys: &'static [&'static str]) {
        let word = key.rsplit('.').next().unwrap_or(key);
        let nearest = key_meant(word, keys.iter().copied());
        self.refuse(line, key, Reason::UnknownKey { nearest, keys });
    }

    fn definition(&mut self, name: &str, table: &dyn TableLike) -> Definition {
        let mut definition = Definition {
            name: name.to_owned(),
            ..Definition::default()
        };
        for (key, item) in table.iter() {
            let line = self.file.line_of_key(table, key);
            if key == PARAMETERS {
                definition.parameters = self.parameters(line, item);
                continue;
            }
            let slot = match key {
                SENTENCE => &mut definition.sentence,
                ACTS_ON => &mut definition.acts_on,
                EXPRESSION => &mut definition.expression,
                EXCITED_BY => &mut definition.excited_by,
                SOURCE => &mut definition.source,
                _ => {
                    self.unknown_key(line, key, &KEYS);
                    continue;
                }
            };
            match item.as_str() {
                Some(text) => *slot = text.to_owned(),
                None => self.wrong_type(key, line, item, "a text in quotes"),
            }
        }
        for (key, about, example) in NEEDED {
            let is_empty = table
                .get(key)
                .is_none_or(|item| item.as_str().is_some_and(str::is_empty));
            if is_empty {
                self.refuse(self.line, key, Reason::Missing { about, example });
            }
        }
        definition
    }

    fn parameters(&mut self, line: usize, item: &Item) -> Vec<OwnParameter> {
        let Some(table) = item.as_table_like() else {
            let expected =
                "a table, such as parameters.k = { typical = 1e-10, range = [1e-12, 1e-8] }";
            self.wrong_type(PARAMETERS, line, item, expected);
            return Vec::new();
        };
        let parameter = |(key, item): (&str, &Item)| {
            let line = self.file.line_of_key(table, key);
            self.parameter(line, key, item)
        };
        table.iter().map(parameter).collect()
    }

    fn parameter(&mut self, line: usize, key: &str, item: &Item) -> OwnParameter {
        let mut parameter = OwnParameter {
            key: key.to_owned(),
            ..OwnParameter::default()
        };
        let name = |word: &str| format!("{PARAMETERS}.{key}.{word}");
        let Some(table) = item.as_table_like() else {
            let expected =
                "a table, such as { typical = 1e-10, range = [1e-12, 1e-8], unit = \"kg/s/Pa\" }";
            self.wrong_type(&format!("{PARAMETERS}.{key}"), line, item, expected);
            return parameter;
        };
        for (word, item) in table.iter() {
            match word {
                TYPICAL => match number(item) {
                    Some(value) => parameter.typical = value,
                    None => self.wrong_type(&name(word), line, item, "a number"),
                },
                RANGE => match range(item) {
                    Some(range) => parameter.range = range,
                    None => self.wrong_type(&name(word), line, item, "[least, most], two numbers"),
                },
                UNIT | ABOUT => {
                    let text = item.as_str().map(str::to_owned);
                    if text.is_none() {
                        self.wrong_type(&name(word), line, item, "a text in quotes");
                    }
                    match word {
                        UNIT => parameter.unit = text,
                        _ => parameter.about = text,
                    }
                }
                _ => self.unknown_key(line, &name(word), &PARAMETER_KEYS),
            }
        }
        for (word, about, example) in [
            (TYPICAL, "the size at which a fit begins", "typical = 1e-10"),
            (
                RANGE,
                "its smallest and its largest value",
                "range = [1e-12, 1e-8]",
            ),
        ] {
            if !table.contains_key(word) {
                self.refuse(line, &name(word), Reason::Missing { about, example });
            }
        }
        parameter
    }
}

/// Returns an array of two numbers.
fn range(item: &Item) -> Option<(f64, f64)> {
    let array = item.as_array()?;
    let mut numbers = array
        .iter()
        .map(|value| number(&Item::Value(value.clone())));
    let (least, most) = (numbers.next()??, numbers.next()??);
    numbers.next().is_none().then_some((least, most))
}
