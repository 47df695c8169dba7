//! Events that end a step early, and their consequences.

use super::physics::{Physics, WithinStep};
use super::smooth::Smooth;
use super::solver::{SHORTEST_EVENT, Solver};
use super::span::{Span, first_of};
use crate::coil::{Drive, RestingCurrent};
use crate::plant::{FILL, VENT};
use crate::solver::root::first_positive;
use crate::valve::{Motion, ValveState};

/// Event that ended a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// A resting armature breaks away from its stop.
    BreaksAway(usize),
    /// A moving armature reaches a stop, or the position at which its orifice changes between curtain and bore (m).
    Reaches(usize, f64),
    /// A moving armature comes to a halt between the stops, where friction may keep it.
    Halts(usize),
    /// The current of a live valve has decayed to zero.
    CurrentDecayed(usize),
}

impl<P: Physics> Solver<P> {
    /// Returns the first resting armature that breaks away in (0, h], under a force that is known over time.
    pub(super) fn first_breakaway(
        &self,
        h: f64,
        force: impl Fn(usize, f64) -> f64,
    ) -> Option<(f64, usize)> {
        let breakaway = |index: usize| {
            if self.state.valves[index].motion == Motion::Moving {
                return None;
            }
            let force = |t: f64| force(index, t);
            let breaks_away = force(h) > 0.0;
            breaks_away.then(|| {
                (
                    first_positive(force, 0.0, h).max(SHORTEST_EVENT).min(h),
                    index,
                )
            })
        };
        match (breakaway(FILL), breakaway(VENT)) {
            (Some(fill), Some(vent)) => Some(if vent.0 < fill.0 { vent } else { fill }),
            (fill, vent) => fill.or(vent),
        }
    }

    /// Returns the earliest event within a step, with its time.
    pub(super) fn first_event<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        currents: &[RestingCurrent; 2],
    ) -> Option<(f64, Event)> {
        let h = span.h;
        let mut first: Option<(f64, Event)> = None;
        let mut offer = |time: f64, event: Event| {
            let time = time.max(SHORTEST_EVENT).min(h);
            if first.is_none_or(|(earliest, _)| time < earliest) {
                first = Some((time, event));
            }
        };

        let pressure = span.pressure();
        let force = |index: usize, t: f64| {
            self.physics.breakaway_force_within(
                index,
                &self.state.valves[index],
                WithinStep {
                    smooth,
                    span,
                    pressure: &pressure,
                    current: &currents[index],
                    time: t,
                },
            )
        };
        if let Some((time, index)) = self.first_breakaway(h, force) {
            offer(time, Event::BreaksAway(index));
        }
        for slot in 0..M {
            let index = smooth.live[slot];
            let direction = smooth.directions[slot];
            if direction != 0.0 {
                let [position, velocity] = [1, 2].map(|offset| first_of(slot) + offset);
                let plant = self.physics.plant();
                let [lowest, highest] = plant.valves[index].interval(smooth.limits[slot]);
                let (v0, v1) = (span.start[velocity], span.end[velocity]);
                // An armature that turns within the step may have been beyond a bound in between.
                let turns_up = v0 < 0.0 && v1 > 0.0;
                let turns_down = v0 > 0.0 && v1 < 0.0;
                if span.end[position] < lowest || turns_up {
                    let x = span.position(slot);
                    if let Some(time) = passage(|t| lowest - x.at(t), |t| x.rate_at(t), turns_up, h)
                    {
                        offer(time, Event::Reaches(index, lowest));
                    }
                }
                if span.end[position] > highest || turns_down {
                    let x = span.position(slot);
                    if let Some(time) =
                        passage(|t| x.at(t) - highest, |t| -x.rate_at(t), turns_down, h)
                    {
                        offer(time, Event::Reaches(index, highest));
                    }
                }
                if self.physics.has_friction() && direction * v1 < 0.0 {
                    let x = span.position(slot);
                    let time = first_positive(|t| -direction * x.rate_at(t), 0.0, h);
                    offer(time, Event::Halts(index));
                }
            }
            if let Some(time) = self.physics.time_of_zero_current(smooth, span, slot) {
                offer(time, Event::CurrentDecayed(index));
            }
        }
        first
    }

    pub(super) fn apply(&mut self, event: Event) {
        match event {
            Event::BreaksAway(index) => self.state.valves[index].motion = Motion::Moving,
            Event::CurrentDecayed(index) => {
                let valve = &mut self.state.valves[index];
                self.physics.after_current_ended(index, valve.drive);
                valve.current = 0.0;
                valve.drive = Drive::Blocked;
            }
            Event::Halts(index) => {
                let valve = &mut self.state.valves[index];
                valve.v = 0.0;
                // It is released at once if friction does not keep it in place.
                valve.motion = Motion::Stuck;
            }
            Event::Reaches(index, position) => {
                let parameters = &self.physics.plant().valves[index];
                let stroke = parameters.armature.stroke;
                if parameters.lift(position) <= 0.0 {
                    self.lifts[index].land();
                }
                let valve = &mut self.state.valves[index];
                valve.x = position;
                let stop = if position == 0.0 {
                    Motion::AtRestStop
                } else if position == stroke {
                    Motion::AtFullStroke
                } else {
                    return;
                };
                let arrived = ValveState {
                    motion: stop,
                    ..*valve
                };
                valve.v = self
                    .physics
                    .velocity_after_stop(index, &arrived, self.state.pressure);
                if valve.v == 0.0 {
                    valve.motion = stop;
                }
            }
        }
    }
}

