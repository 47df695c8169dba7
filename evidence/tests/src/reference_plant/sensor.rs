//! Readings of the rig before noise: the anti-aliased pressure at the sample, and the mean currents.

use super::departures::SensorDepartures;
use super::state::*;

/// Time constant of the anti-alias filter (s).
const ANTI_ALIAS: f64 = 5e-5;
/// Gauge pressure with the largest deviation from a straight line (Pa).
const BOW_PRESSURE: f64 = 4e5;

/// Reading of one sample without noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// Chamber pressure as measured by the sensor (Pa gauge).
    pub pressure: f64,
    /// Rate of that pressure (Pa/s).
    pub pressure_rate: f64,
    /// Mean currents since the previous sample (A), fill and vent.
    pub currents: [f64; 2],
}

/// Computes the rates of the sensor's states; `seen` is the pressure at its port (Pa abs).
pub(super) fn rates(sensor: &SensorDepartures, seen: f64, state: &State, rate: &mut State) {
    rate[FILTERED] = (seen - state[FILTERED]) / ANTI_ALIAS;
    if sensor.lag_s > 0.0 {
        rate[LAGGED] = (state[FILTERED] - state[LAGGED]) / sensor.lag_s;
    }
    if sensor.second_lag_s > 0.0 {
        rate[LAGGED_AGAIN] = (state[LAGGED] - state[LAGGED_AGAIN]) / sensor.second_lag_s;
    }
}

/// Returns the index of the state that the sensor shows.
pub(super) fn shown(sensor: &SensorDepartures) -> usize {
    if sensor.second_lag_s > 0.0 {
        LAGGED_AGAIN
    } else if sensor.lag_s > 0.0 {
        LAGGED
    } else {
        FILTERED
    }
}

/// Returns the reading (Pa gauge) at the pressure `gauge` after the reading `before`: unchanged while the pressure is
/// within the play.
pub(super) fn played(sensor: &SensorDepartures, before: f64, gauge: f64) -> f64 {
    let half = 0.5 * sensor.play_pa;
    before.clamp(gauge - half, gauge + half)
}

/// Returns the reading (Pa gauge) with the other static faults of the sensor.
pub(super) fn distorted(sensor: &SensorDepartures, gauge: f64, time: f64) -> f64 {
    let mut reading = gauge + sensor.offset_pa;
    if sensor.warm_offset_pa != 0.0 {
        reading += sensor.warm_offset_pa * (1.0 - (-time / sensor.warm_s).exp());
    }
    if sensor.bow_pa != 0.0 {
        let share = gauge / BOW_PRESSURE;
        reading += sensor.bow_pa * share * (2.0 - share);
    }
    reading
}

/// Returns the disturbance of the current measurements (A).
pub(super) fn interference(sensor: &SensorDepartures, time: f64) -> f64 {
    if sensor.interference_a == 0.0 {
        return 0.0;
    }
    sensor.interference_a * (std::f64::consts::TAU * sensor.interference_hz * time).sin()
}
