//! Chamber whose volume grows with the pressure (E65): a hose, a bellows.

use super::Volume;

/// Growth of the volume with the gauge pressure p: G p, or G P (1 - exp(-p/P)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Growth {
    /// G (m³/Pa).
    slope: f64,
    /// P (Pa); `None` where the growth is in proportion to the pressure.
    fading: Option<f64>,
    /// Ambient pressure (Pa abs).
    ambient: f64,
}

impl Growth {
    /// Returns the growth by `slope` (m³/Pa) that fades over `fading` (Pa) above `ambient` (Pa abs); `None` for a slope of 0. A `fading` of 0
    /// is a growth in proportion to the pressure.
    pub(crate) fn new(slope: f64, fading: f64, ambient: f64) -> Option<Self> {
        (slope > 0.0).then_some(Self {
            slope,
            fading: (fading > 0.0).then_some(fading),
            ambient,
        })
    }

    /// Returns the grown volume at `pressure` (Pa abs).
    pub(crate) fn volume(&self, pressure: f64) -> Volume {
        let gauge = pressure - self.ambient;
        let (size, compliance) = match self.fading {
            None => (self.slope * gauge, self.slope),
            Some(fading) => {
                let left = (-gauge / fading).exp();
                (self.slope * fading * (1.0 - left), self.slope * left)
            }
        };
        Volume {
            size,
            compliance,
            growth: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::{Command, PlantParameters, Simulator, Tolerance};

    /// Isothermal, choked filling: the same mass of air enters a stiff chamber and one that grows, so p V is the same.
    #[test]
    fn the_mass_that_fills_a_hose_is_that_of_pressure_and_volume() {
        let fill = |plant: &PlantParameters| {
            let mut simulator = Simulator::with_tolerance(plant, Tolerance::scaled(0.01));
            simulator.command(Command {
                duty_fill_pct: 100.0,
                duty_vent_pct: 0.0,
            });
            simulator.advance_to_ns(55_000_000);
            simulator.state().pressure
        };
        let stiff = PlantParameters::nominal();
        for fading_bar in [0.0, 3.0] {
            let mut hose = stiff.clone();
            hose.chamber.growth_m3_per_bar = 5e-6;
            hose.chamber.growth_pressure_bar = fading_bar;
            let [grown, plain] = [&hose, &stiff].map(fill);
            let gauge_bar = (grown - stiff.gas.ambient_pressure_pa) / 1e5;
            let growth = match fading_bar {
                0.0 => 5e-6 * gauge_bar,
                fading_bar => 5e-6 * fading_bar * (1.0 - f64::exp(-gauge_bar / fading_bar)),
            };
            let volume = stiff.chamber.volume_m3 + growth;
            let ratio = grown * volume / (plain * stiff.chamber.volume_m3);
            assert!(plain > grown + 1e4, "{plain} {grown}");
            assert!((ratio - 1.0).abs() < 1e-4, "{fading_bar}: {ratio}");
        }
    }
}
