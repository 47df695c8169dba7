//! Reasons why a step failed. Each variant names the cause and, if known, the remedy.

use std::path::PathBuf;
use std::process::ExitStatus;
use std::{io, time::Duration};

use crate::budgets::unproved::Unproved;
use crate::digests::{Difference, Unreadable};

/// Reason why a step failed.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    #[error("{what} is missing and could not be installed from here; to install it, run: {paste}")]
    Missing { what: String, paste: String },
    #[error(
        "not run: {what} is missing and could not be installed from here; to have it, run: {paste}"
    )]
    Skipped { what: String, paste: String },
    #[error("`{line}` could not be started: {source}")]
    NotStarted { line: String, source: io::Error },
    #[error("`{line}` ended with {status}{}", quoted(.said))]
    Ended {
        line: String,
        status: ExitStatus,
        said: String,
    },
    #[error("`{line}` did not end within its deadline of {} s and was stopped{}", .deadline.as_secs(), quoted(.said))]
    Deadline {
        line: String,
        deadline: Duration,
        said: String,
    },
    #[error("`{line}` could not be watched: {source}")]
    Watch { line: String, source: io::Error },
    #[error("{}: its SHA-512 is not {expected}; delete it and try again", .path.display())]
    NotGenuine {
        path: PathBuf,
        expected: &'static str,
    },
    #[error("{}: {source}", .path.display())]
    File { path: PathBuf, source: io::Error },
    #[error("the self-test's output on {machine}, {source}")]
    Digests {
        machine: &'static str,
        source: Unreadable,
    },
    #[error("host and ARM image differ: {0}")]
    Differs(#[from] Difference),
    #[error("one flipped bit at {planted} was not found there; the comparison said: {said}")]
    CanaryLived { planted: String, said: String },
    #[error(transparent)]
    Budgets(#[from] Unproved),
    #[error(
        "the tests do not reach all of it; add a test that claims what is missed, or delete it\n{missed}"
    )]
    NotCovered { missed: String },
    #[error(
        "these changes of the code are seen by no test; add a test that claims what they break, or list them with a reason\n{mutants}"
    )]
    MutantsLived { mutants: String },
    #[error("these are listed as survivors and are none; take them off the list\n{mutants}")]
    MutantsGone { mutants: String },
    #[error("{survived} of {all} mutants survive, more than {percent} %")]
    TooManyMutants {
        survived: usize,
        all: usize,
        percent: usize,
    },
    #[error("needs the step `{0}`, which did not pass")]
    Needs(&'static str),
}

/// Returns the last lines of a captured program's output, for the summary.
fn quoted(said: &str) -> String {
    const LAST_LINES: usize = 12;
    let lines: Vec<&str> = said.lines().collect();
    let from = lines.len().saturating_sub(LAST_LINES);
    lines[from..]
        .iter()
        .map(|line| format!("\n    | {line}"))
        .collect()
}
