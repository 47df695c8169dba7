//! Fixed restrictions: orifices and tubes in parallel or in series with a valve (E46).

use crate::orifice::{LAMINAR_RATIO, NozzleLaw};
use crate::solver::root::increasing_root;

/// Fixed orifice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Restriction {
    /// Discharge coefficient times area (m²).
    pub effective_area: f64,
}

impl Restriction {
    /// Returns the orifice with the flow of this one and `other` in series: 1/A² adds up, which is exact for small
    /// pressure drops and within a few percent for all.
    #[must_use]
    pub fn in_series_with(self, other: Option<Self>) -> Self {
        let Some(other) = other else { return self };
        let square = |one: Self| one.effective_area.powi(-2);
        Self {
            effective_area: (square(self) + square(other)).sqrt().recip(),
        }
    }
}

/// Restriction at the mouth of a volume, whose flow is linear for nearly equal pressures.
///
/// Both sides of it are nearly equal most of the time. With the slope of an orifice there, a small volume would follow in
/// microseconds, which no tube lets it do. In a linear zone that is wider than necessary, a chamber follows too late.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mouth {
    /// Discharge coefficient times area (m²).
    pub effective_area: f64,
    /// Ratio of downstream to upstream pressure above which the flow is linear in the pressure drop.
    linear_ratio: f64,
    /// Slope of the linear zone per (1 - ratio) (s/m).
    linear_slope: f64,
}

/// Time constant (s) with which a volume comes to the pressure beyond its mouth in the linear zone, ...
const LINEAR_S: f64 = 3e-3;
/// ... unless the zone would be wider than this ratio. It is never narrower than that of a valve.
const LEAST_LINEAR_RATIO: f64 = 0.99;

impl Mouth {
    /// Creates the mouth of a `volume` (m³) that gas of `gas` = R T (J/kg) passes by the law of `nozzle`.
    pub(crate) fn new(effective_area: f64, volume: f64, nozzle: &NozzleLaw, gas: f64) -> Self {
        // The flow over the square root of (1 - r) is constant for nearly equal pressures, so that the time constant over it
        // is as well.
        let flow = |ratio: f64| gas * effective_area * nozzle.flow_function(ratio);
        let width = 1.0 - LEAST_LINEAR_RATIO;
        let widest_s = volume * width / flow(LEAST_LINEAR_RATIO);
        let width = width * (LINEAR_S / widest_s).powi(2).min(1.0);
        let linear_ratio = (1.0 - width).min(LAMINAR_RATIO);
        Self {
            effective_area,
            linear_ratio,
            linear_slope: nozzle.flow_function(linear_ratio) / (1.0 - linear_ratio),
        }
    }

    /// Returns the mass flow (kg/s) from `upstream` to `downstream` (Pa abs): the nozzle law, linear for nearly equal
    /// pressures.
    #[inline]
    pub fn mass_flow(&self, nozzle: &NozzleLaw, upstream: f64, downstream: f64) -> f64 {
        if upstream < downstream {
            return -self.mass_flow(nozzle, downstream, upstream);
        }
        let ratio = downstream / upstream;
        let factor = if ratio < self.linear_ratio {
            nozzle.flow_function(ratio)
        } else {
            self.linear_slope * (1.0 - ratio)
        };
        self.effective_area * upstream * factor
    }

    /// Returns the mass flow per effective area, upstream pressure and (1 - ratio) in the linear zone (s/m).
    #[cfg(test)]
    pub(crate) fn linear_slope(&self) -> f64 {
        self.linear_slope
    }
}

