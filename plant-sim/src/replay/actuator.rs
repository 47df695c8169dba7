//! Logged position of the actuator that changes the volume of the chamber (E74).

use recording::{Quantity, Recording, TimeBase, Unit};

use super::averaging::{Input, averaged};
use super::error::ReplayError;
use crate::parameters::{Part, PlantParameters};

/// Name of the signal.
pub const ACTUATOR_POSITION: &str = "x_actuator";

/// Effect that needs the position.
const EFFECT: &str = "actuator_volume";
/// Position (m): an actuator that swings, a tenth of a period from sample to sample, has hardly any fourth differences.
const POSITION: Input = Input {
    differences: &[1.0, -4.0, 6.0, -4.0, 1.0],
    least_step: 1e-9,
};

/// Returns the position (m) at the rows of `base`, averaged according to its noise and interpolated between its samples; before the first
/// sample and after the last one it rests. `None` if the log has none, or the plant has no chamber.
///
/// # Errors
/// Returns an error for a signal of another quantity or without a value; if the plant needs the position and the log does not have it; or
/// if the chamber has no volume at a position.
pub(super) fn logged_position(
    parameters: &PlantParameters,
    log: &Recording,
    base: &TimeBase,
) -> Result<Option<Vec<f64>>, ReplayError> {
    let effect = parameters.effect(EFFECT).filter(|effect| !effect.is_off());
    if !Part::Chamber.is_in(parameters) || effect.is_none() && !log.mentions(ACTUATOR_POSITION) {
        return Ok(None);
    }
    let signal = log.require(ACTUATOR_POSITION, Quantity::Length)?;
    let values = signal.values_in(Unit::Metre)?;
    let values = averaged(&values, &POSITION);
    let own = log.time_base(signal.time_base());
    let times_s = own.ok_or(ReplayError::NoTimeBase)?.times_s().iter();
    let samples: Vec<(f64, f64)> = times_s.copied().zip(values).collect();
    let samples: Vec<_> = samples
        .into_iter()
        .filter(|one| one.1.is_finite())
        .collect();
    if samples.is_empty() {
        return Err(ReplayError::EmptyPosition);
    }
    if let Some(area) = effect.and_then(|effect| effect.get("area_m2")) {
        let smallest = |one: &f64, other: &f64| (area * one).total_cmp(&(area * other));
        let position = samples.iter().map(|one| one.1).min_by(smallest);
        let position = position.unwrap_or_default();
        if parameters.chamber.volume_m3 + area * position <= 0.0 {
            return Err(ReplayError::NoVolume { position, area });
        }
    }
    let times_s = base.times_s().iter();
    Ok(Some(times_s.map(|&time_s| at(&samples, time_s)).collect()))
}

/// Returns the value at a time (s) between samples (s, value), of which there is one.
fn at(samples: &[(f64, f64)], time_s: f64) -> f64 {
    let next = samples.partition_point(|one| one.0 < time_s);
    let (Some(&(from_s, from)), Some(&(to_s, to))) = (
        next.checked_sub(1).map(|before| &samples[before]),
        samples.get(next),
    ) else {
        return samples[next.min(samples.len() - 1)].1;
    };
    from + (to - from) * (time_s - from_s) / (to_s - from_s)
}
