//! Conditions of one log that are not parameters of the plant: the clock of its logger and the state in which it begins.

use plant_sim::PlantParameters;
use plant_sim::logger_clock::LoggerClock;
use plant_sim::replay::{CurrentSampling, ReplayInput};

use crate::result::{ClockSource, FoundClock, FoundStart};

/// Conditions of one log.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Conditions {
    /// Clock of the logger; none where each row is the instant of the ECU's own clock at which it gave the row's command.
    pub(crate) clock: Option<LoggerClock>,
    /// Gas in the chamber at the first row.
    pub(crate) start_gas: StartGas,
    /// Time (ns) from the beginning of a PWM period, shifted by the command delay, to the ECU sample from which the clock counts: 0 where a
    /// sample time is a whole number of PWM periods.
    pub(crate) pwm_lead_ns: u64,
}

impl Conditions {
    /// Returns the instant of the first row in the time of the ECU (ns).
    pub(crate) fn first_row_ns(&self) -> u64 {
        let of_clock = self.clock.map_or(0, |clock| clock.ecu_time_ns(0));
        self.pwm_lead_ns + of_clock
    }

    /// Converts `input` to the time of the ECU. Its row lies `log_ns` after the first one by the clock of the logger, and its command was
    /// given at `issued_ns` in the time of the ECU. Without a clock, the row is an instant of the ECU.
    pub(crate) fn on_ecu_time(
        &self,
        input: ReplayInput,
        log_ns: u64,
        issued_ns: Option<u64>,
    ) -> ReplayInput {
        let (time_ns, shown_ns, issued_ns) = match self.clock.zip(issued_ns) {
            None => (input.time_ns, input.shown_ns, input.issued_ns),
            Some((clock, issued_ns)) => {
                // Time that was removed from pauses before the row.
                let taken_ns = log_ns - input.time_ns;
                let on_ecu = |log_ns| clock.ecu_time_ns(log_ns).saturating_sub(taken_ns);
                let shown_ns = on_ecu(shown_log_ns(&input, log_ns));
                let issued_ns = issued_ns.saturating_sub(taken_ns).min(shown_ns);
                (on_ecu(log_ns), shown_ns, issued_ns)
            }
        };
        ReplayInput {
            time_ns: time_ns + self.pwm_lead_ns,
            shown_ns: shown_ns + self.pwm_lead_ns,
            issued_ns: issued_ns + self.pwm_lead_ns,
            ..input
        }
    }
}

/// Returns the time (ns, clock of the logger) of the row that shows the command of `input`, which lies `log_ns` after the first row.
pub(crate) fn shown_log_ns(input: &ReplayInput, log_ns: u64) -> u64 {
    log_ns + input.shown_ns.saturating_sub(input.time_ns)
}

/// Conditions under which a log was made, as found: clock of the rows relative to the ECU, meaning of the currents, and temperature of the
/// gas at the beginning.
///
/// The default is a log of the ECU itself that begins at rest: each row is an instant at which the ECU gave the row's command.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LogConditions {
    pub(crate) conditions: Conditions,
    pub(crate) clock_source: ClockSource,
    /// Least and largest drift of the clock (ppm) that the logged commands admit; set where the plant was not fitted and the commands do
    /// not determine the drift.
    pub(crate) admitted_drifts_ppm: Option<(f64, f64)>,
    /// Whether the log begins with a filled chamber.
    pub(crate) begins_filled: bool,
    /// Instants (ns, clock of the logger) of rows that show commands, in order, and the instants (ns, ECU time) at which the commands were
    /// given; those of other rows follow from the clock alone.
    pub(crate) issued_ns: Vec<(u64, u64)>,
    /// Median time from command to command in the log (ns) and sample time of the ECU (ns).
    pub(crate) interval_ns: u64,
    pub(crate) sample_time_ns: u64,
    /// Meaning of the currents, means or instantaneous values; none if the time from sample to sample decides.
    pub(crate) sampling: Option<CurrentSampling>,
}

impl LogConditions {
    /// Number of rows, and time from the first one (s), of the beginning of a log from which its conditions are found; the longer one
    /// counts. It limits memory and time on long logs.
    const BEGINNING: (usize, f64) = (40_000, 60.0);

    /// Returns whether a row belongs to the beginning of a log: the row at `index`, `time_s` after the first one.
    pub fn is_in_beginning(index: usize, time_s: f64) -> bool {
        let (rows, duration_s) = Self::BEGINNING;
        index < rows || time_s <= duration_s
    }

    /// Converts `input`, a row of the log, to the time of the ECU; the row lies `log_ns` after the first one by the clock of the logger.
    pub fn on_ecu_time(&self, input: ReplayInput, log_ns: u64) -> ReplayInput {
        let issued_ns = self.conditions.clock.map(|clock| {
            let shown_ns = shown_log_ns(&input, log_ns);
            let known = self
                .issued_ns
                .binary_search_by_key(&shown_ns, |&(shown_ns, _)| shown_ns);
            let known_ns = known.ok().map(|place| self.issued_ns[place].1);
            known_ns.unwrap_or_else(|| {
                let sample = clock.ecu_sample(shown_ns, self.interval_ns, self.sample_time_ns);
                sample * self.sample_time_ns
            })
        });
        self.conditions.on_ecu_time(input, log_ns, issued_ns)
    }

