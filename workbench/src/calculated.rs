//! Calculated channels of a project: a name, a unit, and a formula over the signals of each log.

use formula::{Formula, FormulaError};
use recording::{Provenance, Recording, TimeBase, TimeBaseId, Unit};
use serde::{Deserialize, Serialize};

use crate::refusal::{Problem, Refusal};

/// Largest number of calculated channels in a project.
const CHANNELS_MAX: usize = 32;

/// Calculated channel in the user's notation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Calculated {
    name: String,
    /// Unit as in the header of a log: `bar_gauge`, `mA`.
    unit: String,
    /// Formula over the values in the units of the log.
    formula: String,
}

/// Refuses channels that are invalid for every log. A problem's line is the number of the channel; its column is the
/// position in the formula.
pub(crate) fn check(channels: &[Calculated]) -> Result<(), Refusal> {
    if channels.len() > CHANNELS_MAX {
        return Err(Refusal::value(format!(
            "a project has at most {CHANNELS_MAX} calculated channels; remove one first"
        )));
    }
    // A recording already checks names and duplicates.
    let mut names = Recording::new(Provenance::default());
    let base = TimeBase::uniform(0.0, 1.0, 1).map_err(|error| Refusal::value(error.to_string()))?;
    let base = names.add_time_base(base);
    for (index, channel) in channels.iter().enumerate() {
        let of_channel = |problem: Problem| Problem {
            line: Some(index as u64 + 1),
            ..problem
        };
        channel.check(&mut names, base).map_err(of_channel)?;
    }
    Ok(())
}

impl Calculated {
    fn check(&self, names: &mut Recording, base: TimeBaseId) -> Result<(), Problem> {
        let unit = self
            .known_unit()
            .map_err(|text| Problem::new("E-CHANNEL", text))?;
        self.parsed().map_err(|error| Problem {
            column: Some(error.position),
            ..Problem::new("E-FORMULA", format!("{}: {error}", self.name))
        })?;
        let added = names.add_signal(&self.name, unit, base, vec![0.0]);
        added
            .map(drop)
            .map_err(|error| Problem::new("E-CHANNEL", error.to_string()))
    }

    /// Parses the formula, which has at least one signal.
    fn parsed(&self) -> Result<Formula, FormulaError> {
        let formula = Formula::parse(&self.formula)?;
        if formula.names().len() == 0 {
            return Err(FormulaError {
                position: 1,
                problem: "there is no signal in it; a constant is no channel".to_owned(),
            });
        }
        Ok(formula)
    }

    fn known_unit(&self) -> Result<Unit, String> {
        Unit::parse(&self.unit).ok_or_else(|| {
            format!(
                "{}: {:?} is not a unit; write it as in a header, such as bar_gauge, mA or pct",
                self.name, self.unit
            )
        })
    }

    /// Returns the samples for a log with their time base, or the reason why there are none.
    fn samples(&self, log: &Recording) -> Result<(TimeBaseId, Vec<f64>), String> {
        let formula = self.parsed().map_err(|error| error.to_string())?;
        let signal = |name: &str| {
            let signal = log.signal(name);
            signal
                .ok_or_else(|| format!("the log has no signal {name:?}, of which it is calculated"))
        };
        let signals: Vec<_> = formula.names().map(signal).collect::<Result<_, _>>()?;
        let base = signals[0].time_base();
        if let Some(other) = signals.iter().find(|other| other.time_base() != base) {
            return Err(format!(
                "{:?} and {:?} were sampled at different instants",
                signals[0].name(),
                other.name()
            ));
        }
        let columns: Vec<&[f64]> = signals
            .iter()
            .map(|signal| signal.values_or_nan())
            .collect();
        let rows = 0..signals[0].len();
        let mut values = vec![0.0; columns.len()];
        let at = |row: usize| {
            for (value, column) in values.iter_mut().zip(&columns) {
                *value = column[row];
            }
            // A sample without a finite value is missing.
            Some(formula.value(&values)).filter(|value| value.is_finite())
        };
        let samples = rows.map(at).map(|value| value.unwrap_or(f64::NAN));
        Ok((base, samples.collect()))
    }

