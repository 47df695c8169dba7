//! Tables of a plant file that a person edits as a text of their own: the kinds of the valves, the valves without a coil,
//! and the user's own effects.

use toml_edit::{Item, Table};

use super::error::{ParameterError, Problem};
use super::names::{FUNCTIONS, ON_OFF, PROPORTIONAL, VALVE_KEYS, VALVES};
use crate::description::{EFFECTS, PlantParameters};
use crate::own_effects::{OWN, OWN_EFFECTS};
use crate::toml_file::{TomlFile, shown};
use crate::valve::ValveFunction;

/// Returns the names of the edited tables, in their written form.
pub(super) fn edited() -> Vec<String> {
    let tables = [VALVES].into_iter().chain(ON_OFF).chain(PROPORTIONAL);
    let own = [format!("[{OWN_EFFECTS}.*]"), format!("[{EFFECTS}.{OWN}.*]")];
    tables
        .map(|table| format!("[{table}]"))
        .chain(own)
        .collect()
}

/// Returns whether the table `[top.sub]` is edited.
fn is_edited(top: &str, sub: Option<&str>) -> bool {
    match top {
        EFFECTS => sub == Some(OWN),
        VALVES | OWN_EFFECTS => true,
        other => ON_OFF.contains(&other) || PROPORTIONAL.contains(&other),
    }
}

impl PlantParameters {
    /// Returns the part of the plant file that a person edits as text: the tables `[valves]`, `[on_off_*]`,
    /// `[proportional_*]`, `[own_effects.*]` and `[effects.own.*]`.
    pub fn edited_tables(&self) -> String {
        let text = self.to_toml();
        let edited: String = tables(&text)
            .filter(|one| one.is_edited())
            .map(|one| one.text)
            .collect();
        edited.trim().to_owned() + "\n"
    }

    /// Returns the plant with the tables of [`Self::edited_tables`] replaced by those of `text`. Values of parts that
    /// the plant loses with its kind of valves are dropped. Errors use `name` for the text.
    ///
    /// # Errors
    /// Returns all problems, as [`Self::from_toml`] does; a line that exceeds `text` is one of the rest of the file.
    /// Another table than those is refused.
    pub fn with_edited_tables(&self, text: &str, name: &str) -> Result<Self, ParameterError> {
        let fail = |problems| Err(ParameterError::new(name, problems));
        let file = match TomlFile::parse(text) {
            Ok(file) => file,
            Err(unreadable) => return fail(vec![Problem::Unreadable(unreadable)]),
        };
        let elsewhere = elsewhere(&file);
        if !elsewhere.is_empty() {
            return fail(elsewhere);
        }
        let mut rest = self.clone();
        rest.functions = functions(file.root());
        let rest = rest.to_toml();
        let rest: String = tables(&rest)
            .filter(|one| !one.is_edited())
            .map(|one| one.text)
            .collect();
        // The text comes first, so that its lines keep their numbers.
        Self::from_toml(&format!("{text}\n{rest}"), name)
    }
}

/// Returns the tables of `file` that are not edited.
fn elsewhere(file: &TomlFile) -> Vec<Problem> {
    let root = file.root();
    let problem = |line: usize, section: String| Problem::NotEdited { line, section };
    let each = root
        .iter()
        .flat_map(|(top, item)| match item.as_table_like() {
            Some(table) if top == EFFECTS => {
                let other = table.iter().filter(|(sub, _)| !is_edited(top, Some(sub)));
                let other = other.map(|(sub, _)| {
                    let section = format!("{EFFECTS}.{}", shown(sub));
                    problem(file.line_of_key(table, sub), section)
                });
                other.collect()
            }
            _ if is_edited(top, None) => Vec::new(),
            _ => vec![problem(file.line_of_key(root, top), shown(top))],
        });
    each.collect()
}

/// Returns the kinds of the valves in `[valves]`; a word that is none counts as absent, and the reader refuses it.
fn functions(root: &Table) -> [ValveFunction; 2] {
    let valves = root.get(VALVES).and_then(Item::as_table_like);
    let mut functions = PlantParameters::blank().functions;
    for (key, function) in VALVE_KEYS.iter().zip(&mut functions) {
        let word = valves.and_then(|table| table.get(key)?.as_str());
        let known = FUNCTIONS.iter().find(|(known, _)| Some(*known) == word);
        if let Some((_, known)) = known {
            *function = *known;
        }
    }
    functions
}

/// Table of a written plant file with its heading; the comment before the first table has none.
struct Written<'a> {
    heading: Option<&'a str>,
    text: &'a str,
}

impl Written<'_> {
    fn is_edited(&self) -> bool {
        self.heading.is_some_and(|heading| {
            let mut names = heading.split('.');
            is_edited(names.next().unwrap_or_default(), names.next())
        })
    }
}

