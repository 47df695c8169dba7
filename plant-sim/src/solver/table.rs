//! Function tabulated with its derivative on an even grid, cubic in between.

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Table {
    start: f64,
    intervals_per_unit: f64,
    /// Value, and derivative times the step, at each node.
    nodes: Vec<[f64; 2]>,
}

impl Table {
    /// Creates a table with nodes `step` apart from `start` on, each a value with its derivative.
    pub(crate) fn new(start: f64, step: f64, nodes: impl Iterator<Item = [f64; 2]>) -> Self {
        Self {
            start,
            intervals_per_unit: 1.0 / step,
            nodes: nodes.map(|[value, slope]| [value, slope * step]).collect(),
        }
    }

    /// Returns the value at `x`; beyond the ends, the outermost cubic is continued.
    #[inline]
    pub(crate) fn at(&self, x: f64) -> f64 {
        self.with_slope_at(x)[0]
    }

    /// Returns the value and the slope at `x`; beyond the ends, the outermost cubic is continued.
    #[inline]
    pub(crate) fn with_slope_at(&self, x: f64) -> [f64; 2] {
        let position = (x - self.start) * self.intervals_per_unit;
        let index = (position.max(0.0) as usize).min(self.nodes.len() - 2);
        let t = position - index as f64;
        let ([y0, m0], [y1, m1]) = (self.nodes[index], self.nodes[index + 1]);
        let rise = y1 - y0;
        let (square, cube) = (3.0 * rise - 2.0 * m0 - m1, m0 + m1 - 2.0 * rise);
        [
            y0 + t * (m0 + t * (square + t * cube)),
            (m0 + t * (2.0 * square + t * 3.0 * cube)) * self.intervals_per_unit,
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_function_is_reproduced_to_the_fourth_order() {
        let worst = |n: usize| {
            let step = 2.0 / n as f64;
            let nodes = (0..=n).map(|k| {
                let x = 1.0 + step * k as f64;
                [x.ln(), 1.0 / x]
            });
            let table = Table::new(1.0, step, nodes);
            (0..=1000)
                .map(|k| 1.0 + 2e-3 * f64::from(k))
                .map(|x| (table.at(x) - x.ln()).abs())
                .fold(0.0, f64::max)
        };
        assert!(worst(64) < 1e-7);
        let order = (worst(32) / worst(64)).log2();
        assert!((3.8..4.2).contains(&order), "{order}");
    }
}
