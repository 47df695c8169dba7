//! Names and units of the signals.

use model_lab::diagnosis::result::BySignal;

/// Small unit for errors: `0.012 bar` is `12 mbar`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallUnit<'a> {
    /// Factor from the original unit to `symbol`.
    pub per_unit: f64,
    /// Symbol for tables and axes.
    pub symbol: &'a str,
}

impl<'a> SmallUnit<'a> {
    /// Returns the small unit for errors given in `unit`.
    pub fn of_errors_in(unit: &'a str) -> Self {
        match unit {
            "bar" => Self {
                per_unit: 1e3,
                symbol: "mbar",
            },
            "mm" => Self {
                per_unit: 1e3,
                symbol: "µm",
            },
            symbol => Self {
                per_unit: 1.0,
                symbol,
            },
        }
    }
}

/// Returns the unit of a signal's numbers in a diagnosis.
pub fn unit_of(signal: &str) -> &'static str {
    if signal.starts_with("i_") {
        "mA"
    } else {
        "bar"
    }
}

/// Returns the numbers by signal, the chamber pressure first.
pub fn pressure_first(figures: &BySignal) -> impl Iterator<Item = (&str, f64)> {
    let (pressure, rest): (Vec<_>, Vec<_>) = figures
        .iter()
        .map(|(signal, figure)| (signal.as_str(), *figure))
        .partition(|(signal, _)| unit_of(signal) == "bar");
    pressure.into_iter().chain(rest)
}

/// Returns the name of a signal in words; an unknown name is returned unchanged.
pub fn signal_words(name: &str) -> &str {
    match name {
        "p_ch" => "chamber pressure",
        "p_sup" => "supply pressure",
        "i_fill" => "current of the fill valve",
        "i_vent" => "current of the vent valve",
        "x_fill" => "lift of the fill valve",
        "x_vent" => "lift of the vent valve",
        "x_plunger" => "position of the plunger",
        other => other,
    }
}

/// Capitalises the first letter, for a title.
pub fn capitalised(words: &str) -> String {
    let mut letters = words.chars();
    letters
        .next()
        .map(|first| first.to_uppercase().chain(letters).collect())
        .unwrap_or_default()
}

/// Formats about three significant digits, with a true minus sign.
pub(super) fn short(value: f64) -> String {
    let decimals = match value.abs() {
        magnitude if magnitude >= 100.0 => 0,
        magnitude if magnitude >= 10.0 => 1,
        magnitude if magnitude >= 1.0 => 2,
        _ => 3,
    };
    with_minus(format!("{value:.decimals$}"))
}

/// Formats the tick of an axis with as many decimals as it needs.
pub(super) fn tick(value: &f64) -> String {
    let rounded = (value * 1e6).round() / 1e6;
    with_minus(format!("{}", if rounded == 0.0 { 0.0 } else { rounded }))
}

fn with_minus(number: String) -> String {
    number.replace('-', "\u{2212}")
}
