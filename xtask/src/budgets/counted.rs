//! Output of the bench: one line for each candidate.

use std::str::FromStr;

/// Counts of the bench for one candidate over its trace.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Counted {
    /// Name of the candidate in the bench.
    pub(crate) name: String,
    /// Address of the function, with bit 0 set as for any Thumb function.
    pub(crate) entry: u32,
    pub(crate) calls: u32,
    /// Instructions of all calls, of the cheapest and of the most expensive one.
    pub(crate) sum: u32,
    pub(crate) min: u32,
    pub(crate) max: u32,
    /// Depth to which the painted stack was written (bytes).
    pub(crate) stack: u32,
    pub(crate) state_bytes: u32,
    pub(crate) config_bytes: u32,
    /// Largest difference of a duty cycle from the project's own controller (2⁻¹⁶ %).
    pub(crate) deviation: u32,
    /// Samples in which another valve is driven.
    pub(crate) decisions: u32,
}

/// Reason why the bench's output cannot be used.
#[derive(Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum Unreadable {
    #[error("no candidate was measured")]
    Nothing,
    #[error("line {line} has no number `{key}`: {text}")]
    Line {
        line: usize,
        key: &'static str,
        text: String,
    },
}

impl Counted {
    /// Returns the mean number of instructions of a call.
    pub(crate) fn mean(&self) -> f64 {
        f64::from(self.sum) / f64::from(self.calls)
    }

    /// Reads all lines.
    pub(crate) fn read(text: &str) -> Result<Vec<Self>, Unreadable> {
        let lines = text.lines().enumerate();
        let candidates = lines
            .map(|(index, text)| Self::line(index + 1, text))
            .collect::<Result<Vec<_>, _>>()?;
        if candidates.is_empty() {
            return Err(Unreadable::Nothing);
        }
        Ok(candidates)
    }

    fn line(line: usize, text: &str) -> Result<Self, Unreadable> {
        let value = |key: &'static str| {
            let mut words = text.split(' ').filter_map(|word| word.split_once('='));
            let found = words.find(|(name, _)| *name == key);
            let missing = || Unreadable::Line {
                line,
                key,
                text: text.to_owned(),
            };
            found.map(|(_, value)| value).ok_or_else(missing)
        };
        let number = |key| {
            let value = value(key)?;
            let read = match value.strip_prefix("0x") {
                Some(hexadecimal) => u32::from_str_radix(hexadecimal, 16),
                None => u32::from_str(value),
            };
            read.map_err(|_| Unreadable::Line {
                line,
                key,
                text: text.to_owned(),
            })
        };
        Ok(Self {
            name: value("candidate")?.to_owned(),
            entry: number("entry")?,
            calls: number("calls")?,
            sum: number("sum")?,
            min: number("min")?,
            max: number("max")?,
            stack: number("stack")?,
            state_bytes: number("state")?,
            config_bytes: number("config")?,
            deviation: number("deviation")?,
            decisions: number("decisions")?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LINE: &str = "candidate=full entry=0x00001c69 calls=4 sum=10 min=1 max=5 stack=8 state=24 config=44 deviation=3 decisions=0";

    #[test]
    fn a_line_gives_every_figure_and_the_mean() {
        let counted = Counted::read(LINE).unwrap().remove(0);
        assert_eq!((counted.name.as_str(), counted.entry), ("full", 0x1c69));
        assert_eq!((counted.calls, counted.sum, counted.max), (4, 10, 5));
        assert_eq!(counted.mean(), 2.5);
    }

    #[test]
    fn a_figure_that_is_missing_or_no_number_is_named_with_its_line() {
        for key in ["candidate", "entry", "sum", "deviation"] {
            let broken = format!("{LINE}\n{}", LINE.replace(key, "other"));
            let unreadable = Counted::read(&broken).unwrap_err();
            assert!(
                matches!(&unreadable, Unreadable::Line { line: 2, key: named, .. } if *named == key),
                "{unreadable}"
            );
        }
        assert!(Counted::read(&LINE.replace("sum=10", "sum=ten")).is_err());
    }

    #[test]
    fn a_silent_bench_is_no_bench_without_candidates() {
        assert_eq!(Counted::read(""), Err(Unreadable::Nothing));
    }
}
