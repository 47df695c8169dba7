//! What plant files and controller files are made of.

use hil_harness::controller_file::{self, KEYS};
use plant_sim::parameters::PARAMETERS;

use super::number::{or_dash, value};
use super::table::{Align, Table, painted};
use super::{Colour, Terminal, title};
use crate::input::{NamedController, NamedPlant};

/// All parameters of a plant.
pub(super) fn parameters(plant: &NamedPlant, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("parameter", Align::Left),
            ("value", Align::Right),
            ("unit", Align::Left),
            ("range", Align::Left),
            ("meaning", Align::Left),
            ("value from", Align::Left),
        ],
        terminal,
    );
    let mut section = "";
    for spec in PARAMETERS.iter() {
        if spec.section != section {
            section = spec.section;
            table.heading(&format!("[{section}]"));
        }
        let origin = plant.parameters.provenance.get(&spec.name());
        table.row([
            format!("  {}", spec.key).into(),
            or_dash(spec.value(&plant.parameters), value).into(),
            spec.unit.into(),
            format!("{} to {}", value(spec.range.0), value(spec.range.1)).into(),
            spec.about.into(),
            painted(Colour::Faint, origin.map_or("", String::as_str)),
        ]);
    }
    let mut text = title(&format!("Parameters of {}", plant.name), terminal);
    text += &table.to_string();
    text += "\nChange one: --set SECTION.KEY=VALUE. A file to start from: retarder parameters --toml > my-plant.toml\n";
    text
}

/// All settings of a controller.
pub(super) fn settings(controller: &NamedController, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("setting", Align::Left),
            ("value", Align::Right),
            ("meaning", Align::Left),
        ],
        terminal,
    );
    let text = controller_file::write(&controller.settings);
    let mut section = "";
    for key in KEYS {
        if key.table != section {
            section = key.table;
            table.heading(&format!("[{section}]"));
        }
        table.row([
            format!("  {}", key.name).into(),
            value_in(&text, key.table, key.name).unwrap_or("-").into(),
            key.about.into(),
        ]);
    }
    let mut text = title(&format!("Settings of {}", controller.name), terminal);
    text += &table.to_string();
    text += "\nA file to start from: retarder settings --toml > my-controller.toml\n";
    text
}

/// The value of a key in a file that we have written: one key per line, comments behind.
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
