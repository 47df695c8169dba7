//! Statistics of the numbers of one column.

use crate::united::OwnRate;

/// Number, extremes and order of the numbers of a column, in the unit of the file.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnValues {
    /// Number of cells with a number.
    pub count: u64,
    /// Number of cells without a number.
    pub missing: u64,
    /// Least number; infinity without any.
    pub least: f64,
    /// Greatest number; negative infinity without any.
    pub greatest: f64,
    /// Whether every number is an integer.
    pub are_whole: bool,
    /// Whether each number is greater than the one before it.
    pub increase: bool,
    first: f64,
    last: f64,
    cells: OwnRate,
}

impl Default for ColumnValues {
    fn default() -> Self {
        Self {
            count: 0,
            missing: 0,
            least: f64::INFINITY,
            greatest: f64::NEG_INFINITY,
            are_whole: true,
            increase: true,
            first: f64::NAN,
            last: f64::NAN,
            cells: OwnRate::default(),
        }
    }
}

impl ColumnValues {
    /// Creates the statistics of these numbers, NaN where missing.
    pub(crate) fn of(values: &[f64]) -> Self {
        let mut all = Self::default();
        values.iter().for_each(|&value| all.add(value));
        all
    }

    /// Adds the next cell; NaN is a cell without a number.
    pub(crate) fn add(&mut self, value: f64) {
        self.cells.add(!value.is_nan());
        if value.is_nan() {
            self.missing += 1;
            return;
        }
        self.increase &= self.count == 0 || value > self.last;
        if self.count == 0 {
            self.first = value;
        }
        self.count += 1;
        self.last = value;
        self.least = self.least.min(value);
        self.greatest = self.greatest.max(value);
        self.are_whole &= value.fract() == 0.0;
    }

    /// Returns whether the column has a lower rate than the rows: its empty cells alternate with numbers.
    pub fn has_own_rate(&self) -> bool {
        self.cells.is_own()
    }

    /// Returns the mean difference of two consecutive numbers; `None` for fewer than two.
    pub(crate) fn mean_step(&self) -> Option<f64> {
        (self.count > 1).then(|| (self.last - self.first) / (self.count - 1) as f64)
    }

    /// Returns whether the column has numbers, and all of them are within this range.
    pub(crate) fn are_within(&self, least: f64, greatest: f64) -> bool {
        self.count > 0 && self.least >= least && self.greatest <= greatest
    }
}
