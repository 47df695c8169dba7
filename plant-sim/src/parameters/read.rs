//! Reader of plant files: it finds every problem before it uses anything.

use toml_edit::{Item, TableLike};

use super::consistency::inconsistency;
use super::error::{ParameterError, Problem};
use super::knowledge::{self, FORMS, number};
use super::names::{
    CHAMBER, FUNCTIONS, LAG_OF, LAGS, PROPORTIONAL, REGULATING_VALVE, SECOND_CHAMBER, SENSOR,
    SENSOR_PLACES, VALVE_KEYS, VALVES, VARIANT,
};
use super::own_effects;
use super::parts::Part;
use super::table::PARAMETERS;
use super::units::{converted, in_other_unit};
use crate::description::{
    About, EFFECTS, Effect, EffectSetting, ParameterSpec, PlantParameters,
    RegulatingValveParameters, Variant,
};
use crate::own_effects::{OWN, OWN_EFFECTS};
use crate::toml_file::{TomlFile, key_meant, shown};

/// Key of the file with its line.
type Present = (&'static ParameterSpec, usize);

struct Reader<'a> {
    file: &'a TomlFile<'a>,
    problems: Vec<Problem>,
    parameters: PlantParameters,
}

pub(super) fn read(
    text: &str,
    name: &str,
    own: &[&'static dyn Effect],
) -> Result<PlantParameters, ParameterError> {
    let fail = |problems| Err(ParameterError::new(name, problems));
    let file = match TomlFile::parse(text) {
        Ok(file) => file,
        Err(unreadable) => return fail(vec![Problem::Unreadable(unreadable)]),
    };
    let mut reader = Reader {
        file: &file,
        problems: Vec::new(),
        parameters: PlantParameters::blank(),
    };
    for effect in own {
        reader.parameters.own.add(*effect);
    }
    reader.root();
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
    fn root(&mut self) {
        let root = self.file.root();
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
        // The definitions come first, because a table of an effect may precede its definition.
        if let Some(table) = root.get(OWN_EFFECTS).and_then(Item::as_table_like) {
            for effect in own_effects::read(self.file, table, &mut self.problems) {
                self.parameters.own.add(effect);
            }
        }
        for (section, item) in root.iter() {
            let line = self.file.line_of_key(root, section);
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
            } else if section == OWN_EFFECTS {
                // Read above.
            } else if section == EFFECTS {
                self.effects(table, "");
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
                && spec.preset(&self.parameters).is_none()
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
            let line = self.file.line_of_key(table, key);
            let name = format!("{section}.{key}");
            if (section, key) == (SECOND_CHAMBER, SENSOR) {
                if let Some(place) = self.choice(line, name, item, &SENSOR_PLACES) {
                    self.parameters.second_chamber.sensor = place;
                }
                continue;
            }
            if key == LAG_OF
                && let Some(valve) = PROPORTIONAL.iter().position(|table| *table == section)
            {
                self.parameters.proportional_mut(valve).lag_of =
                    self.choice(line, name, item, &LAGS);
                continue;
            }
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
                    key_meant(key, specs.iter().map(|spec| spec.key)).map(str::to_owned)
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
            if let Some(comment) = self.file.comment_behind(item) {
                self.parameters.provenance.insert(name, comment.to_owned());
            }
        }
    }

    /// Reads one of these words; records a problem where it is another one.
    fn choice<T: Copy>(
        &mut self,
        line: usize,
        key: String,
        item: &Item,
        choices: &[(&'static str, T)],
    ) -> Option<T> {
        let word = item.as_str().unwrap_or(item.type_name());
        let found = choices.iter().find(|(known, _)| *known == word);
        if found.is_none() {
            self.problems.push(Problem::UnknownChoice {
                line,
                key,
                found: shown(word),
                choices: choices.iter().map(|(known, _)| *known).collect(),
            });
        }
        found.map(|(_, choice)| *choice)
    }

    /// Reads `[effects]`: one table per effect, with `variant` and the variant's parameters in each. The ids begin with
    /// `prefix`: `own.` in the table `[effects.own]`.
    fn effects(&mut self, effects: &dyn TableLike, prefix: &str) {
        for (name, item) in effects.iter() {
            let line = self.file.line_of_key(effects, name);
            let id = &format!("{prefix}{name}");
            if id == OWN
                && let Some(table) = item.as_table_like()
            {
                self.effects(table, &format!("{OWN}."));
                continue;
            }
            let Some(effect) = self.parameters.candidate(id) else {
                // A definition that was refused is no unknown effect as well.
                if !self.is_refused(id) {
                    let ids: Vec<_> = self.parameters.candidates().collect();
                    let ids = ids.iter().map(|effect| effect.about().id);
                    self.problems.push(Problem::UnknownEffect {
                        line,
                        id: id.to_owned(),
                        nearest: key_meant(id, ids),
                    });
                }
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

    /// Returns whether the file defines the effect `id`.
    fn is_refused(&self, id: &str) -> bool {
        let own = self.file.root().get(OWN_EFFECTS);
        let name = id.split_once('.').map(|(_, name)| name);
        own.and_then(Item::as_table_like)
            .zip(name)
            .is_some_and(|(own, name)| own.contains_key(name))
    }

    fn effect(&mut self, effect: &'static dyn Effect, table: &dyn TableLike) {
        let about = effect.about();
        let name = format!("{EFFECTS}.{}", about.id);
        let line = self.file.line_of_key(table, VARIANT);
        let variant = match table.get(VARIANT).map(|item| (item, item.as_str())) {
            None => Some(variant_of_keys(about, table)),
            Some((_, Some(word))) => about.variant(word).or_else(|| {
                self.problems.push(Problem::UnknownVariant {
                    line,
                    effect: about,
                    found: shown(word),
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
            let line = self.file.line_of_key(table, key);
            let name = format!("{VALVES}.{key}");
            let Some(index) = VALVE_KEYS.iter().position(|valve| *valve == key) else {
                self.problems.push(Problem::UnknownKey {
                    line,
                    key: name,
                    suggestion: None,
                });
                continue;
            };
            if item.as_str().is_none() {
                self.problems.push(Problem::WrongType {
                    line,
                    key: name,
                    found: item.type_name(),
                    expected: "a text, such as \"normally_closed\"",
                });
                continue;
            }
            if let Some(function) = self.choice(line, name, item, &FUNCTIONS) {
                self.parameters.functions[index] = function;
            }
        }
    }
}

/// Returns the form of an effect's law that has exactly the parameters in `table`, or all of them and others, or else the usual form.
fn variant_of_keys(about: &'static About, table: &dyn TableLike) -> &'static Variant {
    let keys: Vec<&str> = table.iter().map(|(key, _)| key).collect();
    let has_all = |variant: &&Variant| {
        let has = |key: &&str| variant.parameters.iter().any(|spec| spec.key == *key);
        keys.iter().all(has)
    };
    let mut fitting = about.variants.iter().filter(has_all);
    let exact = fitting
        .clone()
        .find(|variant| variant.parameters.len() == keys.len());
    exact.or(fitting.next()).unwrap_or(&about.variants[0])
}
