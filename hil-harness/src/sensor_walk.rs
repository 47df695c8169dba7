//! Inputs for the comparison of two ECUs: a rig that mostly works, and inputs that an ECU should never get.

use ecu::VentValve;

use crate::random::{Draws, Random, Stream};
use crate::sensor;
use crate::wire::{self, Actuators, FULL_DUTY, Sensors};

/// Random walk through the inputs of an ECU. It responds to the coils roughly like a rig, so that every mode of the
/// supervisor is reached and left again.
#[derive(Clone, Debug)]
pub struct SensorWalk {
    draws: Draws,
    vent_valve: VentValve,
    sample: u32,
    pressure_bar: f64,
    reference_bar: f64,
    /// Present fault, if any.
    broken: Option<Broken>,
    /// Number of samples left in this interval.
    left: u32,
    /// Code of a stuck converter.
    last_code: u16,
}

#[derive(Clone, Copy, Debug)]
enum Broken {
    SensorSilent,
    SensorStuck,
    SensorAt { code: u16 },
    SensorJumps,
    ValvesDead,
    ValvesOpen,
    Leak,
    SupplyLost,
    ReferenceSilent,
    CoilsOpen,
    Currents,
    BatteryAt { mv: u16 },
    Battery,
    Time,
    Anything,
}

const WAYS: [Broken; 18] = [
    Broken::SensorSilent,
    Broken::SensorStuck,
    Broken::SensorAt { code: 0 },
    Broken::SensorAt { code: 20 },
    Broken::SensorAt { code: 4095 },
    Broken::SensorJumps,
    Broken::ValvesDead,
    Broken::ValvesOpen,
    Broken::Leak,
    Broken::SupplyLost,
    Broken::ReferenceSilent,
    Broken::CoilsOpen,
    Broken::Currents,
    Broken::BatteryAt { mv: 15_000 },
    Broken::BatteryAt { mv: 40_000 },
    Broken::Battery,
    Broken::Time,
    Broken::Anything,
];

/// Number of first samples with a reference of zero, as an ECU requires.
const ZERO_SAMPLES: u32 = 16;
/// Longest interval with one kind of behaviour (samples): longer than the time in which a fault is forgiven.
const STRETCH_MAX: u32 = 400;
/// p_sup (bar gauge).
const SUPPLY_BAR: f64 = 8.4;
/// Pressure change by an open valve per sample, as a share of the absolute upstream pressure.
const SHARE_PER_SAMPLE: f64 = 0.07;
/// Current of a coil at 100 % (mA).
const FULL_CURRENT_MA: f64 = 292.0;

impl SensorWalk {
    /// Creates the walk from switching on, on a rig with this vent valve.
    pub fn new(seed: u64, vent_valve: VentValve) -> Self {
        let mut draws = Draws::new(Random::new(seed, Stream::Walk));
        let is_full = draws.below(8) == 0;
        let empty = Self {
            draws,
            vent_valve,
            sample: 0,
            pressure_bar: 0.0,
            reference_bar: 0.0,
            broken: None,
            left: ZERO_SAMPLES,
            last_code: 0,
        };
        if !is_full {
            return empty;
        }
        // The chamber was left under pressure, and leaks before anything is filled.
        Self {
            pressure_bar: 4.0,
            reference_bar: 5.0,
            broken: Some(Broken::Leak),
            left: 2 * ZERO_SAMPLES,
            ..empty
        }
    }

    /// Returns the next sample, after the coils got `driven`.
    pub fn next(&mut self, driven: Actuators) -> Sensors {
        if self.left == 0 {
            self.turn();
        }
        self.left -= 1;
        self.move_pressure(driven);
        let sound = self.sound(driven);
        let sensors = self.spoil(sound);
        self.last_code = sensors.pressure.unwrap_or(self.last_code);
        self.sample += 1;
        sensors
    }

    /// Begins another interval, mostly healthy, and mostly with another reference; zero often enough for the ECU to
    /// start again.
    fn turn(&mut self) {
        self.left = 1 + self.draws.below(STRETCH_MAX);
        self.broken = match self.draws.below(4) {
            0 => Some(WAYS[self.draws.below(WAYS.len() as u32) as usize]),
            _ => None,
        };
        if matches!(self.broken, Some(Broken::ValvesOpen)) {
            // A short interval: a long one would leave little time for anything else.
            self.left = 1 + self.left % 20;
        }
        self.reference_bar = match (self.broken, self.draws.below(4)) {
            // These faults are visible only while nothing else moves, or while the chamber is filled.
            (Some(Broken::Leak), _) => self.reference_bar,
            (Some(Broken::SupplyLost), _) => self.pressure_bar + 2.0,
            (_, 0) => 0.0,
            (_, 1) => self.draws.between(-0.2, SUPPLY_BAR + 0.2),
            _ => self.draws.between(0.0, 0.8 * SUPPLY_BAR),
        };
    }

