//! Ids and figures in sentences.

/// Returns an id in natural language: `chamber leak`.
pub(crate) fn spaced(id: &str) -> String {
    id.replace(['_', '.'], " ")
}

/// Returns the `parts` of a list in a sentence: `leak, droop and eddy currents`.
pub(crate) fn all_of(parts: &[String]) -> String {
    match parts {
        [before @ .., last] if !before.is_empty() => format!("{} and {last}", before.join(", ")),
        _ => parts.concat(),
    }
}

/// Returns a value with `digits` significant digits, and with an exponent where a plant file has one.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    let rounded = format!("{value:.*e}", digits - 1);
    let rounded = rounded.parse().unwrap_or(value);
    if rounded != 0.0 && !(1e-3..1e6).contains(&f64::abs(rounded)) {
        format!("{rounded:e}")
    } else {
        rounded.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::{all_of, significant};

    #[test]
    fn a_list_has_commas_and_one_and() {
        let parts = ["leak", "droop", "lag"].map(str::to_owned);
        assert_eq!(all_of(&parts), "leak, droop and lag");
        assert_eq!(all_of(&parts[..2]), "leak and droop");
        assert_eq!(all_of(&parts[..1]), "leak");
        assert_eq!(all_of(&[]), "");
    }

    #[test]
    fn a_value_has_its_significant_digits_and_an_exponent_where_a_plant_file_has_one() {
        assert_eq!(significant(5.2461, 2), "5.2");
        assert_eq!(significant(2.0948e-8, 3), "2.09e-8");
        assert_eq!(significant(-100.0, 2), "-100");
        assert_eq!(significant(0.0, 2), "0");
    }
}
