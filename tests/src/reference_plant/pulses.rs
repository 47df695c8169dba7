//! Output stage of the ECU: state of each coil's output, and the end of that state.

use super::departures::Departures;
use super::rig::Rig;

/// PWM outputs, from the commands of all samples so far.
#[derive(Debug, Clone)]
pub(super) struct Pulses {
    /// PWM period by the clock of the log (ns).
    period_ns: u64,
    delay_ns: u64,
    /// Amplitude of a varying delay (ns), and its period in PWM periods.
    wander: (f64, f64),
    missed_share: f64,
    missed_seed: u64,
    /// Shares of the period, fill and vent, one pair per sample.
    commands: Vec<[f64; 2]>,
}

impl Pulses {
    /// Creates the outputs of `rig`: the period of the sample's command begins one command delay after the sample.
    pub(super) fn new(rig: &Rig) -> Self {
        let ecu = &rig.datasheet.ecu;
        assert!(
            (ecu.sample_time_s * ecu.pwm_frequency_hz - 1.0).abs() < 1e-9,
            "one PWM period per ECU sample"
        );
        let Departures { pulses, .. } = rig.departures;
        Self {
            period_ns: (ecu.sample_time_s * 1e9 * (1.0 + pulses.clock_drift)).round() as u64,
            delay_ns: (ecu.command_delay_s * 1e9).round() as u64,
            wander: (
                pulses.delay_wander_s * 1e9,
                pulses.delay_wander_period_s / ecu.sample_time_s,
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
        let share = self.commands[period as usize];
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
