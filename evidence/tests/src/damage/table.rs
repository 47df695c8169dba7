//! Counts of the results of many cases.

use std::collections::BTreeMap;
use std::fmt;
use std::time::Duration;

use super::commands::Name;
use super::finding::Finding;
use super::limits::Ended;

/// Counts of one command.
#[derive(Debug, Clone, Default)]
struct Row {
    cases: u64,
    /// Exit status 0, 1, 2 and 3.
    exits: [u64; 4],
    findings: BTreeMap<Finding, u64>,
    /// Processor time.
    slowest: Duration,
    slowest_case: u64,
    peak_bytes: u64,
    processor_time: Duration,
}

/// Counts by command.
#[derive(Debug, Clone, Default)]
pub struct Table {
    rows: BTreeMap<Name, Row>,
}

impl Table {
    /// Counts a case.
    pub fn add(&mut self, name: Name, number: u64, ended: &Ended, finding: Option<Finding>) {
        let row = self.rows.entry(name).or_default();
        row.cases += 1;
        if let Some(count) = ended
            .status
            .code()
            .and_then(|code| row.exits.get_mut(code as usize))
        {
            *count += 1;
        }
        if let Some(finding) = finding {
            *row.findings.entry(finding).or_default() += 1;
        }
        if ended.processor_time > row.slowest {
            (row.slowest, row.slowest_case) = (ended.processor_time, number);
        }
        row.peak_bytes = row.peak_bytes.max(ended.peak_bytes);
        row.processor_time += ended.processor_time;
    }

    /// Returns the number of cases so far.
    pub fn cases(&self) -> u64 {
        self.rows.values().map(|row| row.cases).sum()
    }

    /// Returns the number of cases with a finding so far.
    pub fn findings(&self) -> u64 {
        self.rows
            .values()
            .flat_map(|row| row.findings.values())
            .sum()
    }

    /// Returns the number of cases that ended with an exit status.
    pub fn ended_with(&self, status: usize) -> u64 {
        self.rows.values().map(|row| row.exits[status]).sum()
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:16}{:>8}{:>8}{:>8}{:>8}{:>8}",
            "command", "cases", "exit 0", "exit 1", "exit 2", "exit 3"
        )?;
        for finding in Finding::ALL {
            write!(f, "{finding:>10}")?;
        }
        writeln!(f, "{:>11}{:>9}{:>9}", "longest s", "in case", "peak MB")?;
        for (name, row) in &self.rows {
            write!(f, "{:16}{:>8}", name.word(), row.cases)?;
            for count in row.exits {
                write!(f, "{count:>8}")?;
            }
            for finding in Finding::ALL {
                write!(f, "{:>10}", row.findings.get(&finding).unwrap_or(&0))?;
            }
            let (slowest, peak) = (row.slowest.as_secs_f64(), row.peak_bytes as f64 / 1e6);
            writeln!(f, "{slowest:>11.2}{:>9}{peak:>9.1}", row.slowest_case)?;
        }
        let time: Duration = self.rows.values().map(|row| row.processor_time).sum();
        let (cases, findings, time) = (self.cases(), self.findings(), time.as_secs_f64());
        write!(
            f,
            "{cases} cases, {findings} findings, {time:.0} s of processor time"
        )
    }
}
