//! One sample: the mechanisms in their order.

use core::mem;

use crate::anti_windup::is_driven;
use crate::arithmetic::reload_barrier;
use crate::config::{Coefficients, Config};
use crate::control_signal::ControlSignal;
use crate::direction::Direction;
use crate::input_output::{Input, Output};
use crate::pid::Pid;
use crate::prediction::{differentiated, predicted, switches_off};
use crate::pressure::{ERROR_SHIFT, Pressure};
use crate::state::{Sample, State};
use crate::structure::Structure;
use crate::trace::{Activity, Saturation, Trace};

/// Computes one sample of the controller: a pure function of configuration, state and input.
///
/// Call it once per sample time. Any input is allowed; pressures beyond the control range ([`Pressure::MIN_CONTROL`]
/// ..= [`Pressure::MAX_CONTROL`]) saturate at its ends.
///
/// [`FixedConfig::step`](crate::FixedConfig::step) gives the same bits at half the cost.
#[inline]
pub fn step(config: &Config, state: &mut State, input: Input) -> Output {
    sample(config.structure, &config.coefficients, state, input).0
}

/// Computes one sample as [`step`] does, and its trace. It is the same code: state and output are equal bit for bit.
#[inline]
pub fn step_traced(config: &Config, state: &mut State, input: Input) -> (Output, Trace) {
    sample(config.structure, &config.coefficients, state, input)
}

// Always inlined, so that the compiler removes the mechanisms that a constant structure does not have, and the
// computations that only the trace needs.
#[inline(always)]
pub(crate) fn sample(
    structure: Structure,
    config: &Coefficients,
    state: &mut State,
    input: Input,
) -> (Output, Trace) {
    let now = Sample::of(input);
    let before = mem::replace(&mut state.previous, now);
    // From here all values are counted along the direction of the error: filling and venting are one case.
    let direction = Direction::of(now.error);
    let error = direction.along(now.error);
    let error_change = direction.along(now.error.wrapping_sub(before.error));
    let pressure_change = direction.along(now.pressure.wrapping_sub(before.pressure));

    if direction != Direction::of(before.error) {
        state.integral = state.integral.negated();
        state.clear_at_reference(structure.integral_at_reference);
    }
    let shortfall = config.boost.shortfall(pressure_change);
    let predicted = predicted(structure, error, error_change, pressure_change);
    let predicted_error = Pressure::from_bits(direction.along(predicted >> ERROR_SHIFT));
    if config.tolerance.is_reached(error) {
        state.clear_at_reference(structure.integral_at_reference);
        let trace = Trace::off(state, predicted_error, Activity::InsideTolerance);
        return (Output::OFF, trace);
    }
    if switches_off(structure, config.tolerance, predicted) {
        let trace = Trace::off(state, predicted_error, Activity::SwitchedOffAhead);
        return (Output::OFF, trace);
    }

    // The two parts without memory come first, and each sum is next to its use: fewer live values mean fewer registers
    // to save.
    let error_change = differentiated(structure, error_change, pressure_change);
    // At most 960 + 10 + 10 times 100 % in 2⁻²⁰: below 2³⁰.
    let u = config.pid.proportional_and_derivative(error, error_change);
    let boosting = shortfall > 0;
    let boost = config.boost.advanced(state.boost, boosting, error);
    let u = u.wrapping_add(boost.part());
    let integral = config.pid.integrated(state.integral, error);
    let u = u.wrapping_add(Pid::integral_part(integral));

    let integrating = structure.anti_windup.settle(
        config.tracking,
        &config.pid,
        &mut state.integral,
        integral,
        u,
    );
    if !is_driven(u) {
        state.boost = boost;
    }
    // The direction is read again from the state, so that no register has to keep it until here.
    reload_barrier();
    let direction = state.direction();
    let (duty_fill, duty_vent) = config
        .distributor
        .duties(structure, direction, u, now.pressure);

    let signal = |along: i32| ControlSignal::from_units(direction.along(along));
    let trace = Trace {
        error: Pressure::from_bits(now.error >> ERROR_SHIFT),
        predicted_error,
        proportional: signal(config.pid.proportional(error)),
        derivative: signal(config.pid.derivative(error_change)),
        integral: signal(Pid::integral_part(integral)),
        boost: signal(boost.part()),
        u_unsaturated: signal(u),
        u: signal(u).saturated(),
        activity: Activity::Controlling,
        saturation: Saturation::of(signal(u)),
        integrating,
        boosting: boosting && !is_driven(u),
    };
    (
        Output {
            duty_fill,
            duty_vent,
        },
        trace,
    )
}
