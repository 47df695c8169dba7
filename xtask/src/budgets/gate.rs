//! Budget, its figure, and whether the figure is within it.

use std::fmt;

use serde::Serialize;

use super::table::Table;
use super::unbounded::Unbounded;
use super::unproved::Unproved;
use crate::failure::Failure;

/// Budget and its figure.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Gate {
    what: String,
    found: Figure,
    allowed: Figure,
    kept: bool,
}

/// Number, or the text in its place.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
enum Figure {
    Number(f64),
    Words(String),
}

impl fmt::Display for Figure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(number) if number.fract() == 0.0 => write!(f, "{number}"),
            Self::Number(number) => write!(f, "{number:.2}"),
            Self::Words(words) => f.write_str(words),
        }
    }
}

impl Gate {
    /// Creates the gate of a figure that may reach its budget but not exceed it.
    pub(crate) fn at_most<T: PartialOrd + Into<f64>>(what: &str, found: T, allowed: T) -> Self {
        Self {
            what: what.to_owned(),
            kept: found <= allowed,
            found: Figure::Number(found.into()),
            allowed: Figure::Number(allowed.into()),
        }
    }

    /// Creates the gate of a bound that may not exist.
    pub(crate) fn bounded(what: &str, found: &Result<u32, Unbounded>, allowed: u32) -> Self {
        match found {
            Ok(found) => Self::at_most(what, *found, allowed),
            Err(reason) => Self {
                what: what.to_owned(),
                found: Figure::Words(reason.to_string()),
                allowed: Figure::Number(allowed.into()),
                kept: false,
            },
        }
    }

    /// Creates the gate of a list that must be empty; otherwise it shows the first entry.
    pub(crate) fn none<'a>(what: &str, found: impl IntoIterator<Item = &'a String>) -> Self {
        let first = found.into_iter().next();
        Self {
            what: what.to_owned(),
            found: Figure::Words(first.map_or("none", String::as_str).to_owned()),
            allowed: Figure::Words("none".to_owned()),
            kept: first.is_none(),
        }
    }

    pub(crate) fn missing(what: &str) -> Self {
        Self {
            what: what.to_owned(),
            found: Figure::Words("not measured".to_owned()),
            allowed: Figure::Words("measured".to_owned()),
            kept: false,
        }
    }
}

/// Fails if a budget is exceeded; the failure names budget, figure and allowed value.
pub(crate) fn judge(gates: &[Gate]) -> Result<(), Failure> {
    let exceeded = exceeded(gates);
    if exceeded.is_empty() {
        Ok(())
    } else {
        Err(Unproved::Exceeded(exceeded).into())
    }
}

/// Returns the gates as a table.
pub(crate) fn table(gates: &[Gate]) -> Table {
    let mut table = Table::new(&["budget", "found", "at most", ""]);
    for gate in gates {
        let verdict = if gate.kept { "kept" } else { "EXCEEDED" };
        table.row(vec![
            gate.what.clone(),
            gate.found.to_string(),
            gate.allowed.to_string(),
            verdict.to_owned(),
        ]);
    }
    table
}

/// Returns the exceeded budgets as sentences.
pub(crate) fn exceeded(gates: &[Gate]) -> Vec<String> {
    let exceeded = gates.iter().filter(|gate| !gate.kept);
    let sentence = |gate: &Gate| {
        let Gate {
            what,
            found,
            allowed,
            ..
        } = gate;
        match allowed {
            Figure::Number(_) => format!("{what}: {found}, at most {allowed}"),
            Figure::Words(_) => format!("{what}: {found}, has to be: {allowed}"),
        }
    };
    exceeded.map(sentence).collect()
}
