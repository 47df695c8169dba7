//! The distributor: how the control signal becomes two duty cycles, section 6.3.

use fixed::types::I16F16;

use crate::arithmetic::high_product;
use crate::control_signal::ControlSignal;
use crate::duty::Duty;
use crate::error::{ConfigError, Field};
use crate::lower_limit::{LowerLimit, OpeningCurve, OpeningFields};
use crate::range::{Range, propagate};
use crate::settings::{self, Settings};

const SUPPLY_PRESSURE_BAR: Range = Range::new("1", "15");

/// How u becomes two duty cycles. The traditional scheme is Scheme 1 from 0 to 100 %.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Distributor {
    scheme: Scheme,
    fill: Valve,
    vent: Valve,
    /// p_sup \[bar\], 2⁻¹⁶.
    supply: i32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
enum Scheme {
    /// The valve that u asks for; the other is off (6.3.1).
    Separate,
    /// The valve that u asks for above its middle, the other below its own (6.3.2).
    Together,
}

impl Distributor {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let supply = propagate!(
            SUPPLY_PRESSURE_BAR.checked(Field::SupplyPressure, settings.supply_pressure_bar)
        );
        let fill = propagate!(CheckedValve::new(FILL, settings, supply));
        let vent = propagate!(CheckedValve::new(VENT, settings, supply));
        let (scheme, fill, vent) = match settings.distributor {
            // The limits were checked all the same, so that a change of scheme cannot bring up an old mistake.
            settings::Distributor::Traditional => {
                (Scheme::Separate, Valve::TRADITIONAL, Valve::TRADITIONAL)
            }
            settings::Distributor::Scheme1 => (Scheme::Separate, fill.valve, vent.valve),
            settings::Distributor::Scheme2 {
                middle_fill_pct,
                middle_vent_pct,
            } => (
                Scheme::Together,
                propagate!(fill.around(middle_fill_pct)),
                propagate!(vent.around(middle_vent_pct)),
            ),
        };
        Ok(Self {
            scheme,
            fill,
            vent,
            supply,
        })
    }

    /// The duty cycles of the fill and the vent valve for u at this chamber pressure [2⁻¹⁶ bar].
    #[inline(always)]
    pub(crate) fn duties(&self, u: ControlSignal, pressure: i32) -> (Duty, Duty) {
        let u = u.to_bits();
        // |u| ≤ 100 · 2¹²: the magnitude exists and has 12 bits to spare.
        let magnitude = u.wrapping_abs();
        // The pressure that helps each valve to open; both terms are below 2²¹.
        let at_fill = self.supply.wrapping_sub(pressure);
        let at_vent = pressure;
        match self.scheme {
            Scheme::Separate if u > 0 => (self.fill.alone(magnitude, at_fill), Duty::OFF),
            Scheme::Separate if u < 0 => (Duty::OFF, self.vent.alone(magnitude, at_vent)),
            Scheme::Separate => (Duty::OFF, Duty::OFF),
            Scheme::Together if u >= 0 => (
                self.fill.above_middle(magnitude),
                self.vent.below_middle(magnitude, at_vent),
            ),
            Scheme::Together => (
                self.fill.below_middle(magnitude, at_fill),
                self.vent.above_middle(magnitude),
            ),
        }
    }
}

/// The range of one valve's duty cycle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Valve {
    min: LowerLimit,
    /// What the valve gets at u = 0 when both are driven [%], 2⁻¹⁶.
    middle: i32,
    max: i32,
    /// (DC_max - DC_min)/100 where DC_min is constant, 2⁻²⁸, rounded up so that u = 100 % gives exactly DC_max.
    slope: i32,
}

impl Valve {
    /// From 0 to 100 %: equations 6.3 to 6.5.
    const TRADITIONAL: Self = Self {
        min: LowerLimit::Constant(0),
        middle: 0,
        max: Duty::FULL.to_bits(),
        slope: 1 << 28,
    };

    /// `magnitude` of u [2⁻¹² %] from DC_min to DC_max.
    #[inline(always)]
    fn alone(&self, magnitude: i32, difference: i32) -> Duty {
        Duty::from_proved_bits(match self.min {
            // |u| with 20 bits times a slope of 28 leaves 16; at most DC_max (docs/numerics.md).
            LowerLimit::Constant(min) => min.wrapping_add(high_product(magnitude << 8, self.slope)),
            LowerLimit::ByPressure(_) => between(self.min.at(difference), self.max, magnitude),
        })
    }

