//! Distributor: converts the control signal into two duty cycles (section 6.3).

use fixed::types::I16F16;

use crate::arithmetic::high_product;
use crate::control_signal::ControlSignal;
use crate::direction::Direction;
use crate::duty::Duty;
use crate::error::ConfigError;
use crate::lower_limit::{LowerLimit, OpeningCurve, OpeningFields, Supply};
use crate::range::{Range, checked, propagate};
use crate::settings::{self, Settings};
use crate::structure::{Scheme, Structure};
use crate::table::Field;

/// Conversion of u into two duty cycles. The traditional scheme is Scheme 1 with limits of 0 and 100 %.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Distributor {
    fill: Valve,
    vent: Valve,
    supply: Supply,
}

impl Distributor {
    pub(crate) const fn new(settings: &Settings) -> Result<Self, ConfigError> {
        let supply = propagate!(Supply::new(settings));
        let fill = propagate!(CheckedValve::new(FILL, settings));
        let vent = propagate!(CheckedValve::new(VENT, settings));
        let (fill, vent) = match settings.distributor {
            // The limits are checked for every scheme, so that a later change of the scheme cannot reveal an old
            // mistake.
            settings::Distributor::Traditional => (Valve::TRADITIONAL, Valve::TRADITIONAL),
            settings::Distributor::Scheme1 => (fill.valve, vent.valve),
            settings::Distributor::Scheme2 {
                middle_fill_pct,
                middle_vent_pct,
            } => (
                propagate!(fill.around(middle_fill_pct)),
                propagate!(vent.around(middle_vent_pct)),
            ),
        };
        Ok(Self { fill, vent, supply })
    }

    /// Returns the duty cycles of the fill and the vent valve for u, counted along the direction (100 %, 2⁻²⁰), at this
    /// chamber pressure (bar, 2⁻²⁵).
    #[inline(always)]
    pub(crate) fn duties(
        &self,
        structure: Structure,
        direction: Direction,
        u: i32,
        pressure: i32,
    ) -> (Duty, Duty) {
        // |u| is below 2³⁰; it saturates at 100 %.
        let magnitude = u.wrapping_abs().min(ControlSignal::MAX.units());
        let venting = Direction::of(u) != direction;
        // Reduction of each valve's lower limit by the pressure difference that helps to open it; both differences are
        // below 2³⁰.
        let drop = |valve: &Valve, difference| match structure.lower_limit {
            LowerLimit::Constant => 0,
            LowerLimit::ByPressure => valve.limit.drop(&self.supply, difference),
        };
        let drop_fill = || drop(&self.fill, self.supply.pressure.wrapping_sub(pressure));
        let drop_vent = || drop(&self.vent, pressure);
        match structure.scheme {
            Scheme::Separate if u == 0 => (Duty::OFF, Duty::OFF),
            Scheme::Separate if venting => (Duty::OFF, self.vent.alone(magnitude, drop_vent())),
            Scheme::Separate => (self.fill.alone(magnitude, drop_fill()), Duty::OFF),
            Scheme::Together if !venting => (
                self.fill.above_middle(magnitude),
                self.vent.below_middle(magnitude, drop_vent()),
            ),
            Scheme::Together => (
                self.fill.below_middle(magnitude, drop_fill()),
                self.vent.above_middle(magnitude),
            ),
        }
    }
}

/// Duty cycle range of one valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
struct Valve {
    /// Lower limit DC_min.
    limit: OpeningCurve,
    /// DC_max - DC_min without pressure difference (%), 2⁻²⁴.
    span: i32,
    /// Duty cycle at u = 0 when both valves are driven (%), 2⁻¹⁶.
    middle: i32,
}

impl Valve {
    /// Range 0 to 100 % (equations 6.3 to 6.5).
    const TRADITIONAL: Self = Self {
        limit: OpeningCurve::level(0),
        span: Duty::FULL.to_bits() << SPAN_SHIFT,
        middle: 0,
    };

    /// Maps `magnitude` of u (100 %, 2⁻²⁰) to DC_min ..= DC_max.
    #[inline(always)]
    const fn alone(&self, magnitude: i32, drop: i32) -> Duty {
        let min = self.limit.without_pressure().wrapping_sub(drop);
        let span = self.span.wrapping_add(drop << SPAN_SHIFT);
        Duty::from_proved_bits(min.wrapping_add(share(span, magnitude)))
    }

    /// Maps `magnitude` of u (100 %, 2⁻²⁰) to the range from the middle up to DC_max.
    #[inline(always)]
    const fn above_middle(&self, magnitude: i32) -> Duty {
        let max = self
            .limit
            .without_pressure()
            .wrapping_add(self.span >> SPAN_SHIFT);
        self.towards(max, magnitude)
    }

    /// Maps `magnitude` of u (100 %, 2⁻²⁰) to the range from the middle down to DC_min.
    #[inline(always)]
    const fn below_middle(&self, magnitude: i32, drop: i32) -> Duty {
        self.towards(self.limit.without_pressure().wrapping_sub(drop), magnitude)
    }

    #[inline(always)]
    const fn towards(&self, end: i32, magnitude: i32) -> Duty {
        let span = end.wrapping_sub(self.middle) << SPAN_SHIFT;
        Duty::from_proved_bits(self.middle.wrapping_add(share(span, magnitude)))
    }
}

/// Number of bits by which a span is finer than a duty cycle: 100 % then has 31 bits.
const SPAN_SHIFT: u32 = 8;

/// Returns the share |u| (2⁻²⁰, at most 1) of a span (2⁻²⁴ %) in 2⁻¹⁶ %: exactly 0 at 0 and the whole span at 1.
#[inline(always)]
const fn share(span: i32, magnitude: i32) -> i32 {
    high_product(span, magnitude << 4)
}

/// Field names of one valve's settings, as error messages show them.
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

/// Checked valve without a middle yet, with the values that the check of the middle needs.
struct CheckedValve {
    valve: Valve,
    fields: Fields,
    /// Largest DC_min over all pressure differences (%).
    min_pct: I16F16,
    max_pct: I16F16,
}

impl CheckedValve {
    const fn new(fields: Fields, settings: &Settings) -> Result<Self, ConfigError> {
        let max_pct = if fields.is_fill {
            settings.duty_max_fill_pct
        } else {
            settings.duty_max_vent_pct
        };
        let (limit, min_pct) = match settings.duty_min {
            settings::LowerLimit::Constant { fill_pct, vent_pct } => {
                let min_pct = if fields.is_fill { fill_pct } else { vent_pct };
                let min = propagate!(checked(fields.min, min_pct));
                (OpeningCurve::level(min), min_pct)
            }
            settings::LowerLimit::PressureDependent { fill, vent } => {
                let opening = if fields.is_fill { fill } else { vent };
                let names = OpeningFields {
                    without_pressure: fields.min,
                    at_half: fields.at_half,
                    with_supply_pressure: fields.with_supply_pressure,
                };
                let curve = propagate!(OpeningCurve::new(&opening, names));
                (curve, opening.without_pressure_pct)
            }
        };
        let max = propagate!(
            Range::of(fields.max)
                .from(min_pct)
                .checked_not_below(fields.min, fields.max, max_pct)
        );
        let min = min_pct.to_bits();
        Ok(Self {
            valve: Valve {
                limit,
                span: max.wrapping_sub(min) << SPAN_SHIFT,
                middle: min,
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
