//! Assignment of signals to columns that are compared with each other: the time, pressures and valves without a place,
//! and rivals.

use super::unit::{GuessedUnit, short};
use super::words::Meaning;
use super::words::Meaning as M;
use super::{DUTIES, Question, Reading, SIGNALS, Subject, TIME};
use crate::{Quantity, Unit};

/// Chooses the time among the columns, and its unit by the steps where the file states none.
pub(super) fn choose_time(columns: &[Subject<'_>], readings: &mut [Reading]) {
    let rank = |index: usize| {
        let reading = &readings[index];
        let values = columns[index].values;
        let is_named = reading.kind == Some(M::Time);
        let is_possible = values.count > 1 && values.increase && values.missing == 0;
        (is_possible && (is_named || reading.kind.is_none() && reading.question.is_none()))
            .then(|| (is_named, reading.unit.is_some(), columns.len() - index))
    };
    let best = (0..columns.len())
        .filter_map(|index| Some((rank(index)?, index)))
        .max();
    for (index, reading) in readings.iter_mut().enumerate() {
        let is_named = reading.kind == Some(M::Time);
        if is_named && best.is_none_or(|(_, chosen)| chosen != index) {
            reading.signal = None;
            let text = match columns[index].values.increase {
                true => "another column is the time",
                false => "named as the time, but it does not increase in every row",
            };
            reading.reasons.push(text.to_owned());
        }
    }
    let Some((_, index)) = best else { return };
    let reading = &mut readings[index];
    if reading.kind != Some(M::Time) {
        reading.reasons = vec!["increases in every row".to_owned()];
        reading.assumed.push("this column is the time".to_owned());
        reading.kind = Some(M::Time);
    }
    reading.signal = Some(TIME);
    let is_time =
        matches!(&reading.unit, Some(GuessedUnit::Unit(unit)) if unit.quantity() == Quantity::Time);
    if !is_time {
        let step = columns[index].values.mean_step().unwrap_or(1.0);
        let unit = match (columns[index].values.are_whole, step) {
            (true, 1000.0..) => Unit::Microsecond,
            (true, _) => Unit::Millisecond,
            (false, 0.5..) => Unit::Millisecond,
            (false, _) => Unit::Second,
        };
        let text = format!("{} because the mean step is {}", unit.token(), short(step));
        reading.assumed.push(text);
        reading.unit = Some(GuessedUnit::Unit(unit));
    }
}

/// Names pressures without a place: the one that changes is the chamber pressure, a steady one is that of the supply.
pub(super) fn name_pressures(columns: &[Subject<'_>], readings: &mut [Reading]) {
    let is_there =
        |readings: &[Reading], signal| readings.iter().any(|one| one.signal == Some(signal));
    let open: Vec<usize> = (0..readings.len())
        .filter(|&index| {
            let reading = &readings[index];
            reading.kind == Some(M::Pressure) && reading.signal.is_none()
        })
        .collect();
    match open[..] {
        [one] if !is_there(readings, "p_ch") => {
            readings[one].signal = Some("p_ch");
            readings[one]
                .reasons
                .push("the only pressure without a place".to_owned());
        }
        [one, two] if !is_there(readings, "p_ch") && !is_there(readings, "p_sup") => {
            let is_steady = |index: usize| {
                let values = columns[index].values;
                values.least > 0.5 * values.greatest
            };
            for (steady, other) in [(one, two), (two, one)] {
                if is_steady(steady) && !is_steady(other) {
                    readings[steady].signal = Some("p_sup");
                    readings[steady]
                        .assumed
                        .push("steady: the supply pressure".to_owned());
                    readings[other].signal = Some("p_ch");
                    readings[other]
                        .assumed
                        .push("it changes: the chamber pressure".to_owned());
                }
            }
        }
        _ => {}
    }
    let is_ready = is_there(readings, "p_ch");
    for &index in &open {
        if readings[index].signal.is_none() && !is_ready {
            readings[index].question = Some(Question::Rival("p_ch"));
        }
    }
    for &index in &open {
        if readings[index].signal.is_none() && is_ready {
            (readings[index].question, readings[index].unit) = (None, None);
        }
    }
}

/// Share of the range of the pressure by which it rises or falls while a valve is on, above which its direction is
/// clear.
const CLEAR_RISE: f64 = 0.2;

/// Names the valves of a column that commands both, by the direction in which the pressure goes at positive numbers.
/// It is not taken as a command if another column is named as that of one valve, or if there are several like it.
pub(super) fn name_pair(
    readings: &mut [Reading],
    pressure: Option<usize>,
    rise: &dyn Fn(usize, Option<usize>, usize) -> Option<f64>,
) {
    let is_named = |reading: &Reading| DUTIES.iter().any(|duty| reading.signal == Some(duty));
    let is_one_named = readings
        .iter()
        .any(|one| one.pair.is_none() && is_named(one));
    let pairs = readings.iter().filter(|one| one.pair.is_some()).count();
    for (index, reading) in readings.iter_mut().enumerate() {
        let Some(pair) = &mut reading.pair else {
            continue;
        };
        if is_one_named || pairs > 1 {
            (reading.kind, reading.signal, reading.unit) = (None, None, None);
            continue;
        }
        let share = pressure.and_then(|pressure| rise(index, None, pressure));
        match share.filter(|share| share.abs() >= CLEAR_RISE) {
            Some(share) if share < 0.0 => {
                pair.signals.reverse();
                reading
                    .reasons
                    .push("the pressure falls at positive numbers".to_owned());
            }
            Some(_) => reading
                .reasons
                .push("the pressure rises at positive numbers".to_owned()),
            None => reading.assumed.push("positive numbers fill".to_owned()),
        }
        reading.signal = Some(pair.signals[0]);
    }
}

/// Names columns of valves without a place by the direction in which the pressure goes while each is on.
pub(super) fn name_valves(
    readings: &mut [Reading],
    kind: Meaning,
    signals: [&'static str; 2],
    pressure: Option<usize>,
    rise: &dyn Fn(usize, Option<usize>, usize) -> Option<f64>,
) {
    let place_of =
        |readings: &[Reading], signal| readings.iter().position(|one| one.signal == Some(signal));
    let (named, unnamed): (Vec<usize>, Vec<usize>) = (0..readings.len())
        .filter(|&index| readings[index].kind == Some(kind) && readings[index].signal.is_none())
        .partition(|&index| readings[index].strength > 0);
    let open = if named.is_empty() { unnamed } else { named };
    let [fill, vent] = signals.map(|signal| place_of(readings, signal));
    let direction =
        |valve, other| rise(valve, other, pressure?).filter(|share| share.abs() >= CLEAR_RISE);
    let mut found: Vec<(usize, usize, &str)> = Vec::new();
    match (&open[..], fill, vent) {
        (&[one], None, Some(_)) => found.push((one, 0, "the other valve is named")),
        (&[one], Some(_), None) => found.push((one, 1, "the other valve is named")),
        (&[one], None, None) => match direction(one, None) {
            Some(share) if share > 0.0 => found.push((one, 0, RISES)),
            Some(_) => found.push((one, 1, FALLS)),
            None => {}
        },
        (&[one, two], None, None) => match (direction(one, Some(two)), direction(two, Some(one))) {
            (Some(first), Some(second)) if first > 0.0 && second < 0.0 => {
                found.extend([(one, 0, RISES), (two, 1, FALLS)]);
            }
            (Some(first), Some(second)) if first < 0.0 && second > 0.0 => {
                found.extend([(two, 0, RISES), (one, 1, FALLS)]);
            }
            _ => {}
        },
        _ => {}
    }
    for (index, signal, reason) in found {
        readings[index].signal = Some(signals[signal]);
        readings[index].reasons.push(reason.to_owned());
    }
    for index in open {
        if readings[index].signal.is_none() && (fill.is_none() || vent.is_none()) {
            readings[index].question = Some(Question::Valve);
        }
    }
}

const RISES: &str = "the pressure rises while it is on";
const FALLS: &str = "the pressure falls while it is on";

/// Leaves a signal to the column with the clearest name, or, of equals, opens a question.
pub(super) fn refuse_rivals(columns: &[Subject<'_>], readings: &mut [Reading]) {
    for signal in SIGNALS.iter().map(|&(signal, ..)| signal) {
        let rivals: Vec<usize> = (0..readings.len())
            .filter(|&index| readings[index].signal == Some(signal))
            .collect();
        let most = |key: &dyn Fn(usize) -> u64| rivals.iter().map(|&index| key(index)).max();
        let strength = |index: usize| u64::from(readings[index].strength);
        let clearest: Vec<usize> = rivals
            .iter()
            .copied()
            .filter(|&index| Some(strength(index)) == most(&strength))
            .collect();
        // Groups of one logger repeat a channel at several rates.
        let is_one_name = clearest
            .iter()
            .all(|&index| columns[index].header == columns[clearest[0]].header);
        let fastest = clearest
            .iter()
            .copied()
            .max_by_key(|&index| (columns[index].values.count, std::cmp::Reverse(index)));
        let chosen = fastest.filter(|_| clearest.len() == 1 || is_one_name);
        for index in rivals {
            if Some(index) == chosen {
                if clearest.len() > 1 {
                    readings[index]
                        .assumed
                        .push("the fastest of this name".to_owned());
                }
                continue;
            }
            let reading = &mut readings[index];
            reading.signal = None;
            reading.question = match chosen {
                Some(_) => {
                    reading.reasons.push(format!("another column is {signal}"));
                    None
                }
                None => Some(Question::Rival(signal)),
            };
        }
    }
}
