//! Comparison of `docs/settings.md` with the tables of settings.

use ecu::controller::fixed::types::I16F16;
use ecu::controller::{Field, Form, SettingSpec, Settings};
use ecu::{EcuField, EcuSettings};

use crate::page::{assert_written, with_table};

const PAGE: &str = include_str!("../../../docs/settings.md");

/// `BLESS=1 cargo nextest run -p retarder-ecu settings_page` writes the tables of the page.
#[test]
fn the_tables_of_the_page_are_those_of_the_code() {
    let page = with_table(PAGE, "| setting | key |", &Field::ALL.map(controller_row));
    let page = with_table(&page, "| setting | unit |", &EcuField::ALL.map(ecu_row));
    assert_written("settings.md", PAGE, &page);
}

fn controller_row(field: Field) -> String {
    let spec = field.spec();
    let key = |key: &&str| match spec.form {
        Form::Section => format!("`[{}]`", spec.section),
        _ => format!("`{}.{key}`", spec.section),
    };
    let keys: Vec<String> = spec.keys.iter().map(key).collect();
    let value = |settings: &Settings| shown(spec, field.get(settings));
    format!(
        "| `{field}` | {} | {} | {} | {} | {} | {} |",
        keys.join(" or "),
        spec.unit,
        range(spec),
        value(&Settings::thesis()),
        value(&Settings::recommended()),
        spec.about,
    )
}

fn ecu_row(field: EcuField) -> String {
    let spec = field.spec();
    format!(
        "| `{field}` | {} | {} | {} | {} |",
        spec.unit,
        range(spec),
        shown(spec, field.get(&EcuSettings::bench())),
        spec.about,
    )
}

fn range(spec: &SettingSpec) -> String {
    let [min, max] = spec.range;
    match spec.choices {
        [] => format!("{min} to {max}"),
        words => words.join(", "),
    }
}

fn shown(spec: &SettingSpec, number: Option<i32>) -> String {
    match number {
        None => "not used".to_owned(),
        Some(bits) if spec.choices.is_empty() => I16F16::from_bits(bits).to_string(),
        Some(number) => spec.choices[usize::try_from(number).unwrap()].to_owned(),
    }
}
