//! Units of names: products and quotients of SI units.

use core::fmt;
use core::ops::{Div, Mul};

/// Number of base units in use.
const BASES: usize = 5;
/// Difference below which two exponents are equal.
const ROUNDING: f32 = 1e-4;
/// Symbols of the base units.
const BASE_SYMBOLS: [&str; BASES] = ["kg", "m", "s", "A", "K"];

/// Dimension: the exponents of kg, m, s, A and K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dimension([f32; BASES]);

/// SI units with their exponents of kg, m, s, A and K. The first of equal ones names the dimension in messages.
const UNITS: [(&str, [f32; BASES]); 20] = [
    ("1", [0.0; BASES]),
    ("-", [0.0; BASES]),
    ("rad", [0.0; BASES]),
    ("kg", [1.0, 0.0, 0.0, 0.0, 0.0]),
    ("m", [0.0, 1.0, 0.0, 0.0, 0.0]),
    ("s", [0.0, 0.0, 1.0, 0.0, 0.0]),
    ("A", [0.0, 0.0, 0.0, 1.0, 0.0]),
    ("K", [0.0, 0.0, 0.0, 0.0, 1.0]),
    ("Pa", [1.0, -1.0, -2.0, 0.0, 0.0]),
    ("N", [1.0, 1.0, -2.0, 0.0, 0.0]),
    ("J", [1.0, 2.0, -2.0, 0.0, 0.0]),
    ("W", [1.0, 2.0, -3.0, 0.0, 0.0]),
    ("V", [1.0, 2.0, -3.0, -1.0, 0.0]),
    ("ohm", [1.0, 2.0, -3.0, -2.0, 0.0]),
    ("Ohm", [1.0, 2.0, -3.0, -2.0, 0.0]),
    ("Ω", [1.0, 2.0, -3.0, -2.0, 0.0]),
    ("H", [1.0, 2.0, -2.0, -2.0, 0.0]),
    ("Wb", [1.0, 2.0, -2.0, -1.0, 0.0]),
    ("C", [0.0, 0.0, 1.0, 1.0, 0.0]),
    ("Hz", [0.0, 0.0, -1.0, 0.0, 0.0]),
];

/// Units that are no SI units, with the SI unit and the factor to it.
const OTHERS: [(&str, &str, f64); 15] = [
    ("bar", "Pa", 1e5),
    ("mbar", "Pa", 100.0),
    ("kPa", "Pa", 1e3),
    ("MPa", "Pa", 1e6),
    ("psi", "Pa", 6_894.757),
    ("mm", "m", 1e-3),
    ("cm", "m", 1e-2),
    ("g", "kg", 1e-3),
    ("ms", "s", 1e-3),
    ("min", "s", 60.0),
    ("h", "s", 3600.0),
    ("mA", "A", 1e-3),
    ("mV", "V", 1e-3),
    ("%", "1", 0.01),
    ("pct", "1", 0.01),
];

/// Reason why a text is no unit of a formula.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// The unit is known, but a formula computes in SI units.
    #[error(
        "`{found}` is no SI unit, and a formula computes in SI units: write `{si}` instead, and multiply the values by {factor:e}"
    )]
    NotSi {
        /// Unit found.
        found: String,
        /// SI unit of the same dimension.
        si: &'static str,
        /// Factor to the SI unit.
        factor: f64,
    },
    /// The symbol is unknown.
    #[error(
        "`{found}` is no unit; the units are {} with * / ^, such as kg/s/Pa^0.5",
        known()
    )]
    Unknown {
        /// Symbol found.
        found: String,
    },
    /// The exponent is neither a number nor a name.
    #[error("`{found}` is no exponent; write a number, such as Pa^0.5, or the name of a parameter")]
    Exponent {
        /// Text found.
        found: String,
    },
}

fn known() -> String {
    let symbols: Vec<&str> = UNITS.iter().map(|(symbol, _)| *symbol).collect();
    symbols.join(", ")
}

/// Returns the dimension of a unit such as `kg/s/Pa^0.5`; `None` if an exponent is a name, as in `kg/s/Pa^n`.
///
/// # Errors
/// Returns an error if a symbol is unknown or no SI unit, or an exponent is neither a number nor a name.
pub fn parse_unit(text: &str) -> Result<Option<Dimension>, UnitError> {
    let mut dimension = Some(Dimension::NUMBER);
    let mut rest = text.trim();
    let mut sign = 1.0;
    if rest.is_empty() {
        return Ok(dimension);
    }
    loop {
        let end = rest.find(['*', '/']).unwrap_or(rest.len());
        let factor = rest[..end].trim();
        let (symbol, exponent) = factor.split_once('^').unwrap_or((factor, "1"));
        let of_symbol = symbol_dimension(symbol.trim())?;
        dimension = match exponent_value(exponent.trim())? {
            Some(exponent) => dimension.map(|known| known * of_symbol.power(sign * exponent)),
            None => None,
        };
        let Some(separator) = rest[end..].chars().next() else {
            return Ok(dimension);
        };
        sign = if separator == '/' { -1.0 } else { 1.0 };
        rest = &rest[end + 1..];
    }
}

