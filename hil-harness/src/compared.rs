//! Comparison of two devices that must give the same bits at every sample.

use ecu::EcuSettings;

use crate::device::{DeviceUnderTest, DutError};
use crate::difference::Difference;
use crate::wire::{Answer, Sensors};

/// Two devices that get the same samples. The first different answer ends the run.
#[derive(Clone, Debug)]
pub struct Compared<A, B> {
    reference: A,
    device: B,
    samples: u64,
}

impl<A: DeviceUnderTest, B: DeviceUnderTest> Compared<A, B> {
    /// Creates the comparison of `device` with the `reference` that it must be equal to.
    pub const fn new(reference: A, device: B) -> Self {
        Self {
            reference,
            device,
            samples: 0,
        }
    }

    /// Returns the number of samples in which both were equal.
    pub const fn samples(&self) -> u64 {
        self.samples
    }

    /// Returns the compared device.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ecu_under_test::InProcess;
    use crate::run::{RunError, run};
    use crate::scenario::Scenario;

    /// ECU that loses one bit of its state.
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
        let difference = expected.first_difference(&found).unwrap();
        assert_eq!(difference.sensors.sample, 321);
        assert_eq!(expected.first_difference(&expected), None);
    }

    #[test]
    fn a_device_is_equal_to_itself() {
        let scenario = Scenario::built_in("hold").unwrap();
        let mut pair = Compared::new(InProcess::new(), InProcess::new());
        let run = run(&scenario, &mut pair).unwrap();
        assert_eq!(pair.samples(), run.exchanges.len() as u64);
    }
}
