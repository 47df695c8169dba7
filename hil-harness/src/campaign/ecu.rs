//! Faults of the ECU around its logic: battery, task, reset, memory.

use plant_sim::PlantParameters;

use super::chance::{Chance, chance};
use super::fault::ecu::EcuFault;
use super::injection::Injection;
use super::injector::{Injector, Now};
use super::target::Target;
use crate::device::DutError;
use crate::random::Random;
use crate::wire::{self, Actuators, Sensors};
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
    /// Battery voltage during a fault of it (V).
    battery_v: Option<f64>,
}

impl Broken {
    pub(super) fn new(fault: EcuFault, injection: &Injection, plant: &PlantParameters) -> Self {
        Self {
            fault,
            severity: injection.severity(),
            random: chance(injection.seed, Chance::Fault),
            sound_v: plant.ecu.supply_voltage_v,
            elapsed_periods: 1,
            battery_v: None,
        }
    }

    fn voltage(&self) -> Option<f64> {
        match self.fault {
            EcuFault::BatteryLow => Some(self.sound_v * (1.0 - 0.5 * self.severity)),
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
        if let Some(volt) = self.battery_v {
            sensors.battery_mv = Some(wire::battery_mv(volt));
        }
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
        let wanted = now.age.and_then(|_| self.voltage());
        if wanted != self.battery_v {
            world
                .simulator_mut()
                .set_supply_voltage(wanted.unwrap_or(self.sound_v));
            self.battery_v = wanted;
        }
        self.elapsed_periods = match (self.fault, now.age) {
            (EcuFault::TaskLate, Some(_)) => 3 + (3.0 * self.severity).round() as u32,
            _ => 1,
        };
        for _ in 0..self.elapsed_periods {
            world.actuate(actuators);
        }
    }
}
