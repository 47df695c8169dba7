//! Additions of a mapping: signals that stayed constant, and rows before and after a test that are left out.

use std::collections::BTreeMap;

use serde::Deserialize;
use toml::Spanned;

use super::error::Excerpt;
use super::header::{Reference, parse_unit};
use super::mapping_error::{AtSpan, MappingProblem};
use crate::bounds::Allowed;
use crate::name::{check_name, is_time_column};
use crate::signal::quantity_of;
use crate::{Bounds, Unit};

/// Time window of the kept rows (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Window {
    pub(crate) from_s: f64,
    pub(crate) until_s: f64,
}

impl Default for Window {
    fn default() -> Self {
        Self {
            from_s: f64::NEG_INFINITY,
            until_s: f64::INFINITY,
        }
    }
}

impl Window {
    pub(crate) fn contains(self, time_s: f64) -> bool {
        (self.from_s..=self.until_s).contains(&time_s)
    }
}

/// Constant signal that is missing in the log.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Constant {
    pub(crate) value: f64,
    pub(crate) unit: Unit,
    /// Whether the constant applies only to logs without the signal: one mapping can serve several logs.
    pub(crate) where_absent: bool,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct WindowToml {
    from_s: Option<Spanned<f64>>,
    until_s: Option<Spanned<f64>>,
    pub(super) instants_of: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ConstantToml {
    value: Spanned<f64>,
    unit: Spanned<String>,
    #[serde(default)]
    where_absent: bool,
}

pub(super) fn resolve_window(raw: WindowToml) -> Result<Window, AtSpan> {
    let all = Window::default();
    let number = |value: &Option<Spanned<f64>>, default| match value {
        None => Ok(default),
        Some(value) if value.get_ref().is_finite() => Ok(*value.get_ref()),
        Some(value) => Err((value.span(), MappingProblem::Factor(*value.get_ref()))),
    };
    let window = Window {
        from_s: number(&raw.from_s, all.from_s)?,
        until_s: number(&raw.until_s, all.until_s)?,
    };
    match raw.until_s.filter(|_| window.until_s <= window.from_s) {
        Some(until) => Err((until.span(), MappingProblem::WindowEmpty)),
        None => Ok(window),
    }
}

pub(super) fn resolve_constants(
    raw: BTreeMap<Spanned<String>, ConstantToml>,
    reference: Reference,
) -> Result<BTreeMap<String, Constant>, AtSpan> {
    let mut constants = BTreeMap::new();
    for (name, constant) in raw {
        let (span, name) = (name.span(), name.into_inner());
        check_name(&name).map_err(|problem| (span.clone(), MappingProblem::Name(problem)))?;
        let unit = parse_unit(constant.unit.get_ref(), reference).map_err(|problem| {
            let problem = format!("{problem}; {}", problem.next_step());
            (constant.unit.span(), MappingProblem::Unit(problem))
        })?;
        if is_time_column(&name, unit) {
            return Err((span, MappingProblem::TimeAsSignal));
        }
        let value = *constant.value.get_ref();
        let bounds = Bounds::of(quantity_of(&name, unit)).in_unit(unit);
        if !bounds.contains(&value) {
            let allowed = Allowed(&bounds, unit).to_string();
            let found = Excerpt::of(&format!("{value} {}", unit.symbol()));
            return Err((
                constant.value.span(),
                MappingProblem::Constant { found, allowed },
            ));
        }
        let where_absent = constant.where_absent;
        let constant = Constant {
            value,
            unit,
            where_absent,
        };
        constants.insert(name, constant);
    }
    Ok(constants)
}