fn symbol_dimension(symbol: &str) -> Result<Dimension, UnitError> {
    if let Some((_, exponents)) = UNITS.iter().find(|(known, _)| *known == symbol) {
        return Ok(Dimension(*exponents));
    }
    let found = symbol.to_owned();
    match OTHERS.iter().find(|(known, ..)| *known == symbol) {
        Some(&(_, si, factor)) => Err(UnitError::NotSi { found, si, factor }),
        None => Err(UnitError::Unknown { found }),
    }
}

/// Returns an exponent; `None` if it is a name.
fn exponent_value(text: &str) -> Result<Option<f64>, UnitError> {
    let is_name = |text: &str| {
        let mut characters = text.chars();
        let first = characters.next();
        first.is_some_and(|first| first.is_alphabetic() || first == '_')
            && characters.all(|one| one.is_alphanumeric() || one == '_')
    };
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value.abs() <= 100.0 => Ok(Some(value)),
        Err(_) if is_name(text) => Ok(None),
        _ => Err(UnitError::Exponent {
            found: text.to_owned(),
        }),
    }
}

impl Dimension {
    /// Dimension of a pure number.
    pub const NUMBER: Self = Self([0.0; BASES]);

    /// Returns the dimension of a power.
    #[must_use]
    pub fn power(self, exponent: f64) -> Self {
        Self(self.0.map(|one| (f64::from(one) * exponent) as f32))
    }

    /// Returns whether two dimensions are equal, apart from rounding of their exponents.
    pub fn is(self, other: Self) -> bool {
        let pairs = self.0.iter().zip(other.0);
        pairs
            .into_iter()
            .all(|(one, other)| (one - other).abs() < ROUNDING)
    }
}

impl Mul for Dimension {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self(core::array::from_fn(|n| self.0[n] + other.0[n]))
    }
}

impl Div for Dimension {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        self * other.power(-1.0)
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((symbol, _)) = UNITS.iter().find(|(_, one)| self.is(Self(*one))) {
            let symbol = if *symbol == "1" {
                "a pure number"
            } else {
                symbol
            };
            return f.write_str(symbol);
        }
        let factors = BASE_SYMBOLS.iter().zip(self.0);
        let of_sign = |sign: f32| {
            let factors = factors
                .clone()
                .map(move |(symbol, one)| (symbol, sign * one));
            factors.filter(|(_, exponent)| *exponent > ROUNDING)
        };
        if of_sign(1.0).next().is_none() {
            f.write_str("1")?;
        }
        for (n, (symbol, exponent)) in of_sign(1.0).enumerate() {
            write!(
                f,
                "{}{symbol}{}",
                if n > 0 { "*" } else { "" },
                power(exponent)
            )?;
        }
        for (symbol, exponent) in of_sign(-1.0) {
            write!(f, "/{symbol}{}", power(exponent))?;
        }
        Ok(())
    }
}

/// Returns a positive exponent as text; empty for 1.
fn power(exponent: f32) -> String {
    // A third has more digits than a reader needs.
    let rounded = (exponent * 1e3).round() / 1e3;
    if rounded == 1.0 {
        String::new()
    } else {
        format!("^{rounded}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(text: &str) -> Dimension {
        parse_unit(text).unwrap().unwrap()
    }

    #[test]
    fn a_unit_is_a_product_of_base_units() {
        assert_eq!(unit("Pa*m^2"), unit("N"));
        assert_eq!(unit("V / A"), unit("ohm"));
        assert_eq!(unit("W*s"), unit("J"));
        assert_eq!(unit("1/s"), unit("Hz"));
        assert!(unit("Pa^0.5").power(2.0).is(unit("Pa")));
        assert_eq!(unit(""), Dimension::NUMBER);
        assert_eq!(parse_unit("kg/s/Pa^n"), Ok(None));
    }

    #[test]
    fn a_dimension_is_shown_as_its_unit_or_its_base_units() {
        assert_eq!(unit("kg/m/s^2").to_string(), "Pa");
        assert_eq!(unit("kg/s").to_string(), "kg/s");
        assert_eq!(unit("m^2/s/K^0.5").to_string(), "m^2/s/K^0.5");
        assert_eq!(unit("1/K").to_string(), "1/K");
        assert_eq!(unit("1").to_string(), "a pure number");
    }

    #[test]
    fn an_unknown_unit_is_refused_with_the_known_ones_or_the_factor() {
        for (text, part) in [
            ("bar", "write `Pa` instead, and multiply the values by 1e5"),
            ("kg/furlong", "`furlong` is no unit"),
            ("kg//s", "`` is no unit"),
            ("Pa^", "`` is no exponent"),
            ("Pa^1e400", "`1e400` is no exponent"),
            ("Pa^NaN", "`NaN` is no exponent"),
        ] {
            let error = parse_unit(text).unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
