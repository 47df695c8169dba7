//! First sample in which two devices differ.

use core::fmt;

use crate::wire::{Answer, Sensors};

/// First sample in which two devices differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// Sensors that both got.
    pub sensors: Sensors,
    /// Identities of the devices.
    pub devices: [String; 2],
    /// Answers of the devices, with their state after the sample.
    pub answers: [Answer; 2],
}

/// Returns every number of an answer, by name.
fn rows(answer: &Answer) -> Vec<(String, i64)> {
    let Answer {
        sample,
        actuators,
        telemetry,
    } = answer;
    let mut rows = vec![
        ("sample".to_owned(), i64::from(*sample)),
        ("duty_fill [2^-16 %]".to_owned(), actuators.duty_fill.into()),
        ("duty_vent [2^-16 %]".to_owned(), actuators.duty_vent.into()),
        ("u [2^-12 %]".to_owned(), telemetry.control_signal.into()),
    ];
    let state = telemetry.controller_state.iter().enumerate();
    rows.extend(state.map(|(word, value)| (format!("controller state {word}"), i64::from(*value))));
    rows.push(("mode".to_owned(), telemetry.mode.into()));
    rows.push(("faults".to_owned(), telemetry.faults.into()));
    rows.push(("ecu_digest".to_owned(), telemetry.ecu_digest.into()));
    rows
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [expected, found] = &self.answers;
        writeln!(f, "sample {} differs:", self.sensors.sample)?;
        writeln!(f, "  A: {}\n  B: {}", self.devices[0], self.devices[1])?;
        writeln!(f, "  {:22}{:>14}{:>14}", "", "A", "B")?;
        for ((name, a), (_, b)) in rows(expected).iter().zip(rows(found)) {
            let mark = if *a == b { ' ' } else { '*' };
            writeln!(f, "{mark} {name:22}{a:>14}{b:>14}")?;
        }
        write!(f, "  input of both: {:?}", self.sensors)
    }
}
