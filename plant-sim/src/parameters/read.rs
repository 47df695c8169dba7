//! Reader of plant files: it finds every problem before it uses anything.

use std::ops::Range;

use recording::nearest_name;
use toml_edit::{Document, Item, TableLike};

use super::consistency::inconsistency;
use super::error::{ParameterError, Problem};
use super::knowledge::{self, FORMS, number};
use super::names::{
    CHAMBER, FUNCTIONS, OMITTED_IF_0, REGULATING_VALVE, SECOND_CHAMBER, VALVE_KEYS, VALVES, VARIANT,
};
use super::parts::Part;
use super::table::PARAMETERS;
use super::units::{converted, in_other_unit};
use crate::description::{
    EFFECTS, Effect, EffectSetting, ParameterSpec, PlantParameters, RegulatingValveParameters,
};
use crate::effects::LIBRARY;

/// Size beyond which a file is certainly not a plant file (bytes).
const MAX_BYTES: usize = 1 << 20;

/// Key of the file with its line.
type Present = (&'static ParameterSpec, usize);

struct Reader<'a> {
    text: &'a str,
    /// Effects that the plant may have: those of the library, and user-defined ones.
    library: Vec<&'static dyn Effect>,
    problems: Vec<Problem>,
    parameters: PlantParameters,
}