    /// Returns the meaning of the currents of a log, sampled every `interval_s`: means or instantaneous values.
    pub fn sampling(&self, interval_s: f64, parameters: &PlantParameters) -> CurrentSampling {
        let usual = || CurrentSampling::of_interval(interval_s, parameters);
        self.sampling.unwrap_or_else(usual)
    }

    /// Returns the clock of the logger of the log `source`; none where it is that of the ECU.
    pub fn clock(&self, source: &str) -> Option<FoundClock> {
        let clock = self.conditions.clock?;
        let sample_time_s = self.sample_time_ns as f64 * 1e-9;
        Some(FoundClock::new(
            source,
            clock,
            sample_time_s,
            (self.clock_source, self.admitted_drifts_ppm),
        ))
    }

    /// Returns the state of the gas when the log `source` begins; none where it begins with an empty chamber.
    pub fn start(&self, source: &str) -> Option<FoundStart> {
        let gas = self.conditions.start_gas;
        self.begins_filled
            .then(|| FoundStart::new(source, gas.excess_k, gas.cooling_s))
    }
}

/// Gas that is warmer than the chamber's wall when a log begins, as after a fast filling, and approaches the temperature of the wall.
///
/// At constant mass the pressure is proportional to the temperature, and the difference of temperatures falls with exp(-t / cooling time):
/// the energy balance E52 with a constant conductance to a wall of constant temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StartGas {
    /// Temperature above that of the wall (K).
    pub(crate) excess_k: f64,
    /// Time constant of the cooling (s).
    pub(crate) cooling_s: f64,
}

/// Cooling time of a chamber of 50 to 125 cm3 (s): mass of the air times c_v over a conductance of 0.1 W/K to the wall.
const USUAL_COOLING_S: f64 = 0.3;

/// Prior knowledge of the gas in a filled chamber.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct UsualGas {
    /// Temperature above that of the wall (K): standard deviation about 0, least and largest value.
    pub(crate) excess_sd_k: f64,
    pub(crate) excess_k: (f64, f64),
    /// Cooling time (s): usual, least and largest value.
    pub(crate) usual_s: f64,
    pub(crate) least_s: f64,
    pub(crate) most_s: f64,
    /// Standard deviation of the logarithm of the cooling time.
    pub(crate) ln_sd: f64,
}

impl UsualGas {
    /// Gas in a chamber between valves with coils, which fill it within a fraction of a second; adiabatic filling ends 120 K above the
    /// supply.
    pub(crate) const BETWEEN_VALVES: Self = Self {
        excess_sd_k: 40.0,
        excess_k: (-100.0, 150.0),
        usual_s: USUAL_COOLING_S,
        least_s: 0.01,
        most_s: 10.0,
        ln_sd: 1.0,
    };
    /// Largest ratio of the cooling time to its estimate, for shape, fittings and convection. With a wider range, slow cooling would fit a
    /// leak.
    const REACH: f64 = 3.0;

    /// Returns the gas in a vessel that no valve with a coil fills: the chamber of `parameters`, with gas at `pressure` (Pa abs). Its
    /// cooling time is its heat capacity m c_v over the conductance of a wall that grows with the square of the vessel's size. It is filled
    /// and shut by hand, so that half of the temperature rise of adiabatic filling is gone; gas is colder than the wall only after a part
    /// was let out.
    pub(crate) fn of_vessel(parameters: &PlantParameters, pressure: f64) -> Self {
        let gas = &parameters.gas;
        let volume = parameters.chamber.volume_m3;
        let (conductance, of_volume) = USUAL_CONDUCTANCE;
        let conductance = conductance * (volume / of_volume).powf(2.0 / 3.0);
        // m c_v = p V/(R T) · R/(k - 1)
        let heat_capacity =
            pressure * volume / ((gas.heat_capacity_ratio - 1.0) * gas.temperature_k);
        let usual_s = heat_capacity / conductance;
        Self {
            excess_sd_k: 20.0,
            excess_k: (-20.0, 60.0),
            usual_s,
            least_s: usual_s / Self::REACH,
            most_s: usual_s * Self::REACH,
            ln_sd: 0.5,
        }
    }
}

/// Heat that a chamber of 75 cm³ exchanges with its gas (W/K), and its volume (m³): the effect `gas_temperature` at its typical size.
const USUAL_CONDUCTANCE: (f64, f64) = (0.1, 75e-6);

impl Default for StartGas {
    fn default() -> Self {
        Self {
            excess_k: 0.0,
            cooling_s: USUAL_COOLING_S,
        }
    }
}

impl StartGas {
    /// Returns the pressure over that of gas at the temperature of the wall, `wall_k`, at `time_s` since the first row.
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
