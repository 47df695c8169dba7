//! Header fields with name and unit: `p_ch_bar_gauge`, `p_ch [bar gauge]`, `p_ch (bar gauge)`.

use super::error::Excerpt;
use super::number::is_number_like;
use super::problem::Problem;
use crate::name::check_name;
use crate::{PressureReference, Unit};

/// Reference of a pressure whose unit states none, such as `bar`; `None` where nobody stated it.
pub(crate) type Reference = Option<PressureReference>;

/// Columns that are duty cycles by another name: the state of a valve, 0 or 1, and the command of a proportional valve.
const COMMANDS: [(&str, &str, Unit); 4] = [
    ("state_fill", "duty_fill", Unit::Fraction),
    ("state_vent", "duty_vent", Unit::Fraction),
    ("cmd_fill_pct", "duty_fill", Unit::Percent),
    ("cmd_vent_pct", "duty_vent", Unit::Percent),
];

/// Content of a column header.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Heading {
    pub(crate) name: String,
    pub(crate) unit: Unit,
}

/// Parses a header field that contains its unit.
pub(crate) fn parse_heading(field: &str, reference: Reference) -> Result<Heading, Problem> {
    let field = without_formula_guard(field);
    let (name, unit) = match bracketed(field) {
        _ if let Some((_, duty, unit)) = COMMANDS.iter().find(|(name, ..)| *name == field) => {
            (*duty, *unit)
        }
        Some((name, unit)) => (name, parse_unit(unit, reference)?),
        None => suffixed(field, reference)?,
    };
    named(name, field, unit)
}

/// Parses a header field above a units row; both may contain the unit if they agree.
pub(crate) fn parse_heading_over_unit(
    field: &str,
    unit: &str,
    reference: Reference,
) -> Result<Heading, Problem> {
    if unit.is_empty() {
        return parse_heading(field, reference);
    }
    let unit = parse_unit(unit, reference)?;
    match parse_heading(field, reference) {
        Ok(heading) if heading.unit == unit => Ok(heading),
        Ok(heading) => Err(Problem::UnitConflict {
            header: heading.unit,
            units_row: unit,
        }),
        Err(_) => named(without_formula_guard(field), field, unit),
    }
}

/// Returns whether a second record is a row of units: it has no number and at least one unit.
pub(super) fn is_units_row<'a>(fields: impl Iterator<Item = &'a str>) -> bool {
    let mut has_unit = false;
    for field in fields {
        // `1` is also a unit, but as a field it is a number.
        if is_number_like(field) {
            return false;
        }
        has_unit |= !matches!(
            parse_unit(field, None),
            Err(Problem::UnitUnknown { meant: None, .. })
        );
    }
    has_unit
}

/// Parses a unit of a mapping or a units row. A unit that states its reference keeps it.
pub(crate) fn parse_unit(text: &str, reference: Reference) -> Result<Unit, Problem> {
    let text = unwrapped(text);
    let unit = Unit::parse(text).or_else(|| with_reference(text, reference?));
    unit.ok_or_else(|| {
        if with_reference(text, PressureReference::Gauge).is_some() {
            return Problem::PressureReference {
                found: Excerpt::of(text),
            };
        }
        let meant = Unit::all().find(|unit| unit.token().eq_ignore_ascii_case(text));
        Problem::UnitUnknown {
            found: Excerpt::of(text),
            meant,
        }
    })
}

/// Returns the header field of a column; [`parse_heading`] returns exactly this name and unit.
pub(crate) fn format_heading(name: &str, unit: Unit) -> String {
    let heading = Heading {
        name: name.to_owned(),
        unit,
    };
    let suffixed = guarded(format!("{name}_{}", unit.token()));
    if parse_heading(&suffixed, None).is_ok_and(|read| read == heading) {
        return suffixed;
    }
    guarded(format!("{name} [{}]", unit.token()))
}