/// Returns the tables of a text that [`PlantParameters::to_toml`] wrote, each of which begins with its heading.
fn tables(text: &str) -> impl Iterator<Item = Written<'_>> {
    let mut rest = text;
    core::iter::from_fn(move || {
        if rest.is_empty() {
            return None;
        }
        let end = rest.find("\n[").map_or(rest.len(), |at| at + 1);
        let (text, after) = rest.split_at(end);
        rest = after;
        let heading = text
            .strip_prefix('[')
            .and_then(|text| text.split(']').next());
        Some(Written { heading, text })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const SEAL: &str = "[own_effects.lifting_seal]\nsentence = \"The seal lifts.\"\nacts_on = \"leak_flow\"\n\
        expression = \"k * max(p - p_ambient, 0)\"\nparameters.k = { typical = 1e-10, range = [1e-12, 1e-8], unit = \"kg/s/Pa\" }\n\
        [effects.own.lifting_seal]\nk = 3e-10\n";
    const ON_OFF_VALVE: &str = "conductance_dm3_per_s_bar = 0.6\ncritical_ratio = 0.3\nopening_delay_s = 8e-3\n\
        closing_delay_s = 7e-3\nopening_ramp_s = 2e-3\nclosing_ramp_s = 3e-3\n";

    fn closed() -> &'static str {
        "[valves]\nfill = \"normally_closed\"\nvent = \"normally_closed\"\n"
    }

    #[test]
    fn the_edited_text_of_any_plant_gives_the_same_plant() {
        let plain = PlantParameters::nominal();
        let with_seal = plain
            .with_edited_tables(&format!("{}{SEAL}", closed()), "edited")
            .unwrap();
        for plant in [plain, with_seal] {
            let text = plant.edited_tables();
            let again = plant.with_edited_tables(&text, "edited").unwrap();
            assert_eq!(again.to_toml(), plant.to_toml(), "{text}");
        }
    }

    #[test]
    fn an_own_effect_comes_and_goes_with_its_tables_and_the_rest_stays() {
        let mut plant = PlantParameters::nominal();
        plant.set("chamber.volume_m3", 81e-6, "measured").unwrap();
        let with_seal = plant
            .with_edited_tables(&format!("{}{SEAL}", closed()), "edited")
            .unwrap();
        assert_eq!(with_seal.get("effects.own.lifting_seal.k"), Some(3e-10));
        assert_eq!(with_seal.get("chamber.volume_m3"), Some(81e-6));
        assert!(
            with_seal
                .edited_tables()
                .contains("[own_effects.lifting_seal]")
        );
        let without = with_seal.with_edited_tables(closed(), "edited").unwrap();
        assert_eq!(without.to_toml(), plant.to_toml());
    }

    #[test]
    fn a_valve_becomes_an_on_off_valve_and_the_values_of_its_armature_are_dropped() {
        let plant = PlantParameters::nominal();
        let text = format!(
            "[valves]\nfill = \"on_off\"\nvent = \"normally_closed\"\n[on_off_fill]\n{ON_OFF_VALVE}"
        );
        let changed = plant.with_edited_tables(&text, "edited").unwrap();
        assert_eq!(changed.functions[0], ValveFunction::OnOff);
        assert_eq!(changed.get("on_off_fill.opening_delay_s"), Some(8e-3));
        assert_eq!(changed.get("armature.preload_fill_n"), None);
        assert_eq!(
            changed.get("armature.preload_vent_n"),
            plant.get("armature.preload_vent_n")
        );
        let both = format!(
            "[valves]\nfill = \"on_off\"\nvent = \"on_off\"\n[on_off_fill]\n{ON_OFF_VALVE}[on_off_vent]\n{ON_OFF_VALVE}"
        );
        let changed = changed.with_edited_tables(&both, "edited").unwrap();
        assert_eq!(changed.get("coil.resistance_20c_ohm"), None);
    }

    #[test]
    fn a_problem_has_its_line_in_the_edited_text_and_another_table_is_refused() {
        let plant = PlantParameters::nominal();
        for (text, line, says) in [
            (
                "[valves]\nfill = \"onoff\"\nvent = \"normally_closed\"\n",
                2,
                "is not one of",
            ),
            ("[valves\n", 1, "not valid TOML"),
            (
                "[valves]\n[chamber]\nvolume_m3 = 1e-4\n",
                2,
                "`[chamber]` is not edited here",
            ),
            (
                "[effects.chamber_leak]\narea_m2 = 2e-8\n",
                1,
                "`[effects.chamber_leak]` is not edited here",
            ),
            (
                "[valves]\nfill = \"on_off\"\n[on_off_fill]\nopening_delay_s = 20\n",
                4,
                "out of range",
            ),
            (
                "\n[own_effects.x]\nsentence = \"x\"\nacts_on = \"leak_flow\"\nexpression = \"k *\"\n",
                5,
                "expression",
            ),
        ] {
            let refused = plant.with_edited_tables(text, "edited").unwrap_err();
            let problem = &refused.problems()[0];
            assert_eq!(problem.line(), Some(line), "{text}: {problem}");
            assert!(problem.to_string().contains(says), "{text}: {problem}");
        }
    }
}
