//! How well a plant file knows a value.

use super::spec::ParameterSpec;

/// How well a plant file knows one of its values. A value without such a statement has the usual tolerance of its part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Knowledge {
    /// `{ value = V, exact = true }`: no fit moves it.
    Exact,
    /// `{ value = V, tolerance_pct = T }`: within T % of V.
    TolerancePct(f64),
    /// `{ value = V, tolerance = T }`: within T of V, in the unit of the parameter.
    Tolerance(f64),
    /// `{ min = A, max = B }`, perhaps with a `value` at which a fit begins.
    Range(f64, f64),
    /// `"unknown"`: anywhere in the physical range.
    Unknown,
}

impl Knowledge {
    /// Returns the least and the largest possible value of `spec`, of which the plant file gives `value`.
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

/// Returns the value at which a fit begins in a range of which nothing else is known: its middle on a logarithmic scale where
/// that exists.
pub(crate) fn middle((least, most): (f64, f64)) -> f64 {
    if least > 0.0 {
        (least * most).sqrt()
    } else {
        0.5 * (least + most)
    }
}
