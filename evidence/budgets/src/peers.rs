//! Published PID controllers of other authors, each called as its documentation states. They have no prediction, no
//! deadband and no distributor. Gains differ in meaning from crate to crate, and only the cost is compared.

use advanced_pid::{Pid as AdvancedPid, PidConfig, PidController};
use dsp_fixedpoint::Q;
use dsp_process::SplitProcess;
use idsp::iir::{Biquad, BiquadClamp, DirectForm1, DirectForm1Wide};
use pid::Pid;

/// Two integer bits and the sign: coefficients up to 4.
pub(crate) type FixedBiquad = BiquadClamp<Q<i32, i64, 29>, i32>;
pub(crate) type FloatBiquad = BiquadClamp<f32, f32>;

/// K (1 + T_s/T_i + T_d/T_s), -K (1 + 2 T_d/T_s), K T_d/T_s of the thesis' controller, relative to full scale instead
/// of percent; and the integrator's pole.
const COEFFICIENTS: [f32; 5] = [0.804, -1.2, 0.4, 1.0, 0.0];
/// Full scale of u, ±1 in 2⁻¹⁶.
const FULL: i32 = 1 << 16;

pub(crate) fn fixed_biquad() -> FixedBiquad {
    let mut biquad = FixedBiquad::from(Biquad {
        ba: COEFFICIENTS
            .map(|coefficient| Q::from_bits((coefficient * (1_u32 << 29) as f32) as i32)),
    });
    biquad.min = -FULL;
    biquad.max = FULL;
    biquad
}

pub(crate) fn float_biquad() -> FloatBiquad {
    let mut biquad = FloatBiquad::from(Biquad { ba: COEFFICIENTS });
    biquad.min = -1.0;
    biquad.max = 1.0;
    biquad
}

pub(crate) extern "C" fn idsp_fixed(
    biquad: &FixedBiquad,
    state: &mut DirectForm1<i32>,
    reference: i32,
    pressure: i32,
) -> i32 {
    biquad.process(state, reference.wrapping_sub(pressure))
}

pub(crate) extern "C" fn idsp_fixed_wide(
    biquad: &FixedBiquad,
    state: &mut DirectForm1Wide,
    reference: i32,
    pressure: i32,
) -> i32 {
    biquad.process(state, reference.wrapping_sub(pressure))
}

pub(crate) extern "C" fn idsp_float(
    biquad: &FloatBiquad,
    state: &mut DirectForm1<f32>,
    reference: f32,
    pressure: f32,
) -> f32 {
    biquad.process(state, reference - pressure)
}

pub(crate) fn pid() -> Pid<f32> {
    let mut pid = Pid::new(0.0, 100.0);
    pid.p(40.0, 1000.0).i(0.4, 100.0).d(40.0, 1000.0);
    pid
}

pub(crate) extern "C" fn pid_step(
    _: &(),
    pid: &mut Pid<f32>,
    reference: f32,
    pressure: f32,
) -> f32 {
    pid.setpoint(reference);
    pid.next_control_output(pressure).output
}

pub(crate) fn advanced_pid() -> AdvancedPid {
    AdvancedPid::new(PidConfig::new(40.0, 40.0, 0.4).with_limits(-100.0, 100.0))
}

/// Runs a step; the configuration is the sample time (s).
pub(crate) extern "C" fn advanced_pid_step(
    sample_time: &f32,
    pid: &mut AdvancedPid,
    reference: f32,
    pressure: f32,
) -> f32 {
    pid.update(reference, pressure, *sample_time)
}
