//! Leak from one pressure to another (E41).

use crate::orifice::NozzleLaw;

/// Leak from one pressure to another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leak {
    law: LeakLaw,
    /// Effective area of the orifice with the same flow at the reference pressures (m²).
    area: f64,
    /// Mass flow per area at the reference pressures (kg/(s m²)).
    reference_flow: f64,
    /// Difference of the reference pressures (Pa), and of their squares (Pa²).
    reference: [f64; 2],
}

/// Law of a leak's flow over the pressures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum LeakLaw {
    Orifice,
    /// ΔP² = a ṁ + b ṁ², with this share of the linear part at the reference.
    Mixed(f64),
    Power(f64),
}

impl Leak {
    /// Creates the leak with the flow of an orifice with `area` (m²) from `high` to `low` (Pa abs).
    pub(crate) fn new(law: LeakLaw, area: f64, nozzle: &NozzleLaw, high: f64, low: f64) -> Self {
        Self {
            law,
            area,
            reference_flow: nozzle.mass_flow(1.0, high, low),
            reference: [high - low, high * high - low * low],
        }
    }

    /// Returns the area by which the leak widens a parallel valve; `None` if its law is not that of an orifice.
    pub(crate) fn orifice_area(&self) -> Option<f64> {
        (self.law == LeakLaw::Orifice).then_some(self.area)
    }

    /// Returns the mass flow (kg/s) from the pressure `upstream` to `downstream` (Pa abs); negative if `downstream` is
    /// larger.
    pub(crate) fn mass_flow(&self, nozzle: &NozzleLaw, upstream: f64, downstream: f64) -> f64 {
        if upstream < downstream {
            return -self.mass_flow(nozzle, downstream, upstream);
        }
        let reference = self.area * self.reference_flow;
        match self.law {
            LeakLaw::Orifice => nozzle.mass_flow(self.area, upstream, downstream),
            LeakLaw::Power(exponent) => {
                reference * ((upstream - downstream) / self.reference[0]).powf(exponent)
            }
            LeakLaw::Mixed(share) => {
                // share m + (1 - share) m² = s for the flow m relative to the reference.
                let s = (upstream * upstream - downstream * downstream) / self.reference[1];
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
