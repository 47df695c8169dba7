//! Devices under test, which answer to sensors with duty cycles.

use ecu::{EcuConfigError, EcuSettings};

use crate::difference::Difference;
use crate::link::LinkError;
use crate::wire::{Answer, FULL_DUTY, Sensors};

/// ECU in this process, in an emulator, or on a board.
///
/// ```text
/// plant -> sensors, reference -> exchange -> duty cycles of the coils -> plant      once per sample
/// ```
pub trait DeviceUnderTest {
    /// Returns the identity: kind, name, version; for the record of a run.
    fn identity(&self) -> String;

    /// Starts the device with these settings, in the state after power-on.
    ///
    /// # Errors
    /// Returns an error if the device cannot be reached, or the settings are out of bounds.
    fn start(&mut self, settings: &EcuSettings) -> Result<(), DutError>;

    /// Runs one sample.
    ///
    /// # Errors
    /// Returns an error if the device did not answer, or its answer is no pair of duty cycles. The run ends then.
    fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError>;

    /// Returns the log since the last call, oldest line first; empty for a device without a log.
    ///
    /// # Errors
    /// Returns an error if the device cannot be reached.
    fn take_log(&mut self) -> Result<Vec<String>, DutError> {
        Ok(Vec::new())
    }
}

/// Reason why a device gave no duty cycles.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DutError {
    /// There is no answer, or an unusable one.
    #[error(transparent)]
    Link(#[from] LinkError),
    /// The settings are out of bounds.
    #[error(transparent)]
    Settings(#[from] EcuConfigError),
    /// Two devices that must be equal differ.
    #[error("{0}")]
    Different(Box<Difference>),
    /// The answer belongs to another sample.
    #[error(
        "the answer to sample {expected} carries number {found}: one was lost or repeated on the way"
    )]
    OtherSample {
        /// Number of the sent sample.
        expected: u32,
        /// Number of the answered sample.
        found: u32,
    },
    /// The duty cycle is impossible for a PWM.
    #[error(
        "sample {sample}: {bits} units of 2^-16 % for the {valve} valve is beyond 100 % (6553600 units)"
    )]
    ImpossibleDuty {
        /// Number of the answered sample.
        sample: u32,
        /// `fill` or `vent`.
        valve: &'static str,
        /// Answered value.
        bits: u32,
    },
}

/// Returns `answer`, if it belongs to `sensors` and a PWM can output it.
///
/// # Errors
/// Returns an error otherwise.
pub fn plausible(sensors: &Sensors, answer: Answer) -> Result<Answer, DutError> {
    if answer.sample != sensors.sample {
        return Err(DutError::OtherSample {
            expected: sensors.sample,
            found: answer.sample,
        });
    }
    let duties = [
        ("fill", answer.actuators.duty_fill),
        ("vent", answer.actuators.duty_vent),
    ];
    match duties.into_iter().find(|(_, bits)| *bits > FULL_DUTY) {
        Some((valve, bits)) => Err(DutError::ImpossibleDuty {
            sample: answer.sample,
            valve,
            bits,
        }),
        None => Ok(answer),
    }
}

#[cfg(test)]
mod tests {
    use hil_protocol::{Actuators, STATE_WORDS, Telemetry};

    use super::*;

    fn answer(sample: u32, duty_fill: u32, duty_vent: u32) -> Answer {
        Answer {
            sample,
            actuators: Actuators {
                duty_fill,
                duty_vent,
            },
            telemetry: Telemetry {
                control_signal: 0,
                controller_state: [0; STATE_WORDS],
                mode: 0,
                faults: 0,
                ecu_digest: 0,
            },
        }
    }

    #[test]
    fn an_answer_ends_exactly_at_100_percent_and_carries_the_number_of_its_question() {
        let sensors = Sensors {
            sample: 7,
            elapsed_us: 10_000,
            reference: None,
            pressure: None,
            current_fill_ma: None,
            current_vent_ma: None,
            battery_mv: None,
        };
        let full = answer(7, FULL_DUTY, FULL_DUTY);
        assert_eq!(plausible(&sensors, full).unwrap(), full);
        for (wrong, said) in [
            (answer(8, 0, 0), "the answer to sample 7 carries number 8"),
            (
                answer(7, FULL_DUTY + 1, 0),
                "6553601 units of 2^-16 % for the fill valve",
            ),
            (answer(7, 0, u32::MAX), "for the vent valve is beyond 100 %"),
        ] {
            let error = plausible(&sensors, wrong).unwrap_err().to_string();
            assert!(error.contains(said), "{error}");
        }
    }
}
