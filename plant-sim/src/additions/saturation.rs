//! Magnetisation curve of the iron (E44).

/// i = λ / (ratio L) (1 + (λ/λ_s)^n).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Saturation {
    /// Unsaturated inductance over that of the plant file (-).
    pub(crate) ratio: f64,
    /// λ_s (Wb).
    pub(crate) flux: f64,
    /// n (-).
    pub(crate) exponent: f64,
}

impl Saturation {
    /// The current (A) that a flux linkage (Wb) takes where the plain coil has `inductance` (H).
    #[inline]
    pub(crate) fn current(&self, flux: f64, inductance: f64) -> f64 {
        let knee = (flux.abs() / self.flux).powf(self.exponent);
        flux / (self.ratio * inductance) * (1.0 + knee)
    }

    /// Unsaturated inductance over that of the plant file (-).
    pub fn unsaturated_inductance_ratio(&self) -> f64 {
        self.ratio
    }
}
