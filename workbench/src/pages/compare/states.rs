//! Commanded states of the valves as time intervals, from the duty cycles of a log.

use plant_sim::PlantParameters;
use plant_sim::plant::{FILL, VENT};
use recording::{Quantity, Recording, TimeBase};
use serde::Serialize;

use crate::pages::points::{Range, gap_s};
use crate::refusal::Refusal;

/// Largest number of intervals in a view; beyond it, each part of the view gets the state with the longest time in it.
const SEGMENTS_MAX: usize = 500;

/// State commanded by both duty cycles.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum State {
    /// Only the fill valve is open.
    Filling,
    /// Only the vent valve is open.
    Venting,
    Both,
    Shut,
}

impl State {
    const ALL: [Self; 4] = [Self::Filling, Self::Venting, Self::Both, Self::Shut];

    /// Returns the state that two duty cycles command, with those that shut the valves.
    fn of(duties: [f64; 2], shut: [f64; 2]) -> Option<Self> {
        if duties.into_iter().any(f64::is_nan) {
            return None;
        }
        Some(
            match (duties[FILL] != shut[FILL], duties[VENT] != shut[VENT]) {
                (true, false) => Self::Filling,
                (false, true) => Self::Venting,
                (true, true) => Self::Both,
                (false, false) => Self::Shut,
            },
        )
    }
}

/// Interval with one state.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(super) struct Segment {
    state: State,
    from_s: f64,
    to_s: f64,
}

impl Segment {
    /// Appends an interval, joined with the previous one if both have the same state without a break.
    fn append(self, segments: &mut Vec<Self>) {
        match segments.last_mut() {
            Some(last) if last.state == self.state && last.to_s >= self.from_s => {
                last.to_s = self.to_s;
            }
            _ => segments.push(self),
        }
    }
}

/// Returns the states of the valves of `plant` in `range`; empty if the log does not have both duty cycles on one time base.
pub(super) fn segments(
    log: &Recording,
    plant: &PlantParameters,
    range: Range,
) -> Result<Vec<Segment>, Refusal> {
    let duty = |name| log.require(name, Quantity::DutyCycle).ok();
    let Some((fill, vent)) = duty("duty_fill").zip(duty("duty_vent")) else {
        return Ok(Vec::new());
    };
    let base = log.time_base(fill.time_base());
    let Some(base) = base.filter(|_| fill.time_base() == vent.time_base()) else {
        return Ok(Vec::new());
    };
    let (within, view_s) = range.of(base)?;
    let duties = [fill.values_or_nan(), vent.values_or_nan()];
    // An orifice that nothing shuts counts as open.
    let shut = plant
        .functions
        .map(|function| function.shut_duty_pct().unwrap_or(f64::NAN));
    // A command applies until the next one: one from before the view is still in effect.
    let all = held(
        base,
        duties,
        shut,
        within.start.saturating_sub(1)..within.end,
    );
    if all.len() <= SEGMENTS_MAX {
        return Ok(all);
    }
    let view_s = (view_s.0.max(base.start_s()), view_s.1.min(base.end_s()));
    Ok(longest_in_each_piece(&all, view_s))
}

/// Returns the state that each sample commands until the next one; during a pause of the log there is none.
fn held(
    base: &TimeBase,
    duties: [&[f64]; 2],
    shut: [f64; 2],
    rows: std::ops::Range<usize>,
) -> Vec<Segment> {
    let gap_s = gap_s(base);
    let times_s = base.times_s();
    let mut segments = Vec::new();
    for row in rows {
        let (from_s, Some(&to_s)) = (times_s[row], times_s.get(row + 1)) else {
            break;
        };
        let state = State::of(duties.map(|duties| duties[row]), shut);
        if let Some(state) = state.filter(|_| to_s - from_s <= gap_s) {
            let segment = Segment {
                state,
                from_s,
                to_s,
            };
            segment.append(&mut segments);
        }
    }
    segments
}

