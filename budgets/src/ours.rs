//! The project's own controller, out of line, as the bench calls every candidate: configuration, state, reference, pressure.

use controller::{Config, Input, Output, Pressure, State, Trace, step, step_traced};

use crate::trace::THESIS;

/// The full step, every setting in RAM.
pub extern "C" fn full_step(
    config: &Config,
    state: &mut State,
    reference: i32,
    pressure: i32,
) -> u64 {
    in_registers(step(config, state, input(reference, pressure)))
}

/// The full step with settings that the compiler knows.
pub extern "C" fn full_step_constant(
    _: &(),
    state: &mut State,
    reference: i32,
    pressure: i32,
) -> u64 {
    in_registers(step(&THESIS, state, input(reference, pressure)))
}

/// A controller's state, and the trace that it leaves for the log.
pub struct Traced {
    /// Goes on to the next sample.
    pub state: State,
    /// Of the last sample.
    pub trace: Option<Trace>,
}

impl Traced {
    /// Before the first sample.
    pub const fn at_rest() -> Self {
        Self {
            state: State::at_rest(),
            trace: None,
        }
    }
}

/// The full step with its trace, every setting in RAM.
pub extern "C" fn traced_step(
    config: &Config,
    traced: &mut Traced,
    reference: i32,
    pressure: i32,
) -> u64 {
    let (output, trace) = step_traced(config, &mut traced.state, input(reference, pressure));
    traced.trace = Some(trace);
    in_registers(output)
}

fn input(reference: i32, pressure: i32) -> Input {
    Input {
        reference: Pressure::from_bits(reference),
        pressure: Pressure::from_bits(pressure),
    }
}

/// Both duty cycles [2⁻¹⁶ %] as the calling convention of C returns them in two registers: fill, then vent.
fn in_registers(output: Output) -> u64 {
    let word = |bits: i32| u64::from(bits as u32);
    word(output.duty_fill.to_bits()) | word(output.duty_vent.to_bits()) << 32
}
