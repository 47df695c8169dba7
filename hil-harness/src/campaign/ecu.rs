//! Faults of the ECU around its logic: battery, task, reset, memory.

use plant_sim::PlantParameters;

use super::bounds;
use super::chance::{Chance, chance};
use super::class::{Survival, named};
use super::injection::Injection;
use super::injector::{Injector, Now};
use super::target::Target;
use crate::device::DutError;
use crate::random::Random;
use crate::wire::{self, Actuators, Sensors};
use crate::world::World;

named! {
    /// A fault of the ECU.
    EcuFault {
        /// The battery gives (1 - severity / 2) of its voltage.
        BatteryLow = "battery-low",
        /// The battery gives 34 to 48 V.
        BatteryHigh = "battery-high",
        /// Samples are 3 to 6 periods apart.
        TaskLate = "task-late",
        /// The task runs again 0 to 4 ms after it ran, by its clock.
        TaskEarly = "task-early",
        /// The time between samples wavers by up to a fifth, by the task's clock.
        TaskJitter = "task-jitter",
        /// A reset: no current for the time of the fault, then a start without memory.
        Reset = "reset",
        /// A setting of the controller flips in the target's memory; only where the target can be damaged.
        ConfigDamaged = "config-damaged",
        /// The supervisor's state flips; only where the target can be damaged.
        SupervisorDamaged = "supervisor-damaged",
        /// The controller asks for both valves at once; only where the target can be damaged.
        ControllerDamaged = "controller-damaged",
    }
}

/// Duration that both valves shut bridge \[samples\]: HOLD_N less the recovery.
const BRIDGED: u32 = 30;

impl EcuFault {
    /// What can be damaged in the target's memory.
    pub const DAMAGES: [Self; 3] = [
        Self::ConfigDamaged,
        Self::SupervisorDamaged,
        Self::ControllerDamaged,
    ];

    /// Whether it shows as one row of the table.
    pub(super) fn is_plain(self) -> bool {
        matches!(
            self,
            Self::BatteryLow
                | Self::BatteryHigh
                | Self::TaskLate
                | Self::TaskEarly
                | Self::TaskJitter
        )
    }

    pub(super) fn survival(self, duration: u32) -> Survival {
        match self {
            Self::TaskJitter => Survival::Unnoticed,
            Self::BatteryLow | Self::BatteryHigh if duration < bounds::BATTERY_N => {
                Survival::Unnoticed
            }
            Self::BatteryLow | Self::BatteryHigh if duration <= BRIDGED => Survival::Held,
            Self::TaskLate | Self::TaskEarly if duration < bounds::SAMPLE_TIME_N => {
                Survival::Unnoticed
            }
            _ => Survival::NotClaimed,
        }
    }
}

/// An ECU with one thing broken.
pub(super) struct Broken {
    fault: EcuFault,
    severity: f64,
    random: Random,
    /// Voltage of the rig's battery \[V\].
    sound_v: f64,
    /// Periods since the last sample.
    elapsed_periods: u32,
    /// The battery, while it has another voltage than it should \[V\].
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
