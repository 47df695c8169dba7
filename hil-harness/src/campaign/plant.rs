//! Faults of valves, coils, chamber and supply.
//!
//! The simulator has healthy valves. A stuck valve gets another command than its coil. The current of its coil then
//! comes from a twin of the simulator whose valves follow the commands.

use plant_sim::{Command, PlantParameters, Simulator};

use super::fault::plant::PlantFault;
use super::injection::Injection;
use super::injector::{Injector, Now};
use crate::wire::{self, Actuators, FULL_DUTY, Sensors};
use crate::world::World;

/// Minimum share of each PWM period in which a valve that is stuck open is open: about its opening duty cycle.
const STUCK_OPEN_MIN: f64 = 0.5;
/// Rate of the largest leak (1/s), about a fifth of the nominal vent valve's.
const LEAK_MAX_PER_S: f64 = 1.5;
/// Current of shorted windings, as a multiple of a healthy coil's: the minimum, and the width of the range above.
const SHORT_FACTOR: [f64; 2] = [4.0, 16.0];
/// Time for which the twin is used after a fault (samples): command delay and decay of a current.
const TWIN_SAMPLES: u32 = 20;

/// Plant with one fault.
pub(super) struct Broken<'a> {
    plant: &'a PlantParameters,
    fault: PlantFault,
    severity: f64,
    /// Twin that follows the commands, for the currents, and the number of samples for which it is still needed.
    twin: Option<(Simulator, u32)>,
    commanded: Actuators,
}

impl<'a> Broken<'a> {
    pub(super) fn new(
        fault: PlantFault,
        injection: &Injection,
        plant: &'a PlantParameters,
    ) -> Self {
        Self {
            plant,
            fault,
            severity: injection.severity(),
            twin: None,
            commanded: Actuators::OFF,
        }
    }

    /// Returns the effective duty cycles of the valves for those of the coils.
    fn valves(&self, world: &mut World<'_>, coils: Actuators) -> Actuators {
        let Actuators {
            duty_fill,
            duty_vent,
        } = coils;
        let open = STUCK_OPEN_MIN + (1.0 - STUCK_OPEN_MIN) * self.severity;
        let open = (open * f64::from(FULL_DUTY)) as u32;
        match self.fault {
            PlantFault::FillStuckOpen => Actuators {
                duty_fill: open,
                duty_vent,
            },
            PlantFault::VentStuckOpen => Actuators {
                duty_fill,
                duty_vent: open,
            },
            PlantFault::FillDriverShort => Actuators {
                duty_fill: FULL_DUTY,
                duty_vent,
            },
            PlantFault::VentDriverShort => Actuators {
                duty_fill,
                duty_vent: FULL_DUTY,
            },
            PlantFault::FillStuckClosed | PlantFault::FillCoilOpen | PlantFault::FillCoilShort => {
                Actuators {
                    duty_fill: 0,
                    duty_vent,
                }
            }
            PlantFault::VentStuckClosed | PlantFault::VentCoilOpen | PlantFault::VentCoilShort => {
                Actuators {
                    duty_fill,
                    duty_vent: 0,
                }
            }
            PlantFault::SupplyLost if pressure_pa(world) > self.supply_pa() => Actuators {
                duty_fill: 0,
                duty_vent: duty_vent.max(duty_fill),
            },
            PlantFault::SupplyLost | PlantFault::Leak => coils,
        }
    }

    /// Returns the remaining supply pressure (Pa abs).
    fn supply_pa(&self) -> f64 {
        let gas = &self.plant.gas;
        gas.ambient_pressure_pa + (1.0 - self.severity) * gas.supply_pressure_bar_gauge * 1e5
    }

    /// Simulates a flow for which the simulator has no orifice.
    fn flow(&self, world: &mut World<'_>, before_pa: f64) {
        let now_pa = pressure_pa(world);
        let plant = self.plant;
        let ambient_pa = plant.gas.ambient_pressure_pa;
        let then_pa = match self.fault {
            PlantFault::Leak => {
                let share = LEAK_MAX_PER_S * self.severity * plant.ecu.sample_time_s;
                now_pa - share * (now_pa - ambient_pa)
            }
            PlantFault::SupplyLost => now_pa.min(self.supply_pa().max(before_pa)),
            _ => return,
        };
        if then_pa < now_pa {
            world.simulator_mut().set_chamber_pressure(then_pa);
        }
    }

    /// Returns the current of a coil with shorted windings for its duty cycle (mA).
    fn short_current_ma(&self, duty: u32) -> u16 {
        let [least, more] = SHORT_FACTOR;
        let share = f64::from(duty) / f64::from(FULL_DUTY);
        let full = self.plant.ecu.supply_voltage_v / self.plant.coil.resistance_20c_ohm;
        wire::current_ma((least + more * self.severity) * share * full)
    }
}

fn pressure_pa(world: &mut World<'_>) -> f64 {
    world.simulator_mut().state().pressure
}

impl Injector for Broken<'_> {
    fn sense(&mut self, now: Now, sensors: &mut Sensors) {
        if let Some((twin, _)) = &mut self.twin {
            let [fill, vent] = twin.sample().mean_current;
            sensors.current_fill_ma = Some(wire::current_ma(fill));
            sensors.current_vent_ma = Some(wire::current_ma(vent));
        }
        // The first sample of the fault still shows the period before it.
        if now.age.is_none_or(|age| age == 0) {
            return;
        }
        let Actuators {
            duty_fill,
            duty_vent,
        } = self.commanded;
        match self.fault {
            PlantFault::FillCoilShort => {
                sensors.current_fill_ma = Some(self.short_current_ma(duty_fill));
            }
            PlantFault::VentCoilShort => {
                sensors.current_vent_ma = Some(self.short_current_ma(duty_vent));
            }
            _ => {}
        }
    }

    fn actuate(&mut self, now: Now, world: &mut World<'_>, coils: Actuators) {
        self.commanded = coils;
        let is_broken = now.age.is_some();
        if is_broken && self.fault.leaves_coils_alone() {
            match &mut self.twin {
                Some((_, needed_for)) => *needed_for = TWIN_SAMPLES,
                None => self.twin = Some((world.simulator_mut().clone(), TWIN_SAMPLES)),
            }
        }
        let valves = if is_broken {
            self.valves(world, coils)
        } else {
            coils
        };
        let before_pa = pressure_pa(world);
        world.actuate(valves);
        if is_broken {
            self.flow(world, before_pa);
        }
        if let Some((twin, needed_for)) = &mut self.twin {
            twin.command(Command {
                duty_fill_pct: wire::duty_pct(coils.duty_fill),
                duty_vent_pct: wire::duty_pct(coils.duty_vent),
            });
            twin.advance_to_ns(world.simulator_mut().time_ns());
            *needed_for -= 1;
            if *needed_for == 0 {
                self.twin = None;
            }
        }
    }
}
