//! Controller with plausibility check of its input, for an ECU with its own supervisor.

use controller::{
    ControlSignal, FixedConfig, Input, Mechanisms, OtherMechanism, Output, Pressure, State,
};

use crate::config::{EcuConfig, Limits};
use crate::detector::PressureInput;
use crate::fault::FaultSet;
use crate::sensor::SensorCode;

/// Controller and plausibility check of the pressure, without supervisor: range, jump, stuck and missing codes.
///
/// [`Ecu`](crate::Ecu) has the complete logic; this is the part that has to fit into the fastest task.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct CheckedLoop {
    controller: State,
    input: PressureInput,
    opening: Output,
}

/// Part of an [`EcuConfig`] that the [`CheckedLoop`] needs, with the controller's mechanisms fixed at compile time.
pub struct CheckedLoopConfig<M> {
    controller: FixedConfig<M>,
    limits: Limits,
}

impl<M: Mechanisms> CheckedLoopConfig<M> {
    /// Creates the part of this configuration, if its controller has these mechanisms.
    ///
    /// # Errors
    /// Returns the first mechanism that differs from the compiled ones.
    pub const fn new(config: &EcuConfig) -> Result<Self, OtherMechanism> {
        match FixedConfig::new(config.controller) {
            Ok(controller) => Ok(Self {
                controller,
                limits: config.limits,
            }),
            Err(error) => Err(error),
        }
    }
}

/// Internal values after a sample of the [`CheckedLoop`], for a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct LoopTelemetry {
    /// Control signal u; 0 in a sample with an implausible pressure.
    pub control_signal: ControlSignal,
    /// State of the controller.
    pub controller_state: State,
    /// Confirmed faults of the pressure sensor.
    pub faults: FaultSet,
}

impl CheckedLoop {
    /// State after a reset.
    pub const NEW: Self = Self {
        controller: State::at_rest(),
        input: PressureInput::NEW,
        opening: Output::OFF,
    };

    /// Runs one sample; both valves are off if this sample's code is implausible.
    #[inline]
    pub fn sample<M: Mechanisms>(
        &mut self,
        config: &CheckedLoopConfig<M>,
        reference: Pressure,
        code: Option<SensorCode>,
    ) -> (Output, LoopTelemetry) {
        let CheckedLoopConfig { controller, limits } = config;
        let (output, control_signal) = match self.input.sample(limits, self.opening, code) {
            Some(pressure) => {
                let input = Input {
                    reference,
                    pressure,
                };
                let (output, trace) = controller.step_traced(&mut self.controller, input);
                (output, trace.u)
            }
            None => (Output::OFF, ControlSignal::ZERO),
        };
        self.opening = output;
        let telemetry = LoopTelemetry {
            control_signal,
            controller_state: self.controller,
            faults: self.input.faults(limits),
        };
        (output, telemetry)
    }
}

impl<M> Clone for CheckedLoopConfig<M> {
    fn clone(&self) -> Self {
        *self
    }
}

// Implemented by hand: derived implementations would require the same trait of `M`, which is only a name.
impl<M> Copy for CheckedLoopConfig<M> {}

impl<M> core::fmt::Debug for CheckedLoopConfig<M> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self { controller, limits } = self;
        f.debug_struct("CheckedLoopConfig")
            .field("controller", controller)
            .field("limits", limits)
            .finish()
    }
}
