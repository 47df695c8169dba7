//! All findings as a JSON document.

use std::fs;
use std::path::Path;

use serde::Serialize;

use super::figures::Figures;
use super::gate::{Gate, judge};
use super::unbounded::Unbounded;
use crate::failure::Failure;

/// Figures and budgets, in the order in which they were found.
#[derive(Debug, Serialize)]
pub(crate) struct Findings {
    /// Name and version of this document's format.
    schema: &'static str,
    candidates: Vec<Row>,
    budgets: Vec<Gate>,
}

/// Figures of one candidate; a figure without a bound is absent, and its reason is present.
#[derive(Debug, Serialize)]
struct Row {
    name: &'static str,
    title: &'static str,
    duty: String,
    calls: u32,
    instructions_mean: f64,
    instructions_min: u32,
    instructions_max: u32,
    instructions_proved: Option<u32>,
    unbounded: Option<String>,
    code_bytes: u32,
    state_bytes: u32,
    config_bytes: u32,
    stack_proved_bytes: Option<u32>,
    stack_touched_bytes: u32,
    panics: bool,
    deviation_pct: Option<f64>,
}

impl Row {
    fn of(figures: &Figures) -> Self {
        let Figures {
            candidate,
            counted,
            proved,
            stack,
            reach,
        } = figures;
        Self {
            name: candidate.name,
            title: candidate.title,
            duty: candidate.duty.to_string(),
            calls: counted.calls,
            instructions_mean: counted.mean(),
            instructions_min: counted.min,
            instructions_max: counted.max,
            instructions_proved: proved.as_ref().ok().copied(),
            unbounded: proved.as_ref().err().map(Unbounded::to_string),
            code_bytes: reach.bytes,
            state_bytes: counted.state_bytes,
            config_bytes: counted.config_bytes,
            stack_proved_bytes: stack.as_ref().ok().copied(),
            stack_touched_bytes: counted.stack,
            panics: !reach.panics.is_empty(),
            deviation_pct: figures.deviation_pct(),
        }
    }
}

impl Default for Findings {
    fn default() -> Self {
        Self {
            schema: "retarder.budgets/1",
            candidates: Vec::new(),
            budgets: Vec::new(),
        }
    }
}

impl Findings {
    /// Adds the counted and proved figures.
    pub(crate) fn measured(&mut self, figures: &[Figures]) {
        self.candidates.extend(figures.iter().map(Row::of));
    }

    /// Adds budgets, and fails if one is exceeded.
    pub(crate) fn judge(&mut self, gates: &[Gate]) -> Result<(), Failure> {
        self.budgets.extend_from_slice(gates);
        judge(gates)
    }

    /// Writes the document; missing figures are left out.
    pub(crate) fn write(&self, path: &Path) -> Result<(), Failure> {
        let failed = |source| Failure::File {
            path: path.to_owned(),
            source,
        };
        let text = serde_json::to_string_pretty(self).map_err(|source| failed(source.into()))?;
        fs::write(path, text + "\n").map_err(failed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_that_is_not_kept_fails_and_is_in_the_document_with_figure_and_goal() {
        let mut findings = Findings::default();
        let gates = [
            Gate::at_most("stack [bytes]", 36, 24),
            Gate::at_most("mean", 62.5, 65.0),
        ];
        let failure = findings.judge(&gates).unwrap_err().to_string();
        assert!(
            failure.contains("stack [bytes]: 36, at most 24"),
            "{failure}"
        );
        let document = serde_json::to_value(&findings).unwrap();
        let expected = serde_json::json!({
            "schema": "retarder.budgets/1",
            "candidates": [],
            "budgets": [
                { "what": "stack [bytes]", "found": 36.0, "allowed": 24.0, "kept": false },
                { "what": "mean", "found": 62.5, "allowed": 65.0, "kept": true },
            ],
        });
        assert_eq!(document, expected);
    }
}
