//! Check whether the size of the values fits their declared unit. A unit that is wrong by a factor causes no other
//! error.

use std::fmt;
use std::ops::RangeInclusive;

use crate::bounds::{Allowed, Bounds, OutOfBounds, Short};
use crate::proposal::signal_line;
use crate::signal::quantity_of;
use crate::{Converter, PressureReference, Quantity, Unit};

/// Largest plausible pressure of a pneumatic brake (bar); its supply is at 6 to 12 bar.
const LARGEST_BAR: f64 = 50.0;
/// Pressure range of a charged chamber (bar).
const CHARGED_BAR: RangeInclusive<f64> = 1.0..=25.0;
/// Usual highest pressure of a charged chamber (bar).
const USUAL_BAR: f64 = 6.0;
/// Pressure below which a log in a small unit is suspected to be one in a larger unit (bar).
const SMALL_BAR: f64 = 0.25;
/// Lowest ambient pressure for a vehicle, at an altitude of about 5500 m (bar).
const AMBIENT_MIN_BAR: f64 = 0.5;

/// Values that no logged signal of this unit has.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Implausible {
    /// A duty cycle is impossible for a PWM output.
    DutyRange {
        /// Duty cycle (%).
        percent: f64,
    },
    /// Half of the cells or more are outside the hard bounds of their quantity.
    OutOfBounds {
        /// First such cells, their number, and the allowed range.
        cells: Box<OutOfBounds>,
        /// Number of cells with a value.
        of: u64,
    },
    /// The size of the values does not fit the declared unit.
    Scale {
        /// Value farthest from zero.
        largest: f64,
        /// Declared unit.
        declared: Unit,
        /// Unit that the values seem to have.
        looks_like: Option<Unit>,
        /// Line for a mapping file that accepts them.
        proposal: String,
    },
}

impl Implausible {
    /// Returns the last part of the stable code, which follows that of the reader.
    pub(crate) fn code(&self) -> Code {
        match self {
            Self::DutyRange { .. } => Code::DutyRange,
            Self::OutOfBounds { cells, .. } if is_below_vacuum(cells) => Code::BelowVacuum,
            Self::OutOfBounds { .. } => Code::Bounds,
            Self::Scale { .. } => Code::Scale,
        }
    }

    /// Returns the next step, as an instruction.
    pub fn next_step(&self) -> String {
        match self {
            Self::DutyRange { percent } if *percent < 0.0 => {
                "if one column commands both valves, by its sign, `retarder inspect` proposes a mapping into two; \
                 otherwise check the unit (pct or frac) and the logger"
                    .to_owned()
            }
            Self::DutyRange { .. } => "check the unit (pct or frac) and the logger".to_owned(),
            Self::OutOfBounds { cells, .. } if is_below_vacuum(cells) => format!(
                "check whether {} is the right reference, whether the sensor was plugged in, and its offset",
                cells.unit.symbol()
            ),
            Self::OutOfBounds { .. } => {
                "check the unit of the column, its scale and offset in the mapping, and the sensor"
                    .to_owned()
            }
            Self::Scale { proposal, .. } => format!("say in a mapping: {proposal}"),
        }
    }
}

impl fmt::Display for Implausible {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::DutyRange { percent } => {
                write!(f, "found a duty cycle of {percent} %, expected 0 to 100 %")
            }
            Self::OutOfBounds { cells, of } => {
                let first = cells.first.first();
                let value = Short(first.map_or(f64::NAN, |outlier| outlier.value));
                let allowed = Allowed(&cells.allowed, cells.unit);
                let unit = cells.unit.symbol();
                write!(
                    f,
                    "found {value} {unit} ({allowed}), and {} of {of} cells outside",
                    cells.count
                )
            }
            Self::Scale {
                largest,
                declared,
                looks_like,
                ..
            } => {
                write!(f, "found values up to {largest}, declared {declared}")?;
                match looks_like {
                    Some(unit) => write!(f, ", but their size looks like {unit}"),
                    None => write!(f, ", expected a {} of usual size", declared.quantity()),
                }
            }
        }
    }
}

/// Kind of implausibility in a code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Code {
    DutyRange,
    BelowVacuum,
    Bounds,
    Scale,
}

fn is_below_vacuum(cells: &OutOfBounds) -> bool {
    let first = cells.first.first();
    cells.unit.pressure_reference().is_some()
        && first.is_some_and(|outlier| outlier.value < *cells.allowed.start())
}

