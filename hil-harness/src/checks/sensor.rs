//! Error of the pressure sensor, apart from the requirements on the true pressure.

use recording::{Quantity, Recording, Unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::trajectory::Trajectory;

/// Measured minus true chamber pressure. The requirements are judged by the true pressure, so this error is a part of
/// the loop's error that no controller can correct.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SensorError {
    /// Mean (bar): an offset.
    pub mean_bar: f64,
    /// Root mean square (bar).
    pub rms_bar: f64,
    /// Largest magnitude (bar).
    pub largest_bar: f64,
}

/// Returns the error over all samples with a measured pressure; `None` if no such signal was recorded.
pub(super) fn sensor_error(recording: &Recording, trajectory: &Trajectory) -> Option<SensorError> {
    let measured = recording
        .require("p_ch_measured", Quantity::Pressure)
        .ok()?;
    let truth = recording.require("p_ch", Quantity::Pressure).ok()?;
    if measured.time_base() != truth.time_base() {
        return None;
    }
    let measured = measured.values_in(Unit::BarGauge).ok()?;
    let errors: Vec<f64> = measured
        .iter()
        .zip(&trajectory.pressure)
        .map(|(measured, truth)| measured - truth)
        .filter(|error| error.is_finite())
        .collect();
    if errors.is_empty() {
        return None;
    }
    let mean_of = |value: fn(f64) -> f64| {
        errors.iter().map(|&error| value(error)).sum::<f64>() / errors.len() as f64
    };
    Some(SensorError {
        mean_bar: mean_of(|error| error),
        rms_bar: mean_of(|error| error * error).sqrt(),
        largest_bar: errors
            .iter()
            .fold(0.0, |largest, error| error.abs().max(largest)),
    })
}
