use plant_sim::replay::{ReplayError, UnknownSignal};
use recording::{AddSignalError, ConversionError, MissingSignal};

/// Reason why a model cannot be compared with a log.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CompareError {
    /// The log cannot drive the model.
    #[error(transparent)]
    Replay(#[from] ReplayError),
    /// A signal with a name of the model has another quantity.
    #[error(transparent)]
    Quantity(#[from] MissingSignal),
    /// A signal cannot be converted to the unit of the model.
    #[error(transparent)]
    Conversion(#[from] ConversionError),
    /// The residuals do not form a recording.
    #[error(transparent)]
    Residual(#[from] AddSignalError),
    /// The log and the model have no signal in common.
    #[error(
        "{log} has no measured signal that the model has: it has {}, the model {}{}; \
         log one of these, or map a column to its name",
        listed(logged),
        listed(modelled),
        questions(meant)
    )]
    NothingToCompare {
        /// Source of the log.
        log: String,
        /// Signals of the log.
        logged: Vec<String>,
        /// Signals of the model that can be compared.
        modelled: Vec<String>,
        /// Signals of the log that may be one of these.
        meant: Vec<UnknownSignal>,
    },
    /// The signals that log and model have in common cannot be compared.
    #[error("{log}: {name:?} cannot be compared: {reason}")]
    NotComparable {
        /// Source of the log.
        log: String,
        /// The first of them.
        name: String,
        /// Reason.
        reason: String,
    },
    /// An option is outside its range.
    #[error("option `{option}` is {value}; it must be {range}")]
    Option {
        /// Name of the option.
        option: String,
        /// Its value.
        value: f64,
        /// Allowed range.
        range: &'static str,
    },
    /// The observer stopped the comparison.
    #[error("the comparison was stopped before its end; begin it again")]
    Stopped,
    /// A tolerance is given for a signal that is not compared.
    #[error(
        "there is a tolerance for {name:?}, but compared are {}; remove it or correct the name",
        listed(compared)
    )]
    UnusedTolerance {
        /// Name of the signal.
        name: String,
        /// Compared signals.
        compared: Vec<String>,
    },
}

/// Returns the question whether a signal is another one.
fn questions(meant: &[UnknownSignal]) -> String {
    let questions = meant.iter();
    questions
        .map(|UnknownSignal { name, nearest }| format!("; is {name} {}?", nearest.join(" or ")))
        .collect()
}

/// Returns names as a list in a sentence.
fn listed(names: &[String]) -> String {
    if names.is_empty() {
        "none".to_owned()
    } else {
        names.join(", ")
    }
}