pub(super) fn read(
    text: &str,
    name: &str,
    own: &[&'static dyn Effect],
) -> Result<PlantParameters, ParameterError> {
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
        library: LIBRARY.iter().chain(own).copied().collect(),
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
        let mut present = Vec::new();
        if root.contains_key(REGULATING_VALVE) {
            self.parameters.regulating_valve = Some(RegulatingValveParameters::default());
        }
        if root.contains_key(CHAMBER) {
            // The chamber exists until its volume is read.
            self.parameters.chamber.volume_m3 = 1.0;
        }
        if root.contains_key(SECOND_CHAMBER) {
            self.parameters.second_chamber.volume_m3 = 1.0;
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
            let specs = || PARAMETERS.iter().filter(|spec| spec.section == section);
            if section == VALVES {
                self.valves(table);
            } else if section == EFFECTS {
                self.effects(table);
            } else if specs().next().is_some() {
                let specs: Vec<_> = specs().copied().collect();
                self.section(section, table, &specs, &mut present);
            } else {
                self.problems.push(Problem::UnknownSection {
                    line,
                    section: section.to_owned(),
                });
            }
        }
        self.missing(&present);
        // A part may seem to be omitted because of another mistake, so this check comes last.
        if self.problems.is_empty() {
            self.superfluous(&present);
        }
    }

    /// Records missing keys that the parts of the plant need.
    fn missing(&mut self, present: &[Present]) {
        let regulating = self.parameters.regulating_valve.is_some();
        for &spec in PARAMETERS.iter() {
            let in_table = !spec.is_optional() || (regulating && spec.section == REGULATING_VALVE);
            let needed = in_table
                && !OMITTED_IF_0.contains(&(spec.section, spec.key))
                && Part::of_parameter(spec).is_in(&self.parameters);
            if needed && !present.iter().any(|(seen, _)| std::ptr::eq(*seen, spec)) {
                self.problems.push(Problem::MissingKey { spec });
            }
        }
    }

    /// Records keys that describe omitted parts.
    fn superfluous(&mut self, present: &[Present]) {
        for &(spec, line) in present {
            if !Part::of_parameter(spec).is_in(&self.parameters) {
                self.problems.push(Problem::AbsentPart { line, spec });
            }
        }
    }

    fn section(
        &mut self,
        section: &str,
        table: &dyn TableLike,
        specs: &[&'static ParameterSpec],
        present: &mut Vec<Present>,
    ) {
        for (key, item) in table.iter() {
            if key == VARIANT && section.starts_with(EFFECTS) {
                continue;
            }
            let line = self.line(table.key(key).and_then(toml_edit::Key::span));
            let name = format!("{section}.{key}");
            let Some(spec) = specs.iter().copied().find(|spec| spec.key == key) else {
                let suggestion = in_other_unit(key, specs.iter()).map(|(spec, factor)| {
                    // The key is present, though in the wrong unit: it is not missing as well.
                    present.push((spec, line));
                    match number(item) {
                        Some(value) => format!("{} = {:e}", spec.key, converted(value, factor)),
                        None => spec.key.to_owned(),
                    }
                });
                let suggestion = suggestion.or_else(|| {
                    nearest_name(key, specs.iter().map(|spec| spec.key)).map(str::to_owned)
                });
                self.problems.push(Problem::UnknownKey {
                    line,
                    key: name,
                    suggestion,
                });
                continue;
            };
            present.push((spec, line));
            let Some((value, knowledge)) = knowledge::read(spec, item) else {
                self.problems.push(Problem::WrongType {
                    line,
                    key: name,
                    found: item.type_name(),
                    expected: FORMS,
                });
                continue;
            };
            if !spec.contains(value) {
                self.problems
                    .push(Problem::OutOfRange { line, spec, value });
                continue;
            }
            if let Some(slot) = spec.slot(&mut self.parameters) {
                *slot = value;
            }
            if let Some(knowledge) = knowledge {
                self.parameters.knowledge.insert(name.clone(), knowledge);
            }
            if let Some(comment) = comment_behind(self.text, item) {
                self.parameters.provenance.insert(name, comment);
            }
        }
    }

    /// Reads `[effects]`: one table per effect, with `variant` and the variant's parameters in each.
    fn effects(&mut self, effects: &dyn TableLike) {
        for (id, item) in effects.iter() {
            let line = self.line(effects.key(id).and_then(toml_edit::Key::span));
            let known = |effect: &&&'static dyn Effect| effect.about().id == id;
            let Some(&effect) = self.library.iter().find(known) else {
                let ids = self.library.iter().map(|effect| effect.about().id);
                self.problems.push(Problem::UnknownEffect {
                    line,
                    id: id.to_owned(),
                    nearest: nearest_name(id, ids),
                });
                continue;
            };
            let Some(table) = item.as_table_like() else {
                self.problems.push(Problem::WrongType {
                    line,
                    key: format!("{EFFECTS}.{id}"),
                    found: item.type_name(),
                    expected: "a table of parameters",
                });
                continue;
            };
            self.effect(effect, table);
        }
    }

    fn effect(&mut self, effect: &'static dyn Effect, table: &dyn TableLike) {
        let about = effect.about();
        let name = format!("{EFFECTS}.{}", about.id);
        let line = self.line(table.key(VARIANT).and_then(toml_edit::Key::span));
        let variant = match table.get(VARIANT).map(|item| (item, item.as_str())) {
            None => Some(&about.variants[0]),
            Some((_, Some(word))) => about.variant(word).or_else(|| {
                self.problems.push(Problem::UnknownVariant {
                    line,
                    effect: about,
                    found: quotable(word),
                });
                None
            }),
            Some((item, None)) => {
                self.problems.push(Problem::WrongType {
                    line,
                    key: format!("{name}.{VARIANT}"),
                    found: item.type_name(),
                    expected: "the name of a variant",
                });
                None
            }
        };
        let Some(variant) = variant else { return };
        self.parameters
            .effects
            .push(EffectSetting::typical_variant(effect, variant));
        let mut present = Vec::new();
        self.section(&name, table, variant.parameters, &mut present);
        for &spec in variant.parameters {
            if !present.iter().any(|(seen, _)| std::ptr::eq(*seen, spec)) {
                self.problems.push(Problem::MissingKey { spec });
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
            let Some(word) = item.as_str() else {
                self.problems.push(Problem::WrongType {
                    line,
                    key: name,
                    found: item.type_name(),
                    expected: "a text, such as \"normally_closed\"",
                });
                continue;
            };
            match FUNCTIONS.iter().find(|(known, _)| *known == word) {
                Some(&(_, function)) => self.parameters.functions[index] = function,
                None => self.problems.push(Problem::UnknownChoice {
                    line,
                    key: name,
                    found: quotable(word),
                    choices: FUNCTIONS.iter().map(|(known, _)| *known).collect(),
                }),
            }
        }
    }

    fn line(&self, span: Option<Range<usize>>) -> usize {
        line_of(self.text, span)
    }
}

/// Returns text of the file in a form that a message may show.
fn quotable(text: &str) -> String {
    text.chars()
        .take(80)
        .flat_map(char::escape_default)
        .collect()
}

/// Returns the comment after a value on its line: the provenance of the value.
pub(super) fn comment_behind(text: &str, item: &Item) -> Option<String> {
    let rest = text.get(item.span()?.end..)?.lines().next()?;
    let comment = rest.trim_start().strip_prefix('#')?.trim();
    (!comment.is_empty()).then(|| comment.to_owned())
}

pub(super) fn line_of(text: &str, span: Option<Range<usize>>) -> usize {
    span.map_or(0, |span| {
        1 + text.as_bytes()[..span.start.min(text.len())]
            .iter()
            .filter(|byte| **byte == b'\n')
            .count()
    })
}
