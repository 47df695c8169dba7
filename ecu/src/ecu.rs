//! One sample of the ECU.

use controller::{ControlSignal, Duty, Input, Pressure, State, step_traced};
use hil_protocol::{ResetCause, Telemetry, crc32};

use crate::config::EcuConfig;
use crate::fault::FaultSet;
use crate::input_output::{Inputs, Outputs};
use crate::mode::Mode;
use crate::sensor::PressureSensor;
use crate::settings::VentValve;

/// The logic between what an ECU measures and its two coils.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ecu {
    config: EcuConfig,
    controller: State,
    reset_cause: ResetCause,
    mode: Mode,
    faults: FaultSet,
    reference: Pressure,
    pressure: Pressure,
    u: ControlSignal,
}

impl Ecu {
    /// As after a reset with this cause.
    pub const fn new(config: EcuConfig, cause: ResetCause) -> Self {
        Self {
            config,
            controller: State::at_rest(),
            reset_cause: cause,
            mode: Mode::Running,
            faults: FaultSet::NONE,
            reference: Pressure::ZERO,
            pressure: Pressure::ZERO,
            u: ControlSignal::ZERO,
        }
    }

    /// One sample: call it once per sample time, and give the coils what it returns until the next call.
    pub fn sample(&mut self, inputs: &Inputs) -> Outputs {
        if let Some(reference) = inputs.reference {
            self.reference = reference;
        }
        if let Some(code) = inputs.pressure {
            self.pressure = PressureSensor::pressure(code);
        }
        let input = Input {
            reference: self.reference,
            pressure: self.pressure,
        };
        let (output, trace) = step_traced(&self.config.controller, &mut self.controller, input);
        self.u = trace.u;
        Outputs {
            duty_fill: output.duty_fill,
            duty_vent: match self.config.vent_valve {
                VentValve::NormallyClosed => output.duty_vent,
                VentValve::NormallyOpen => complement(output.duty_vent),
            },
        }
    }

    /// What the supervisor is doing.
    pub const fn mode(&self) -> Mode {
        self.mode
    }

    /// Faults that are present or latched.
    pub const fn faults(&self) -> FaultSet {
        self.faults
    }

    /// Why it was started.
    pub const fn reset_cause(&self) -> ResetCause {
        self.reset_cause
    }

    /// What the last sample left inside.
    pub fn telemetry(&self) -> Telemetry {
        Telemetry {
            control_signal: self.u.to_bits(),
            controller_state: self.controller.to_words(),
            mode: self.mode as u8,
            faults: self.faults.bits(),
            ecu_digest: crc32::values_digest(&[self.reference.to_bits(), self.pressure.to_bits()]),
        }
    }

    /// Other settings, whole, from the next sample on; the controller continues without a bump.
    pub fn retune(&mut self, config: EcuConfig) {
        let input = Input {
            reference: self.reference,
            pressure: self.pressure,
        };
        self.controller = State::taking_over(&config.controller, input, self.u);
        self.config = config;
    }
}

/// The rest of the period.
fn complement(duty: Duty) -> Duty {
    Duty::saturating_from_bits(Duty::FULL.to_bits().wrapping_sub(duty.to_bits()))
}
