//! Comparison of model and measurement.

use model_lab::result::SignalComparison;
use model_lab::{CompareOptions, Comparison, compare};
use recording::Recording;

use super::Answer;
use crate::failure::Failure;
use crate::input::NamedPlant;
use crate::progress::Progress;

/// Comparison with its inputs.
pub(crate) struct Compared {
    pub(crate) plant: NamedPlant,
    pub(crate) log: Recording,
    pub(crate) comparison: Comparison,
    /// Index of the signal that is shown in detail.
    focus: usize,
    /// Whether the signal was chosen on the command line.
    is_chosen: bool,
}

/// Compares model and measurement. `focus` names the signal to show in detail; without it, that is the signal with the
/// largest error.
pub(crate) fn run(
    plant: NamedPlant,
    log: Recording,
    options: &CompareOptions,
    focus: Option<&str>,
) -> Result<Compared, Failure> {
    let _progress = Progress::of_unknown_length("comparing");
    let comparison = compare(&plant.parameters, &log, options)?;
    let is_chosen = focus.is_some();
    let focus = match focus {
        None => farthest_off(&comparison.signals),
        Some(name) => comparison
            .signals
            .iter()
            .position(|signal| signal.name == name)
            .ok_or_else(|| Failure::NoSuchSignal {
                name: name.to_owned(),
                compared: names(&comparison.signals),
            })?,
    };
    Ok(Compared {
        plant,
        log,
        comparison,
        focus,
        is_chosen,
    })
}

impl Compared {
    /// Returns the signal that is shown in detail.
    pub(crate) fn focus(&self) -> &SignalComparison {
        &self.comparison.signals[self.focus]
    }

    /// Returns whether there is an error to locate, or a signal was chosen.
    pub(crate) fn shows_regimes(&self) -> bool {
        self.is_chosen || self.focus().holds != Some(true)
    }

    pub(crate) fn answer(&self) -> Answer {
        let verdict = &self.comparison.verdict;
        match (verdict.holds, verdict.failing.is_empty()) {
            (true, _) => Answer::Holds,
            (false, false) => Answer::DoesNotHold,
            (false, true) => Answer::Open,
        }
    }
}

fn farthest_off(signals: &[SignalComparison]) -> usize {
    let over_limit = |signal: &SignalComparison| match signal.limit {
        Some(limit) if limit > 0.0 => signal.free_run.rms / limit,
        _ => 0.0,
    };
    // The first of equals, since the chamber pressure comes first.
    (0..signals.len()).fold(0, |farthest, index| {
        if over_limit(&signals[index]) > over_limit(&signals[farthest]) {
            index
        } else {
            farthest
        }
    })
}

fn names(signals: &[SignalComparison]) -> String {
    let names: Vec<&str> = signals.iter().map(|signal| signal.name.as_str()).collect();
    names.join(", ")
}
