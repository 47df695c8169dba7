//! Devices under test: whatever answers to sensor codes with duty cycles.

use controller::{Config, ConfigError, Input, Pressure, Settings, State, step_traced};

use crate::sensor::PressureSensor;
use crate::wire::{Actuators, DutyCode, Sensors};

/// A controller somewhere: in this process, in an emulator, on a board.
///
/// ```text
/// plant -> sensor code, reference -> exchange -> duty cycles -> plant      once per sample
/// ```
pub trait DeviceUnderTest {
    /// What it is: kind, name, version; for the record of a run.
    fn identity(&self) -> String;

    /// Back to the state after power-on.
    ///
    /// # Errors
    /// The device cannot be reached.
    fn reset(&mut self) -> Result<(), DutError>;

    /// One sample.
    ///
    /// # Errors
    /// The device did not answer, or what it answered is no pair of duty cycles. The run ends then.
    fn exchange(&mut self, sensors: Sensors) -> Result<Actuators, DutError>;

    /// What the last sample left inside; none from a device that does not tell.
    fn telemetry(&self) -> Option<Telemetry>;
}

/// What a controller tells about its inside, to be logged and compared bit for bit. The plant never sees it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Telemetry {
    /// Control signal u \[%\], 2⁻¹² %.
    pub control_signal_bits: i32,
    /// The controller's state after the sample ([`State::to_words`]).
    pub state_words: [i32; State::WORDS],
}

impl Telemetry {
    /// Control signal u \[%\], exactly.
    pub fn control_signal_pct(&self) -> f64 {
        f64::from(self.control_signal_bits) / 4096.0
    }
}

/// Why a device gave no duty cycles.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DutError {
    /// Silence.
    #[error(
        "no answer to sample {sample} within {waited_ms} ms: is the device powered, connected and running?"
    )]
    NoAnswer {
        /// Sample that was sent.
        sample: u32,
        /// How long was waited \[ms\].
        waited_ms: u32,
    },
    /// An answer to another sample.
    #[error(
        "the answer to sample {expected} carries number {found}: one was lost or repeated on the way"
    )]
    OtherSample {
        /// Sample that was sent.
        expected: u32,
        /// Sample that was answered.
        found: u32,
    },
    /// A duty cycle that no PWM can give.
    #[error(
        "sample {sample}: {bits} units of 2^-16 % for the {valve} valve is beyond 100 % (6553600 units)"
    )]
    ImpossibleDuty {
        /// Sample that was answered.
        sample: u32,
        /// `fill` or `vent`.
        valve: &'static str,
        /// What was answered.
        bits: u32,
    },
}

/// The controller crate in this process.
#[derive(Clone, Debug)]
pub struct InProcess {
    config: Config,
    state: State,
    telemetry: Option<Telemetry>,
}

impl InProcess {
    /// A controller with these settings, as after power-on.
    ///
    /// # Errors
    /// The settings are out of bounds.
    pub fn new(settings: &Settings) -> Result<Self, ConfigError> {
        Ok(Self {
            config: Config::new(settings)?,
            state: State::at_rest(),
            telemetry: None,
        })
    }
}

impl DeviceUnderTest for InProcess {
    fn identity(&self) -> String {
        concat!("controller ", env!("CARGO_PKG_VERSION"), " in process").to_owned()
    }

    fn reset(&mut self) -> Result<(), DutError> {
        self.state = State::at_rest();
        self.telemetry = None;
        Ok(())
    }

    fn exchange(&mut self, sensors: Sensors) -> Result<Actuators, DutError> {
        let input = Input {
            reference: Pressure::from_bits(sensors.reference.bits()),
            pressure: PressureSensor::pressure(sensors.pressure),
        };
        let (output, trace) = step_traced(&self.config, &mut self.state, input);
        self.telemetry = Some(Telemetry {
            control_signal_bits: trace.u.to_bits(),
            state_words: self.state.to_words(),
        });
        let duty = |valve, duty: controller::Duty| {
            let bits = duty.to_bits().unsigned_abs();
            DutyCode::from_bits(bits).ok_or(DutError::ImpossibleDuty {
                sample: sensors.sample,
                valve,
                bits,
            })
        };
        Ok(Actuators {
            duty_fill: duty("fill", output.duty_fill)?,
            duty_vent: duty("vent", output.duty_vent)?,
        })
    }

    fn telemetry(&self) -> Option<Telemetry> {
        self.telemetry
    }
}
