//! Opening delay of an on/off valve that depends on the pressure difference (E70).

/// Change of the opening delay with the pressure difference at the valve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpeningDelay {
    /// Share by which the delay grows from no pressure difference to the nominal one (-).
    pub pressure_share: f64,
    /// Pressure difference (Pa) at which the valve has the delay of the plant file.
    pub nominal_drop: f64,
}

impl OpeningDelay {
    /// Returns the delay over that of the plant file (-) at a pressure difference (Pa).
    pub(crate) fn factor(&self, drop: f64) -> f64 {
        let away = (drop - self.nominal_drop) / self.nominal_drop;
        (1.0 + self.pressure_share * away).max(0.0)
    }
}
