//! Results of the steps. A failed step does not stop the others; all failures are reported together at the end.

use std::fmt;
use std::time::{Duration, Instant};

use crate::failure::Failure;

/// All steps of one call, in the order in which they ran.
#[derive(Default)]
pub(crate) struct Report {
    steps: Vec<Step>,
}

struct Step {
    name: &'static str,
    outcome: Result<(), Failure>,
    took: Duration,
}

impl Report {
    /// Runs one step and records its result; later steps can use its value.
    pub(crate) fn step<T>(
        &mut self,
        name: &'static str,
        work: impl FnOnce() -> Result<T, Failure>,
    ) -> Option<T> {
        eprintln!("\n== {name}");
        let start = Instant::now();
        let (outcome, result) = match work() {
            Ok(result) => (Ok(()), Some(result)),
            Err(failure) => {
                eprintln!("{failure}");
                (Err(failure), None)
            }
        };
        self.steps.push(Step {
            name,
            outcome,
            took: start.elapsed(),
        });
        result
    }

    pub(crate) fn all_passed(&self) -> bool {
        self.failed() == 0
    }

    fn failed(&self) -> usize {
        self.steps.iter().filter(|step| step.failed()).count()
    }

    fn skipped(&self) -> usize {
        self.steps.iter().filter(|step| step.skipped()).count()
    }
}

impl Step {
    fn failed(&self) -> bool {
        self.outcome.is_err() && !self.skipped()
    }

    /// Returns whether the step was skipped. Only a step that needs a tool that this machine cannot get may be skipped.
    fn skipped(&self) -> bool {
        matches!(self.outcome, Err(Failure::Skipped { .. }))
    }

    fn verdict(&self) -> &'static str {
        match &self.outcome {
            Ok(()) => "passed",
            Err(Failure::Missing { .. }) => "missing",
            Err(Failure::Needs(_)) => "not run",
            Err(Failure::Skipped { .. }) => "skipped",
            Err(_) => "FAILED",
        }
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.steps.iter().map(|step| step.name.len()).max();
        let width = width.unwrap_or(0).max("step".len());
        writeln!(f, "{:width$}  verdict  seconds", "step")?;
        for step in &self.steps {
            let (name, verdict) = (step.name, step.verdict());
            writeln!(
                f,
                "{name:width$}  {verdict:7}  {:7.1}",
                step.took.as_secs_f64()
            )?;
        }
        for step in &self.steps {
            if let Err(failure) = &step.outcome {
                writeln!(f, "\n{}: {failure}", step.name)?;
            }
        }
        let (failed, skipped) = (self.failed(), self.skipped());
        let passed = self.steps.len() - failed - skipped;
        write!(f, "\n{passed} passed, {failed} failed")?;
        match skipped {
            0 => writeln!(f),
            _ => writeln!(f, ", {skipped} skipped"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Report {
        let mut report = Report::default();
        report.step("bricks", || Ok(()));
        report.step("mortar", || Err::<(), _>(Failure::Needs("water")));
        report.step("roof", || Ok(()));
        report
    }

    #[test]
    fn a_failed_step_stops_no_other_and_fails_the_whole() {
        let report = report();
        assert_eq!(report.steps.len(), 3);
        assert!(!report.all_passed());
    }

    #[test]
    fn the_last_line_counts_the_steps_and_stands_alone() {
        assert!(report().to_string().ends_with("\n2 passed, 1 failed\n"));
    }

    #[test]
    fn a_step_without_its_tool_fails_nothing_and_is_not_counted_as_passed() {
        let mut report = Report::default();
        report.step("view", || {
            Err::<(), _>(Failure::Skipped {
                what: "a window".to_owned(),
                paste: "saw".to_owned(),
            })
        });
        assert!(report.all_passed());
        let text = report.to_string();
        assert!(
            text.ends_with("\n0 passed, 0 failed, 1 skipped\n"),
            "{text}"
        );
        assert!(text.contains("to have it, run: saw"), "{text}");
    }

    #[test]
    fn each_failure_is_listed_under_the_table_with_its_step() {
        let text = report().to_string();
        assert!(text.contains("mortar  not run"), "{text}");
        assert!(
            text.contains("\nmortar: needs the step `water`, which did not pass\n"),
            "{text}"
        );
    }

    #[test]
    fn a_step_hands_its_result_to_those_that_build_on_it() {
        assert_eq!(Report::default().step("bricks", || Ok(7)), Some(7));
    }
}
