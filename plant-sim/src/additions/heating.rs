//! Resistance and temperature of the coil (E42, E43).

use super::WarmUp;

/// Heating of the coils by their surroundings and by their own current.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Heating {
    /// Temperature coefficient of the resistance (1/K).
    pub(crate) coefficient: f64,
    /// Resistance at 20 °C (Ω).
    pub(crate) at_20: f64,
    /// Temperature of the surroundings above 20 °C at the beginning (K).
    pub(crate) ambient: f64,
    /// Warming of the surroundings (K).
    pub(crate) warm_up: Option<WarmUp>,
    /// Heat store that the current warms; without it a coil has the temperature of its surroundings.
    pub(crate) winding: Option<HeatStore>,
    /// Heat store between the winding and the surroundings.
    pub(crate) body: Option<HeatStore>,
}

/// Heat balance of a part with one temperature: C dT/dt = P - k (T - T_around).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HeatStore {
    /// Heat capacity (J/K).
    capacity: f64,
    /// Cooling (W/K).
    cooling: f64,
}

/// Temperatures of a coil above 20 °C (K).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct CoilTemperature {
    pub(crate) winding: f64,
    body: f64,
}

impl HeatStore {
    /// Creates a heat store; `None` for an infinite capacity, which never warms.
    pub(crate) fn new(capacity: f64, cooling: f64) -> Option<Self> {
        capacity.is_finite().then_some(Self { capacity, cooling })
    }

    /// Returns the temperature after `heat` (J) came in over `duration` (s), and the heat passed on to the surroundings
    /// of the part (J).
    fn after(&self, temperature: f64, around: f64, heat: f64, duration: f64) -> (f64, f64) {
        // Exact for constant power.
        let rate = self.cooling / self.capacity;
        let share = -(-rate * duration).exp_m1();
        let cooled = temperature - share * (temperature - around);
        let held = if rate * duration > 1e-9 {
            share / (rate * duration)
        } else {
            1.0
        };
        let warmed = cooled + held * heat / self.capacity;
        (warmed, heat - self.capacity * (warmed - temperature))
    }
}

impl Heating {
    /// Returns the temperature of a coil before its first current.
    pub(crate) fn start(&self) -> CoilTemperature {
        CoilTemperature {
            winding: self.ambient,
            body: self.ambient,
        }
    }

    /// Returns the temperature after `heat` (J) came into the winding over `duration` (s), at `elapsed` (s) since the
    /// beginning.
    pub(crate) fn after(
        &self,
        coil: CoilTemperature,
        heat: f64,
        duration: f64,
        elapsed: f64,
    ) -> CoilTemperature {
        let risen = self.warm_up.map_or(0.0, |warm_up| warm_up.after(elapsed));
        let surroundings = self.ambient + risen;
        let around = self.body.map_or(surroundings, |_| coil.body);
        let (winding, passed_on) = match self.winding {
            Some(winding) => winding.after(coil.winding, around, heat, duration),
            None => (surroundings, 0.0),
        };
        let body = self.body.map_or(surroundings, |body| {
            body.after(coil.body, surroundings, passed_on, duration).0
        });
        CoilTemperature { winding, body }
    }

    /// Returns the increase of the resistance since the beginning (Ω).
    pub(crate) fn risen(&self, coil: CoilTemperature) -> f64 {
        let resistance = |difference| resistance(self.at_20, self.coefficient, difference);
        resistance(coil.winding) - resistance(self.ambient)
    }
}

/// Returns the resistance (Ω) at `difference` (K) above 20 °C, of copper with `at_20` at 20 °C (equation 5.7).
#[inline]
pub(crate) fn resistance(at_20: f64, coefficient: f64, difference: f64) -> f64 {
    at_20 * (1.0 + coefficient * difference)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two first-order bodies in series, compared with fine Euler steps of their heat balances.
    #[test]
    fn winding_and_body_follow_their_heat_balances() {
        let [winding, body] = [(4.0, 0.8), (50.0, 0.5)];
        let heating = Heating {
            coefficient: 0.0039,
            at_20: 82.2,
            ambient: 10.0,
            warm_up: Some(WarmUp {
                in_the_end: 5.0,
                time_constant: 30.0,
            }),
            winding: HeatStore::new(winding.0, winding.1),
            body: HeatStore::new(body.0, body.1),
        };
        let (power, step, fine) = (6.0, 0.05, 100);
        let mut coil = heating.start();
        let (mut hot, mut around) = (10.0, 10.0);
        for n in 1..=2000_u32 {
            let elapsed = f64::from(n) * step;
            coil = heating.after(coil, power * step, step, elapsed);
            let surroundings = 10.0 - 5.0 * (-elapsed / 30.0).exp_m1();
            for _ in 0..fine {
                let dt = step / f64::from(fine);
                let passed = winding.1 * (hot - around);
                hot += (power - passed) / winding.0 * dt;
                around += (passed - body.1 * (around - surroundings)) / body.0 * dt;
            }
        }
        assert!(
            (coil.winding - hot).abs() < 0.02 && hot > 25.0,
            "{} {hot}",
            coil.winding
        );
    }
}
