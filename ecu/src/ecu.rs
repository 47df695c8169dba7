//! One sample of the ECU.

use controller::{
    Activity, ControlSignal, Duty, Input, Output, Pressure, PulseConfig, PulseState, State,
    pulse_step, step_traced,
};
use hil_protocol::{ResetCause, Telemetry};

use crate::coil_resistance::CoilResistances;
use crate::config::EcuConfig;
use crate::detector::{Command, Detectors, Observation};
use crate::digest::digest;
use crate::duty_scales::DutyScales;
use crate::fault::FaultSet;
use crate::input_output::{Inputs, Outputs, safe_outputs};
#[cfg(any(test, feature = "fault-seeding"))]
use crate::mechanism::Damage;
use crate::mechanism::Mechanism;
use crate::mode::Mode;
use crate::settings::VentValve;
use crate::supervisor::{ReleaseRefused, Supervisor};
use crate::valve::Valves;

/// Logic between the measured inputs of an ECU and its two coils.
///
/// ```text
///  inputs ──► detectors ──► supervisor ──► controller ──► mode's valves ──► coils
///                 ▲         mode, faults   reference led   shut, vent only     │
///                 └───────────────── what valves and coils were command ◄─────────┘
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ecu {
    config: EcuConfig,
    /// Copy of the configuration, compared in every sample: no damaged number reaches a coil.
    copy: EcuConfig,
    reset_cause: ResetCause,
    state: EcuState,
}

/// State between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct EcuState {
    controller: State,
    pulses: PulseState,
    detectors: Detectors,
    supervisor: Supervisor,
    resistances: CoilResistances,
    /// Factors of the duty limits in this sample.
    scales: DutyScales,
    command: Command,
    /// Last plausible pressure.
    pressure: Pressure,
    /// Last reference that was passed to the controller.
    reference: Pressure,
    u: ControlSignal,
    /// Controller that was active in the last sample: another one takes over.
    active: Active,
}

/// Controller of a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum Active {
    None,
    Pid,
    Pulses,
}

impl Ecu {
    /// Creates an ECU as after a reset with this cause.
    pub const fn new(config: EcuConfig, cause: ResetCause) -> Self {
        Self {
            config,
            copy: config,
            reset_cause: cause,
            state: EcuState {
                controller: State::at_rest(),
                pulses: PulseState::at_rest(),
                detectors: Detectors::NEW,
                supervisor: Supervisor::NEW,
                resistances: CoilResistances::NEW,
                scales: DutyScales::ONE,
                command: Command {
                    valves: Valves::UNKNOWN,
                    opening: Output::OFF,
                },
                pressure: Pressure::ZERO,
                reference: Pressure::ZERO,
                u: ControlSignal::ZERO,
                active: Active::None,
            },
        }
    }

    /// Runs one sample: call it once per sample time, and apply the returned duty cycles until the next call.
    pub fn sample(&mut self, inputs: &Inputs) -> Outputs {
        let is_damaged = self.config != self.copy;
        let Self { config, state, .. } = self;
        let observation = state
            .detectors
            .sample(&config.limits, &state.command, inputs);
        if let Some(pressure) = observation.pressure {
            state.pressure = pressure;
        }
        state
            .supervisor
            .sample(config, &observation, state.pressure, is_damaged);
        state.scales = match config.controller.compensation() {
            Some(compensation) => {
                state
                    .resistances
                    .sample(compensation, &config.limits, inputs, observation.faults)
            }
            None => DutyScales::ONE,
        };
        let opening = state.opening_for(config, &observation);
        let outputs = match state.supervisor.mode() {
            Mode::Safe | Mode::Locked => safe_outputs(),
            _ => coils(opening, config.vent_valve),
        };
        state.remember(config, outputs);
        outputs
    }

    /// Returns the mode of the supervisor.
    pub const fn mode(&self) -> Mode {
        self.state.supervisor.mode()
    }

    /// Returns the faults that are confirmed, or were confirmed since the last entry into [`Mode::Running`].
    pub const fn faults(&self) -> FaultSet {
        self.state.supervisor.latched()
    }

    /// Returns the cause of the last reset.
    pub const fn reset_cause(&self) -> ResetCause {
        self.reset_cause
    }

