//! Walls of the first chamber: its volume over the pressure.

/// Walls of a chamber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Walls {
    /// The volume is constant.
    Rigid,
    /// A hose whose volume grows in proportion to the gauge pressure.
    Hose {
        /// Growth (m³/Pa).
        growth_m3_per_pa: f64,
    },
    /// A hose whose growth comes to an end.
    HoseAtMost {
        /// Growth at a high pressure (m³).
        growth_at_most_m3: f64,
        /// Gauge pressure at which 63 % of it is reached (Pa).
        growth_pressure_pa: f64,
    },
}

impl Walls {
    /// Returns the growth of the volume (m³) at a gauge pressure (Pa), and its derivative (m³/Pa).
    fn growth(&self, gauge: f64) -> (f64, f64) {
        match *self {
            Self::Rigid => (0.0, 0.0),
            Self::Hose { growth_m3_per_pa } => (growth_m3_per_pa * gauge, growth_m3_per_pa),
            Self::HoseAtMost {
                growth_at_most_m3: most,
                growth_pressure_pa: pressure,
            } => {
                let left = (-gauge / pressure).exp();
                (most * (1.0 - left), most / pressure * left)
            }
        }
    }

    /// Returns the volume (m³) at a pressure (Pa abs), and its derivative (m³/Pa).
    pub(super) fn volume(&self, at_ambient_m3: f64, ambient: f64, pressure: f64) -> (f64, f64) {
        let (growth, slope) = self.growth(pressure - ambient);
        (at_ambient_m3 + growth, slope)
    }

    /// Returns the pressure (Pa abs) at which pressure times volume is `product` (J): Newton's method from `guess`.
    pub(super) fn pressure(
        &self,
        at_ambient_m3: f64,
        ambient: f64,
        product: f64,
        guess: f64,
    ) -> f64 {
        let mut pressure = guess;
        for _ in 0..STEPS_MAX {
            let (volume, slope) = self.volume(at_ambient_m3, ambient, pressure);
            let step = (product - pressure * volume) / (volume + pressure * slope);
            pressure += step;
            if step.abs() < PRESSURE_ERROR_MAX {
                break;
            }
        }
        pressure
    }
}

/// Error of the pressure at which the method ends (Pa), and its largest number of steps.
const PRESSURE_ERROR_MAX: f64 = 1e-6;
const STEPS_MAX: usize = 20;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_pressure_is_that_of_the_product() {
        let hoses = [
            Walls::Rigid,
            Walls::Hose {
                growth_m3_per_pa: 60e-11,
            },
            Walls::HoseAtMost {
                growth_at_most_m3: 200e-6,
                growth_pressure_pa: 2e5,
            },
        ];
        for walls in hoses {
            for pressure in [1e5, 1.3e5, 4e5, 9e5] {
                let (volume, _) = walls.volume(400e-6, 1e5, pressure);
                let found = walls.pressure(400e-6, 1e5, pressure * volume, 1e5);
                assert!((found - pressure).abs() < 1e-3, "{walls:?} {found}");
            }
        }
    }
}
