//! Faults of the ECU around its logic: battery, task, reset, memory.

use plant_sim::PlantParameters;

use super::chance::{Chance, chance};
use super::fault::ecu::EcuFault;
use super::injection::Injection;
use super::injector::{Injector, Now};
use super::target::Target;
use crate::device::DutError;
use crate::random::Random;
use crate::wire::{Actuators, Sensors};
use crate::world::World;

/// ECU with one fault.
pub(super) struct Broken {
    fault: EcuFault,
    severity: f64,
    random: Random,
    /// Voltage of the rig's healthy battery (V).
    sound_v: f64,
    /// Number of periods since the last sample.
    elapsed_periods: u32,
}

impl Broken {
    pub(super) fn new(fault: EcuFault, injection: &Injection, plant: &PlantParameters) -> Self {
        Self {
            fault,
            severity: injection.severity(),
            random: chance(injection.seed, Chance::Fault),
            sound_v: plant.ecu.supply_voltage_v,
            elapsed_periods: 1,
        }
    }

    fn voltage(&self) -> Option<f64> {
        match self.fault {
            EcuFault::BatteryLow => Some(self.sound_v * (0.75 - 0.25 * self.severity)),
            EcuFault::BatteryHigh => Some(34.0 + 14.0 * self.severity),
            _ => None,
        }
    }
}

impl Injector for Broken {
    fn is_powered(&self, now: Now) -> bool {
        self.fault != EcuFault::Reset || now.age.is_none()
    }

    fn sense(&mut self, now: Now, sensors: &mut Sensors) {
        sensors.elapsed_us = sensors.elapsed_us.saturating_mul(self.elapsed_periods);
        if now.age.is_none() {
            return;
        }
        let draw = self.random.symmetric(u64::from(now.sample));
        match self.fault {
            EcuFault::TaskEarly => sensors.elapsed_us = (4000.0 * (1.0 - self.severity)) as u32,
            EcuFault::TaskJitter => {
                sensors.elapsed_us = (f64::from(sensors.elapsed_us) * (1.0 + 0.2 * draw)) as u32;
            }
            _ => {}
        }
    }

    fn disturb(&mut self, now: Now, target: &mut dyn Target) -> Result<bool, DutError> {
        if now.age == Some(0) && EcuFault::DAMAGES.contains(&self.fault) {
            target.damage(self.fault)
        } else {
            Ok(false)
        }
    }

    fn actuate(&mut self, now: Now, world: &mut World<'_>, actuators: Actuators) {
        world.force_supply(now.age.and_then(|_| self.voltage()));
        self.elapsed_periods = match (self.fault, now.age) {
            (EcuFault::TaskLate, Some(_)) => 3 + (3.0 * self.severity).round() as u32,
            _ => 1,
        };
        for _ in 0..self.elapsed_periods {
            world.actuate(actuators);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference_profile::ReferenceProfile;
    use crate::scenario::Scenario;

    /// Defect seen: a low battery was measured, and the coils kept the voltage of the sound one.
    #[test]
    fn a_low_battery_is_measured_and_drives_the_coils() {
        let scenario = Scenario::new("battery", ReferenceProfile::starting_at(0.0).hold_ms(1000));
        let injection: Injection =
            "ecu/battery-low onset=0 duration=80 times=1 severity=1.00 rig=2 seed=0x1"
                .parse()
                .unwrap();
        let mut world = World::new(&scenario);
        let mut broken = Broken::new(EcuFault::BatteryLow, &injection, &scenario.plant);
        let actuators = Actuators {
            duty_fill: 100 << 16,
            ..Actuators::OFF
        };
        // The coil current settles within 50 ms.
        let mut settled = |age: Option<u32>| {
            for sample in 0..10 {
                world.sense();
                broken.actuate(Now { sample, age }, &mut world, actuators);
            }
            let sensors = world.sense();
            (world.shown().mean_current[0], sensors.battery_mv.unwrap())
        };
        let [(sound_a, sound_mv), (low_a, low_mv)] = [None, Some(0)].map(&mut settled);
        assert!((low_a / sound_a - 0.5).abs() < 0.01, "{sound_a} {low_a}");
        assert!((f64::from(low_mv) / f64::from(sound_mv) - 0.5).abs() < 0.02);
        assert!((settled(None).0 / sound_a - 1.0).abs() < 0.01);
    }
}
