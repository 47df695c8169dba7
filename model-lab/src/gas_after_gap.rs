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
            let pressure = restart.pressure + solved(1);
            if (excess_k - last_k).abs() < NEAR_K || excess_k.abs() < NEAR_K {
                return Some(Self { pressure, excess_k });
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