/// Returns the time at which a moving armature passes a bound, if it does. `beyond` is positive outside, `retreat` is
/// the velocity away from the bound, and `turns` is true if `retreat` changes from negative to positive within the
/// step.
fn passage(
    beyond: impl Fn(f64) -> f64,
    retreat: impl Fn(f64) -> f64,
    turns: bool,
    h: f64,
) -> Option<f64> {
    let deepest = if turns {
        first_positive(retreat, 0.0, h)
    } else {
        h
    };
    if beyond(deepest) <= 0.0 {
        return None;
    }
    // The armature may have just left this bound; the search then begins at an instant at which it is inside.
    let halvings = (1..=6).map(|halvings| deepest / f64::from(1 << halvings));
    let inside = core::iter::once(0.0)
        .chain(halvings)
        .find(|&t| beyond(t) < 0.0);
    Some(inside.map_or(SHORTEST_EVENT, |lo| first_positive(beyond, lo, deepest)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solver::hermite::Quintic;

    /// x = v t - d t²: up and back through the seat within one step. Defect seen on a random plant: this event was
    /// missed.
    #[test]
    fn an_armature_that_rises_and_falls_back_within_a_step_arrives() {
        let x = Quintic::new(1.0, [0.1, 1.0, -4.0], [-0.9, -3.0, -4.0]);
        let time = passage(|t| -x.at(t), |t| x.rate_at(t), false, 1.0).unwrap();
        assert!((time - (1.0 + 1.8_f64.sqrt()) / 4.0).abs() < 1e-9, "{time}");
    }

    /// A touch between two states that are both inside the stroke.
    #[test]
    fn an_armature_that_dips_through_its_seat_within_a_step_arrives() {
        let x = Quintic::new(1.0, [0.1, -1.0, 4.0], [1.1, 3.0, 4.0]);
        let arrives = |start: f64| passage(|t| -(x.at(t) + start), |t| x.rate_at(t), true, 1.0);
        let time = arrives(0.0).unwrap();
        assert!(
            (time - (1.0 - 0.2_f64.sqrt()) / 4.0 * 1.0).abs() < 0.15 && x.at(time).abs() < 1e-9
        );
        assert_eq!(arrives(0.1), None, "it turns before the seat");
    }

    /// A hundredth of the step inside the bound. Defect seen: it was treated as a distance of zero, an error of 0.003
    /// mbar per pulse.
    #[test]
    fn an_armature_that_starts_just_inside_a_bound_arrives_in_its_time() {
        let x = Quintic::new(1.0, [0.01, -1.0, 0.0], [-0.99, -1.0, 0.0]);
        let time = passage(|t| -x.at(t), |t| x.rate_at(t), false, 1.0).unwrap();
        assert!((time - 0.01).abs() < 1e-9, "{time}");
    }

    /// Just left the stop (x = 0, v = 0): the start itself is not an arrival.
    #[test]
    fn an_armature_that_leaves_and_returns_arrives_once() {
        let x = Quintic::new(1.0, [0.0, 0.0, 1.0], [-0.5, -2.0, -5.0]);
        let time = passage(|t| -x.at(t), |t| x.rate_at(t), false, 1.0).unwrap();
        assert!(time > 0.3 && x.at(time).abs() < 1e-9, "{time}");
    }
}
