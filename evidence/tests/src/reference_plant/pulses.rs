//! Output stage of the ECU: state of each coil's output, and the end of that state.

use super::departures::Departures;
use super::rig::Rig;

/// PWM outputs, from the commands of all samples so far.
#[derive(Debug, Clone)]
pub(super) struct Pulses {
    /// PWM period by the clock of the log (ns), and the ECU samples in it.
    period_ns: u64,
    samples_of_period: u64,
    delay_ns: u64,
    /// Amplitude of a varying delay (ns), and its period in PWM periods.
    wander: (f64, f64),
    missed_share: f64,
    missed_seed: u64,
    /// Shares of the period, fill and vent, one pair per sample.
    commands: Vec<[f64; 2]>,
}

impl Pulses {
    /// Creates the outputs of `rig`: a period begins one command delay after the sample whose command it follows.
    pub(super) fn new(rig: &Rig) -> Self {
        let ecu = &rig.datasheet.ecu;
        let samples = 1.0 / (ecu.sample_time_s * ecu.pwm_frequency_hz);
        assert!(
            samples > 0.5 && (samples - samples.round()).abs() < 1e-9,
            "a PWM period is a whole number of ECU samples"
        );
        let Departures { pulses, .. } = rig.departures;
        let period_s = samples.round() * ecu.sample_time_s;
        Self {
            period_ns: (period_s * 1e9 * (1.0 + pulses.clock_drift)).round() as u64,
            samples_of_period: samples.round() as u64,
            delay_ns: (ecu.command_delay_s * 1e9).round() as u64,
            wander: (
                pulses.delay_wander_s * 1e9,
                pulses.delay_wander_period_s / period_s,
            ),
            missed_share: pulses.missed_share,
            missed_seed: pulses.missed_seed,
            commands: Vec::new(),
        }
    }

    /// Sets the duty cycles (%) of the next sample.
    pub(super) fn command(&mut self, duty_pct: [f64; 2]) {
        self.commands
            .push(duty_pct.map(|duty| (duty / 100.0).clamp(0.0, 1.0)));
    }

    /// Returns which outputs are high from `now_ns` on, and the instant until which that is certain.
    pub(super) fn at(&self, now_ns: u64) -> ([bool; 2], u64) {
        if now_ns < self.delay_ns {
            return ([false; 2], self.delay_ns);
        }
        // A varying delay is never negative: the period is this one or an earlier one.
        let mut period = (now_ns - self.delay_ns) / self.period_ns;
        while self.begin_ns(period) > now_ns {
            period -= 1;
        }
        let begin_ns = self.begin_ns(period);
        let share = self.commands[(period * self.samples_of_period) as usize];
        let mut until_ns = self.begin_ns(period + 1);
        let mut high = [false; 2];
        for valve in 0..2 {
            if valve == 0 && self.is_missed(period) {
                continue;
            }
            let edge_ns = begin_ns + (share[valve] * self.period_ns as f64).round() as u64;
            if edge_ns > now_ns {
                high[valve] = true;
                until_ns = until_ns.min(edge_ns);
            }
        }
        (high, until_ns)
    }

    /// Returns the instant at which a period begins.
    fn begin_ns(&self, period: u64) -> u64 {
        let (half_way, wander_period) = self.wander;
        let mut late = 0.0;
        if half_way > 0.0 {
            late = half_way * (1.0 - (std::f64::consts::TAU * period as f64 / wander_period).cos());
        }
        self.delay_ns + period * self.period_ns + late as u64
    }

    /// Returns whether the fill driver skips this period: random, but the same in every run.
    fn is_missed(&self, period: u64) -> bool {
        if self.missed_share == 0.0 {
            return false;
        }
        // SplitMix64's finaliser (Steele, Lea, Flood 2014) as a hash.
        let mut z = self.missed_seed ^ period.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        (((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64) < self.missed_share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: u64 = 1_000_000;

    #[test]
    fn a_period_of_several_samples_follows_the_first_of_them() {
        let mut rig = Rig::nominal();
        rig.datasheet.ecu.pwm_frequency_hz = 20.0;
        let mut pulses = Pulses::new(&rig);
        for duty in [40.0, 90.0, 90.0, 90.0, 90.0, 10.0] {
            pulses.command([duty, 0.0]);
        }
        let edges = [0, 15, 35, 65, 70].map(|at_ms| {
            let (high, until_ns) = pulses.at(at_ms * MS);
            (high[0], until_ns / MS)
        });
        let expected = [
            (false, 15),
            (true, 35),
            (false, 65),
            (true, 70),
            (false, 115),
        ];
        assert_eq!(edges, expected);
    }
}
