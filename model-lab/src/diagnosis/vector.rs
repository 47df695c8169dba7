//! Products of residuals.

pub(crate) fn square(residuals: &[f64]) -> f64 {
    dot(residuals, residuals)
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