/// Observer of the values of one signal.
#[derive(Debug)]
pub(crate) struct Watch {
    law: Law,
    unit: Unit,
    /// Extremes of all values.
    all: Extremes,
    /// Extremes of the values within the bounds.
    within: Extremes,
    cells: u64,
    outside: OutOfBounds,
    /// Whether the allowed range is narrower than the hard bounds.
    is_narrowed: bool,
    between_zero_and_one: bool,
}

/// Extremes of some values, with their places.
#[derive(Debug)]
struct Extremes {
    min: f64,
    max: f64,
    place_of_min: u64,
    place_of_max: u64,
}

impl Extremes {
    fn none() -> Self {
        Self {
            min: f64::INFINITY,
            max: f64::NEG_INFINITY,
            place_of_min: 0,
            place_of_max: 0,
        }
    }

    fn take(&mut self, value: f64, place: u64) {
        if value < self.min {
            (self.min, self.place_of_min) = (value, place);
        }
        if value > self.max {
            (self.max, self.place_of_max) = (value, place);
        }
    }
}

#[derive(Debug)]
enum Law {
    Any,
    Duty {
        to_percent: Converter,
        check_scale: bool,
    },
    Pressure {
        reference: PressureReference,
        to_bar: Converter,
    },
}

impl Watch {
    /// Creates an observer of the signal `name` in `column` of a CSV file, or of MF4. Without `check_scale` values of
    /// unusual size are accepted, but none outside the bounds of the quantity.
    pub(crate) fn new(name: &str, unit: Unit, check_scale: bool, column: Option<usize>) -> Self {
        let quantity = quantity_of(name, unit);
        let law = match (quantity, unit.pressure_reference()) {
            (Quantity::DutyCycle, _) => match unit.converter(Unit::Percent) {
                Ok(to_percent) => Law::Duty {
                    to_percent,
                    check_scale,
                },
                Err(_) => Law::Any,
            },
            (_, Some(reference)) if check_scale => match unit.converter(bar(reference)) {
                Ok(to_bar) => Law::Pressure { reference, to_bar },
                Err(_) => Law::Any,
            },
            _ => Law::Any,
        };
        Self {
            law,
            unit,
            all: Extremes::none(),
            within: Extremes::none(),
            cells: 0,
            outside: OutOfBounds::new(name, unit, &Bounds::of(quantity), column),
            is_narrowed: false,
            between_zero_and_one: false,
        }
    }

    /// Narrows the allowed range to the plausible one of a mapping, if it states one.
    pub(crate) fn narrowed_to(mut self, plausible: Option<&RangeInclusive<f64>>) -> Self {
        if let Some(plausible) = plausible {
            let hard = &self.outside.allowed;
            let (least, most) = (
                hard.start().max(*plausible.start()),
                hard.end().min(*plausible.end()),
            );
            self.outside.allowed = least..=most;
            self.is_narrowed = true;
        }
        self
    }

    /// Takes one value, from a line or sample `place`, and returns it, or NaN if it is out of bounds.
    ///
    /// # Errors
    /// Returns an error for an impossible duty cycle: it is a command, and no other value can replace it. A plausible
    /// range of a mapping accepts it as missing.
    pub(crate) fn take(&mut self, value: f64, place: u64) -> Result<f64, Implausible> {
        let is_glitch = self.is_narrowed && !self.outside.allowed.contains(&value);
        if is_glitch {
            // Counted below.
        } else if let Law::Duty { to_percent, .. } = &self.law {
            let percent = to_percent.apply(value);
            if !(0.0..=100.0).contains(&percent) {
                return Err(Implausible::DutyRange { percent });
            }
            self.between_zero_and_one |= value > 0.0 && value < 1.0;
        }
        self.cells += 1;
        self.all.take(value, place);
        if self.outside.allowed.contains(&value) {
            self.within.take(value, place);
            Ok(value)
        } else {
            self.outside.add(value, place);
            Ok(f64::NAN)
        }
    }

    /// Returns the cells that were out of bounds; `None` if there are none.
    pub(crate) fn outside(&self) -> Option<&OutOfBounds> {
        (self.outside.count > 0).then_some(&self.outside)
    }

