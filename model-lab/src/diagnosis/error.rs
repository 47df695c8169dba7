//! Why a diagnosis cannot be made.

use plant_sim::parameters::{Part, effects_meant};

use super::knowledge::KnowledgeError;
use crate::error::CompareError;
use crate::measured::WEIGHED;

/// Why a diagnosis cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DiagnoseError {
    /// A log cannot be held against the model.
    #[error(transparent)]
    Compare(#[from] CompareError),
    /// Nothing was given to fit.
    #[error("no log to fit: give at least one, `--log A.csv`")]
    NoLog,
    /// The same log again.
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
        /// Source of the one that is the same.
        other: String,
        /// Whether it was to judge.
        is_check: bool,
    },
    /// No signal whose noise can be estimated.
    #[error(
        "{log}: neither the chamber pressure nor a coil current changes, so that nothing can be weighed; \
         log p_ch, i_fill or i_vent with commands that move the valves"
    )]
    NothingToWeigh {
        /// Source of the log.
        log: String,
    },
    /// The pressure is one that the plant cannot have.
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
    /// No such effect.
    #[error(
        "there is no effect `{id}`{}; `retarder parameters` lists the library",
        hint(id)
    )]
    NoSuchEffect {
        /// What was asked for.
        id: String,
    },
    /// The effect has no such form.
    #[error("the effect `{id}` has no form `{variant}`; it has {forms}")]
    NoSuchVariant {
        /// The effect.
        id: String,
        /// What was asked for.
        variant: String,
        /// What there is.
        forms: String,
    },
    /// The effect cannot be fitted to the logs.
    #[error(
        "`{id}` gains nothing on these logs at any size, so that there is nothing to tell it from; use `--for {id}`"
    )]
    NotFitted {
        /// The effect.
        id: String,
    },
    /// The plant leaves out what an experiment commands or watches.
    #[error(
        "the plant has no {part}, and an experiment is planned for both valves and the chamber; \
         describe the part in the plant file, or do by hand what the diagnosis says would show the effect"
    )]
    PartLeftOut {
        /// What it lacks.
        part: Part,
    },
    /// No manoeuvre can be simulated and seen by the rivals.
    #[error(
        "none of the {manoeuvres} manoeuvres can be simulated in a bounded number of steps; \
         check the plant file with `retarder simulate`, or plan with other limits"
    )]
    NoManoeuvreSimulated {
        /// How many were tried.
        manoeuvres: usize,
    },
    /// The logs lack the signals in which the rivals show.
    #[error(
        "the logs have {} alone, which show nothing of {} whatever is commanded, so that no manoeuvre is worth planning; \
         log {} of this rig as well and give that log with --log",
        logged.join(" and "),
        effects.join(" and "),
        unlogged(logged).join(" or ")
    )]
    NoManoeuvreShows {
        /// Ids of the rivals.
        effects: Vec<String>,
        /// Signals that the logs have.
        logged: Vec<String>,
    },
    /// The limits leave nothing to do.
    #[error(
        "no manoeuvre of at most {duration_s} s keeps below {max_bar} bar with duty cycles up to {max_duty_pct} %; allow more"
    )]
    NoManoeuvre {
        /// Longest time (s).
        duration_s: f64,
        /// Highest chamber pressure (bar gauge).
        max_bar: f64,
        /// Highest duty cycle (%).
        max_duty_pct: f64,
    },
    /// No parameter of this name.
    #[error(transparent)]
    Knowledge(#[from] KnowledgeError),
    /// A parameter that no fit moves.
    #[error(
        "`{name}` = {value} {unit} counts as exact, so that no experiment determines it; say in the plant file how well it is \
         known, or free it with --free {name}"
    )]
    Exact {
        /// Its name.
        name: String,
        /// Its value.
        value: f64,
        /// Its unit.
        unit: &'static str,
    },
    /// Somebody stopped it.
    #[error("stopped; nothing was written")]
    Interrupted,
}

/// The signals of a diagnosis that no log has.
fn unlogged(logged: &[String]) -> Vec<&'static str> {
    let is_absent = |signal: &&str| logged.iter().all(|one| one != signal);
    WEIGHED.into_iter().filter(is_absent).collect()
}

/// What may have been meant.
fn hint(id: &str) -> String {
    match effects_meant(id).join("` or `") {
        meant if meant.is_empty() => meant,
        meant => format!(", did you mean `{meant}`?"),
    }
}
