//! Fixed restrictions: orifices and tubes in parallel or in series with a valve (E46).

use crate::orifice::NozzleLaw;
use crate::solver::root::increasing_root;

/// Ratio of downstream to upstream pressure above which the flow through a restriction between two volumes is linear in
/// the pressure drop. The zone is a hundred times as wide as that of a valve. Both sides are nearly equal most of the
/// time, and an orifice's slope there would give a time constant of microseconds, which no tube has.
pub const LINEAR_RATIO: f64 = 0.99;

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

    /// Returns the mass flow between two volumes (kg/s): the nozzle law, linear for nearly equal pressures.
    #[inline]
    pub fn mass_flow(&self, nozzle: &NozzleLaw, upstream: f64, downstream: f64) -> f64 {
        if upstream < downstream {
            return -self.mass_flow(nozzle, downstream, upstream);
        }
        let ratio = downstream / upstream;
        let factor = if ratio < LINEAR_RATIO {
            nozzle.flow_function(ratio)
        } else {
            nozzle.flow_function(LINEAR_RATIO) * (1.0 - ratio) / (1.0 - LINEAR_RATIO)
        };
        self.effective_area * upstream * factor
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
