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
/// sample and after the last one it rests. `None` if the log has no usable one, or the plant has no chamber.
///
/// # Errors
/// Returns an error if the plant needs the position, and the log has none, or one of another quantity or without a value, or one at which
/// the chamber has no volume.
pub(super) fn logged_position(
    parameters: &PlantParameters,
    log: &Recording,
    base: &TimeBase,
) -> Result<Option<Vec<f64>>, ReplayError> {
    if !Part::Chamber.is_in(parameters) {
        return Ok(None);
    }
    let effect = parameters.effect(EFFECT).filter(|effect| !effect.is_off());
    let samples = match (samples(log), effect) {
        (Ok(samples), effect) => {
            check_volume(
                parameters,
                effect.and_then(|effect| effect.get("area_m2")),
                &samples,
            )?;
            samples
        }
        (Err(ReplayError::MissingSignal(missing)), Some(_)) => {
            return Err(ReplayError::NoPosition(missing));
        }
        (Err(error), Some(_)) => return Err(error),
        (Err(_), None) => return Ok(None),
    };
    let times_s = base.times_s().iter();
    Ok(Some(times_s.map(|&time_s| at(&samples, time_s)).collect()))
}

/// Returns the samples of the position (s, m), averaged according to their noise; there is one.
fn samples(log: &Recording) -> Result<Vec<(f64, f64)>, ReplayError> {
    let signal = log.require(ACTUATOR_POSITION, Quantity::Length)?;
    let values = averaged(&signal.values_in(Unit::Metre)?, &POSITION);
    let own = log.time_base(signal.time_base());
    let times_s = own.ok_or(ReplayError::NoTimeBase)?.times_s().iter();
    let mut samples: Vec<(f64, f64)> = times_s.copied().zip(values).collect();
    samples.retain(|(_, position)| position.is_finite());
    match samples.is_empty() {
        true => Err(ReplayError::EmptyPosition),
        false => Ok(samples),
    }
}

/// Refuses samples at which an actuator of this area (m²) leaves the chamber no volume.
fn check_volume(
    parameters: &PlantParameters,
    area: Option<f64>,
    samples: &[(f64, f64)],
) -> Result<(), ReplayError> {
    let area = area.unwrap_or(0.0);
    let positions = samples.iter().map(|(_, position)| *position);
    let least = positions.min_by(|one, other| (area * one).total_cmp(&(area * other)));
    match least.filter(|position| parameters.chamber.volume_m3 + area * position <= 0.0) {
        Some(position) => Err(ReplayError::NoVolume { position, area }),
        None => Ok(()),
    }
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
