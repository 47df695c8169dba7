//! Opening delay of an on/off valve that depends on the voltage and on the pressure difference (E70).

/// Change of the opening delay with the conditions.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpeningDelay {
    /// Exponent of the nominal voltage over the voltage (-).
    pub voltage_exponent: f64,
    /// Share by which the delay grows from no pressure difference to the nominal one (-).
    pub pressure_share: f64,
    /// Voltage (V) at which the valve has the delay of the plant file, ...
    pub nominal_voltage: f64,
    /// ... and the pressure difference (Pa).
    pub nominal_drop: f64,
}

impl OpeningDelay {
    /// Returns the delay over that of the plant file (-) at a voltage (V) and a pressure difference (Pa).
    pub(crate) fn factor(&self, voltage: f64, drop: f64) -> f64 {
        let least_voltage = 0.01 * self.nominal_voltage;
        let by_voltage =
            (self.nominal_voltage / voltage.max(least_voltage)).powf(self.voltage_exponent);
        let away = (drop - self.nominal_drop) / self.nominal_drop;
        by_voltage * (1.0 + self.pressure_share * away).max(0.0)
    }
}
