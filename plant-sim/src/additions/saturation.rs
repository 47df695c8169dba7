//! Magnetisation curve of the iron (E44).

/// i = λ / (ratio L) (1 + (λ/λ_s)^n).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saturation {
    /// Unsaturated inductance divided by that of the plant file (-).
    pub(crate) ratio: f64,
    /// λ_s (Wb).
    pub(crate) flux: f64,
    /// n (-).
    pub(crate) exponent: f64,
}

impl Saturation {
    /// Returns the current (A) of a flux linkage (Wb) for a plain coil with `inductance` (H).
    #[inline]
    pub(crate) fn current(&self, flux: f64, inductance: f64) -> f64 {
        let knee = (flux.abs() / self.flux).powf(self.exponent);
        flux / (self.ratio * inductance) * (1.0 + knee)
    }

    /// Returns the unsaturated inductance divided by that of the plant file (-).
    pub fn unsaturated_inductance_ratio(&self) -> f64 {
        self.ratio
    }
}
