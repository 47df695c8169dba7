//! Opening delay of an on/off valve that depends on the pressure difference and the supply voltage (E73).

/// Share of the nominal voltage that counts at least: a valve without voltage never opens, and a delay is finite.
const LEAST_SHARE: f64 = 0.01;

/// Change of the opening delay with the pressure difference at the valve and with the supply voltage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OpeningDelay {
    /// Share by which the delay grows from no pressure difference to the nominal one (-).
    pub pressure_share: f64,
    /// Exponent of the nominal voltage over the present one (-).
    pub voltage_exponent: f64,
    /// Pressure difference (Pa) at which the valve has the delay of the plant file, ...
    pub nominal_drop: f64,
    /// ... and the supply voltage (V).
    pub nominal_voltage: f64,
}

impl OpeningDelay {
    /// Returns the delay over that of the plant file (-) at a pressure difference (Pa) and a supply voltage (V).
    pub(crate) fn factor(&self, drop: f64, voltage: f64) -> f64 {
        let away = (drop - self.nominal_drop) / self.nominal_drop;
        let by_pressure = (1.0 + self.pressure_share * away).max(0.0);
        let lack = self.nominal_voltage / voltage.max(LEAST_SHARE * self.nominal_voltage);
        by_pressure * lack.powf(self.voltage_exponent)
    }
}