/// Protects a cell that begins like a formula, which a spreadsheet would execute (OWASP, "CSV injection").
fn guarded(cell: String) -> String {
    if cell.starts_with(['=', '+', '-', '@', '\'', '#']) {
        format!("'{cell}")
    } else {
        cell
    }
}

fn without_formula_guard(cell: &str) -> &str {
    match cell.strip_prefix('\'') {
        Some(rest) if rest.starts_with(['=', '+', '-', '@', '\'', '#']) => rest,
        _ => cell,
    }
}

fn named(name: &str, field: &str, unit: Unit) -> Result<Heading, Problem> {
    let name = name.trim();
    match check_name(name) {
        Ok(()) => Ok(Heading {
            name: name.to_owned(),
            unit,
        }),
        Err(problem) => Err(Problem::Name {
            found: Excerpt::of(field),
            problem,
        }),
    }
}

/// Splits `name [unit]` or `name (unit)`.
fn bracketed(field: &str) -> Option<(&str, &str)> {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, unit)) = field
            .strip_suffix(close)
            .and_then(|rest| rest.rsplit_once(open))
        {
            return Some((name, unit));
        }
    }
    None
}

/// Splits off the longest suffix that is a unit; at least one character remains for the name.
fn suffixed(field: &str, reference: Reference) -> Result<(&str, Unit), Problem> {
    for (at, _) in field.match_indices('_').filter(|&(at, _)| at > 0) {
        let suffix = &field[at + 1..];
        // `x_1` is a name and not a fraction.
        if let Some(unit) = Unit::parse(suffix)
            .filter(|_| !suffix.starts_with(|first: char| first.is_ascii_digit()))
        {
            return Ok((&field[..at], unit));
        }
    }
    if let Some(reference) = reference {
        let places = field.match_indices('_').filter(|&(at, _)| at > 0);
        let mut found = places.filter_map(|(at, _)| {
            Some((&field[..at], with_reference(&field[at + 1..], reference)?))
        });
        if let Some(found) = found.next() {
            return Ok(found);
        }
    }
    // No unit was found; the suffix may be similar to one, such as `kpa_abs` or `bar`.
    let suffixes = field
        .match_indices('_')
        .filter(|&(at, _)| at > 0)
        .map(|(at, _)| &field[at + 1..]);
    let nearly = suffixes.filter_map(|suffix| parse_unit(suffix, None).err());
    let missing = || Problem::UnitMissing {
        found: Excerpt::of(field),
    };
    Err(nearly
        .into_iter()
        .find(|problem| !matches!(problem, Problem::UnitUnknown { meant: None, .. }))
        .unwrap_or_else(missing))
}

fn unwrapped(text: &str) -> &str {
    let text = text.trim();
    [('[', ']'), ('(', ')')]
        .into_iter()
        .find_map(|(open, close)| text.strip_prefix(open)?.strip_suffix(close))
        .unwrap_or(text)
        .trim()
}

