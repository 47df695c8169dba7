//! Forbidden results of a run.

use std::fmt;
use std::os::unix::process::ExitStatusExt as _;

use super::limits::{Ended, Limits};

/// Violation of a requirement by a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Finding {
    /// Panic of the program or of one of its threads.
    Panic,
    /// End by a signal.
    Abort,
    /// Time above the limit.
    Hang,
    /// Memory use above the limit.
    Memory,
    /// Exit status other than 0, 1, 2 and 3.
    Status,
    /// No message, although the program could not run or decide.
    Silent,
    /// Change of an input file, or a temporary file that remains.
    Files,
    /// NaN or an infinite number in a result.
    NotANumber,
}

impl Finding {
    /// All findings.
    pub const ALL: [Self; 8] = [
        Self::Panic,
        Self::Abort,
        Self::Hang,
        Self::Memory,
        Self::Status,
        Self::Silent,
        Self::Files,
        Self::NotANumber,
    ];

    /// Returns the first violation of a run, if any. `said` is its output.
    pub fn of(ended: &Ended, limits: &Limits, said: &Said) -> Option<Self> {
        let code = ended.status.code();
        let holds = |finding| match finding {
            Self::Panic => code == Some(101) || contains(&said.standard_error, b"panicked at"),
            Self::Hang => ended.is_overdue || ended.processor_time > limits.processor_time,
            Self::Abort => ended.status.signal().is_some() && !ended.is_overdue,
            Self::Memory => ended.peak_bytes > limits.peak_bytes,
            Self::Status => !matches!(code, Some(0..=3)),
            Self::Silent => {
                code == Some(2) && said.standard_error.is_empty() && said.standard_output.is_empty()
            }
            Self::Files => said.has_disturbed_files,
            Self::NotANumber => said.wrote.iter().any(|text| has_no_number(text)),
        };
        Self::ALL.into_iter().find(|finding| holds(*finding))
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Panic => "panic",
            Self::Abort => "abort",
            Self::Hang => "hang",
            Self::Memory => "memory",
            Self::Status => "status",
            Self::Silent => "silent",
            Self::Files => "files",
            Self::NotANumber => "no-number",
        })
    }
}

/// Output of a run.
#[derive(Debug, Clone, Default)]
pub struct Said {
    /// Standard output.
    pub standard_output: Vec<u8>,
    /// Standard error.
    pub standard_error: Vec<u8>,
    /// Results as JSON and CSV, on the standard output or in a file.
    pub wrote: Vec<Vec<u8>>,
    /// Whether an input changed or a temporary file remained.
    pub has_disturbed_files: bool,
}

fn contains(text: &[u8], part: &[u8]) -> bool {
    text.windows(part.len()).any(|window| window == part)
}

/// Returns whether a value of a CSV or JSON result is written as `NaN` or `inf`.
fn has_no_number(text: &[u8]) -> bool {
    let is_word = |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-' | b'"');
    text.split(|byte| !is_word(byte)).any(|word| {
        matches!(
            word,
            b"NaN" | b"nan" | b"-nan" | b"inf" | b"-inf" | b"Infinity" | b"-Infinity"
        )
    })
}

#[cfg(test)]
mod tests {
    use std::process::ExitStatus;
    use std::time::Duration;

    use super::*;

    fn ended(raw_status: i32) -> Ended {
        Ended {
            status: ExitStatus::from_raw(raw_status),
            is_overdue: false,
            elapsed: Duration::from_millis(3),
            processor_time: Duration::from_millis(2),
            peak_bytes: 6_000_000,
        }
    }

    fn found(ended: Ended, said: &Said) -> Option<Finding> {
        Finding::of(&ended, &Limits::default(), said)
    }

    fn complains(text: &str) -> Said {
        Said {
            standard_error: text.into(),
            ..Said::default()
        }
    }

    /// Tests the detection itself: each finding is reported for a run that has it, and for no good run.
    #[test]
    fn each_finding_is_recognised_by_its_sign() {
        let exit = |code: i32| ended(code << 8);
        let quiet = Said::default();
        let refused = complains("error: E-CSV-NO-ROWS");
        assert_eq!(found(exit(0), &quiet), None);
        assert_eq!(found(exit(1), &quiet), None);
        assert_eq!(found(exit(2), &refused), None);
        assert_eq!(found(exit(2), &quiet), Some(Finding::Silent));
        assert_eq!(found(exit(3), &quiet), None);
        assert_eq!(found(exit(4), &refused), Some(Finding::Status));
        assert_eq!(found(exit(101), &refused), Some(Finding::Panic));
        let panicked = complains("thread '<unnamed>' panicked at src/lib.rs:1:1");
        assert_eq!(found(exit(0), &panicked), Some(Finding::Panic));
        assert_eq!(found(ended(6), &quiet), Some(Finding::Abort));
        let overdue = Ended {
            is_overdue: true,
            ..ended(9)
        };
        assert_eq!(found(overdue, &quiet), Some(Finding::Hang));
        let late = Ended {
            processor_time: Duration::from_secs(11),
            ..exit(0)
        };
        assert_eq!(found(late, &quiet), Some(Finding::Hang));
        let large = Ended {
            peak_bytes: 500_000_001,
            ..exit(0)
        };
        assert_eq!(found(large, &quiet), Some(Finding::Memory));
        let disturbed = Said {
            has_disturbed_files: true,
            ..Said::default()
        };
        assert_eq!(found(exit(0), &disturbed), Some(Finding::Files));
        let wrote = |text: &str| Said {
            wrote: vec![text.into()],
            ..Said::default()
        };
        assert_eq!(
            found(exit(0), &wrote("0.01,NaN,3\n")),
            Some(Finding::NotANumber)
        );
        assert_eq!(
            found(exit(0), &wrote("{\"name\": \"inf.csv\", \"x\": 1}")),
            None
        );
    }
}
