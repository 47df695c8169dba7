//! Reading a plant file: every problem is found before anything is used.

use std::ops::Range;

use toml_edit::{Document, Item, TableLike, Value};

use super::consistency::inconsistency;
use super::error::{ParameterError, Problem};
use super::table::{FUNCTIONS, PARAMETERS, ParameterSpec, REGULATING_VALVE, VALVE_KEYS, VALVES};
use super::units::in_other_unit;
use super::values::{PlantParameters, RegulatingValveParameters};
use crate::valve::ValveFunction;

/// Size beyond which a file is certainly not a plant file (bytes).
const MAX_BYTES: usize = 1 << 20;

struct Reader<'a> {
    text: &'a str,
    problems: Vec<Problem>,
    parameters: PlantParameters,
}

pub(super) fn read(text: &str, name: &str) -> Result<PlantParameters, ParameterError> {
    let fail = |problems| Err(ParameterError::new(name, problems));
    if text.len() > MAX_BYTES {
        let message = format!(
            "{} bytes, more than the {MAX_BYTES} of any plant file",
            text.len()
        );
        return fail(vec![Problem::Syntax { line: 0, message }]);
    }
    let document = match Document::parse(text) {
        Ok(document) => document,
        Err(error) => {
            return fail(vec![Problem::Syntax {
                line: line_of(text, error.span()),
                message: error.message().trim().replace('\n', ", "),
            }]);
        }
    };
    let mut reader = Reader {
        text,
        problems: Vec::new(),
        parameters: PlantParameters::blank(),
    };
    reader.root(&document);
    reader
        .problems
        .sort_by_key(|problem| problem.line().unwrap_or(usize::MAX));
    if reader.problems.is_empty() {
        reader.problems.extend(inconsistency(&reader.parameters));
    }
    if reader.problems.is_empty() {
        Ok(reader.parameters)
    } else {
        fail(reader.problems)
    }
}

impl Reader<'_> {
    fn root(&mut self, document: &Document<&str>) {
        let root = document.as_table();
        let mut present: Vec<&'static ParameterSpec> = Vec::new();
        if root.contains_key(REGULATING_VALVE) {
            self.parameters.regulating_valve = Some(RegulatingValveParameters::default());
        }
        for (section, item) in root.iter() {
            let line = self.line(root.key(section).and_then(toml_edit::Key::span));
            let Some(table) = item.as_table_like() else {
                self.problems.push(Problem::UnknownSection {
                    line,
                    section: section.to_owned(),
                });
                continue;
            };
            if section == VALVES {
                self.valves(table);
            } else if PARAMETERS.iter().any(|spec| spec.section == section) {
                self.section(section, table, &mut present);
            } else {
                self.problems.push(Problem::UnknownSection {
                    line,
                    section: section.to_owned(),
                });
            }
        }
        let regulating = self.parameters.regulating_valve.is_some();
        for &spec in PARAMETERS.iter() {
            let needed = !spec.is_optional() || regulating;
            let known = present.iter().any(|&seen| std::ptr::eq(seen, spec));
            if needed && !known {
                self.problems.push(Problem::MissingKey { spec });
            }
        }
    }

    fn section(
        &mut self,
        section: &str,
        table: &dyn TableLike,
        present: &mut Vec<&'static ParameterSpec>,
    ) {
        let specs = || PARAMETERS.iter().filter(|spec| spec.section == section);
        for (key, item) in table.iter() {
            let line = self.line(table.key(key).and_then(toml_edit::Key::span));
            let name = format!("{section}.{key}");
            let Some(spec) = specs().find(|spec| spec.key == key) else {
                let suggestion = in_other_unit(key, specs()).map(|(spec, factor)| {
                    // Named, if in the wrong unit: it is not missing as well.
                    present.push(spec);
                    match number(item) {
                        Some(value) => format!("{} = {:e}", spec.key, value * factor),
                        None => spec.key.to_owned(),
                    }
                });
                self.problems.push(Problem::UnknownKey {
                    line,
                    key: name,
                    suggestion,
                });
                continue;
            };
            present.push(spec);
            let Some(value) = number(item) else {
                self.problems.push(Problem::WrongType {
                    line,
                    key: name,
                    found: item.type_name(),
                    expected: "a number",
                });
                continue;
            };
            if !spec.contains(value) {
                self.problems
                    .push(Problem::OutOfRange { line, spec, value });
                continue;
            }
            if let Some(slot) = (spec.slot)(&mut self.parameters) {
                *slot = value;
            }
            if let Some(comment) = self.comment_behind(item) {
                self.parameters.provenance.insert(name, comment);
            }
        }
    }

    fn valves(&mut self, table: &dyn TableLike) {
        for (key, item) in table.iter() {
            let line = self.line(table.key(key).and_then(toml_edit::Key::span));
            let name = format!("{VALVES}.{key}");
            let Some(index) = VALVE_KEYS.iter().position(|valve| *valve == key) else {
                self.problems.push(Problem::UnknownKey {
                    line,
                    key: name,
                    suggestion: None,
                });
                continue;
            };
            match item.as_str() {
                Some("normally_closed") => {
                    self.parameters.functions[index] = ValveFunction::NormallyClosed;
                }
                Some("normally_open") => {
                    self.parameters.functions[index] = ValveFunction::NormallyOpen;
                }
                Some(found) => self.problems.push(Problem::UnknownChoice {
                    line,
                    key: name,
                    found: found
                        .chars()
                        .take(80)
                        .flat_map(char::escape_default)
                        .collect(),
                    choices: FUNCTIONS,
                }),
                None => self.problems.push(Problem::WrongType {
                    line,
                    key: name,
                    found: item.type_name(),
                    expected: "a text, \"normally_closed\" or \"normally_open\"",
                }),
            }
        }
    }

    fn line(&self, span: Option<Range<usize>>) -> usize {
        line_of(self.text, span)
    }

    /// The comment that follows a value on its line: where the value comes from.
    fn comment_behind(&self, item: &Item) -> Option<String> {
        let rest = self.text.get(item.span()?.end..)?.lines().next()?;
        let comment = rest.trim_start().strip_prefix('#')?.trim();
        (!comment.is_empty()).then(|| comment.to_owned())
    }
}

fn number(item: &Item) -> Option<f64> {
    match item.as_value()? {
        Value::Float(value) => Some(*value.value()),
        Value::Integer(value) => Some(*value.value() as f64),
        _ => None,
    }
}

fn line_of(text: &str, span: Option<Range<usize>>) -> usize {
    span.map_or(0, |span| {
        1 + text.as_bytes()[..span.start.min(text.len())]
            .iter()
            .filter(|byte| **byte == b'\n')
            .count()
    })
}