    /// Checks the size of the values so far; only at the end of the file can they be too small. A mapping calls the
    /// signal `name` and its column `key`.
    ///
    /// # Errors
    /// Returns the place of the largest value, and its problem.
    pub(crate) fn judge(
        &self,
        name: &str,
        key: impl FnOnce() -> String,
        at_end: bool,
    ) -> Result<(), (u64, Implausible)> {
        let is_outside = self.outside.count > 0 && 2 * self.outside.count >= self.cells;
        let seen = if is_outside { &self.all } else { &self.within };
        match self.judge_scale(seen, name, key, at_end) {
            // No unit makes values out of bounds plausible: then these are reported.
            Err((
                _,
                Implausible::Scale {
                    looks_like: None, ..
                },
            )) if is_outside => {}
            judgement => judgement?,
        }
        match self.outside.first.first().filter(|_| is_outside) {
            None => Ok(()),
            Some(first) => Err((
                first.place,
                Implausible::OutOfBounds {
                    cells: Box::new(self.outside.clone()),
                    of: self.cells,
                },
            )),
        }
    }

    fn judge_scale(
        &self,
        seen: &Extremes,
        name: &str,
        key: impl FnOnce() -> String,
        at_end: bool,
    ) -> Result<(), (u64, Implausible)> {
        if seen.max < seen.min {
            return Ok(());
        }
        let looks_like = match &self.law {
            Law::Duty {
                check_scale: true, ..
            } => {
                let is_fraction = at_end
                    && self.unit == Unit::Percent
                    && seen.max <= 1.0
                    && self.between_zero_and_one;
                if !is_fraction {
                    return Ok(());
                }
                Some(Unit::Fraction)
            }
            Law::Pressure { reference, to_bar } => {
                let (min, max) = (to_bar.apply(seen.min), to_bar.apply(seen.max));
                let large = max.max(-min) > LARGEST_BAR;
                let small = at_end && max > 0.0 && max < SMALL_BAR && min >= -0.1 * max;
                let vacuous =
                    at_end && *reference == PressureReference::Absolute && min < AMBIENT_MIN_BAR;
                let looks_like = self.likely_unit(seen, *reference, large);
                match (large, small || vacuous, looks_like) {
                    (true, _, looks_like) => looks_like,
                    (false, true, Some(unit)) => Some(unit),
                    _ => return Ok(()),
                }
            }
            _ => return Ok(()),
        };
        let (largest, place) = if -seen.min > seen.max {
            (seen.min, seen.place_of_min)
        } else {
            (seen.max, seen.place_of_max)
        };
        let unit = looks_like.unwrap_or(self.unit).token();
        let mut proposal = signal_line(name, &key(), unit);
        if looks_like.is_none() {
            proposal.insert_str(proposal.len() - " }".len(), ", check_scale = false");
        }
        Err((
            place,
            Implausible::Scale {
                largest,
                declared: self.unit,
                looks_like,
                proposal,
            },
        ))
    }

    /// Returns the unit in which these values would be those of a chamber that is charged at some time.
    fn likely_unit(
        &self,
        seen: &Extremes,
        reference: PressureReference,
        large: bool,
    ) -> Option<Unit> {
        use Unit as U;
        let gauge = [
            U::BarGauge,
            U::KilopascalGauge,
            U::PsiGauge,
            U::MillibarGauge,
            U::PascalGauge,
        ];
        let absolute = [
            U::BarAbsolute,
            U::KilopascalAbsolute,
            U::PsiAbsolute,
            U::MillibarAbsolute,
            U::PascalAbsolute,
        ];
        let candidates = match reference {
            PressureReference::Gauge => gauge.into_iter().chain([]).collect::<Vec<_>>(),
            PressureReference::Absolute => absolute.into_iter().chain(gauge).collect(),
        };
        candidates
            .into_iter()
            .filter(|&unit| unit != self.unit)
            .filter_map(|unit| {
                // Values that are too small can only come from a larger unit; psi is not a likely confusion there.
                if !large && matches!(unit, U::PsiGauge | U::PsiAbsolute) {
                    return None;
                }
                let reference = unit.pressure_reference()?;
                let to_bar = unit.converter(bar(reference)).ok()?;
                let lowest_bar = match reference {
                    PressureReference::Gauge => -0.2,
                    PressureReference::Absolute => AMBIENT_MIN_BAR,
                };
                let [min_bar, max_bar] = [seen.min, seen.max].map(|value| to_bar.apply(value));
                let fits = CHARGED_BAR.contains(&max_bar) && min_bar >= lowest_bar;
                fits.then_some((unit, (max_bar / USUAL_BAR).ln().abs()))
            })
            // A value of 120 more probably means a chamber at 8 bar in psi than one at 1.2 bar in kPa.
            .min_by(|one, other| one.1.total_cmp(&other.1))
            .map(|(unit, _)| unit)
    }
}

fn bar(reference: PressureReference) -> Unit {
    match reference {
        PressureReference::Gauge => Unit::BarGauge,
        PressureReference::Absolute => Unit::BarAbsolute,
    }
}