    fn add_to(&self, log: &mut Recording) -> Result<(), String> {
        let unit = self.known_unit()?;
        let (base, samples) = self.samples(log)?;
        let added = log.add_signal(&self.name, unit, base, samples);
        added.map(drop).map_err(|error| error.to_string())
    }
}

/// Adds each channel to a log, in order, so that a channel may use previous ones. A channel that cannot be added is
/// left out, with the reason.
pub(crate) fn add_to(log: &mut Recording, channels: &[Calculated]) {
    for channel in channels {
        if let Err(reason) = channel.add_to(log) {
            log.leave_out(&channel.name, format!("calculated channel: {reason}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(name: &str, unit: &str, formula: &str) -> Calculated {
        Calculated {
            name: name.to_owned(),
            unit: unit.to_owned(),
            formula: formula.to_owned(),
        }
    }

    fn log() -> Recording {
        let mut log = Recording::new(Provenance::from_source("bench"));
        let base = log.add_time_base(TimeBase::uniform(0.0, 0.1, 3).unwrap());
        let add = |log: &mut Recording, name, unit, values: [f64; 3]| {
            log.add_signal(name, unit, base, values.to_vec())
                .map(drop)
                .unwrap();
        };
        add(&mut log, "p_ch", Unit::BarGauge, [1.0, f64::NAN, 3.0]);
        add(&mut log, "i fill", Unit::Ampere, [0.5, 0.5, 0.0]);
        log
    }

    #[test]
    fn channels_are_added_in_order_with_gaps_where_something_is_missing() {
        let mut log = log();
        let channels = [
            channel("twice", "bar_gauge", "2 * p_ch"),
            channel("ratio", "1", "twice / \"i fill\""),
        ];
        add_to(&mut log, &channels);
        let values = |name| log.signal(name).unwrap().iter().collect::<Vec<_>>();
        assert_eq!(values("twice"), [Some(2.0), None, Some(6.0)]);
        assert_eq!(values("ratio"), [Some(4.0), None, None]);
        assert_eq!(log.left_out(), []);
    }

    #[test]
    fn what_a_log_cannot_have_is_left_out_with_the_reason() {
        let mut log = log();
        let other = log.add_time_base(TimeBase::uniform(0.0, 0.2, 3).unwrap());
        log.add_signal("slow", Unit::Volt, other, vec![1.0; 3])
            .unwrap();
        let channels = [
            channel("p_ch", "bar_gauge", "2 * p_ch"),
            channel("x", "bar_gauge", "nothing + 1"),
            channel("y", "bar_gauge", "slow + p_ch"),
            channel("z", "parsec", "p_ch"),
        ];
        add_to(&mut log, &channels);
        assert_eq!(log.signals().len(), 3);
        let reasons: Vec<&str> = log
            .left_out()
            .iter()
            .map(|one| one.reason.as_str())
            .collect();
        for (reason, words) in reasons
            .iter()
            .zip(["already", "\"nothing\"", "instants", "unit"])
        {
            assert!(reason.contains(words), "{reason}");
        }
    }

    #[test]
    fn wrong_channels_are_refused_with_their_line_and_place() {
        let good = channel("good", "mA", "a");
        for (wrong, line, column) in [
            (channel("x", "mA", "a + "), 2, Some(5)),
            (channel("x", "furlong", "a"), 2, None),
            (channel("good", "mA", "b"), 2, None),
            (channel(" ", "mA", "b"), 2, None),
            (channel("a\u{202e}b", "mA", "b"), 2, None),
            (channel(&"n".repeat(300), "mA", "b"), 2, None),
            (channel("time", "s", "b"), 2, None),
        ] {
            let refusal = check(&[good.clone(), wrong.clone()]).unwrap_err();
            let problem = &refusal.problems[0];
            assert_eq!(
                (problem.line, problem.column),
                (Some(line), column),
                "{wrong:?}"
            );
        }
        let many: Vec<_> = (0..=CHANNELS_MAX)
            .map(|index| channel(&format!("n{index}"), "mA", "a"))
            .collect();
        assert!(check(&many[1..]).is_ok());
        assert!(check(&many).is_err());
    }
}