/// Returns at most the allowed number of intervals: in each part of the view the state with the longest time.
fn longest_in_each_piece(all: &[Segment], (from_s, to_s): (f64, f64)) -> Vec<Segment> {
    let piece_s = (to_s - from_s) / SEGMENTS_MAX as f64;
    let mut shown = Vec::new();
    let mut rest = all;
    for piece in 0..SEGMENTS_MAX {
        // The end of a part equals the begin of the next bit by bit.
        let [begin_s, end_s] = [piece, piece + 1].map(|edge| from_s + edge as f64 * piece_s);
        let gone = rest.partition_point(|segment| segment.to_s <= begin_s);
        rest = &rest[gone..];
        let here = rest.iter().take_while(|segment| segment.from_s < end_s);
        let mut lasts_s = [0.0; State::ALL.len()];
        for segment in here {
            lasts_s[segment.state as usize] +=
                segment.to_s.min(end_s) - segment.from_s.max(begin_s);
        }
        let longest = State::ALL
            .into_iter()
            .max_by(|&one, &other| lasts_s[one as usize].total_cmp(&lasts_s[other as usize]));
        let longest = longest.filter(|&state| lasts_s[state as usize] > 0.0);
        if let Some(state) = longest {
            let segment = Segment {
                state,
                from_s: begin_s,
                to_s: end_s,
            };
            segment.append(&mut shown);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use plant_sim::valve::ValveFunction;
    use recording::{Provenance, Unit};

    use super::*;

    fn log(times_s: Vec<f64>, fill: Vec<f64>, vent: Vec<f64>) -> Recording {
        let mut log = Recording::new(Provenance::from_source("bench"));
        let id = log.add_time_base(TimeBase::new(times_s).unwrap());
        log.add_signal("duty_fill", Unit::Percent, id, fill)
            .unwrap();
        log.add_signal("duty_vent", Unit::Percent, id, vent)
            .unwrap();
        log
    }

    fn all() -> Range {
        Range {
            from_s: None,
            to_s: None,
        }
    }

    #[test]
    fn each_command_holds_until_the_next_and_a_gap_has_no_state() {
        let times_s = (0..8).map(f64::from).chain([100.0, 101.0]).collect();
        let fill = [0.0, 30.0, 30.0, 0.0, 10.0, f64::NAN, 0.0, 0.0, 5.0, 5.0].to_vec();
        let vent = [0.0, 0.0, 0.0, 50.0, 10.0, 0.0, 0.0, 0.0, 0.0, 0.0].to_vec();
        // The pause of 93 s is longer than five mean steps.
        let found = segments(
            &log(times_s, fill, vent),
            &PlantParameters::nominal(),
            all(),
        )
        .unwrap();
        let segment = |state, from_s, to_s| Segment {
            state,
            from_s,
            to_s,
        };
        assert_eq!(
            found,
            [
                segment(State::Shut, 0.0, 1.0),
                segment(State::Filling, 1.0, 3.0),
                segment(State::Venting, 3.0, 4.0),
                segment(State::Both, 4.0, 5.0),
                segment(State::Shut, 6.0, 7.0),
                segment(State::Filling, 100.0, 101.0),
            ]
        );
    }

    #[test]
    fn what_changes_more_often_than_can_be_seen_is_what_it_is_for_longest() {
        let count = 40_000;
        let times_s = (0..count).map(|row| f64::from(row) * 0.01).collect();
        let pulse = |row: i32| if row % 4 == 0 { 50.0 } else { 0.0 };
        let second_half = |row: i32| if row >= count / 2 { 20.0 } else { 0.0 };
        let fill = (0..count).map(pulse).collect();
        let vent = (0..count).map(second_half).collect();
        let log = log(times_s, fill, vent);
        let found = segments(&log, &PlantParameters::nominal(), all()).unwrap();
        let states: Vec<State> = found.iter().map(|segment| segment.state).collect();
        assert_eq!(states, [State::Shut, State::Venting]);
        assert!((found[0].to_s - 200.0).abs() < 1.0);
        // In a short view, each pulse is shown.
        let near = Range {
            from_s: Some(10.0),
            to_s: Some(10.2),
        };
        let found = segments(&log, &PlantParameters::nominal(), near).unwrap();
        assert!(found.iter().any(|segment| segment.state == State::Filling));
    }

    /// Defect seen: a normally open vent valve under current was shown as venting.
    #[test]
    fn a_normally_open_vent_valve_is_shut_by_full_duty() {
        let mut plant = PlantParameters::nominal();
        plant.functions[VENT] = ValveFunction::NormallyOpen;
        let (times_s, fill) = (vec![0.0, 1.0, 2.0, 3.0], vec![0.0, 0.0, 60.0, 0.0]);
        let log = log(times_s, fill, vec![0.0, 100.0, 100.0, 0.0]);
        let found = segments(&log, &plant, all()).unwrap();
        let states: Vec<State> = found.iter().map(|segment| segment.state).collect();
        assert_eq!(states, [State::Venting, State::Shut, State::Filling]);
    }

    #[test]
    fn without_commands_there_are_no_states() {
        let mut log = Recording::new(Provenance::from_source("bench"));
        let id = log.add_time_base(TimeBase::new(vec![0.0, 1.0]).unwrap());
        log.add_signal("p_ch", Unit::BarGauge, id, vec![1.0, 2.0])
            .unwrap();
        assert_eq!(
            segments(&log, &PlantParameters::nominal(), all()).unwrap(),
            []
        );
    }
}
