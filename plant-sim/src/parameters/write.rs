//! Writing a plant file that reads back to the same bits.

use core::fmt::Write as _;

use super::table::{PARAMETERS, VALVE_KEYS, VALVES};
use super::values::PlantParameters;
use crate::valve::ValveFunction;

pub(super) fn write(parameters: &PlantParameters) -> String {
    let mut text = String::from(
        "# Plant model. The unit is the end of each key; the comment says where the value comes from.\n",
    );
    let mut section = "";
    for spec in PARAMETERS.iter() {
        let Some(value) = spec.value(parameters) else {
            continue;
        };
        if spec.section != section {
            section = spec.section;
            let _ = write!(text, "\n[{section}]\n");
        }
        let _ = write!(text, "{} = {value:?}", spec.key);
        if let Some(provenance) = parameters.provenance.get(&spec.name()) {
            let _ = write!(text, "   # {}", provenance.replace(char::is_control, " "));
        }
        text.push('\n');
    }
    let _ = write!(text, "\n[{VALVES}]\n");
    for (key, function) in VALVE_KEYS.iter().zip(parameters.functions) {
        let word = match function {
            ValveFunction::NormallyClosed => "normally_closed",
            ValveFunction::NormallyOpen => "normally_open",
        };
        let _ = writeln!(text, "{key} = \"{word}\"");
    }
    text
}
