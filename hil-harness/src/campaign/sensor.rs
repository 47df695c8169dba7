//! Faults of the pressure sensor and its converter.

use ecu::SensorCode;

use super::chance::{Chance, chance, uniform};
use super::fault::sensor::SensorFault;
use super::injection::Injection;
use super::injector::{Injector, Now};
use crate::random::Random;
use crate::sensor::code;
use crate::wire::{Sensors, measured_bar};

/// Largest noise (bar rms): ten times the bench's (data/README.md).
const NOISE_MAX_BAR: f64 = 0.04;
const DRIFT_MAX_BAR_PER_SAMPLE: f64 = 0.015;
const DRIFT_END_BAR: f64 = 3.0;

/// Sensor with one fault.
pub(super) struct Broken {
    fault: SensorFault,
    severity: f64,
    random: Random,
    stuck_at: Option<u16>,
}

impl Broken {
    pub(super) fn new(fault: SensorFault, injection: &Injection) -> Self {
        Self {
            fault,
            severity: injection.severity(),
            random: chance(injection.seed, Chance::Fault),
            stuck_at: None,
        }
    }

    /// Returns the sign of the error, the same for the whole run.
    fn sign(&self) -> f64 {
        if self.random.bits(0) & 1 == 0 {
            1.0
        } else {
            -1.0
        }
    }

    /// Returns a code uniform over `from ..= to`, another one in each sample.
    fn code_within(&self, now: Now, from: u16, to: u16) -> u16 {
        let codes = u64::from(to - from) + 1;
        from + (self.random.bits(1 + u64::from(now.sample)) % codes) as u16
    }

    fn shown(&mut self, now: Now, age: u32, sound: u16) -> Option<u16> {
        let sound_bar = measured_bar(sound);
        let chance = uniform(&self.random, 1 + u64::from(now.sample));
        let severity = self.severity;
        let at = |bar: f64| code(AMBIENT_PA + 1e5 * bar).bits();
        Some(match self.fault {
            SensorFault::Stuck => *self.stuck_at.get_or_insert(sound),
            SensorFault::Open => self.code_within(now, 0, 12),
            SensorFault::Short => self.code_within(now, 4084, SensorCode::MAX.bits()),
            SensorFault::BelowRange => self.code_within(now, 13, 31),
            SensorFault::AboveRange => at(10.5 + 8.0 * severity),
            SensorFault::Noise => {
                let noise = self.random.normal(1 + u64::from(now.sample));
                at(sound_bar + NOISE_MAX_BAR * severity * noise)
            }
            SensorFault::Jump => at(sound_bar + self.sign() * (1.7 + 2.3 * severity)),
            SensorFault::Erratic => at(8.0 * chance),
            SensorFault::Missing => return None,
            SensorFault::Intermittent => return (chance > severity).then_some(sound),
            SensorFault::Drift => {
                let drifted = DRIFT_MAX_BAR_PER_SAMPLE * severity * f64::from(age);
                at(sound_bar + self.sign() * drifted.min(DRIFT_END_BAR))
            }
            SensorFault::Offset => at(sound_bar + self.sign() * 1.5 * severity),
        })
    }
}

const AMBIENT_PA: f64 = 101_325.0;

impl Injector for Broken {
    fn sense(&mut self, now: Now, sensors: &mut Sensors) {
        match (now.age, sensors.pressure) {
            (Some(age), Some(sound)) => sensors.pressure = self.shown(now, age, sound),
            _ => self.stuck_at = None,
        }
    }
}
