//! Value of a data sheet and its uncertainty, which the value or the comment behind it states.

use toml_edit::Item;

use super::rows::Row;
use crate::description::Knowledge;
use crate::parameters::knowledge::{self, number};
use crate::toml_file::TomlFile;

/// Returns the value of an item, and what it or the comment behind it states of it.
pub(super) fn stated_value(file: &TomlFile<'_>, item: &Item) -> Option<(f64, Option<Knowledge>)> {
    match number(item) {
        Some(value) => {
            let comment = file.comment_behind(item);
            Some((value, comment.and_then(|comment| stated(comment, value))))
        }
        None => knowledge::read_in(item, |_| true, None),
    }
}

/// Returns the value of the parameter of `row`, and what is stated of it.
pub(super) fn value_of(
    file: &TomlFile<'_>,
    row: &Row,
    item: &Item,
) -> Option<(f64, Option<Knowledge>)> {
    let (value, knowledge) = stated_value(file, item)?;
    let converted = |value: f64| value * row.factor + row.offset;
    let knowledge = knowledge.map(|knowledge| match knowledge {
        Knowledge::Tolerance(half) => Knowledge::Tolerance(brief(half * row.factor)),
        // A share of degrees Celsius is none of kelvins.
        Knowledge::TolerancePct(percent) if row.offset != 0.0 => {
            Knowledge::Tolerance(brief(percent / 100.0 * value.abs() * row.factor))
        }
        Knowledge::Range(least, most) => Knowledge::Range(converted(least), converted(most)),
        other => other,
    });
    Some((brief(converted(value)), knowledge))
}

/// Returns the uncertainty that a comment states: `±15 %`, `+-0.35`, `±25 % and ±1`, `exact`; none if it states none.
fn stated(comment: &str, value: f64) -> Option<Knowledge> {
    let comment = comment.replace("+-", "±").replace("+/-", "±");
    let (mut percent, mut half) = (None, None);
    for width in comment.split('±').skip(1) {
        let width = width.trim_start();
        let end = width.find(|c: char| !c.is_ascii_digit() && c != '.');
        let (digits, rest) = width.split_at(end.unwrap_or(width.len()));
        let number: f64 = digits.trim_end_matches('.').parse().ok()?;
        match rest.trim_start().starts_with('%') {
            true => percent = Some(number),
            false => half = Some(number),
        }
    }
    match (percent, half) {
        (Some(percent), None) => Some(Knowledge::TolerancePct(percent)),
        (None, Some(half)) => Some(Knowledge::Tolerance(half)),
        (Some(percent), Some(half)) => {
            Some(Knowledge::Tolerance(percent / 100.0 * value.abs() + half))
        }
        (None, None) => {
            let mut words = comment.split(|c: char| !c.is_alphanumeric());
            words
                .any(|word| word == "exact")
                .then_some(Knowledge::Exact)
        }
    }
}

/// Returns `value` with the digits that a data sheet may have, without the rounding of a conversion.
pub(super) fn brief(value: f64) -> f64 {
    format!("{value:.8e}").parse().unwrap_or(value)
}