    fn move_pressure(&mut self, driven: Actuators) {
        let open = |duty: u32| ((wire::duty_pct(duty) - 30.0) / 40.0).clamp(0.0, 1.0);
        let vent_duty = match self.vent_valve {
            VentValve::NormallyClosed => driven.duty_vent,
            VentValve::NormallyOpen => FULL_DUTY - driven.duty_vent.min(FULL_DUTY),
        };
        let [fill, vent] = match self.broken {
            Some(Broken::ValvesDead) => [0.0, 0.0],
            Some(Broken::ValvesOpen) => [0.5, 0.0],
            Some(Broken::Leak) => [open(driven.duty_fill), 0.5],
            _ => [open(driven.duty_fill), open(vent_duty)],
        };
        let head_bar = match self.broken {
            Some(Broken::SupplyLost) => -0.15,
            _ => (SUPPLY_BAR - self.pressure_bar).clamp(0.0, 1.0),
        };
        let filled = fill * SHARE_PER_SAMPLE * (SUPPLY_BAR + 1.0) * head_bar;
        let vented =
            vent * SHARE_PER_SAMPLE * (self.pressure_bar + 1.0) * self.pressure_bar.clamp(0.0, 1.0);
        self.pressure_bar = (self.pressure_bar + filled - vented).clamp(0.0, SUPPLY_BAR);
    }

    fn sound(&mut self, driven: Actuators) -> Sensors {
        let noisy_pa = 101_325.0 + 1e5 * self.pressure_bar + self.draws.between(-800.0, 800.0);
        let current = |duty: u32| (FULL_CURRENT_MA * wire::duty_pct(duty) / 100.0) as u16;
        Sensors {
            sample: self.sample,
            elapsed_us: 10_000,
            reference: Some(wire::reference_bits(self.reference_bar)),
            pressure: Some(sensor::code(noisy_pa).bits()),
            current_fill_ma: Some(current(driven.duty_fill)),
            current_vent_ma: Some(current(driven.duty_vent)),
            battery_mv: Some(wire::battery_mv(self.draws.between(23.0, 28.0))),
        }
    }

    fn spoil(&mut self, sound: Sensors) -> Sensors {
        let Some(broken) = self.broken else {
            return sound;
        };
        let bits = self.draws.bits();
        let [a, b, c, d] = [0, 16, 32, 48].map(|shift| (bits >> shift) as u16);
        let code = |word: u16| Some(word % 4096);
        match broken {
            Broken::SensorSilent => Sensors {
                pressure: None,
                ..sound
            },
            Broken::SensorStuck => Sensors {
                pressure: Some(self.last_code),
                ..sound
            },
            Broken::SensorAt { code } => Sensors {
                pressure: Some(code),
                ..sound
            },
            Broken::SensorJumps => Sensors {
                pressure: code(a),
                ..sound
            },
            Broken::ValvesDead | Broken::ValvesOpen | Broken::Leak | Broken::SupplyLost => sound,
            Broken::ReferenceSilent => Sensors {
                reference: None,
                ..sound
            },
            Broken::CoilsOpen => Sensors {
                current_fill_ma: Some(0),
                current_vent_ma: Some(0),
                ..sound
            },
            Broken::Currents => Sensors {
                current_fill_ma: (a % 4 != 0).then_some(b % 2000),
                current_vent_ma: (c % 4 != 0).then_some(d % 2000),
                ..sound
            },
            Broken::BatteryAt { mv } => Sensors {
                battery_mv: Some(mv),
                ..sound
            },
            Broken::Battery => Sensors {
                battery_mv: (a % 4 != 0).then_some(b),
                ..sound
            },
            Broken::Time => Sensors {
                elapsed_us: u32::from(a) * 2,
                ..sound
            },
            Broken::Anything => Sensors {
                sample: sound.sample,
                elapsed_us: (self.draws.bits() >> 32) as u32,
                reference: Some((self.draws.bits() >> 32) as i32),
                pressure: code(a),
                current_fill_ma: Some(b),
                current_vent_ma: Some(c),
                battery_mv: Some(d),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use ecu::{EcuSettings, Fault, FaultSet, Mode};

    use super::*;
    use crate::device::DeviceUnderTest as _;
    use crate::ecu_under_test::InProcess;

    /// A walk that stayed in one mode would compare the same step a million times.
    #[test]
    fn the_walk_reaches_every_mode_and_every_fault_and_runs_a_quarter_of_its_time() {
        let mut device = InProcess::new();
        let mut modes = [0_u32; Mode::ALL.len()];
        let mut faults = FaultSet::NONE;
        let mut samples = 0_u32;
        for life in 0..200 {
            let settings = EcuSettings::bench();
            device.start(&settings).unwrap();
            let mut walk = SensorWalk::new(life, settings.vent_valve);
            let mut driven = Actuators::OFF;
            for _ in 0..2000 {
                let answer = device.exchange(&walk.next(driven)).unwrap();
                driven = answer.actuators;
                modes[usize::from(answer.telemetry.mode)] += 1;
                faults = faults.union(FaultSet::from_bits(answer.telemetry.faults));
                samples += 1;
            }
        }
        assert!(modes.iter().all(|count| *count > 50), "{modes:?}");
        assert!(modes[Mode::Running as usize] > samples / 4, "{modes:?}");
        let missed: Vec<Fault> = Fault::ALL
            .into_iter()
            .filter(|fault| !faults.contains(*fault))
            .collect();
        assert_eq!(missed, [Fault::MemoryDamaged], "no sensor can do that");
    }
}
