//! Does the size of the values fit their declared unit? A unit that is wrong by a factor reads without any error.

use std::fmt;

use crate::proposal::signal_line;
use crate::signal::quantity_of;
use crate::{Converter, PressureReference, Quantity, Unit};

/// No pneumatic brake holds more; its supply is at 6 to 12 bar.
const LARGEST_BAR: f64 = 50.0;
/// The pressure of a charged chamber.
const CHARGED_BAR: std::ops::RangeInclusive<f64> = 1.0..=25.0;
/// Below this a log in a small unit is suspected to be one in a larger unit.
const SMALL_BAR: f64 = 0.25;
/// The thinnest atmosphere a vehicle meets, at about 5500 m.
const AMBIENT_MIN_BAR: f64 = 0.5;
/// Vacuum, with room for the offset of a sensor.
const VACUUM_GAUGE_BAR: f64 = -1.1;
const VACUUM_ABSOLUTE_BAR: f64 = -0.05;

/// Values that no logged signal of this unit has.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Implausible {
    /// A duty cycle that no PWM output has.
    DutyRange {
        /// The duty cycle in %.
        percent: f64,
    },
    /// A pressure below vacuum.
    BelowVacuum {
        /// The value as logged.
        value: f64,
        /// Its declared unit.
        declared: Unit,
    },
    /// Values whose size does not fit the declared unit.
    Scale {
        /// The value farthest from zero.
        largest: f64,
        /// Declared unit.
        declared: Unit,
        /// The unit they look like.
        looks_like: Option<Unit>,
        /// Line for a mapping file that accepts them.
        proposal: String,
    },
}

impl Implausible {
    /// What to do next, as an instruction.
    pub fn next_step(&self) -> String {
        match self {
            Self::DutyRange { .. } => "check the unit (pct or frac) and the logger".to_owned(),
            Self::BelowVacuum { declared, .. } => format!(
                "check whether {} is the right reference, and the sensor's offset",
                declared.symbol()
            ),
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
            Self::BelowVacuum { value, declared } => {
                write!(f, "found {value} {declared}, expected no less than vacuum")
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

/// Watches the values of one signal.
#[derive(Debug)]
pub(crate) struct Watch {
    law: Law,
    unit: Unit,
    min: f64,
    max: f64,
    place_of_min: u64,
    place_of_max: u64,
    between_zero_and_one: bool,
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
    /// A watch on the signal `name`; without `check_scale` values of unusual size pass.
    pub(crate) fn new(name: &str, unit: Unit, check_scale: bool) -> Self {
        let law = match (quantity_of(name, unit), unit.pressure_reference()) {
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
        let (min, max) = (f64::INFINITY, f64::NEG_INFINITY);
        Self {
            law,
            unit,
            min,
            max,
            place_of_min: 0,
            place_of_max: 0,
            between_zero_and_one: false,
        }
    }

    /// Takes one value, from a line or sample `place`; refuses what is impossible by itself.
    pub(crate) fn take(&mut self, value: f64, place: u64) -> Result<(), Implausible> {
        match &self.law {
            Law::Any => return Ok(()),
            Law::Duty { to_percent, .. } => {
                let percent = to_percent.apply(value);
                if !(0.0..=100.0).contains(&percent) {
                    return Err(Implausible::DutyRange { percent });
                }
                self.between_zero_and_one |= value > 0.0 && value < 1.0;
            }
            Law::Pressure { reference, to_bar } => {
                let vacuum_bar = match reference {
                    PressureReference::Gauge => VACUUM_GAUGE_BAR,
                    PressureReference::Absolute => VACUUM_ABSOLUTE_BAR,
                };
                // A large negative value is a matter of size and not of vacuum.
                let bar = to_bar.apply(value);
                if bar < vacuum_bar && bar >= -LARGEST_BAR {
                    return Err(Implausible::BelowVacuum {
                        value,
                        declared: self.unit,
                    });
                }
            }
        }
        if value < self.min {
            (self.min, self.place_of_min) = (value, place);
        }
        if value > self.max {
            (self.max, self.place_of_max) = (value, place);
        }
        Ok(())
    }

    /// Judges the size of the values so far; only at the end of the file can they be too small. A mapping calls the
    /// signal `name` and its column `key`.
    ///
    /// # Errors
    /// The place of the largest value, and what is wrong with it.
    pub(crate) fn judge(
        &self,
        name: &str,
        key: impl FnOnce() -> String,
        at_end: bool,
    ) -> Result<(), (u64, Implausible)> {
        if self.max < self.min {
            return Ok(());
        }
        let looks_like = match &self.law {
            Law::Duty {
                check_scale: true, ..
            } => {
                let is_fraction = at_end
                    && self.unit == Unit::Percent
                    && self.max <= 1.0
                    && self.between_zero_and_one;
                if !is_fraction {
                    return Ok(());
                }
                Some(Unit::Fraction)
            }
            Law::Pressure { reference, to_bar } => {
                let (min, max) = (to_bar.apply(self.min), to_bar.apply(self.max));
                let large = max.max(-min) > LARGEST_BAR;
                let small = at_end && max > 0.0 && max < SMALL_BAR && min >= -0.1 * max;
                let vacuous =
                    at_end && *reference == PressureReference::Absolute && min < AMBIENT_MIN_BAR;
                let looks_like = self.likely_unit(*reference, large);
                match (large, small || vacuous, looks_like) {
                    (true, _, looks_like) => looks_like,
                    (false, true, Some(unit)) => Some(unit),
                    _ => return Ok(()),
                }
            }
            _ => return Ok(()),
        };
        let (largest, place) = if -self.min > self.max {
            (self.min, self.place_of_min)
        } else {
            (self.max, self.place_of_max)
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

    /// The unit in which these values would be those of a chamber that is charged at some time.
    fn likely_unit(&self, reference: PressureReference, large: bool) -> Option<Unit> {
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
            .find(|&unit| {
                // Too small values can only come from a larger unit; psi is no larger unit anyone mixes up there.
                if !large && matches!(unit, U::PsiGauge | U::PsiAbsolute) {
                    return false;
                }
                let Some(reference) = unit.pressure_reference() else {
                    return false;
                };
                let Ok(to_bar) = unit.converter(bar(reference)) else {
                    return false;
                };
                let lowest_bar = match reference {
                    PressureReference::Gauge => -0.2,
                    PressureReference::Absolute => AMBIENT_MIN_BAR,
                };
                CHARGED_BAR.contains(&to_bar.apply(self.max))
                    && to_bar.apply(self.min) >= lowest_bar
            })
    }
}

fn bar(reference: PressureReference) -> Unit {
    match reference {
        PressureReference::Gauge => Unit::BarGauge,
        PressureReference::Absolute => Unit::BarAbsolute,
    }
}
