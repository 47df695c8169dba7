//! Missing flow as a law: a monotone table for a user-defined effect.

use plant_sim::PlantParameters;
use plant_sim::parameters::PA_PER_BAR;

use crate::diagnosis::result::FlowCurve;

/// Largest number of knots of a table.
const KNOTS: usize = 5;

/// Missing mass flow, monotonically rising or falling with the chamber pressure.
///
/// It is made of a curve against `p_ch` while both valves are shut. Between the knots it is linear, beyond them constant.
/// `examples/missing_flow_effect.rs` makes an effect of it.
#[derive(Debug, Clone, PartialEq)]
pub struct MissingFlow {
    /// Chamber pressure (Pa abs), rising, and mass flow into the chamber (kg/s).
    knots: Vec<(f64, f64)>,
}

impl MissingFlow {
    /// Returns the table of `curve`, in the chamber of `plant`; none where the curve is not one against the chamber pressure, or has fewer
    /// than two points.
    pub fn new(curve: &FlowCurve, plant: &PlantParameters) -> Option<Self> {
        if curve.against != crate::measured::PRESSURE || curve.points.len() < 2 {
            return None;
        }
        let ambient_pa = plant.gas.ambient_pressure_pa;
        let mass_per_bar = PA_PER_BAR / plant.plant().chamber.pressure_per_mass;
        let points: Vec<Step> = curve
            .points
            .iter()
            .map(|point| Step {
                at: point.at,
                value: point.bar_per_s,
                weight: point.standard_error.powi(-2),
            })
            .collect();
        let rising = monotone(&points, 1.0);
        let falling = monotone(&points, -1.0);
        let best = if misfit(&points, &rising) <= misfit(&points, &falling) {
            rising
        } else {
            falling
        };
        let knots = points
            .iter()
            .zip(best)
            .map(|(point, bar_per_s)| {
                (ambient_pa + point.at * PA_PER_BAR, bar_per_s * mass_per_bar)
            })
            .collect();
        Some(Self {
            knots: thinned(knots),
        })
    }

    /// Returns the mass flow into the chamber (kg/s) at a chamber pressure (Pa abs).
    pub fn at(&self, pressure_pa: f64) -> f64 {
        let above = self.knots.partition_point(|(knot, _)| *knot <= pressure_pa);
        let clamp = |n: usize| self.knots[n.min(self.knots.len() - 1)];
        let ((low, from), (high, to)) = (clamp(above.saturating_sub(1)), clamp(above));
        if high > low && above > 0 {
            from + (to - from) * (pressure_pa - low) / (high - low)
        } else {
            from
        }
    }

    /// Returns the knots: chamber pressure (Pa abs), rising, and mass flow into the chamber (kg/s).
    pub fn knots(&self) -> &[(f64, f64)] {
        &self.knots
    }
}

#[derive(Debug, Clone, Copy)]
struct Step {
    at: f64,
    value: f64,
    weight: f64,
}

/// Returns the nearest values that rise (`sign` 1) or fall (-1): neighbours in the wrong order are pooled until there are none (M. Ayer et
/// al. 1955).
fn monotone(points: &[Step], sign: f64) -> Vec<f64> {
    let mut pools: Vec<(f64, f64, usize)> = Vec::new();
    for point in points {
        pools.push((sign * point.value, point.weight, 1));
        while let [
            ..,
            (low, low_weight, low_count),
            (high, high_weight, high_count),
        ] = pools[..]
            && low > high
        {
            let weight = low_weight + high_weight;
            let pooled = (low * low_weight + high * high_weight) / weight;
            pools.truncate(pools.len() - 2);
            pools.push((pooled, weight, low_count + high_count));
        }
    }
    pools
        .into_iter()
        .flat_map(|(value, _, count)| core::iter::repeat_n(sign * value, count))
        .collect()
}

fn misfit(points: &[Step], values: &[f64]) -> f64 {
    points
        .iter()
        .zip(values)
        .map(|(point, value)| point.weight * (point.value - value).powi(2))
        .sum()
}

/// Removes one inner knot after the other, each time the one with the least deviation from a straight line.
fn thinned(mut knots: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    while knots.len() > KNOTS {
        let missed = |n: usize| {
            let ((a, from), (x, value), (b, to)) = (knots[n - 1], knots[n], knots[n + 1]);
            (from + (to - from) * (x - a) / (b - a) - value).abs()
        };
        let least = (1..knots.len() - 1).min_by(|&a, &b| missed(a).total_cmp(&missed(b)));
        knots.remove(least.expect("more than two knots have an inner one"));
    }
    knots
}
