//! Two devices that must be one: the same bits at every sample.

use core::fmt;

use ecu::EcuSettings;

use crate::device::{DeviceUnderTest, DutError};
use crate::run::Run;
use crate::wire::{Answer, Sensors};

/// Two devices that get the same samples. The first answer in which they differ ends the run.
#[derive(Clone, Debug)]
pub struct Compared<A, B> {
    reference: A,
    device: B,
    samples: u64,
}

impl<A: DeviceUnderTest, B: DeviceUnderTest> Compared<A, B> {
    /// `device` beside the `reference` that it must be equal to.
    pub const fn new(reference: A, device: B) -> Self {
        Self {
            reference,
            device,
            samples: 0,
        }
    }

    /// Samples in which both were equal.
    pub const fn samples(&self) -> u64 {
        self.samples
    }

    /// The device beside the reference.
    pub const fn device_mut(&mut self) -> &mut B {
        &mut self.device
    }
}

impl<A: DeviceUnderTest, B: DeviceUnderTest> DeviceUnderTest for Compared<A, B> {
    fn identity(&self) -> String {
        format!(
            "{} beside {}",
            self.device.identity(),
            self.reference.identity()
        )
    }

    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError> {
        self.reference.start(settings)?;
        self.device.start(settings)
    }

    fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError> {
        let expected = self.reference.exchange(sensors)?;
        let found = self.device.exchange(sensors)?;
        if found != expected {
            return Err(DutError::Different(Box::new(Difference {
                sensors: *sensors,
                devices: [self.reference.identity(), self.device.identity()],
                answers: [expected, found],
            })));
        }
        self.samples += 1;
        Ok(found)
    }

    fn take_log(&mut self) -> Result<Vec<String>, DutError> {
        self.device.take_log()
    }
}

/// The first sample in which two devices differ.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// What both were told.
    pub sensors: Sensors,
    /// Who they are.
    pub devices: [String; 2],
    /// What each answered, with its state after the sample.
    pub answers: [Answer; 2],
}

impl Difference {
    /// The first sample in which `device` gave another answer than `reference` in the same run.
    pub fn first(reference: &Run, device: &Run) -> Option<Self> {
        let mut pairs = reference.exchanges.iter().zip(&device.exchanges);
        let (expected, found) = pairs.find(|(expected, found)| expected != found)?;
        Some(Self {
            sensors: expected.sensors,
            devices: [reference.device.clone(), device.device.clone()],
            answers: [expected.answer, found.answer],
        })
    }
}

/// Every number of an answer, by name.
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
        write!(f, "  both were told: {:?}", self.sensors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ecu_under_test::InProcess;
    use crate::run::{RunError, run};
    use crate::scenario::Scenario;

    /// An ECU of whose state one bit is lost on the way.
    struct Flipped(InProcess, u32);

    impl DeviceUnderTest for Flipped {
        fn identity(&self) -> String {
            "flipped".to_owned()
        }

        fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError> {
            self.0.start(settings)
        }

        fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError> {
            let mut answer = self.0.exchange(sensors)?;
            answer.telemetry.ecu_digest ^= u32::from(sensors.sample == self.1);
            Ok(answer)
        }
    }

    #[test]
    fn one_flipped_bit_is_found_in_its_sample_and_shown_with_both_states() {
        let scenario = Scenario::built_in("hold").unwrap();
        let mut pair = Compared::new(InProcess::new(), Flipped(InProcess::new(), 321));
        let error = run(&scenario, &mut pair).unwrap_err();
        assert!(matches!(&error, RunError::Device { .. }));
        let text = error.to_string();
        assert!(text.contains("sample 321 differs"), "{text}");
        let marked: Vec<&str> = text.lines().filter(|line| line.starts_with('*')).collect();
        assert_eq!(marked.len(), 1, "{text}");
        assert!(marked[0].contains("ecu_digest"), "{text}");
        assert_eq!(pair.samples(), 321);

        let expected = run(&scenario, &mut InProcess::new()).unwrap();
        let found = run(&scenario, &mut Flipped(InProcess::new(), 321)).unwrap();
        let difference = Difference::first(&expected, &found).unwrap();
        assert_eq!(difference.sensors.sample, 321);
        assert_eq!(Difference::first(&expected, &expected), None);
    }

    #[test]
    fn a_device_is_equal_to_itself() {
        let scenario = Scenario::built_in("hold").unwrap();
        let mut pair = Compared::new(InProcess::new(), InProcess::new());
        let run = run(&scenario, &mut pair).unwrap();
        assert_eq!(pair.samples(), run.exchanges.len() as u64);
    }
}