    /// Returns the internal values after the last sample.
    pub fn telemetry(&self) -> Telemetry {
        Telemetry {
            control_signal: self.state.u.to_bits(),
            controller_state: self.state.controller.to_words(),
            mode: self.mode() as u8,
            faults: self.faults().bits(),
            ecu_digest: digest(&self.state),
        }
    }

    /// Releases [`Mode::Locked`] into [`Mode::Waiting`], on request of a person who knows the cause. The faults are
    /// cleared on entry into [`Mode::Running`].
    ///
    /// # Errors
    /// Returns the missing condition: no fault and the reference at zero, each for ten samples. After
    /// [`Fault::MemoryDamaged`](crate::Fault::MemoryDamaged) only a reset releases the lock.
    pub fn release(&mut self) -> Result<(), ReleaseRefused> {
        self.state.supervisor.release()
    }

    /// Damages the ECU, so that a test can check that the damage is detected.
    #[cfg(any(test, feature = "fault-seeding"))]
    pub fn damage(&mut self, damage: Damage) {
        match damage {
            Damage::Config => {
                self.config.vent_valve = match self.config.vent_valve {
                    VentValve::NormallyClosed => VentValve::NormallyOpen,
                    VentValve::NormallyOpen => VentValve::NormallyClosed,
                };
            }
            Damage::Supervisor => self.state.supervisor.damage(),
            Damage::Controller => {
                let mechanisms = &mut self.config.limits.mechanisms;
                *mechanisms = mechanisms.driving_both();
                self.copy = self.config;
            }
        }
    }

    /// Applies other settings, all at once, from the next sample on; the change is bumpless.
    pub fn retune(&mut self, config: EcuConfig) {
        let input = Input {
            reference: self.state.reference,
            pressure: self.state.pressure,
        };
        // Control signal of the old settings at constant pressure; the part of its change is computed anew in the next
        // sample.
        let state = self.state.controller;
        let (_, trace) = step_traced(&self.config.controller, &mut state.clone(), input);
        self.state.controller = if trace.activity == Activity::Controlling {
            let summed = state
                .integral()
                .percent()
                .wrapping_add(state.boost().percent());
            let percent = trace.proportional.percent().wrapping_add(summed);
            let u = ControlSignal::saturating_from_percent(percent);
            State::taking_over(&config.controller, input, u)
        } else {
            State::new(input)
        };
        self.config = config;
        self.copy = config;
    }
}

impl EcuState {
    /// Returns the valve openings of this sample.
    #[inline(always)]
    fn opening_for(&mut self, config: &EcuConfig, observation: &Observation) -> Output {
        let mode = self.supervisor.mode();
        let before = self.command.opening;
        self.u = ControlSignal::ZERO;
        let is_controlled = matches!(mode, Mode::Waiting | Mode::Running | Mode::Ramping);
        if !is_controlled {
            self.active = Active::None;
        }
        if mode == Mode::Venting && self.supervisor.vents_now() {
            return Output {
                duty_fill: Duty::OFF,
                duty_vent: Duty::FULL,
            };
        }
        let is_believed = observation.pressure.is_some() || !config.has(Mechanism::ShutOnDoubt);
        if !is_controlled || !is_believed {
            // Without a pressure none takes over; a controller that was active stays active.
            self.pulses.interrupt();
            return Output::OFF;
        }
        self.reference = self
            .supervisor
            .reference(observation.reference, self.pressure);
        let requested = match config.controller.pulses() {
            Some(pulses) if self.scales.allow_pulses(self.active != Active::Pid) => {
                self.pulsed(pulses)
            }
            _ => self.controlled(config),
        };
        let mut opening = if config.limits.mechanisms.drives_both() {
            BOTH
        } else {
            requested
        };
        if mode != Mode::Running {
            opening.duty_fill = Duty::OFF;
        }
        if !observation.reference_is_new && config.has(Mechanism::NoIncreaseWithoutReference) {
            opening.duty_fill = opening.duty_fill.min(before.duty_fill);
        }
        if opening != requested {
            self.pulses.interrupt();
        }
        let drives_both = !opening.duty_fill.is_off() && !opening.duty_vent.is_off();
        if drives_both && !config.drives_both && config.has(Mechanism::BothValvesInterlock) {
            self.supervisor.lock();
        }
        opening
    }

