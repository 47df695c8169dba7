//! Formats of numbers.

/// Formats about three significant digits, with a true minus sign.
pub(super) fn number(value: f64) -> String {
    let decimals = match value.abs() {
        // Counts have no decimals.
        magnitude if magnitude.fract() == 0.0 => 0,
        magnitude if magnitude >= 100.0 => 0,
        magnitude if magnitude >= 10.0 => 1,
        magnitude if magnitude >= 1.0 => 2,
        magnitude if magnitude >= 0.01 => 3,
        _ => 5,
    };
    format!("{value:.decimals$}").replace('-', "\u{2212}")
}

/// Formats a number with `+` if it is positive.
pub(super) fn signed(value: f64) -> String {
    let sign = if value > 0.0 { "+" } else { "" };
    format!("{sign}{}", number(value))
}

/// Formats a number that may be unknown.
pub(super) fn known(value: Option<f64>) -> String {
    value.map_or("unknown".to_owned(), number)
}

/// Formats a share, 0 to 1, as percent.
pub(super) fn percent(share: f64) -> String {
    format!("{:.0} %", 100.0 * share).replace('-', "\u{2212}")
}

/// Formats values of any size with three digits; long rows of zeros become a power of ten.
pub(super) fn engineering(value: f64) -> String {
    let text = if value != 0.0 && !(0.1..1e5).contains(&value.abs()) {
        format!("{value:.2e}")
    } else {
        number(value)
    };
    text.replace('-', "\u{2212}")
}
