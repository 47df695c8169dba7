//! Reasons why a budget is not proved.

use std::path::PathBuf;

use super::counted::Unreadable;
use super::unbounded::Unbounded;

/// Reason why a budget is not proved.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Unproved {
    #[error("{} is no ELF that can be read: {source}", .path.display())]
    Elf {
        path: PathBuf,
        source: object::Error,
    },
    #[error("the bench's output: {0}")]
    Bench(Unreadable),
    #[error("the bench measured `{name}`, which xtask/src/budgets/candidate.rs does not list")]
    Candidate { name: String },
    #[error("over budget:{}", listed(.0))]
    Exceeded(Vec<String>),
    #[error("{} has no `{name}`", .path.display())]
    NoSymbol { path: PathBuf, name: &'static str },
    #[error("the stack of the image has no bound: {0}")]
    Stack(Unbounded),
    #[error("panics are left in the image:{}", listed(.0))]
    PanicsLeft(Vec<String>),
    #[error("the self-test did not say how much of its stack it used")]
    NotPainted,
    #[error(
        "a panic is left in an image that must not have one; the linker says who calls it:\n{said}"
    )]
    CanPanic { said: String },
    #[error("an image with a panic on purpose linked: the proof by the linker proves nothing")]
    CanaryLinked,
}

fn listed(lines: &[String]) -> String {
    lines.iter().map(|line| format!("\n    {line}")).collect()
}
