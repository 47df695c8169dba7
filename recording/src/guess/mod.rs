//! Guess of signal and unit of a column from its name, its unit and its values. Each guess has a reason, and none is
//! used before a person has seen it.

mod assignment;
mod unit;
mod words;

use crate::values::ColumnValues;
use crate::{PressureReference, Quantity, Unit};

use assignment::{choose_time, name_pair, name_pressures, name_valves, refuse_rivals};
use unit::{split, suggested_reference, unit_of};
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
    ("x_actuator", M::Position, &[M::Actuator]),
];

/// Signals of the commands of both valves.
const DUTIES: [&str; 2] = ["duty_fill", "duty_vent"];
/// Numbers at which a valve is fully open where one column commands both.
const FULL_PAIRS: [f64; 2] = [1.0, 100.0];

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
    /// Whether the column commands both valves.
    pub(crate) pair: Option<Pair>,
    /// Reason of the guess.
    pub(crate) reason: String,
    /// Assumption to check; empty if name and unit say everything.
    pub(crate) assumed: String,
    /// Open question that nothing in the file answers.
    pub(crate) question: Option<Question>,
}

/// Command of both valves in one column: one valve opens at positive numbers, the other one at negative numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pair {
    /// Number at which a valve is fully open.
    pub(crate) full: f64,
    /// Signals at positive and at negative numbers.
    pub(crate) signals: [&'static str; 2],
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
    pair: Option<Pair>,
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
    name_pair(&mut readings, pressure, rise);
    for (kind, signals) in [(M::Duty, DUTIES), (M::Current, ["i_fill", "i_vent"])] {
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
            pair: None,
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
        let full = FULL_PAIRS.into_iter().find(|&full| {
            (values.least, values.greatest) == (-full, full)
                && (is_of_valve || values.are_whole && full == 1.0)
        });
        // A letter such as `u` also names the command of a controller.
        let is_open = of_unit.is_none() && long.is_none();
        if let Some(full) = full.filter(|_| is_open || self.kind == Some(M::Duty)) {
            self.kind = Some(M::Duty);
            self.pair = Some(Pair {
                full,
                signals: DUTIES,
            });
        }
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
        let (unit, reason) = if let Some(Pair { full, .. }) = self.pair {
            let unit = if full == 1.0 {
                Unit::Fraction
            } else {
                Unit::Percent
            };
            (
                unit,
                format!("-{full} to {full}: the command of both valves"),
            )
        } else if values.are_within(0.0, 1.0) {
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
            pair: self.pair.filter(|_| self.signal.is_some()),
            reason: self.reasons.join("; "),
            assumed: self.assumed.join("; "),
            question: self.question,
        }
    }
}

#[cfg(test)]
mod tests;