/// Returns the mass flow (kg/s) through two orifices in series without a volume between them, and the pressure (Pa abs)
/// between them. `areas` are the effective areas (m²): first that next to the pressure `upstream`, then that next to
/// `downstream`.
pub fn in_series(
    nozzle: &NozzleLaw,
    areas: [f64; 2],
    upstream: f64,
    downstream: f64,
) -> (f64, f64) {
    if upstream < downstream {
        let (flow, between) = in_series(nozzle, [areas[1], areas[0]], downstream, upstream);
        return (-flow, between);
    }
    if areas[0] <= 0.0 {
        return (0.0, downstream);
    }
    if areas[1] <= 0.0 || upstream == downstream {
        return (0.0, upstream);
    }
    // Squares of both flows per effective area of the second orifice, and their derivatives by the pressure between:
    // nearly linear in it, while the flows themselves have an infinite slope at either end.
    let share = areas[0] / areas[1];
    let squares = |between: f64| {
        let [into, into_slope] = nozzle.flow_function_with_slope(between / upstream);
        let ratio = downstream / between;
        let [out, out_slope] = nozzle.flow_function_with_slope(ratio);
        let (into, into_slope) = (share * upstream * into, share * into_slope);
        let (out, out_slope) = (between * out, out - ratio * out_slope);
        let surplus = out * out - into * into;
        [surplus, 2.0 * (out * out_slope - into * into_slope)]
    };
    // Start value: for a linear function, the pressure drops are inversely proportional to the squares of the areas.
    let start = downstream + (upstream - downstream) * share * share / (1.0 + share * share);
    let between = increasing_root(squares, [downstream, upstream], start);
    (nozzle.mass_flow(areas[1], between, downstream), between)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlantParameters;

    #[test]
    fn the_same_flow_passes_both_orifices() {
        let nozzle = PlantParameters::nominal().plant().nozzle;
        for areas in [[1e-6, 1e-6], [1e-7, 1e-6], [1e-6, 1e-8]] {
            for downstream in [1e5, 5e5, 9e5, 9.39e5] {
                let (flow, between) = in_series(&nozzle, areas, 9.4e5, downstream);
                let first = nozzle.mass_flow(areas[0], 9.4e5, between);
                assert!((flow / first - 1.0).abs() < 1e-6, "{areas:?} {downstream}");
                let (back, same) = in_series(&nozzle, [areas[1], areas[0]], downstream, 9.4e5);
                assert_eq!((back, same), (-flow, between));
            }
        }
    }

    /// Both choked: the pressure between is A1/A2 times the upstream pressure.
    #[test]
    fn two_choked_orifices_have_the_pressure_of_the_areas_ratio_between_them() {
        let nozzle = PlantParameters::nominal().plant().nozzle;
        let (_, between) = in_series(&nozzle, [1e-6, 4e-6], 8e5, 1e4);
        assert!((between / 2e5 - 1.0).abs() < 1e-9, "{between}");
    }

    /// The zone is as wide as the time constant requires, from that of a valve to a hundredth.
    #[test]
    fn a_volume_follows_its_mouth_in_three_milliseconds_where_the_zone_can_be_so_wide() {
        let plant = PlantParameters::nominal().plant();
        let gas = plant.chamber.pressure_per_mass * plant.chamber.volume;
        for (volume, ratio) in [
            (1e-6, Some(LEAST_LINEAR_RATIO)),
            (10e-6, None),
            (20e-6, None),
            (60e-6, Some(LAMINAR_RATIO)),
        ] {
            let mouth = Mouth::new(3e-7, volume, &plant.nozzle, gas);
            let found_s = volume / (gas * mouth.effective_area * mouth.linear_slope);
            match ratio {
                Some(ratio) => assert_eq!(mouth.linear_ratio, ratio),
                None => assert!((found_s / LINEAR_S - 1.0).abs() < 0.01, "{found_s}"),
            }
        }
        let mouth = Mouth::new(3e-7, 60e-6, &plant.nozzle, gas);
        let below = plant.nozzle.mass_flow(3e-7, 9e5, 8e5);
        assert_eq!(mouth.mass_flow(&plant.nozzle, 9e5, 8e5), below);
        assert_eq!(mouth.mass_flow(&plant.nozzle, 8e5, 9e5), -below);
    }

    #[test]
    fn a_small_pressure_drop_divides_as_the_squares_of_the_areas() {
        let nozzle = PlantParameters::nominal().plant().nozzle;
        let (flow, _) = in_series(&nozzle, [2e-6, 1e-6], 5e5, 4.95e5);
        let one = Restriction {
            effective_area: 2e-6,
        }
        .in_series_with(Some(Restriction {
            effective_area: 1e-6,
        }));
        let lumped = nozzle.mass_flow(one.effective_area, 5e5, 4.95e5);
        assert!((flow / lumped - 1.0).abs() < 3e-3, "{flow} {lumped}");
    }
}
