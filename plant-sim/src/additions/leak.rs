//! A leak from one pressure to another (E41).

use crate::orifice::NozzleLaw;

/// A leak from one pressure to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leak {
    law: LeakLaw,
    /// Effective area of the orifice that leaks as much at the reference pressures (m²).
    area: f64,
    /// Mass flow per area at the reference pressures (kg/(s m²)).
    reference_flow: f64,
    /// Difference of the reference pressures (Pa), and of their squares (Pa²).
    reference: [f64; 2],
}

/// How a leak's flow depends on the pressures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LeakLaw {
    Orifice,
    /// ΔP² = a ṁ + b ṁ², with this share of the linear part at the reference.
    Mixed(f64),
    Power(f64),
}

impl Leak {
    /// The leak that lets through what an orifice with `area` (m²) does from `high` to `low` (Pa abs).
    pub(crate) fn new(law: LeakLaw, area: f64, nozzle: &NozzleLaw, high: f64, low: f64) -> Self {
        Self {
            law,
            area,
            reference_flow: nozzle.mass_flow(1.0, high, low),
            reference: [high - low, high * high - low * low],
        }
    }

    /// The area by which it widens a valve beside it; none where it follows another law than an orifice.
    pub(crate) fn orifice_area(&self) -> Option<f64> {
        (self.law == LeakLaw::Orifice).then_some(self.area)
    }

    /// Mass flow (kg/s) from `upside` to `downside` (Pa abs); negative where they are reversed.
    pub(crate) fn mass_flow(&self, nozzle: &NozzleLaw, upside: f64, downside: f64) -> f64 {
        if upside < downside {
            return -self.mass_flow(nozzle, downside, upside);
        }
        let reference = self.area * self.reference_flow;
        match self.law {
            LeakLaw::Orifice => nozzle.mass_flow(self.area, upside, downside),
            LeakLaw::Power(exponent) => {
                reference * ((upside - downside) / self.reference[0]).powf(exponent)
            }
            LeakLaw::Mixed(share) => {
                // share m + (1 - share) m² = s for the flow m relative to the reference.
                let s = (upside * upside - downside * downside) / self.reference[1];
                let root = (share * share + 4.0 * (1.0 - share) * s).sqrt();
                if s == 0.0 {
                    0.0
                } else {
                    reference * 2.0 * s / (share + root)
                }
            }
        }
    }
}
