//! One sample: the mechanisms in their order.

use crate::arithmetic::{differ_in_sign, high_word_towards_zero};
use crate::config::Config;
use crate::control_signal::ControlSignal;
use crate::input_output::{Input, Output};
use crate::integrator::Integrator;
use crate::pressure::Pressure;
use crate::state::{Sample, State};
use crate::trace::{Activity, Saturation, Trace};

/// One sample of the controller: a pure function of configuration, state and input.
///
/// Call it once per sample time. Any input is allowed; pressures beyond the control range
/// ([`Pressure::MIN_CONTROL`] ..= [`Pressure::MAX_CONTROL`]) are taken as its ends.
#[inline]
pub fn step(config: &Config, state: &mut State, input: Input) -> Output {
    sample(config, state, input).0
}

/// [`step`], and how it came to its output. The same code: state and output are equal bit for bit.
#[inline]
pub fn step_traced(config: &Config, state: &mut State, input: Input) -> (Output, Trace) {
    sample(config, state, input)
}

// Always inlined, so that in `step` the compiler drops what only the trace needs.
#[inline(always)]
fn sample(config: &Config, state: &mut State, input: Input) -> (Output, Trace) {
    let now = Sample::of(input);
    let before = state.previous;
    state.previous = now;
    let Sample { pressure, error } = now;
    // Differences of values of 21 and 22 bits.
    let pressure_change = pressure.wrapping_sub(before.pressure);
    let error_change = error.wrapping_sub(before.error);

    let inside = config.tolerance.holds(error);
    if inside || differ_in_sign(error, before.error) {
        state.boost = Integrator::ZERO;
        if config.clears_integral {
            state.integral = Integrator::ZERO;
        }
    }

    let predicted = config
        .prediction
        .predicted(error, error_change, pressure_change);
    if inside
        || config
            .prediction
            .switches_off(config.tolerance, error, predicted)
    {
        let activity = if inside {
            Activity::InsideTolerance
        } else {
            Activity::SwitchedOffAhead
        };
        return (Output::OFF, Trace::off(now, predicted, activity, state));
    }

    let proportional = config.pid.proportional(error);
    let derivative = config.pid.derivative(error_change);
    let integral = config.pid.integrated(state.integral, error);
    let boosting = config.boost.is_needed(error, pressure_change);
    let boost = if boosting {
        config.boost.advanced(state.boost, error)
    } else {
        state.boost
    };

    // At most 32 000 + 64 000 + 1000 + 1000 % in 2⁻⁴⁴ %: below 2⁶¹.
    let sum = proportional
        .wrapping_add(derivative)
        .wrapping_add(integral.bits())
        .wrapping_add(boost.bits());
    let unsaturated = ControlSignal::from_bits(high_word_towards_zero(sum));
    let u = unsaturated.saturated();

    // Both below 2³⁰.
    let excess = unsaturated.to_bits().wrapping_sub(u.to_bits());
    let driven = excess != 0 && !differ_in_sign(excess, error);
    state.integral =
        config
            .anti_windup
            .settled(&config.pid, state.integral, integral, excess, driven);
    if !driven {
        state.boost = boost;
    }

    let (duty_fill, duty_vent) = config.distributor.duties(u, pressure);
    let trace = Trace {
        error: Pressure::from_bits(error),
        predicted_error: Pressure::from_bits(predicted),
        proportional: ControlSignal::from_bits(high_word_towards_zero(proportional)),
        derivative: ControlSignal::from_bits(high_word_towards_zero(derivative)),
        integral: integral.part(),
        boost: boost.part(),
        u_unsaturated: unsaturated,
        u,
        activity: Activity::Controlling,
        saturation: Saturation::of(excess),
        integrating: state.integral == integral,
        boosting: boosting && !driven,
    };
    (
        Output {
            duty_fill,
            duty_vent,
        },
        trace,
    )
}
