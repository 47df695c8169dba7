//! The controller behind the plausibility of its input, for an ECU with a supervisor of its own.

use controller::{Input, Output, Pressure, State, step_traced};

use crate::config::EcuConfig;
use crate::detector::PressureInput;
use crate::fault::FaultSet;
use crate::sensor::SensorCode;

/// Controller and plausibility of the pressure, without supervisor: range, jump, stuck and missing codes.
///
/// [`Ecu`](crate::Ecu) has all of it; this is the part that has to fit into the fastest task.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct CheckedLoop {
    controller: State,
    input: PressureInput,
    opening: Output,
}

/// What a sample of the [`CheckedLoop`] left, for a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LoopTelemetry {
    /// Control signal u [2⁻¹² %]; 0 in a sample whose pressure was not believed.
    pub control_signal: i32,
    /// The controller's state.
    pub controller_state: [i32; State::WORDS],
    /// The confirmed faults of the pressure sensor.
    pub faults: FaultSet,
}

impl CheckedLoop {
    /// As after a reset.
    pub const NEW: Self = Self {
        controller: State::at_rest(),
        input: PressureInput::NEW,
        opening: Output::OFF,
    };

    /// One sample; both valves are off if this sample's code cannot be believed.
    #[inline]
    pub fn sample(
        &mut self,
        config: &EcuConfig,
        reference: Pressure,
        code: Option<SensorCode>,
    ) -> (Output, LoopTelemetry) {
        let (output, control_signal) = match self.input.sample(config, self.opening, code) {
            Some(pressure) => {
                let input = Input {
                    reference,
                    pressure,
                };
                let (output, trace) = step_traced(&config.controller, &mut self.controller, input);
                (output, trace.u.to_bits())
            }
            None => (Output::OFF, 0),
        };
        self.opening = output;
        let telemetry = LoopTelemetry {
            control_signal,
            controller_state: self.controller.to_words(),
            faults: self.input.faults(config),
        };
        (output, telemetry)
    }
}
