//! Guess of signal and unit of a column from its name, its unit and its values. Each guess has a reason, and none is
//! used before a person has seen it.

mod unit;
mod words;

use crate::values::ColumnValues;
use crate::{PressureReference, Quantity, Unit};

use unit::{short, split, suggested_reference, unit_of};
use words::{Meaning, Meaning as M, is_kind, kind_name, named, words};

pub(crate) use unit::GuessedUnit;

/// Name of the time in a guess.
pub(crate) const TIME: &str = "time";

/// Signals of the model that a guess can name: kind, and the places of which the name of a column states one. The first
/// that fits is the guess.
#[rustfmt::skip]
const SIGNALS: &[(&str, Meaning, &[Meaning])] = &[
    ("duty_fill", M::Duty, &[M::Fill, M::Inlet, M::Supply]),
    ("duty_vent", M::Duty, &[M::Vent]),
    ("i_fill", M::Current, &[M::Fill, M::Inlet]),
    ("i_vent", M::Current, &[M::Vent]),
    ("p_ref", M::Pressure, &[M::Reference]),
    ("p_sup", M::Pressure, &[M::Supply, M::Inlet]),
    ("p_amb", M::Pressure, &[M::Ambient]),
    ("p_ch", M::Pressure, &[M::Chamber]),
    ("u_bat", M::Voltage, &[M::Battery, M::Supply]),
    ("t_amb", M::Temperature, &[M::Ambient]),
    ("t_coil", M::Temperature, &[M::Coil]),
    ("t_gas", M::Temperature, &[M::Gas, M::Chamber]),
    ("x_fill", M::Position, &[M::Fill, M::Inlet]),
    ("x_vent", M::Position, &[M::Vent]),
];

/// Highest numbers of counters of PWM hardware, each of which is 100 %.
const FULL_COUNTS: [f64; 3] = [255.0, 1023.0, 4095.0];

/// Column to guess.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subject<'a> {
    /// Header field, or name of the channel; may contain the unit.
    pub(crate) header: &'a str,
    /// Unit of a units row or of the channel; may be empty.
    pub(crate) unit: &'a str,
    pub(crate) values: &'a ColumnValues,
}

/// Guess of the signal of one column.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct ColumnGuess {
    /// Signal, `time` for the time; `None` if the column is none that the model uses.
    pub(crate) signal: Option<&'static str>,
    /// Unit of the column.
    pub(crate) unit: Option<GuessedUnit>,
    /// Factor for the numbers.
    pub(crate) scale: Option<f64>,
    /// Reason of the guess.
    pub(crate) reason: String,
    /// What is assumed and should be checked; empty if name and unit say everything.
    pub(crate) assumed: String,
    /// Open question that nothing in the file answers.
    pub(crate) question: Option<Question>,
}

