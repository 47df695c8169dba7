//! Parameters of the plant with what is known about their values.

use model_lab::diagnosis::{Known, known};
use plant_sim::PlantParameters;
use plant_sim::parameters::{Knowledge, ParameterSpec};
use serde::Serialize;

use crate::history::History;
use crate::refusal::Refusal;

/// Parameter with its value, and how far an estimation may move it.
#[derive(Debug, Serialize)]
pub(super) struct ParameterView {
    name: String,
    about: &'static str,
    unit: &'static str,
    value: f64,
    known: KnownAs,
    /// Tolerance (%), if it is known within one.
    tolerance_pct: Option<f64>,
    /// Least and largest value of an estimation.
    within: [f64; 2],
}

/// Statement about a value, as the page offers it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
enum KnownAs {
    /// As the plant file as opened states.
    Opened,
    Fixed,
    Tolerance,
    Range,
    Unknown,
}

impl ParameterView {
    /// Returns the parameters of the current plant that an estimation moves unless they are fixed.
    pub(super) fn all_of(history: &History) -> Result<Vec<Self>, Refusal> {
        let opened = history.first().plant.parameters()?;
        let now = history.now().plant.parameters()?;
        let view = |spec| Self::of(spec, &now, &opened);
        Ok(now.specs().filter_map(view).collect())
    }

    fn of(
        spec: &'static ParameterSpec,
        now: &PlantParameters,
        opened: &PlantParameters,
    ) -> Option<Self> {
        let name = spec.name();
        let value = now.get(&name).filter(|value| value.is_finite())?;
        let within = match known(now, &name)? {
            Known::Stated { within, .. } => within,
            Known::Bare { estimated, .. } => estimated,
            Known::Size => spec.range,
            _ => return None,
        };
        let stated = now.knowledge.get(&name);
        let known = match stated {
            stated if stated == opened.knowledge.get(&name) => KnownAs::Opened,
            Some(Knowledge::Exact) => KnownAs::Fixed,
            Some(Knowledge::TolerancePct(_)) => KnownAs::Tolerance,
            Some(Knowledge::Unknown) => KnownAs::Unknown,
            _ => KnownAs::Range,
        };
        let tolerance_pct = match stated {
            Some(Knowledge::TolerancePct(percent)) => Some(*percent),
            _ => None,
        };
        Some(Self {
            name,
            about: spec.about,
            unit: spec.unit,
            value,
            known,
            tolerance_pct,
            within: [within.0, within.1],
        })
    }
}
