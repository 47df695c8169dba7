//! A pressure that moved faster than any valve could move it.

use controller::Pressure;

use crate::config::Limits;
use crate::fault::Fault;

/// What is wrong with a pressure that cannot follow on the last one that was believed.
#[inline(always)]
pub(crate) fn jumped(
    limits: &Limits,
    believed: Option<Pressure>,
    pressure: Pressure,
) -> Option<Fault> {
    // Pressures of a sensor: 21 bits.
    let change = pressure.to_bits().wrapping_sub(believed?.to_bits());
    (change.wrapping_abs() > limits.jump).then_some(Fault::SensorJump)
}
