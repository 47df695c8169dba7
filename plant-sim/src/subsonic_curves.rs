//! Subsonic flow through one valve into or out of a chamber: one curve for all areas, volumes and pressures.

use crate::orifice::{LAMINAR_RATIO, NozzleLaw};
use crate::solver::dormand_prince;
use crate::solver::table::Table;

/// Number of intervals of a tabulated curve; the error is below 1e-9 of the pressure ratio.
const INTERVALS: usize = 192;

/// Universal curves of subsonic flow through the fill and the vent valve.
#[derive(Debug, Clone, PartialEq)]
pub struct SubsonicCurves {
    curves: [Curve; 2],
}

impl SubsonicCurves {
    /// Tabulates the curves of the nozzle laws of fill and vent valve.
    pub(crate) fn new([fill, vent]: [&NozzleLaw; 2]) -> Self {
        let into = |ratio: f64| fill.flow_function(ratio);
        let out_of = |ratio: f64| ratio * vent.flow_function(ratio);
        Self {
            curves: [
                Curve::new(into, fill.critical_ratio()),
                Curve::new(out_of, vent.critical_ratio()),
            ],
        }
    }

    /// Returns the curve of the fill (0) or the vent valve (1).
    #[inline]
    pub(crate) fn of(&self, valve: usize) -> &Curve {
        &self.curves[valve]
    }
}

/// Curve r(θ) of dr/dθ = h(r) from the critical ratio up to the laminar zone, in s = √(1 - r): the square root at equal
/// pressures is then a straight line.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Curve {
    /// θ over s.
    theta: Table,
    /// s over θ.
    s: Table,
    /// θ at the laminar zone.
    end: f64,
}

impl Curve {
    fn new(h: impl Fn(f64) -> f64, lowest_ratio: f64) -> Self {
        // -ds/dθ, smooth and positive up to equal pressures. The ratio does not reach the ends, where the law changes.
        let (nearly_choked, nearly_laminar) = (lowest_ratio + 1e-12, LAMINAR_RATIO - 1e-12);
        let rate = |s: f64| h((1.0 - s * s).clamp(nearly_choked, nearly_laminar)) / (2.0 * s);
        let (least, most) = ((1.0 - LAMINAR_RATIO).sqrt(), (1.0 - lowest_ratio).sqrt());
        let step = (most - least) / INTERVALS as f64;
        let node = |n: usize| least + step * n as f64;

        let mut theta = [0.0; INTERVALS + 1];
        for n in (0..INTERVALS).rev() {
            theta[n] = theta[n + 1] + integral(|s| 1.0 / rate(s), node(n), step);
        }
        let end = theta[0];
        let theta_nodes = (0..=INTERVALS).map(|n| [theta[n], -1.0 / rate(node(n))]);

        let theta_step = end / INTERVALS as f64;
        let mut s = most;
        let s_nodes = (0..=INTERVALS).map(|_| {
            let here = [s, -rate(s)];
            let slope = |s: &[f64; 1]| [-rate(s[0].max(least))];
            s = dormand_prince::step(slope, &[s], &slope(&[s]), theta_step)
                .step
                .end[0];
            here
        });
        Self {
            s: Table::new(0.0, theta_step, s_nodes),
            theta: Table::new(least, step, theta_nodes),
            end,
        }
    }

    /// Returns θ at which the laminar zone begins.
    pub(crate) fn end(&self) -> f64 {
        self.end
    }

    /// Returns θ at a pressure ratio.
    pub(crate) fn theta_of(&self, ratio: f64) -> f64 {
        self.theta.at((1.0 - ratio).sqrt())
    }

    /// Returns the pressure ratio at θ.
    pub(crate) fn ratio_at(&self, theta: f64) -> f64 {
        let s = self.s.at(theta);
        1.0 - s * s
    }
}

/// Returns ∫ f over `step` from `start`, by Boole's rule.
fn integral(f: impl Fn(f64) -> f64, start: f64, step: f64) -> f64 {
    let at = |quarter: f64| f(start + 0.25 * quarter * step);
    step / 90.0 * (7.0 * (at(0.0) + at(4.0)) + 32.0 * (at(1.0) + at(3.0)) + 12.0 * at(2.0))
}
