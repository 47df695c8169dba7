//! Conditions of one log that are no parameters of the plant: the clock of its logger and the state in which it begins.

use plant_sim::logger_clock::LoggerClock;

/// Conditions of one log.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Conditions {
    /// Clock of the logger; none where each row is an instant of the ECU's own clock at which it gave the row's command.
    pub(crate) clock: Option<LoggerClock>,
    /// Gas in the chamber at the first row.
    pub(crate) start_gas: StartGas,
}

/// Gas that is warmer than the chamber's wall when a log begins, as after a fast filling, and takes the temperature of the wall.
///
/// At constant mass the pressure goes with the temperature, and the difference of temperatures with exp(-t / cooling time): the
/// energy balance E52 with a constant conductance to a wall of constant temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StartGas {
    /// Temperature above that of the wall (K).
    pub(crate) excess_k: f64,
    /// Time constant of the cooling (s).
    pub(crate) cooling_s: f64,
}

/// Cooling time of a chamber of 50 to 125 cm3 (s): mass of the air times c_v over a conductance of 0.1 W/K to the wall.
pub(crate) const USUAL_COOLING_S: f64 = 0.3;

impl Default for StartGas {
    fn default() -> Self {
        Self {
            excess_k: 0.0,
            cooling_s: USUAL_COOLING_S,
        }
    }
}

impl StartGas {
    /// Returns the pressure over what it is once the gas has the temperature of the wall, `wall_k`, at `time_s` since the first row.
    pub(crate) fn pressure_ratio(&self, wall_k: f64, time_s: f64) -> f64 {
        1.0 + self.excess_k / wall_k * (-time_s / self.cooling_s).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gas_of_the_walls_temperature_changes_nothing() {
        assert_eq!(StartGas::default().pressure_ratio(293.15, 0.0), 1.0);
    }

    #[test]
    fn warm_gas_loses_its_pressure_as_it_cools() {
        let gas = StartGas {
            excess_k: 29.315,
            cooling_s: 0.5,
        };
        assert!((gas.pressure_ratio(293.15, 0.0) - 1.1).abs() < 1e-12);
        let later = gas.pressure_ratio(293.15, 0.5);
        assert!((later - (1.0 + 0.1 * (-1.0_f64).exp())).abs() < 1e-12);
    }
}