    /// `magnitude` of u [2⁻¹² %] from the middle up to DC_max.
    #[inline(always)]
    fn above_middle(&self, magnitude: i32) -> Duty {
        Duty::from_proved_bits(between(self.middle, self.max, magnitude))
    }

    /// `magnitude` of u [2⁻¹² %] from the middle down to DC_min.
    #[inline(always)]
    fn below_middle(&self, magnitude: i32, difference: i32) -> Duty {
        Duty::from_proved_bits(between(self.middle, self.min.at(difference), magnitude))
    }
}

/// From `start` at |u| = 0 to exactly `end` at |u| = 100 % (duty cycles in 2⁻¹⁶ %, `magnitude` in 2⁻¹² %).
#[inline(always)]
fn between(start: i32, end: i32, magnitude: i32) -> i32 {
    /// 2³²·2⁶/100, rounded up: makes 100 % in 2⁻²⁴ exactly 1 in 2⁻³⁰.
    const HUNDREDTH: u64 = (1_u64 << 38).div_ceil(100);
    let fraction = ((((magnitude as u32) << 12) as u64).wrapping_mul(HUNDREDTH) >> 32) as i32;
    // |end - start| ≤ 100 % < 2²³: two bits up and 2⁻³⁰ leave 2⁻¹⁶ %.
    start.wrapping_add(high_product(end.wrapping_sub(start) << 2, fraction))
}

/// The names under which errors show one valve's settings.
#[derive(Clone, Copy)]
struct Fields {
    min: Field,
    at_half: Field,
    with_supply_pressure: Field,
    max: Field,
    middle: Field,
    is_fill: bool,
}

const FILL: Fields = Fields {
    min: Field::DutyMinFill,
    at_half: Field::DutyHalfFill,
    with_supply_pressure: Field::DutyMinFillWithSupplyPressure,
    max: Field::DutyMaxFill,
    middle: Field::DutyMiddleFill,
    is_fill: true,
};

const VENT: Fields = Fields {
    min: Field::DutyMinVent,
    at_half: Field::DutyHalfVent,
    with_supply_pressure: Field::DutyMinVentWithSupplyPressure,
    max: Field::DutyMaxVent,
    middle: Field::DutyMiddleVent,
    is_fill: false,
};

/// A valve without middle yet, and what the check of the middle needs.
struct CheckedValve {
    valve: Valve,
    fields: Fields,
    /// The largest DC_min that pressure can lead to [%].
    min_pct: I16F16,
    max_pct: I16F16,
}

impl CheckedValve {
    const fn new(fields: Fields, settings: &Settings, supply: i32) -> Result<Self, ConfigError> {
        let max_pct = if fields.is_fill {
            settings.duty_max_fill_pct
        } else {
            settings.duty_max_vent_pct
        };
        let (limit, min_pct) = match settings.duty_min {
            settings::LowerLimit::Constant { fill_pct, vent_pct } => {
                let min_pct = if fields.is_fill { fill_pct } else { vent_pct };
                let min = propagate!(Range::PERCENT.checked(fields.min, min_pct));
                (LowerLimit::Constant(min), min_pct)
            }
            settings::LowerLimit::PressureDependent { fill, vent } => {
                let opening = if fields.is_fill { fill } else { vent };
                let names = OpeningFields {
                    without_pressure: fields.min,
                    at_half: fields.at_half,
                    with_supply_pressure: fields.with_supply_pressure,
                };
                let curve = propagate!(OpeningCurve::new(&opening, supply, names));
                (LowerLimit::ByPressure(curve), opening.without_pressure_pct)
            }
        };
        let max = propagate!(
            Range::PERCENT
                .from(min_pct)
                .checked_not_below(fields.min, fields.max, max_pct)
        );
        let min = min_pct.to_bits();
        // From 2⁻¹⁶ % to 2⁻²⁸; at most 100 % / 100 = 2²⁸.
        let slope = ((max.wrapping_sub(min) as i64) << 12).wrapping_add(99) / 100;
        Ok(Self {
            valve: Valve {
                min: limit,
                middle: min,
                max,
                slope: slope as i32,
            },
            fields,
            min_pct,
            max_pct,
        })
    }

    const fn around(self, middle_pct: I16F16) -> Result<Valve, ConfigError> {
        let Self {
            valve,
            fields,
            min_pct,
            max_pct,
        } = self;
        let range = Range::between(min_pct, max_pct);
        if middle_pct.to_bits() >= min_pct.to_bits() {
            propagate!(range.checked_not_above(fields.max, fields.middle, middle_pct));
        }
        let middle = propagate!(range.checked_not_below(fields.min, fields.middle, middle_pct));
        Ok(Valve { middle, ..valve })
    }
}
