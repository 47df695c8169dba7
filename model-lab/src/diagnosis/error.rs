//! Errors of a diagnosis.

use plant_sim::PlantParameters;
use plant_sim::effects::Effect;
use plant_sim::parameters::Part;

use super::knowledge::KnowledgeError;
use super::result::words::all_of;
use crate::error::CompareError;
use crate::measured::FITTED_SIGNALS;

/// Reason why a diagnosis cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DiagnoseError {
    /// A log cannot be compared with the model.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// No log was given to fit.
    #[error("no log to fit: give at least one, `--log A.csv`")]
    NoLog,
    /// The same log was given twice.
    #[error(
        "{log} has the same bytes as {other}, which is given as well: {}",
        if *is_check {
            "a fit is not validated by what was fitted; give another log with --check, or none"
        } else {
            "fitted twice, it would count twice; give it once"
        }
    )]
    LogTwice {
        /// Source of the log.
        log: String,
        /// Source of the identical log.
        other: String,
        /// Whether it was given for validation.
        is_check: bool,
    },
    /// No signal has a noise that can be estimated.
    #[error(
        "{log}: neither the chamber pressure nor a coil current changes, so that nothing can be fitted; \
         log p_ch, i_fill or i_vent with commands that move the valves"
    )]
    NothingToFit {
        /// Source of the log.
        log: String,
    },
    /// The pressure is impossible for the plant.
    #[error("{log}: {statement}")]
    PressureOutOfReach {
        /// Source of the log.
        log: String,
        /// Pressure, supply pressure and remedy, as text.
        statement: String,
    },
    /// The plain plant cannot be simulated on the log.
    #[error(
        "the plant cannot be simulated on {log} in a bounded number of steps; check the plant file with `retarder simulate`"
    )]
    NotSimulated {
        /// Source of the first log.
        log: String,
    },
    /// No effect has this id.
    #[error(
        "there is no effect `{id}`{}; `retarder parameters` lists the library",
        hint(meant)
    )]
    NoSuchEffect {
        /// Requested id.
        id: String,
        /// Ids that may have been meant.
        meant: Vec<&'static str>,
    },
    /// The effect has no form of this name.
    #[error("the effect `{id}` has no form `{variant}`; it has {forms}")]
    NoSuchVariant {
        /// Id of the effect.
        id: String,
        /// Requested form.
        variant: String,
        /// Existing forms.
        forms: String,
    },
    /// No log has the signal without which the effect does nothing.
    #[error(
        "`{id}` follows `{signal}`, which no log has: log it, or map its column to `{signal}`; `retarder inspect LOG` lists the columns"
    )]
    NotDriven {
        /// Id of the effect.
        id: &'static str,
        /// Missing signal.
        signal: &'static str,
    },
    /// The effect cannot be fitted to the logs.
    #[error(
        "`{id}` gains nothing on these logs at any size, so that there is nothing to tell it from; use `--for {id}`"
    )]
    NotFitted {
        /// Id of the effect.
        id: String,
    },
    /// The plant lacks a part that an experiment commands or measures.
    #[error(
        "the plant has no {part}, and an experiment is planned for both valves and the chamber; \
         describe the part in the plant file, or do by hand what the diagnosis says would show the effect"
    )]
    PartLeftOut {
        /// Missing part.
        part: Part,
    },
    /// No excitation can be simulated for the rivals in a bounded number of steps.
    #[error(
        "none of the {test_signals} test signals can be simulated in a bounded number of steps; \
         check the plant file with `retarder simulate`, or plan with other limits"
    )]
    NoTestSignalSimulated {
        /// Number of excitations that were tried.
        test_signals: usize,
    },
    /// The logs lack the signals in which the rivals show.
    #[error(
        "the logs have {} alone, which show nothing of {} whatever is commanded, so that no test signal is worth planning; \
         log {} of this rig as well and give that log with --log",
        all_of(logged),
        all_of(effects),
        unlogged(logged).join(" or ")
    )]
    NoTestSignalShows {
        /// Ids of the rivals.
        effects: Vec<String>,
        /// Signals that the logs have.
        logged: Vec<String>,
    },
    /// No excitation satisfies the limits.
    #[error(
        "no test signal of at most {duration_s} s keeps below {max_bar} bar with duty cycles up to {max_duty_pct} %; allow more"
    )]
    NoTestSignal {
        /// Longest time (s).
        duration_s: f64,
        /// Highest chamber pressure (bar gauge).
        max_bar: f64,
        /// Highest duty cycle (%).
        max_duty_pct: f64,
    },
    /// No parameter has this name.
    #[error(transparent)]
    Knowledge(#[from] KnowledgeError),
    /// The parameter is not free in any fit.
    #[error(
        "`{name}` = {value} {unit} counts as exact, so that no experiment determines it; say in the plant file how well it is \
         known, or free it with --free {name}"
    )]
    Exact {
        /// Name of the parameter.
        name: String,
        /// Value of the parameter.
        value: f64,
        /// Unit of the parameter.
        unit: &'static str,
    },
    /// The diagnosis was stopped.
    #[error("stopped; nothing was written")]
    Interrupted,
}

/// Returns the signals of a diagnosis that no log has.
fn unlogged(logged: &[String]) -> Vec<&'static str> {
    let is_absent = |signal: &&str| logged.iter().all(|one| one != signal);
    FITTED_SIGNALS.into_iter().filter(is_absent).collect()
}

/// Returns the effect `id` that `plant` may have.
///
/// # Errors
/// Returns an error with the ids that may have been meant if there is none.
pub(super) fn candidate(
    plant: &PlantParameters,
    id: &str,
) -> Result<&'static dyn Effect, DiagnoseError> {
    plant
        .candidate(id)
        .ok_or_else(|| DiagnoseError::NoSuchEffect {
            id: id.to_owned(),
            meant: plant.effects_meant(id),
        })
}

/// Returns a suggestion of the id that may have been meant.
fn hint(meant: &[&str]) -> String {
    match meant.join("` or `") {
        meant if meant.is_empty() => meant,
        meant => format!(", did you mean `{meant}`?"),
    }
}