/// Returns the unit of a pressure that states no reference, such as `bar`, with this one.
pub(crate) fn with_reference(text: &str, reference: PressureReference) -> Option<Unit> {
    Unit::parse(&format!(
        "{text}_{}",
        match reference {
            PressureReference::Gauge => "gauge",
            PressureReference::Absolute => "abs",
        }
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_suffix_that_is_a_unit_is_the_unit() {
        let check = |field: &str, name: &str, unit| {
            assert_eq!(
                parse_heading(field, None).unwrap(),
                Heading {
                    name: name.to_owned(),
                    unit
                },
                "{field}"
            );
        };
        check("time_s", "time", Unit::Second);
        check("p_ch_bar_gauge", "p_ch", Unit::BarGauge);
        check("p_ch_kPa_abs", "p_ch", Unit::KilopascalAbsolute);
        check("i_fill_mA", "i_fill", Unit::Milliampere);
        check("u_bat_V", "u_bat", Unit::Volt);
        check("duty_fill_pct", "duty_fill", Unit::Percent);
        check("t_gas_degC", "t_gas", Unit::DegreeCelsius);
        check("x_fill_mm", "x_fill", Unit::Millimetre);
        check("v_plunger_m_per_s", "v_plunger", Unit::MetrePerSecond);
        check("p_ch [bar gauge]", "p_ch", Unit::BarGauge);
        check("Druck (barg)", "Druck", Unit::BarGauge);
        check("duty_fill (%)", "duty_fill", Unit::Percent);
    }

    #[test]
    fn headings_without_a_usable_unit_say_what_is_wrong() {
        let code = |field: &str| parse_heading(field, None).unwrap_err().code();
        for field in ["p_ch", "pressure", "x_1", "", "s", "_mA"] {
            assert_eq!(code(field), "E-CSV-UNIT-MISSING", "{field}");
        }
        for field in ["p_ch_bar", "p_ch [kPa]"] {
            assert_eq!(code(field), "E-CSV-PRESSURE-REFERENCE", "{field}");
        }
        for field in ["i_fill_MA", "p_ch_kpa_abs", "p_ch [furlong]"] {
            assert_eq!(code(field), "E-CSV-UNIT-UNKNOWN", "{field}");
        }
        let meant = parse_heading("p_ch_kpa_abs", None).unwrap_err().next_step();
        assert_eq!(meant, "write kPa_abs");
        assert_eq!(code(" [mA]"), "E-CSV-NAME");
    }

    #[test]
    fn a_given_reference_completes_a_pressure_and_overrides_none() {
        let unit = |field: &str, reference| parse_heading(field, Some(reference)).unwrap().unit;
        let (gauge, absolute) = (PressureReference::Gauge, PressureReference::Absolute);
        for field in ["p_ch_bar", "p_ch [bar]", "p_ch (bar)"] {
            assert_eq!(unit(field, gauge), Unit::BarGauge, "{field}");
            assert_eq!(unit(field, absolute), Unit::BarAbsolute, "{field}");
        }
        assert_eq!(unit("p_ch_hPa", absolute), Unit::MillibarAbsolute);
        assert_eq!(unit("p_ch_bar_abs", gauge), Unit::BarAbsolute);
        assert_eq!(unit("p_ch [barg]", absolute), Unit::BarGauge);
        assert_eq!(unit("dp_bar_diff", gauge), Unit::BarDifference);
        assert_eq!(unit("i_fill_mA", gauge), Unit::Milliampere);
        let name = parse_heading("p_ch_bar", Some(gauge)).unwrap().name;
        assert_eq!(name, "p_ch");
    }

    #[test]
    fn every_name_and_unit_survives_the_way_through_a_heading() {
        let names = [
            "p_ch", "a_m_per", "x_bar", "=1+2", "'-x", "#x", "a [b]", "a,b", "p_ch_mA", "time",
            "x(1)", "phase_A",
        ];
        for name in names {
            for unit in Unit::all() {
                let heading = format_heading(name, unit);
                assert_eq!(
                    parse_heading(&heading, None).unwrap(),
                    Heading {
                        name: name.to_owned(),
                        unit
                    },
                    "{heading}"
                );
                assert!(!heading.starts_with(['=', '+', '-', '@', '#']), "{heading}");
            }
        }
    }

    /// Found by the fuzzer: a first row `1,,` counted as units, because `1` is the symbol of a fraction.
    #[test]
    fn a_row_with_a_number_is_no_units_row() {
        let is_units = |fields: &[&str]| is_units_row(fields.iter().copied());
        assert!(
            is_units(&["s", "bar gauge", ""])
                && is_units(&["[s]", "1/min"])
                && is_units(&["s", "bar"])
        );
        assert!(
            !is_units(&["1", "", ""])
                && !is_units(&["s", "1.5"])
                && !is_units(&["", ""])
                && !is_units(&["x", "y"])
        );
    }
}
