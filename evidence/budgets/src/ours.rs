//! The project's own controller, out of line, as the bench calls every candidate: configuration, state, reference,
//! pressure.

use controller::{
    CoilSlowness, Config, Distributor, Duty, FixedConfig, Input, Mechanisms, Output, Prediction,
    Pressure, PulseConfig, PulseState, Settings, State, Trace, pulse_step, step,
};

/// Mechanisms of the thesis.
pub struct Thesis;

impl Mechanisms for Thesis {
    const SETTINGS: Settings = Settings::thesis();
}

/// Mechanisms recommended for a truck: pressure-dependent lower limits.
pub struct Recommended;

impl Mechanisms for Recommended {
    const SETTINGS: Settings = Settings::recommended();
}

/// PID controller with its anti-windup, and the fewest other mechanisms that the settings allow: the traditional
/// distributor.
pub struct PidAlone;

impl Mechanisms for PidAlone {
    const SETTINGS: Settings = Settings {
        prediction: Prediction::Off,
        boost: None,
        distributor: Distributor::Traditional,
        ..Settings::thesis()
    };
}

/// Returns these mechanisms with the numbers of their own settings, checked at compile time if used in a constant.
pub const fn fixed<M: Mechanisms>() -> FixedConfig<M> {
    let Ok(config) = Config::new(&M::SETTINGS) else {
        panic!("settings are out of bounds");
    };
    let Ok(fixed) = FixedConfig::new(config) else {
        panic!("settings choose other mechanisms than themselves");
    };
    fixed
}

/// Runs the full step: its mechanisms are fixed, its numbers in RAM.
#[inline(never)]
pub extern "C" fn full_step(
    config: &FixedConfig<Thesis>,
    state: &mut State,
    reference: i32,
    pressure: i32,
) -> u64 {
    duties(config.step(state, input(reference, pressure)))
}

/// Runs the full step with every setting in RAM.
pub extern "C" fn full_step_any(
    config: &Config,
    state: &mut State,
    reference: i32,
    pressure: i32,
) -> u64 {
    duties(step(config, state, input(reference, pressure)))
}

/// Runs the PID controller alone: its mechanisms are fixed, its numbers in RAM.
pub extern "C" fn pid_alone(
    config: &FixedConfig<PidAlone>,
    state: &mut State,
    reference: i32,
    pressure: i32,
) -> u64 {
    duties(config.step(state, input(reference, pressure)))
}

/// Model-based pulses for the nominal plant.
pub const PULSES: PulseConfig = {
    let Ok(config) = Config::new(&Settings::pulses()) else {
        panic!("settings are out of bounds");
    };
    let Some(pulses) = config.pulses() else {
        panic!("the settings have no pulses");
    };
    *pulses
};

/// Runs the model-based pulses, with every number in RAM.
pub extern "C" fn pulses(
    config: &PulseConfig,
    state: &mut PulseState,
    reference: i32,
    pressure: i32,
) -> u64 {
    let input = input(reference, pressure);
    duties(pulse_step(config, state, input, CoilSlowness::NOMINAL))
}

/// State of a controller, and its trace for the log.
pub struct Traced {
    /// State, used by the next sample.
    pub state: State,
    /// Trace of the last sample.
    pub trace: Option<Trace>,
}

impl Traced {
    /// State before the first sample.
    pub const fn at_rest() -> Self {
        Self {
            state: State::at_rest(),
            trace: None,
        }
    }
}

/// Runs the full step with its trace: its mechanisms are fixed, its numbers in RAM.
pub extern "C" fn traced_step(
    config: &FixedConfig<Recommended>,
    traced: &mut Traced,
    reference: i32,
    pressure: i32,
) -> u64 {
    let (output, trace) = config.step_traced(&mut traced.state, input(reference, pressure));
    traced.trace = Some(trace);
    duties(output)
}

fn input(reference: i32, pressure: i32) -> Input {
    Input {
        reference: Pressure::from_bits(reference),
        pressure: Pressure::from_bits(pressure),
    }
}

fn duties(output: Output) -> u64 {
    in_registers(output.duty_fill, output.duty_vent)
}

/// Packs fill and vent (2⁻¹⁶ %) as the calling convention of C returns them in two registers.
pub(crate) fn in_registers(fill: Duty, vent: Duty) -> u64 {
    let word = |duty: Duty| u64::from(duty.to_bits() as u32);
    word(fill) | word(vent) << 32
}

/// Unpacks the two registers of a step: fill, then vent (2⁻¹⁶ %).
pub const fn in_words(duties: u64) -> [i32; 2] {
    [duties as i32, (duties >> 32) as i32]
}
