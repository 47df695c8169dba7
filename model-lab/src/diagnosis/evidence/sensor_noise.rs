//! Noise of each sensor, from all logs with the same sampling interval: the few quiet samples of one log are not sufficient.

use core::f64::consts::FRAC_PI_2;

use crate::measured::Measured;
use crate::noise_floor::Floor;

/// Relative difference of sampling intervals that count as equal.
const ALIKE_INTERVAL: f64 = 0.01;
/// Largest difference of the noises of two logs, in standard deviations of the estimates, at which they count as from one sensor.
const AGREES: f64 = 3.0;

/// Noise estimates of each sensor in each log.
#[derive(Debug, Default)]
pub(crate) struct SensorNoise(Vec<NoiseEstimate>);

/// Noise estimate of one sensor from one log.
#[derive(Debug)]
struct NoiseEstimate {
    signal: &'static str,
    interval_s: f64,
    sigma: f64,
    freedom: f64,
}

impl NoiseEstimate {
    /// Returns the estimate of the noise floor; none where the log has no quiet samples.
    fn of(signal: &'static str, floor: &Floor, interval_s: f64) -> Option<Self> {
        (floor.sigma > 0.0 && floor.freedom > 0.0).then_some(Self {
            signal,
            interval_s,
            sigma: floor.sigma,
            freedom: floor.freedom,
        })
    }

    /// Returns the variance of ln sigma: of a median of variances, π/2 times that of their mean.
    fn uncertainty(&self) -> f64 {
        FRAC_PI_2 / (2.0 * self.freedom)
    }

    fn agrees_with(&self, other: &Self) -> bool {
        let uncertainty = self.uncertainty() + other.uncertainty();
        (self.sigma / other.sigma).ln().powi(2) <= AGREES * AGREES * uncertainty
    }
}

impl SensorNoise {
    /// Adds the noise estimates of a log.
    pub(crate) fn add(&mut self, measured: &[Measured]) {
        let estimate =
            |signal: &Measured| NoiseEstimate::of(signal.name, &signal.floor, signal.interval_s);
        self.0.extend(measured.iter().filter_map(estimate));
    }

    /// Returns the standard deviation of the noise of a signal with the floor `own` in its own log; none where no log has an estimate.
    pub(crate) fn of(&self, signal: &'static str, own: &Floor, interval_s: f64) -> Option<f64> {
        let own = NoiseEstimate::of(signal, own, interval_s);
        let alike = |one: &&NoiseEstimate| {
            one.signal == signal
                && (one.interval_s / interval_s - 1.0).abs() < ALIKE_INTERVAL
                && own.as_ref().is_none_or(|own| own.agrees_with(one))
        };
        let (freedom, square) =
            self.0
                .iter()
                .filter(alike)
                .fold((0.0, 0.0), |(freedom, square), one| {
                    (
                        freedom + one.freedom,
                        square + one.freedom * one.sigma * one.sigma,
                    )
                });
        (freedom > 0.0).then(|| f64::sqrt(square / freedom))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::shut_for;
    use crate::noise::Noise;
    use crate::noise_floor::{Quiet, noise_floor};

    fn floor(seed: u64, sigma: f64, count: usize) -> Floor {
        let mut noise = Noise::new(seed);
        let values: Vec<f64> = (0..count).map(|_| sigma * noise.normal()).collect();
        noise_floor(&values, "mA", Quiet::Hold, &shut_for(count, 0.05))
    }

    fn noise_of(floors: &[Floor]) -> SensorNoise {
        let estimates = floors
            .iter()
            .filter_map(|floor| NoiseEstimate::of("i_fill", floor, 0.05));
        SensorNoise(estimates.collect())
    }

    #[test]
    fn logs_of_one_sensor_determine_its_noise_together() {
        for seed in 0..20 {
            let floors = [floor(seed, 0.7, 200), floor(seed + 100, 0.7, 20_000)];
            let noise = noise_of(&floors);
            let of = |own: usize| noise.of("i_fill", &floors[own], 0.05).unwrap();
            assert_eq!(of(0), of(1));
            assert!((of(0) / 0.7 - 1.0).abs() < 0.03, "{seed}: {}", of(0));
        }
    }

    #[test]
    fn another_noise_another_signal_and_another_sampling_are_left_alone() {
        let floors = [floor(1, 0.7, 2000), floor(2, 1.4, 2000)];
        let noise = noise_of(&floors);
        for own in &floors {
            let found = noise.of("i_fill", own, 0.05).unwrap();
            assert!((found / own.sigma - 1.0).abs() < 1e-12, "{found}");
        }
        assert_eq!(noise.of("i_vent", &floors[0], 0.05), None);
        assert_eq!(noise.of("i_fill", &floors[0], 0.01), None);
    }

    #[test]
    fn a_log_without_quiet_samples_asks_the_others() {
        let (known, unknown) = (floor(1, 0.7, 2000), floor(1, 0.7, 5));
        assert_eq!(unknown.sigma, 0.0);
        let found = noise_of(core::slice::from_ref(&known)).of("i_fill", &unknown, 0.05);
        assert!((found.unwrap() / known.sigma - 1.0).abs() < 1e-12);
    }
}
