//! Writer of a plant file that reads back to the same bits.

use core::fmt::Write as _;

use super::knowledge;
use super::names::{
    FUNCTIONS, LAG_OF, PROPORTIONAL, SECOND_CHAMBER, SENSOR, SENSOR_PLACES, VALVE_KEYS, VALVES,
    VARIANT,
};
use super::table::PARAMETERS;
use crate::description::{EffectSetting, ParameterSpec, PlantParameters, SensorPlace};

pub(super) fn write(parameters: &PlantParameters) -> String {
    let mut text = String::from(
        "# Plant model. The unit is the end of each key; the comment says where the value comes from.\n",
    );
    let mut section = "";
    for spec in PARAMETERS.iter().filter(|spec| spec.effect_id().is_none()) {
        let Some(value) = spec.value(parameters) else {
            continue;
        };
        let is_stated = parameters.knowledge.contains_key(&spec.name());
        if spec.preset(parameters) == Some(value) && !is_stated {
            continue;
        }
        if spec.section != section {
            section = spec.section;
            let _ = write!(text, "\n[{section}]\n");
            if section == SECOND_CHAMBER {
                text += &sensor_place(parameters.second_chamber.sensor);
            }
            if let Some(valve) = PROPORTIONAL.iter().position(|table| *table == section) {
                text += &lag_of(parameters, valve);
            }
        }
        text += &assignment(parameters, spec, value);
    }
    let _ = write!(text, "\n[{VALVES}]\n");
    for (key, function) in VALVE_KEYS.iter().zip(parameters.functions) {
        let word = FUNCTIONS.iter().find(|(_, known)| *known == function);
        let _ = writeln!(text, "{key} = \"{}\"", word.map_or("", |(word, _)| word));
    }
    for definition in parameters
        .own
        .iter()
        .filter_map(|one| one.definition_toml())
    {
        let _ = write!(text, "\n{definition}");
    }
    for setting in &parameters.effects {
        text += &effect(parameters, setting);
    }
    text
}

/// Returns the line with the place of the pressure sensor; nothing for the usual place.
fn sensor_place(place: SensorPlace) -> String {
    let word = SENSOR_PLACES.iter().find(|(_, known)| *known == place);
    match word.filter(|_| place != SensorPlace::default()) {
        Some((word, _)) => format!("{SENSOR} = \"{word}\"\n"),
        None => String::new(),
    }
}

/// Returns the line with the part of a proportional valve that lags; nothing where that is open.
fn lag_of(parameters: &PlantParameters, valve: usize) -> String {
    match parameters.proportional(valve).lag_of {
        Some(lag_of) => format!("{LAG_OF} = \"{}\"\n", lag_of.word()),
        None => String::new(),
    }
}

fn effect(parameters: &PlantParameters, setting: &EffectSetting) -> String {
    let mut text = format!(
        "\n[effects.{}]\n{VARIANT} = \"{}\"\n",
        setting.id(),
        setting.variant().name
    );
    for (spec, value) in setting.parameters().iter().zip(setting.values()) {
        text += &assignment(parameters, spec, *value);
    }
    text
}

/// Returns `key = value, with its knowledge # provenance`.
fn assignment(parameters: &PlantParameters, spec: &ParameterSpec, value: f64) -> String {
    let comment = match parameters.provenance.get(&spec.name()) {
        Some(provenance) => format!("   # {}", provenance.replace(char::is_control, " ")),
        None => String::new(),
    };
    let knowledge = parameters.knowledge.get(&spec.name()).copied();
    let value = knowledge::write(value, knowledge);
    format!("{} = {value}{comment}\n", spec.key)
}
