//! Reasons why a definition of a user's own effect is refused.

use formula::{Dimension, FormulaError, Mismatch, UnitError};

use crate::toml_file::brief;

use super::points::{POINTS, Point};
use super::variables::VARIABLES;

/// Problem of a definition: the key, and the reason.
#[derive(Debug, Clone)]
pub struct Fault {
    /// Key below the table of the definition, such as `parameters.k.range`.
    pub key: String,
    /// Reason.
    pub reason: Reason,
}

/// Reason why a value of a definition is refused.
#[derive(Debug, Clone, thiserror::Error)]
#[allow(missing_docs, reason = "the messages name the fields")]
pub enum Reason {
    #[error(
        "a name has letters a to z, digits and `_`, begins with a letter, and has at most {most} characters"
    )]
    Name { most: usize },
    #[error("is missing: {about}; add `{example}`")]
    Missing {
        about: &'static str,
        example: &'static str,
    },
    #[error("is no key of a definition{}; the keys are {}", meant(*.nearest), keys.join(", "))]
    UnknownKey {
        nearest: Option<&'static str>,
        keys: &'static [&'static str],
    },
    #[error("has {length} characters, of at most {most}; shorten it")]
    TooLong { length: usize, most: usize },
    #[error("there are {count} of them, of at most {most}; remove some")]
    TooMany { count: usize, most: usize },
    #[error("= \"{found}\" is no point of the plant{}; the points are {}", meant(*.nearest), points())]
    Point {
        found: String,
        nearest: Option<&'static str>,
    },
    #[error(transparent)]
    Syntax(#[from] FormulaError),
    #[error(
        "character {position} of the formula: `{name}` is neither a parameter nor a variable{}; the parameters are {parameters}; the variables are {}",
        meant(.nearest.as_deref()),
        variables()
    )]
    UnknownName {
        position: usize,
        name: String,
        nearest: Option<String>,
        parameters: String,
    },
    #[error(
        "character {position} of the formula: `{point}` may not depend on `{name}`: it is the {about}"
    )]
    NotAdmitted {
        position: usize,
        name: String,
        point: &'static str,
        about: &'static str,
    },
    #[error("is not in the expression; use it there, or remove it")]
    Unused,
    #[error("is the name of a variable; rename the parameter")]
    Taken,
    #[error("`{unit}`: {error}")]
    Unit { unit: String, error: UnitError },
    #[error("character {position} of the formula: {mismatch}; correct the formula or the unit of a parameter", position = .0.position, mismatch = .0)]
    Mismatch(Mismatch),
    #[error(
        "gives {found}, and `{point}` needs {needed} ({about}); correct the formula or the unit of a parameter"
    )]
    Dimension {
        found: Dimension,
        needed: Dimension,
        point: &'static str,
        about: &'static str,
    },
    #[error("= [{}, {}] is no range; write finite numbers with the smaller one first",
        brief(*.least),
        brief(*.most)
    )]
    Range { least: f64, most: f64 },
    #[error("= {} is outside of its range, {} to {}; correct one of them", brief(*.value), brief(*.least), brief(*.most))]
    Typical { value: f64, least: f64, most: f64 },
    #[error(
        "is {value} at {place}; a root or a power of a negative number has no value, so write `max(..., 0)` as its base, and a divisor must not reach 0"
    )]
    NotFinite { value: f64, place: String },
    #[error(
        "character {position} of the formula: the divisor is positive for some values and negative for others, so that it is 0 between them; limit it with `max(..., ...)`, or narrow the range of a parameter"
    )]
    Divisor { position: usize },
    #[error(
        "shrinks so fast with the pressure at {place} that pressure times volume falls, which no chamber does; narrow the range of a parameter"
    )]
    Shrinks { place: String },
    #[error(
        "is {value} at {place}, and `{point}` ({about}) is at least {least}; limit it with `max(..., {least})`, or narrow the range of a parameter",
        value = brief(*.value)
    )]
    OutOfBounds {
        value: f64,
        place: String,
        point: &'static str,
        about: &'static str,
        least: f64,
    },
    #[error(
        "no parameter switches it off: with one of them at 0 the value must be {neutral}; multiply the deviation by a strength, as in `{example}`"
    )]
    NoStrength { neutral: f64, example: &'static str },
    #[error(
        "this process has read {most} different definitions and keeps each of them; start it again"
    )]
    Exhausted { most: usize },
}

fn meant(nearest: Option<&str>) -> String {
    nearest.map_or_else(String::new, |nearest| {
        format!(", did you mean `{nearest}`?")
    })
}

fn points() -> String {
    let named: Vec<String> = POINTS.iter().map(with_unit).collect();
    named.join(", ")
}

fn with_unit(point: &Point) -> String {
    format!("{} [{}]", point.name, point.unit)
}

fn variables() -> String {
    let named: Vec<&str> = VARIABLES.iter().map(|variable| variable.name).collect();
    named.join(", ")
}
