//! Filling and venting times: the two timed passages of section 1.4.

use super::check::{Bound, Check, CheckId};
use super::steps::{ROUNDING_BAR, StepResponse, place_of};
use super::trajectory::Trajectory;
use crate::requirement::{Reading, Requirement};

/// Share of the passage after which the pressure counts as moving.
const ONSET_SHARE: f64 = 0.05;

/// Passage from ambient pressure to 0.26 p_sup, or from 0.88 to 0.71 p_sup.
struct Passage {
    from_bar: f64,
    to_bar: f64,
    max_t_req: f64,
    /// Reading that binds.
    binding: Reading,
    words: &'static str,
}

impl Passage {
    fn fill(requirement: &Requirement) -> Self {
        Self {
            from_bar: 0.0,
            to_bar: requirement.psup(requirement.fill_to_psup),
            max_t_req: requirement.fill_max_t_req,
            binding: requirement.fill_reading,
            words: "filling from ambient pressure",
        }
    }

    fn vent(requirement: &Requirement) -> Self {
        Self {
            from_bar: requirement.psup(requirement.vent_from_psup),
            to_bar: requirement.psup(requirement.vent_to_psup),
            max_t_req: requirement.vent_max_t_req,
            binding: requirement.vent_reading,
            words: "venting",
        }
    }

    fn direction(&self) -> f64 {
        (self.to_bar - self.from_bar).signum()
    }

    /// Returns whether `step` leads from a reference at the passage's beginning through the whole of it. The pressure
    /// itself begins within P_tol of that reference.
    fn is_in(&self, step: &StepResponse, requirement: &Requirement) -> bool {
        let begins = (step.previous_bar - self.from_bar).abs() <= requirement.p_tol_bar;
        // A reference at the passage's end is rounded to 2⁻¹⁶ bar.
        begins && self.direction() * (step.to_bar - self.to_bar) >= -1e-4
    }

    /// Returns the end of the passage for `step`: its level, or P_tol before the reference if that comes first. A loop
    /// within P_tol of its reference need not come closer.
    fn end_bar(&self, step: &StepResponse, requirement: &Requirement) -> f64 {
        let tolerated = step.to_bar - self.direction() * requirement.p_tol_bar;
        if self.direction() > 0.0 {
            self.to_bar.min(tolerated)
        } else {
            self.to_bar.max(tolerated)
        }
    }
}

/// Duration of a passage (samples), and its dead time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Duration {
    /// Duration from the step of the reference.
    with_dead_time: f64,
    /// Duration from the first motion of the pressure, as in tables 4.3 and 4.4.
    without_dead_time: f64,
}

/// Checks the filling time by every reading.
pub(super) fn fill_times(
    trajectory: &Trajectory,
    steps: &[StepResponse],
    requirement: &Requirement,
) -> [Option<Check>; 4] {
    let ids = [
        CheckId::FillTime,
        CheckId::FillTimeWithDeadTime,
        CheckId::FillTimeToLevel,
        CheckId::FillTimeToLevelWithDeadTime,
    ];
    let passage = Passage::fill(requirement);
    times(ids, &passage, trajectory, steps, requirement)
}

/// Checks the venting time by every reading.
pub(super) fn vent_times(
    trajectory: &Trajectory,
    steps: &[StepResponse],
    requirement: &Requirement,
) -> [Option<Check>; 4] {
    let ids = [
        CheckId::VentTime,
        CheckId::VentTimeWithDeadTime,
        CheckId::VentTimeToLevel,
        CheckId::VentTimeToLevelWithDeadTime,
    ];
    let passage = Passage::vent(requirement);
    times(ids, &passage, trajectory, steps, requirement)
}

/// Checks a passage by every reading, under the ids in the order of [`Reading::ALL`].
fn times(
    ids: [CheckId; 4],
    passage: &Passage,
    trajectory: &Trajectory,
    steps: &[StepResponse],
    requirement: &Requirement,
) -> [Option<Check>; 4] {
    let mut readings = Reading::ALL.into_iter();
    ids.map(|id| {
        timed(
            id,
            readings.next()?,
            passage,
            trajectory,
            steps,
            requirement,
        )
    })
}

fn timed(
    id: CheckId,
    reading: Reading,
    passage: &Passage,
    trajectory: &Trajectory,
    steps: &[StepResponse],
    requirement: &Requirement,
) -> Option<Check> {
    let binding = reading == passage.binding;
    let samples = |step: &StepResponse| {
        let end_bar = match reading.to_level {
            true => passage.to_bar,
            false => passage.end_bar(step, requirement),
        };
        let duration = duration(passage, step, end_bar, trajectory)?;
        Some(match reading.with_dead_time {
            true => duration.with_dead_time,
            false => duration.without_dead_time,
        })
    };
    let (worst, reached) = steps
        .iter()
        .filter(|step| passage.is_in(step, requirement))
        .map(|step| (step, samples(step)))
        .max_by(|(_, a), (_, b)| {
            a.unwrap_or(f64::INFINITY)
                .total_cmp(&b.unwrap_or(f64::INFINITY))
        })?;
    let limit = passage.max_t_req * f64::from(requirement.t_req_samples);
    let begin = match reading.with_dead_time {
        true => "from the step of the reference, dead time included",
        false => "from the first motion of the pressure, as in table 4.3",
    };
    let end = match reading.to_level {
        true => "the level itself".to_owned(),
        false => format!(
            "{} bar before the reference, if that is earlier",
            requirement.p_tol_bar
        ),
    };
    Some(Check {
        id,
        requirement: format!(
            "{} to {:.3} bar takes less than {} T_req, counted {begin}, to {end}{}",
            passage.words,
            passage.to_bar,
            passage.max_t_req,
            requirement.cite("section 1.4")
        ),
        bound: Bound::LessThan,
        limit,
        reached,
        unit: "samples".to_owned(),
        holds: Bound::LessThan.allows(reached, limit),
        binding,
        evidence: place_of(worst),
    })
}

/// Returns the duration to `end_bar` (bar gauge); `None` if the pressure never gets there while the reference is
/// constant.
fn duration(
    passage: &Passage,
    step: &StepResponse,
    end_bar: f64,
    trajectory: &Trajectory,
) -> Option<Duration> {
    let last = (step.index + step.held_samples as usize).min(trajectory.len() - 1);
    let answer = &trajectory.pressure[step.index..=last];
    let distance = |pressure: f64| passage.direction() * (pressure - step.from_bar);
    let whole = distance(end_bar);
    let done = |share: f64| {
        answer
            .iter()
            .position(|&p| distance(p) >= share * whole - ROUNDING_BAR)
    };
    let arrival = done(1.0)?.max(1);
    let crossing = {
        let [before, after] = [answer[arrival - 1], answer[arrival]].map(distance);
        arrival as f64 - ((after - whole) / (after - before)).clamp(0.0, 1.0)
    };
    let onset = {
        // The line through the first two samples in motion, extended back to the pressure at rest.
        let first = done(ONSET_SHARE)?;
        let moved = distance(answer[first]);
        let rate = answer
            .get(first + 1)
            .map_or(moved, |&next| distance(next) - moved);
        first as f64 - (moved / rate).clamp(0.0, 1.0)
    };
    Some(Duration {
        with_dead_time: crossing,
        without_dead_time: crossing - onset,
    })
}