    /// Returns the valve openings that the PID controller requests.
    #[inline(always)]
    fn controlled(&mut self, config: &EcuConfig) -> Output {
        let takes_over = self.active != Active::Pid;
        self.active = Active::Pid;
        let input = Input {
            reference: self.reference,
            pressure: self.pressure,
        };
        if takes_over {
            self.controller = if config.has(Mechanism::BumplessTakeover) {
                State::new(input)
            } else {
                State::at_rest()
            };
        }
        let (output, trace) = step_traced(&config.controller, &mut self.controller, input);
        self.u = trace.u;
        self.compensated(config, output)
    }

    /// Returns the valve openings that the model-based pulses request.
    #[inline(always)]
    fn pulsed(&mut self, pulses: &PulseConfig) -> Output {
        let takes_over = self.active != Active::Pulses;
        self.active = Active::Pulses;
        let input = Input {
            reference: self.reference,
            pressure: self.pressure,
        };
        if takes_over {
            self.pulses = self.pulses.taking_over();
        }
        let slowness = self.resistances.slowness(self.scales);
        let output = pulse_step(pulses, &mut self.pulses, input, slowness);
        self.u = output.control_signal();
        output
    }

    /// Returns the valve openings whose coil currents are those of `output` at nominal voltage and resistance.
    #[inline(always)]
    fn compensated(&self, config: &EcuConfig, output: Output) -> Output {
        let DutyScales {
            fill,
            vent,
            release,
        } = self.scales;
        match config.vent_valve {
            VentValve::NormallyClosed => output.scaled(fill, vent),
            VentValve::NormallyOpen => Output {
                duty_fill: fill.duty(output.duty_fill),
                duty_vent: release.duty(output.duty_vent),
            },
        }
    }

    /// Stores the duty cycles that were applied to the coils.
    #[inline(always)]
    fn remember(&mut self, config: &EcuConfig, outputs: Outputs) {
        self.detectors.command(outputs);
        self.resistances.command(outputs);
        self.command.opening = opening(outputs, config.vent_valve);
        let open = config.limits.open_duties(config.vent_valve, self.scales);
        self.command.valves.record(open, self.command.opening);
    }
}

/// Both valves fully open: a healthy controller gives this output only if its settings allow it.
const BOTH: Output = Output {
    duty_fill: Duty::FULL,
    duty_vent: Duty::FULL,
};

/// Returns the duty cycles of the coils for these valve openings.
#[inline(always)]
fn coils(opening: Output, vent_valve: VentValve) -> Outputs {
    Outputs {
        duty_fill: opening.duty_fill,
        duty_vent: match vent_valve {
            VentValve::NormallyClosed => opening.duty_vent,
            VentValve::NormallyOpen => opening.duty_vent.complement(),
        },
    }
}

/// Returns the valve openings for these duty cycles of the coils.
#[inline(always)]
fn opening(outputs: Outputs, vent_valve: VentValve) -> Output {
    Output {
        duty_fill: outputs.duty_fill,
        duty_vent: match vent_valve {
            VentValve::NormallyClosed => outputs.duty_vent,
            VentValve::NormallyOpen => outputs.duty_vent.complement(),
        },
    }
}

#[cfg(test)]
mod tests {
    use core::hash::{Hash, Hasher};

    use super::*;
    use crate::digest::BYTES_MAX;
    use crate::settings::EcuSettings;

    struct Counted(usize);

    impl Hasher for Counted {
        fn write(&mut self, bytes: &[u8]) {
            self.0 += bytes.len();
        }

        fn finish(&self) -> u64 {
            self.0 as u64
        }
    }

    #[test]
    fn the_whole_state_has_room_in_the_digest() {
        let config = EcuConfig::new(&EcuSettings::bench()).unwrap();
        let mut counted = Counted(0);
        Ecu::new(config, ResetCause::PowerOn)
            .state
            .hash(&mut counted);
        assert!(
            counted.0 > 100 && counted.0 <= BYTES_MAX,
            "{} bytes",
            counted.0
        );
    }
}
