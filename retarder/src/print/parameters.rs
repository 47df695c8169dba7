//! Lists of parameters and settings.

use controller::SettingSpec;
use hil_harness::controller_file::{self, KEYS};
use model_lab::diagnosis::{Known, known};
use plant_sim::PlantParameters;
use plant_sim::parameters::ParameterSpec;

use super::number::{or_dash, value};
use super::{Colour, Terminal, indented, painted_lines, paragraph, title};
use crate::input::{NamedController, NamedPlant};

/// Returns all parameters of a plant, in the order of its file.
pub(super) fn parameters(plant: &NamedPlant, terminal: &Terminal) -> String {
    let mut text = title(&format!("Parameters of the {}", plant.name), terminal);
    let mut section = "";
    for spec in plant.parameters.specs() {
        if spec.section != section {
            section = spec.section;
            text += &format!("\n[{section}]\n");
            text += &own_effect(spec, &plant.parameters, terminal);
        }
        text += &parameter(spec, plant, terminal);
    }
    text += "\nChange one: --set SECTION.KEY=VALUE\n";
    text += &paragraph(
        "Values without `Known` count as exact. Say in the plant file how well you know a value, such as \
         volume_m3 = { value = 75e-6, tolerance_pct = 30 }; `retarder parameters --toml` lists the forms.",
        terminal,
    );
    text + "A file to start from: retarder parameters --toml > my-plant.toml\n"
}

/// Returns the sentence, the law and the source of the user's own effect that `spec` belongs to; empty for any other.
fn own_effect(spec: &ParameterSpec, plant: &PlantParameters, terminal: &Terminal) -> String {
    let effect = spec.effect_id().and_then(|id| plant.candidate(id));
    let Some(effect) = effect.filter(|effect| effect.definition_toml().is_some()) else {
        return String::new();
    };
    let about = effect.about();
    let law = about.variants[0].about;
    let words = format!("{} Law: {law}. Source: {}.", about.sentence, about.source);
    indented(&words, 4, terminal)
}

fn parameter(spec: &ParameterSpec, plant: &NamedPlant, terminal: &Terminal) -> String {
    let found = or_dash(spec.value(&plant.parameters), value);
    let assignment = format!("{} = {found}", spec.key);
    let (low, high) = spec.range;
    let range = format!("{} to {} {}", value(low), value(high), spec.unit);
    let origin = match plant.parameters.provenance.get(&spec.name()) {
        Some(origin) => format!("{}. Value: {origin}", spec.about),
        None if spec.value(&plant.parameters).is_none() => {
            format!("{}. Optional: the whole table may be absent", spec.about)
        }
        None => spec.about.to_owned(),
    };
    let mut text = entry(&assignment, &range, &origin, terminal);
    if let Some(words) = knowledge(spec, &plant.parameters) {
        text += &indented(&format!("Known: {words}"), 4, terminal);
    }
    text
}

/// Returns the uncertainty of the value in words; `None` if it is exact.
fn knowledge(spec: &ParameterSpec, plant: &PlantParameters) -> Option<String> {
    match known(plant, &spec.name())? {
        Known::Exact => None,
        known => Some(known.words(spec.unit)),
    }
}

/// Returns all settings of a controller, in the order of its file.
pub(super) fn settings(controller: &NamedController, terminal: &Terminal) -> String {
    let mut text = title(&format!("Settings of the {}", controller.name), terminal);
    let file = controller_file::write(&controller.settings);
    let mut table = "";
    for key in KEYS.iter() {
        if key.table != table {
            table = key.table;
            text += &format!("\n[{table}]\n");
        }
        let found = value_in(&file, key.table, key.name);
        let assignment = format!("{} = {}", key.name, found.unwrap_or("-"));
        let SettingSpec { range, unit, .. } = key.spec();
        let note = match (found, range) {
            (None, _) => "not used by this controller".to_owned(),
            (Some(_), [min, max]) if min < max => format!("{min} to {max} {unit}"),
            (Some(_), _) => String::new(),
        };
        text += &entry(&assignment, &note, key.about, terminal);
    }
    text + "\nA file to start from: retarder settings --toml > my-controller.toml\n"
}

/// Column of the remarks beside an assignment.
const BESIDE: usize = 48;

fn entry(assignment: &str, beside: &str, meaning: &str, terminal: &Terminal) -> String {
    let padding = " ".repeat(BESIDE.saturating_sub(assignment.chars().count()));
    let line = format!(
        "{}{padding} {beside}",
        terminal.paint(Colour::First, assignment)
    );
    let meaning = painted_lines(Colour::Faint, &indented(meaning, 4, terminal), terminal);
    format!("{}\n{meaning}", line.trim_end())
}

/// Returns the value of a key in a file that this program wrote: one key per line, comments after the value.
fn value_in<'a>(text: &'a str, table: &str, key: &str) -> Option<&'a str> {
    let body = text.split_once(&format!("[{table}]\n"))?.1;
    let body = body.split("\n[").next()?;
    let line = body
        .lines()
        .find_map(|line| line.strip_prefix(key)?.strip_prefix(" = "))?;
    Some(line.split('#').next()?.trim())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_found_in_its_own_table() {
        let text = "[a]\nx = 1   # one\n\n[b]\nx = \"two\"\n";
        assert_eq!(value_in(text, "a", "x"), Some("1"));
        assert_eq!(value_in(text, "b", "x"), Some("\"two\""));
        assert_eq!(value_in(text, "b", "y"), None);
    }
}
