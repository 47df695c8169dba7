//! Knowledge of the values in a plant file.

use super::spec::ParameterSpec;

/// Knowledge of a value in a plant file. A value without such a statement has the usual tolerance of its part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Knowledge {
    /// `{ value = V, exact = true }`: no fit changes it.
    Exact,
    /// `{ value = V, tolerance_pct = T }`: within T % of V.
    TolerancePct(f64),
    /// `{ value = V, tolerance = T }`: within T of V, in the unit of the parameter.
    Tolerance(f64),
    /// `{ min = A, max = B }`, optionally with a `value` at which a fit begins.
    Range(f64, f64),
    /// `"unknown"`: anywhere in the physical range.
    Unknown,
}

impl Knowledge {
    /// Returns the smallest and the largest possible value of `spec`, for which the plant file gives `value`.
    pub fn bounds(self, spec: &ParameterSpec, value: f64) -> (f64, f64) {
        let (least, most) = match self {
            Self::Exact => (value, value),
            Self::TolerancePct(percent) => {
                let half = percent / 100.0 * value.abs();
                (value - half, value + half)
            }
            Self::Tolerance(half) => (value - half, value + half),
            Self::Range(least, most) => (least, most),
            Self::Unknown => spec.range,
        };
        (least.max(spec.range.0), most.min(spec.range.1))
    }
}

/// Returns the value at which a fit begins in a range without further knowledge: its middle on a logarithmic scale if
/// that exists.
pub(crate) fn middle((least, most): (f64, f64)) -> f64 {
    if least > 0.0 {
        (least * most).sqrt()
    } else {
        0.5 * (least + most)
    }
}
