//! The coil's resistance and its temperature (E42, E43).

/// Heat balance of a coil: C dT/dt = R i² - k (T - T_ambient).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heating {
    /// Heat capacity (J/K).
    pub(crate) heat_capacity: f64,
    /// Cooling (W/K).
    pub(crate) cooling: f64,
    /// Temperature coefficient of the resistance (1/K).
    pub(crate) coefficient: f64,
    /// Resistance at 20 °C (Ω).
    pub(crate) at_20: f64,
    /// What the surroundings are warmer than 20 °C (K).
    pub(crate) ambient: f64,
}

impl Heating {
    /// What a coil is warmer than 20 °C (K) before it had any current.
    pub(crate) fn ambient(&self) -> f64 {
        self.ambient
    }

    /// The temperature, counted from 20 °C (K), after `heat` (J) came in over `duration` (s).
    pub(crate) fn after(&self, temperature: f64, heat: f64, duration: f64) -> f64 {
        // Exact for a steady power.
        let rate = self.cooling / self.heat_capacity;
        let share = -(-rate * duration).exp_m1();
        let cooled = temperature - share * (temperature - self.ambient);
        let held = if rate * duration > 1e-9 {
            share / (rate * duration)
        } else {
            1.0
        };
        cooled + held * heat / self.heat_capacity
    }

    /// Resistance (Ω) at a temperature counted from 20 °C (K).
    pub(crate) fn resistance(&self, temperature: f64) -> f64 {
        resistance(self.at_20, self.coefficient, temperature)
    }
}

/// Resistance (Ω) at `difference` (K) above 20 °C, of copper that has `at_20` there (equation 5.7).
#[inline]
pub(crate) fn resistance(at_20: f64, coefficient: f64, difference: f64) -> f64 {
    at_20 * (1.0 + coefficient * difference)
}