/// Open question about a column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Question {
    /// Gauge or absolute. Some evidence may exist in the values.
    Reference {
        /// Reference that the values suggest, with the reason.
        suggested: Option<(PressureReference, String)>,
    },
    /// Fill or vent valve.
    Valve,
    /// The same signal as another column.
    Rival(&'static str),
    /// Unit of a named signal.
    Unit(&'static str),
    /// Scale and offset from the unit of a sensor.
    Scale(&'static str),
}

/// Reading of a column before it is compared with the others.
struct Reading {
    kind: Option<Meaning>,
    places: Vec<Meaning>,
    signal: Option<&'static str>,
    /// 3 for a standard name, 2 for a kind with a place, 1 for a kind alone.
    strength: u8,
    unit: Option<GuessedUnit>,
    scale: Option<f64>,
    reasons: Vec<String>,
    assumed: Vec<String>,
    question: Option<Question>,
}

/// Returns a guess for each column. `reference` completes pressures whose unit states none.
/// `rise(valve, other, pressure)` returns the mean change of a column while one valve is on and the other is off, as a
/// share of its range.
pub(crate) fn guess(
    columns: &[Subject<'_>],
    reference: Option<PressureReference>,
    has_own_time: bool,
    rise: &dyn Fn(usize, Option<usize>, usize) -> Option<f64>,
) -> Vec<ColumnGuess> {
    let mut readings: Vec<Reading> = columns
        .iter()
        .map(|column| Reading::of(column, reference))
        .collect();
    if !has_own_time {
        choose_time(columns, &mut readings);
    }
    name_pressures(columns, &mut readings);
    let pressure = readings.iter().position(|one| one.signal == Some("p_ch"));
    for (kind, signals) in [
        (M::Duty, ["duty_fill", "duty_vent"]),
        (M::Current, ["i_fill", "i_vent"]),
    ] {
        name_valves(&mut readings, kind, signals, pressure, rise);
    }
    refuse_rivals(columns, &mut readings);
    readings.into_iter().map(Reading::finish).collect()
}

impl Reading {
    fn of(column: &Subject<'_>, reference: Option<PressureReference>) -> Self {
        let (name, unit_text, place) = split(column.header, column.unit);
        let words = words(&name);
        let meanings: Vec<Meaning> = words.iter().map(|&(_, meaning)| meaning).collect();
        let (unit, unit_reason) = unit_of(&unit_text, place, reference);
        let mut reading = Self {
            kind: None,
            places: meanings.clone(),
            signal: None,
            strength: 0,
            unit,
            scale: None,
            reasons: Vec::new(),
            assumed: Vec::new(),
            question: None,
        };
        if column.values.count == 0 {
            reading.unit = None;
            reading.reasons.push("no numbers".to_owned());
            return reading;
        }
        if meanings.contains(&M::Other) {
            reading
                .reasons
                .push(named(&words, &name, |meaning| meaning == M::Other));
            reading.reasons.push("no signal of the model".to_owned());
            return reading;
        }
        let standard = SIGNALS.iter().find(|(signal, ..)| *signal == name);
        reading.kind = standard.map(|&(_, kind, _)| kind);
        if reading.kind.is_none() {
            reading.find_kind(&words, column.values);
        }
        let Some(kind) = reading.kind else {
            if reading.question.is_none() && reading.reasons.is_empty() {
                reading
                    .reasons
                    .push("the name says nothing known".to_owned());
            }
            return reading;
        };
        if let Some(&(signal, ..)) = standard {
            (reading.signal, reading.strength) = (Some(signal), 3);
            reading.reasons.push("standard name".to_owned());
        } else {
            let found = SIGNALS.iter().find(|(_, of, places)| {
                *of == kind && places.iter().any(|place| meanings.contains(place))
            });
            let reason = named(&words, &name, |meaning| {
                meaning == kind
                    || meaning == M::Valve
                    || found.is_some_and(|(_, _, places)| places.contains(&meaning))
            });
            if !reason.is_empty() {
                reading.reasons.insert(0, reason);
            }
            match found {
                Some(&(signal, ..)) => (reading.signal, reading.strength) = (Some(signal), 2),
                None if kind == M::Time => (reading.signal, reading.strength) = (Some(TIME), 2),
                // A state without a name, such as `V1`, is a weaker candidate than a named valve.
                None => reading.strength = u8::from(!words.is_empty()),
            }
        }
        reading.reasons.extend(unit_reason);
        if kind != M::Time {
            reading.find_unit(kind, column.values, reference);
        }
        reading
    }

    /// Finds the kind by the unit, the words and the values, in this order.
    fn find_kind(&mut self, words: &[(&str, Meaning)], values: &ColumnValues) {
        let of_words = words.iter().filter(|(_, meaning)| is_kind(*meaning));
        let is_of_valve = words.iter().any(|&(_, meaning)| {
            matches!(meaning, M::Valve | M::Fill | M::Vent | M::Duty | M::Inlet)
        });
        let of_unit = match &self.unit {
            None => None,
            Some(GuessedUnit::Pressure(_)) => Some(M::Pressure),
            Some(GuessedUnit::Unit(unit)) => match unit.quantity() {
                Quantity::Time => Some(M::Time),
                Quantity::Pressure => Some(M::Pressure),
                Quantity::Current => Some(M::Current),
                Quantity::Voltage => Some(M::Voltage),
                Quantity::Temperature => Some(M::Temperature),
                Quantity::Length => Some(M::Position),
                Quantity::Ratio | Quantity::DutyCycle if is_of_valve => Some(M::Duty),
                quantity => {
                    self.reasons
                        .push(format!("a {quantity}: no signal of the model"));
                    return;
                }
            },
        };
        let long = of_words
            .clone()
            .find(|(word, _)| word.len() > 2)
            .map(|&(_, kind)| kind);
        if let (Some(of_unit), Some(named)) = (of_unit, long)
            && !of_words.clone().any(|&(_, kind)| kind == of_unit)
        {
            let unit = self.unit.as_ref().map_or("", GuessedUnit::token);
            self.reasons
                .push(format!("named a {}, but in {unit}", kind_name(named)));
            let signal = SIGNALS.iter().find(|(_, of, places)| {
                *of == named && places.iter().any(|place| self.places.contains(place))
            });
            let plain = (named == M::Pressure).then_some("p_ch");
            if let Some(signal) = signal.map(|&(signal, ..)| signal).or(plain) {
                self.question = Some(Question::Scale(signal));
            }
            return;
        }
        self.kind = of_unit
            .or(long)
            .or_else(|| of_words.clone().next().map(|&(_, kind)| kind));
        let is_state =
            values.are_whole && values.are_within(0.0, 1.0) && values.least < values.greatest;
        if self.kind.is_none()
            && (is_of_valve && values.are_within(0.0, FULL_COUNTS[2]) || is_state)
        {
            self.kind = Some(M::Duty);
        }
    }

    /// Finds the unit by the values where the file states none, and notes the open reference of a pressure.
    fn find_unit(
        &mut self,
        kind: Meaning,
        values: &ColumnValues,
        reference: Option<PressureReference>,
    ) {
        let (least, greatest) = (values.least, values.greatest.max(-values.least));
        if self.unit.is_none() {
            let by_size = match kind {
                M::Duty => self.unit_of_duty(values),
                M::Pressure if greatest <= 50.0 => Some(GuessedUnit::Pressure("bar".to_owned())),
                M::Pressure if (300.0..=1600.0).contains(&greatest) => {
                    Some(GuessedUnit::Pressure("kPa".to_owned()))
                }
                M::Pressure if (1600.0..=25e3).contains(&greatest) => {
                    Some(GuessedUnit::Pressure("mbar".to_owned()))
                }
                M::Pressure if greatest > 25e3 => Some(GuessedUnit::Pressure("Pa".to_owned())),
                M::Current if greatest <= 5.0 => Some(GuessedUnit::Unit(Unit::Ampere)),
                M::Current if greatest >= 20.0 => Some(GuessedUnit::Unit(Unit::Milliampere)),
                M::Voltage if greatest <= 60.0 => Some(GuessedUnit::Unit(Unit::Volt)),
                M::Temperature if least > 200.0 => Some(GuessedUnit::Unit(Unit::Kelvin)),
                M::Temperature if greatest < 200.0 => Some(GuessedUnit::Unit(Unit::DegreeCelsius)),
                _ => None,
            };
            match &by_size {
                None => {
                    if let Some(signal) = self.signal {
                        self.question = Some(Question::Unit(signal));
                    }
                }
                Some(unit) if kind != M::Duty => {
                    let text = format!("{} because of the size of the values", unit.token());
                    self.assumed.push(text);
                }
                Some(_) => {}
            }
            self.unit = by_size.map(|unit| unit.completed(reference));
        }
        if let Some(GuessedUnit::Pressure(text)) = &self.unit {
            self.question = Some(Question::Reference {
                suggested: suggested_reference(text, values),
            });
        }
    }

    fn unit_of_duty(&mut self, values: &ColumnValues) -> Option<GuessedUnit> {
        let (unit, reason) = if values.are_within(0.0, 1.0) {
            let text = match values.are_whole {
                true => "values 0/1: a valve state",
                false => "0 to 1: a duty cycle",
            };
            (Unit::Fraction, text.to_owned())
        } else if values.are_within(0.0, 100.0) {
            (Unit::Percent, "0 to 100: a duty cycle".to_owned())
        } else if values.least >= 0.0 && FULL_COUNTS.contains(&values.greatest) {
            self.scale = Some(100.0 / values.greatest);
            self.assumed.push(format!("{} is 100 %", values.greatest));
            (
                Unit::Percent,
                format!("0 to {}: the count of a PWM output", values.greatest),
            )
        } else if values.are_within(0.0, 1000.0) && values.greatest == 1000.0 {
            self.assumed.push("1000 is 100 %".to_owned());
            (Unit::PerMille, "0 to 1000: a duty cycle".to_owned())
        } else {
            return None;
        };
        self.reasons.push(reason);
        Some(GuessedUnit::Unit(unit))
    }

    fn finish(self) -> ColumnGuess {
        ColumnGuess {
            unit: self
                .unit
                .filter(|_| self.signal.is_some() || self.question.is_some()),
            signal: self.signal,
            scale: self.scale.filter(|_| self.signal.is_some()),
            reason: self.reasons.join("; "),
            assumed: self.assumed.join("; "),
            question: self.question,
        }
    }
}

/// Chooses the time among the columns, and its unit by the steps where the file states none.
fn choose_time(columns: &[Subject<'_>], readings: &mut [Reading]) {
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
fn name_pressures(columns: &[Subject<'_>], readings: &mut [Reading]) {
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

/// Names columns of valves without a place by the direction in which the pressure goes while each is on.
fn name_valves(
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
fn refuse_rivals(columns: &[Subject<'_>], readings: &mut [Reading]) {
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

#[cfg(test)]
mod tests;
