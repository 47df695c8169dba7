//! The same full step in C, in three styles, each compiled for speed and for size (`c/`, `build.rs`).

use controller::fixed::types::I16F16;
use controller::{Boost, LowerLimit, Settings};

use crate::callee::{self, FloatDuties};

/// `integer_parameters` (Q16.16) and `float_parameters` of `c/controller.h`, which defines their meaning.
#[repr(C)]
pub(crate) struct Parameters<T> {
    tolerance: T,
    gain: T,
    derivative_gain: T,
    integral_gain: T,
    sum_max: T,
    boost_rate: T,
    boost_max: T,
    boost_response: T,
    duty_min_fill: T,
    slope_fill: T,
    duty_min_vent: T,
    slope_vent: T,
}

/// `integer_state` and `float_state` of `c/controller.h`.
#[repr(C)]
#[derive(Default)]
pub(crate) struct State<T> {
    pressure: T,
    error: T,
    sum: T,
    boost: T,
}

type Integer = Parameters<i32>;
type Float = Parameters<f32>;

/// Full step in integers.
pub(crate) type IntegerStep = callee::IntegerStep<Integer, State<i32>>;
/// Full step in floats.
pub(crate) type FloatStep = callee::FloatStep<Float, State<f32>>;

macro_rules! declared {
    ($($name:ident($parameters:ty, $state:ty, $pressure:ty) -> $duties:ty;)*) => {
        unsafe extern "C" {
            $(pub(crate) safe fn $name(
                parameters: &$parameters,
                state: &mut $state,
                reference: $pressure,
                pressure: $pressure,
            ) -> $duties;)*
        }
    };
}

// Declared as in `c/controller.h` and the files beside it: the same structs in the same registers; none keeps a
// reference.
declared! {
    saturating_step_o2(Integer, State<i32>, i32) -> u64;
    saturating_step_os(Integer, State<i32>, i32) -> u64;
    tuned_step_o2(Integer, State<i32>, i32) -> u64;
    tuned_step_os(Integer, State<i32>, i32) -> u64;
    float_step_o2(Float, State<f32>, f32) -> FloatDuties;
    float_step_os(Float, State<f32>, f32) -> FloatDuties;
}

/// Parameters of the thesis' settings, computed in floating point like a C programmer would compute them by hand.
pub(crate) const FLOAT: Float = {
    const SETTINGS: Settings = Settings::thesis();
    let LowerLimit::Constant { fill_pct, vent_pct } = SETTINGS.duty_min else {
        panic!("the baselines have constant lower limits");
    };
    let (Some(boost), Some(integral_time), Some(derivative_time)) = (
        SETTINGS.boost,
        SETTINGS.integral_time_ms,
        SETTINGS.derivative_time_ms,
    ) else {
        panic!("the baselines have all of PID and the boost");
    };
    let Boost {
        rate_pct_per_bar_s,
        max_pct,
        response_bar,
    } = boost;
    let gain = real(SETTINGS.gain_pct_per_bar);
    let sample_time = real(SETTINGS.sample_time_ms);
    let integral_gain = gain * sample_time / real(integral_time);
    Parameters {
        tolerance: real(SETTINGS.tolerance_bar),
        gain,
        derivative_gain: gain * real(derivative_time) / sample_time,
        integral_gain,
        sum_max: real(SETTINGS.integral_max_pct) / integral_gain,
        boost_rate: real(rate_pct_per_bar_s) * sample_time / 1000.0,
        boost_max: real(max_pct),
        boost_response: real(response_bar),
        duty_min_fill: real(fill_pct),
        slope_fill: (real(SETTINGS.duty_max_fill_pct) - real(fill_pct)) / 100.0,
        duty_min_vent: real(vent_pct),
        slope_vent: (real(SETTINGS.duty_max_vent_pct) - real(vent_pct)) / 100.0,
    }
};

/// The same parameters in Q16.16.
pub(crate) const INTEGER: Integer = Parameters {
    tolerance: q16(FLOAT.tolerance),
    gain: q16(FLOAT.gain),
    derivative_gain: q16(FLOAT.derivative_gain),
    integral_gain: q16(FLOAT.integral_gain),
    sum_max: q16(FLOAT.sum_max),
    boost_rate: q16(FLOAT.boost_rate),
    boost_max: q16(FLOAT.boost_max),
    boost_response: q16(FLOAT.boost_response),
    duty_min_fill: q16(FLOAT.duty_min_fill),
    slope_fill: q16(FLOAT.slope_fill),
    duty_min_vent: q16(FLOAT.duty_min_vent),
    slope_vent: q16(FLOAT.slope_vent),
};

const fn real(setting: I16F16) -> f32 {
    setting.to_bits() as f32 / 65_536.0
}

const fn q16(real: f32) -> i32 {
    (real * 65_536.0 + 0.5) as i32
}
