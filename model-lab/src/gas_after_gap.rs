//! Gas in the chamber when a model restarts after a gap.
//!
//! Unknown commands fill or vent the chamber in a gap, and leave the gas warm or cold. Where its temperature is a state of the plant, the
//! pressures that follow show it: they fall or rise while the gas takes the temperature of the wall.

use plant_sim::parameters::PA_PER_BAR;
use plant_sim::replay::Replay;

use crate::conditions::UsualGas;
use crate::measured::Restart;

/// Temperature above that of the wall (K) and change of the pressure (Pa) that are tried first, ...
const TRIED_K: f64 = 10.0;
const TRIED_PA: f64 = 1e3;
/// ... difference from one temperature to the next at which the search ends (K), and largest number of trials.
const NEAR_K: f64 = 0.3;
/// Largest distance of the pressure from the measured one, in standard deviations of the noise.
const NOISE_REACH: f64 = 3.0;
const TRIALS: usize = 5;

/// Gas at a pressure that a sensor shows, and at a temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Gas {
    /// Shown pressure (Pa abs).
    pressure: f64,
    /// Temperature above that of the wall (K).
    excess_k: f64,
}

impl Gas {
    /// Time after a gap whose pressures show the gas (ns).
    pub(crate) const SHOWN_NS: u64 = 1_000_000_000;

    /// Returns the most probable gas at a `restart`, given prior knowledge and the `errors` of the pressures that follow: measured less
    /// modelled (bar), NaN where missing. None if a simulation was aborted, or nothing determines the gas.
    ///
    /// Least squares in temperature and pressure. The pressure is nearly linear in both, and each line in the temperature leads through the
    /// last result.
    pub(crate) fn after_gap(
        restart: &Restart,
        usual: &UsualGas,
        errors: impl Fn(&Self) -> Option<Vec<f64>>,
    ) -> Option<Self> {
        let at_wall = Self {
            pressure: restart.pressure,
            excess_k: 0.0,
        };
        let higher = Self {
            pressure: restart.pressure + TRIED_PA,
            ..at_wall
        };
        let [of_wall, of_higher] = [errors(&at_wall)?, errors(&higher)?];
        let (least_k, most_k) = usual.excess_k;
        let mut excess_k = TRIED_K;
        for _ in 0..TRIALS {
            let warm = errors(&Self {
                excess_k,
                ..at_wall
            })?;
            // The mean of several pressures that fall is known no better than one of them.
            let mut squares = [
                (restart.noise_bar / usual.excess_sd_k).powi(2),
                PA_PER_BAR.powi(-2),
            ];
            let (mut products, mut both) = ([0.0; 2], 0.0);
            for ((error, warm), higher) in of_wall.iter().zip(warm).zip(&of_higher) {
                let rates = [(error - warm) / excess_k, (error - higher) / TRIED_PA];
                if error.is_finite() {
                    both += rates[0] * rates[1];
                    for n in 0..2 {
                        squares[n] += rates[n] * rates[n];
                        products[n] += rates[n] * error;
                    }
                }
            }
            let determinant = squares[0] * squares[1] - both * both;
            let solved = |n: usize| {
                let other = 1 - n;
                (products[n] * squares[other] - products[other] * both) / determinant
            };
            let found_k = solved(0);
            if !found_k.is_finite() {
                return None;
            }
            let last_k = excess_k;
            excess_k = found_k.clamp(least_k, most_k);
            let reach_pa = NOISE_REACH * restart.noise_bar * PA_PER_BAR;
            let pressure = restart.pressure + solved(1).clamp(-reach_pa, reach_pa);
            if (excess_k - last_k).abs() < NEAR_K || excess_k.abs() < NEAR_K {
                return (pressure > 0.0).then_some(Self { pressure, excess_k });
            }
        }
        Some(Self {
            excess_k,
            ..at_wall
        })
    }

    /// Lets the gas of `replay` be this one, with a wall at `wall_k`.
    pub(crate) fn put(&self, replay: &mut Replay, wall_k: f64) {
        replay.begin_showing(self.pressure);
        replay
            .simulator()
            .set_gas_temperature(wall_k + self.excess_k);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn restart(noise_bar: f64) -> Restart {
        Restart {
            row: 0,
            pressure: 3e5,
            variance: 1.0,
            noise_bar,
        }
    }

    fn after_gap(noise_bar: f64, per_k: f64, per_pa: f64, truth: Gas) -> Option<Gas> {
        let errors = |gas: &Gas| {
            let rows = (0..200).map(f64::from);
            let error = |row: f64| {
                per_k * row * (truth.excess_k - gas.excess_k)
                    + per_pa * (truth.pressure - gas.pressure)
            };
            Some(rows.map(error).collect())
        };
        Gas::after_gap(&restart(noise_bar), &UsualGas::BETWEEN_VALVES, errors)
    }

    #[test]
    fn a_linear_model_gives_its_temperature_and_its_pressure() {
        let truth = Gas {
            pressure: 3e5 + 250.0,
            excess_k: -31.0,
        };
        let found = after_gap(2e-3, 1e-4, 1e-5, truth).unwrap();
        assert!((found.excess_k + 31.0).abs() < 0.1, "{found:?}");
        assert!((found.pressure - truth.pressure).abs() < 10.0, "{found:?}");
    }

    /// Defect seen: a model that was far off moved the pressure below vacuum, and the program ended.
    #[test]
    fn the_gas_stays_near_the_measured_pressure_and_within_possible_temperatures() {
        let truth = Gas {
            pressure: -9e5,
            excess_k: 2000.0,
        };
        let found = after_gap(2e-3, 1e-4, 1e-5, truth).unwrap();
        assert_eq!(found.excess_k, 150.0);
        assert!((found.pressure - 3e5).abs() <= 600.1, "{found:?}");
    }

    #[test]
    fn pressures_that_show_nothing_leave_the_temperature_of_the_wall() {
        let truth = Gas {
            pressure: 3e5,
            excess_k: 40.0,
        };
        let found = after_gap(2e-3, 0.0, 1e-5, truth).unwrap();
        assert!(found.excess_k.abs() < 1e-9, "{found:?}");
        assert_eq!(after_gap(0.0, 0.0, 0.0, truth), None);
    }
}
