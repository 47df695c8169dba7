//! Table of a campaign's results.

use core::fmt;
use std::collections::BTreeMap;

use super::class::FaultClass;
use super::run::Outcome;

/// Results of many runs, by class.
#[derive(Clone, Debug, Default)]
pub struct Summary {
    rows: BTreeMap<FaultClass, Row>,
    samples: u64,
    /// First runs that violated a requirement.
    failures: Vec<Outcome>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Row {
    runs: u32,
    detected: u32,
    latency_worst: Option<u32>,
    breaking_safety: u32,
    not_live: u32,
    resets: u32,
}

/// Maximum number of stored failures.
const FAILURES_MAX: usize = 20;

impl Summary {
    /// Adds one run.
    pub fn add(&mut self, outcome: Outcome) {
        self.samples += u64::from(outcome.samples);
        let row = self.rows.entry(outcome.injection.class).or_default();
        row.runs += 1;
        row.detected += u32::from(outcome.latency.is_some());
        row.latency_worst = row.latency_worst.max(outcome.latency);
        row.breaking_safety += u32::from(outcome.is_unsafe());
        row.not_live += u32::from(outcome.is_not_live());
        row.resets += outcome.resets;
        if !outcome.violations.is_empty() && self.failures.len() < FAILURES_MAX {
            self.failures.push(outcome);
        }
    }

    /// Returns both summaries combined.
    #[must_use]
    pub fn with(mut self, other: Self) -> Self {
        self.samples += other.samples;
        for (class, more) in other.rows {
            let row = self.rows.entry(class).or_default();
            row.runs += more.runs;
            row.detected += more.detected;
            row.latency_worst = row.latency_worst.max(more.latency_worst);
            row.breaking_safety += more.breaking_safety;
            row.not_live += more.not_live;
            row.resets += more.resets;
        }
        self.failures.extend(other.failures);
        self.failures.truncate(FAILURES_MAX);
        self
    }

    /// Returns the number of runs.
    pub fn runs(&self) -> u32 {
        self.rows.values().map(|row| row.runs).sum()
    }

    /// Returns the number of runs that violated a requirement.
    pub fn failed(&self) -> u32 {
        self.rows
            .values()
            .map(|row| row.breaking_safety + row.not_live)
            .sum()
    }

    /// Returns the classes that were run.
    pub fn classes(&self) -> impl Iterator<Item = FaultClass> {
        self.rows.keys().copied()
    }

    /// Returns the first runs that violated a requirement.
    pub fn failures(&self) -> &[Outcome] {
        &self.failures
    }
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{:24} {:>8} {:>9} {:>16} {:>7} {:>9} {:>7}",
            "fault", "runs", "detected", "latency, worst", "unsafe", "not live", "resets"
        )?;
        for (class, row) in &self.rows {
            let latency = row
                .latency_worst
                .map_or("-".to_owned(), |samples| samples.to_string());
            let Row {
                runs,
                detected,
                breaking_safety,
                not_live,
                resets,
                ..
            } = row;
            writeln!(
                f,
                "{class:24} {runs:8} {detected:9} {latency:>16} {breaking_safety:7} {not_live:9} {resets:7}"
            )?;
        }
        write!(
            f,
            "{} runs, {} samples, {} runs violated a requirement",
            self.runs(),
            self.samples,
            self.failed()
        )?;
        for outcome in &self.failures {
            write!(f, "\n{}", outcome.injection)?;
            for violation in &outcome.violations {
                write!(f, "\n    {violation}")?;
            }
        }
        Ok(())
    }
}
