//! Checkers that compare a recording with the requirement, independent of the code that made it. A bench log with the
//! same signals is judged in the same way.
//!
//! Signals: `p_ref`, `p_ch`, `duty_fill`, `duty_vent`. With `actuations_fill` and `actuations_vent` (counted from the
//! start) the number of valve movements is judged, too. With `p_ch_measured` the error of the sensor is
//! shown, with `x_plunger` the motion of the regulating valve.

mod check;
mod plunger;
mod sensor;
mod speed;
mod steps;
#[cfg(test)]
mod tests;
mod trajectory;
mod valves;
mod verdict;

pub use check::{Bound, Check, CheckId};
pub(crate) use plunger::PLUNGER;
pub use plunger::PlungerMotion;
pub use sensor::SensorError;
pub use steps::StepResponse;
pub use trajectory::JudgeError;
pub use valves::Actuations;
pub use verdict::{SCHEMA, Verdict};

use recording::Recording;

use crate::requirement::Requirement;
use trajectory::Trajectory;

/// Judges a recording by `requirement`.
///
/// # Errors
/// Returns an error if a signal is missing, has gaps or an uneven time base: data that was not logged cannot be judged.
pub fn judge(recording: &Recording, requirement: &Requirement) -> Result<Verdict, JudgeError> {
    let trajectory = Trajectory::of(recording)?;
    let steps = steps::responses(&trajectory, requirement);
    let of_steps = [
        steps::settling_time(&steps, requirement),
        steps::steady_error(&steps, requirement),
        steps::overshoot(&steps, requirement),
        steps::settling_time_beyond_operating_range(&steps, requirement),
    ];
    let of_valves = [
        valves::never_both(&trajectory, requirement),
        valves::duty_limits(&trajectory, requirement),
        valves::rest_actuations(&trajectory, &steps, requirement),
        valves::lifts(&trajectory, requirement),
    ];
    let checks: Vec<Check> = of_steps
        .into_iter()
        .chain(speed::fill_times(&trajectory, &steps, requirement))
        .chain(speed::vent_times(&trajectory, &steps, requirement))
        .chain(of_valves)
        .flatten()
        .collect();
    let plunger = plunger::motion(recording, &trajectory, &steps);
    let verdict = Verdict::new(
        recording,
        requirement,
        checks,
        steps,
        valves::actuations(&trajectory),
        sensor::sensor_error(recording, &trajectory),
    );
    Ok(Verdict { plunger, ..verdict })
}
