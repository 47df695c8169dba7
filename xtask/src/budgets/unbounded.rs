//! Reasons why no bound can be proved, with the place.

/// Reason why a function has no bound for all inputs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Unbounded {
    #[error("loop at {at}")]
    Loop { at: String },
    #[error("recursion at {at}")]
    Recursion { at: String },
    #[error("panic: {at} calls {function}")]
    Panic { at: String, function: String },
    #[error("`{text}` at {at} goes nobody knows where")]
    Indirect { at: String, text: String },
    #[error("trap at {at}")]
    Trap { at: String },
    #[error("no code at {at}")]
    NoCode { at: String },
    #[error("`{text}` at {at} moves the stack pointer by nobody knows how much")]
    StackPointer { at: String, text: String },
    #[error("the stack grows in the loop at {at}")]
    StackGrows { at: String },
}

impl Unbounded {
    /// Returns one word for a table.
    pub(crate) fn word(&self) -> &'static str {
        match self {
            Self::Loop { .. } => "loop",
            Self::Recursion { .. } => "recursion",
            Self::Panic { .. } => "panic",
            Self::Indirect { .. } => "indirect",
            Self::Trap { .. } => "trap",
            Self::NoCode { .. } => "no code",
            Self::StackPointer { .. } => "sp",
            Self::StackGrows { .. } => "stack grows",
        }
    }
}
