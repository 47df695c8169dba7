//! Plant with effects, as the physics of the solver.

mod coils;
mod forces;
mod physics;

use super::layout::Layout;
use super::physics::MANY;
use super::sensor::Sensor;
use super::tolerance::Tolerance;
use crate::additions::{Cavity, CoilTemperature};
use crate::hooks::Now;
use crate::plant::{FILL, Plant, PlantState, VENT};

/// State that an effect adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectState {
    /// `t_gas`, `t_wall`, `t_second`, `t_coil_fill`, `t_coil_vent`, `p_line`, `p_drain`, `p_cavity`, `u_polarisation`,
    /// `i_eddy_fill`, `i_eddy_vent`, `plunger_share`, `x_actuator`, or `own` for a user-defined state.
    pub name: &'static str,
    /// Value: K, Pa abs, V, A, m or a pure number, or the unit of a user-defined state.
    pub value: f64,
}

/// Plant with its additions, and their states.
#[derive(Debug, Clone)]
pub(in crate::simulator) struct Extended {
    plant: Plant,
    layout: Layout,
    /// Whether an effect changes the law of the coils, and that of the flows.
    has_coil_law: bool,
    has_gas_law: bool,
    extra: [f64; MANY],
    /// Inverse tolerances of `extra`.
    extra_weights: [f64; MANY],
    /// Inverse of each coil's inductance at rest (1/H).
    per_inductance: [f64; 2],
    /// Flux linkage of each coil (Wb), if its current does not determine it.
    flux: [f64; 2],
    /// Temperature of each coil, and the heat since its last update (J).
    coils: [CoilTemperature; 2],
    heat: [f64; 2],
    /// Resistance of each coil as installed (Ω).
    installed: [f64; 2],
    /// The plunger's share of its travel.
    swept: f64,
    sensor: Sensor,
    /// Duty cycles in force (0 to 1).
    duty: [f64; 2],
    /// Time since the beginning (s).
    elapsed: f64,
}

impl Extended {
    pub(in crate::simulator) fn new(plant: Plant, tolerance: Tolerance) -> Self {
        let layout = Layout::new(&plant);
        let [extra, extra_weights] = layout.start(&plant, tolerance.pressure);
        let heating = plant.additions.heating;
        let coil = heating.map_or_else(CoilTemperature::default, |heating| heating.start());
        let start = plant.rest_state().pressure;
        Self {
            extra,
            extra_weights,
            per_inductance: [FILL, VENT]
                .map(|index| plant.valves[index].coil.inductance_at_rest.recip()),
            flux: [0.0; 2],
            coils: [coil; 2],
            heat: [0.0; 2],
            installed: [FILL, VENT].map(|index| plant.valves[index].coil.resistance),
            swept: plant.swept_at_rest(),
            sensor: Sensor::new(start),
            duty: [0.0; 2],
            elapsed: 0.0,
            has_coil_law: plant.additions.has_coil_law(),
            has_gas_law: plant.additions.has_gas_law(),
            layout,
            plant,
        }
    }

    /// Returns the input of user-defined laws; `None` if there are none.
    fn now<'a>(
        &self,
        pressure: f64,
        extra: &'a [f64],
        (current, position, velocity): ([f64; 2], [f64; 2], [f64; 2]),
    ) -> Option<Now<'a>> {
        let time = self.layout.time?;
        let (first, number) = self.layout.own;
        Some(Now {
            time: extra[time],
            pressure,
            supply_pressure: self.plant.supply_pressure,
            ambient_pressure: self.plant.ambient_pressure,
            temperature: self
                .layout
                .temperature
                .map_or(f64::NAN, |index| extra[index]),
            current,
            position,
            velocity,
            duty: self.duty,
            own: &extra[first..first + number],
        })
    }

    /// Returns the states of effects, with their names.
    pub(in crate::simulator) fn states(&self) -> Vec<EffectState> {
        let Layout {
            line,
            drain,
            temperature,
            wall,
            second_temperature,
            cavity,
            polarisation,
            eddy_currents,
            plunger,
            actuator,
            own: (first, number),
            ..
        } = self.layout;
        let named = [
            ("p_line", line),
            ("p_drain", drain),
            ("t_gas", temperature),
            ("t_wall", wall),
            ("t_second", second_temperature),
            ("p_cavity", cavity),
            ("u_polarisation", polarisation),
            ("i_eddy_fill", eddy_currents),
            ("i_eddy_vent", eddy_currents.map(|first| first + VENT)),
            ("plunger_share", plunger),
            ("x_actuator", actuator),
        ];
        let state = |name, value| EffectState { name, value };
        let mut states: Vec<_> = named
            .into_iter()
            .filter_map(|(name, index)| Some(state(name, self.extra[index?])))
            .collect();
        if self.plant.additions.heating.is_some() {
            states.push(state("t_coil_fill", self.coils[FILL].winding + 293.15));
            states.push(state("t_coil_vent", self.coils[VENT].winding + 293.15));
        }
        let own = &self.extra[first..first + number];
        states.extend(own.iter().map(|value| state("own", *value)));
        states
    }

    /// Returns the pressure that the sensor shows (Pa abs).
    pub(in crate::simulator) fn measured_pressure(&self, state: &PlantState) -> f64 {
        let valves = &state.valves;
        let now = Now {
            time: self.layout.time.map_or(f64::NAN, |time| self.extra[time]),
            pressure: state.pressure,
            supply_pressure: self.plant.supply_pressure,
            ambient_pressure: self.plant.ambient_pressure,
            temperature: self.temperature().unwrap_or(f64::NAN),
            current: valves.map(|valve| valve.current),
            position: valves.map(|valve| valve.x),
            velocity: valves.map(|valve| valve.v),
            duty: self.duty,
            own: &self.extra[self.layout.own.0..][..self.layout.own.1],
        };
        self.sensor.shown(&self.plant.additions, &now, self.elapsed)
    }

    /// Returns the pressure where the sensor is (Pa abs): that of a second chamber. A small volume in front of the sensor belongs to the sensor.
    pub(in crate::simulator) fn pressure_at_sensor(&self, state: &PlantState) -> f64 {
        let cavity = self.plant.additions.cavity.as_ref();
        let is_second = cavity.is_some_and(Cavity::is_second_chamber);
        let second = self.sensed_cavity().filter(|_| is_second);
        second.map_or(state.pressure, |place| self.extra[place])
    }

    /// Returns the index of the cavity's pressure, if the sensor measures it.
    fn sensed_cavity(&self) -> Option<usize> {
        let cavity = self.plant.additions.cavity.as_ref()?;
        self.layout.cavity.filter(|_| cavity.holds_the_sensor)
    }

    /// Moves the actuator, if there is one, to `position` (m) within a time (s).
    pub(in crate::simulator) fn move_actuator(&mut self, position: f64, within_s: f64) {
        if let (Some(index), Some(actuator)) =
            (self.layout.actuator, &mut self.plant.additions.actuator)
        {
            let present = &mut self.extra[index];
            actuator.velocity = if within_s > 0.0 {
                (position - *present) / within_s
            } else {
                *present = position;
                0.0
            };
        }
    }

    /// Returns the gas temperature (K), if it is a state.
    pub(in crate::simulator) fn temperature(&self) -> Option<f64> {
        Some(self.extra[self.layout.temperature?])
    }

    /// Sets the duty cycles in force (%).
    pub(in crate::simulator) fn set_duty_pct(&mut self, duty_pct: [f64; 2]) {
        // A duty cycle that is no number is 0, as at the output.
        self.duty = duty_pct.map(|pct| (pct / 100.0).clamp(0.0, 1.0).max(0.0));
    }

    /// Sets the supply line to rest at `pressure` (Pa abs), if its pressure is a state.
    pub(in crate::simulator) fn rest_supply_line(&mut self, pressure: f64) {
        if let Some(line) = self.layout.line {
            self.extra[line] = pressure;
        }
    }

    /// Sets the gas temperature (K) at the present pressure; returns whether it is a state.
    pub(in crate::simulator) fn set_temperature(&mut self, kelvin: f64) -> bool {
        let Some(temperature) = self.layout.temperature else {
            return false;
        };
        self.extra[temperature] = kelvin;
        if let Some(second) = self.layout.second_temperature {
            self.extra[second] = kelvin;
        }
        true
    }

    /// Moves the states that follow the chamber pressure, after it was moved by `shift` to `pressure` (Pa).
    pub(in crate::simulator) fn shift_pressure(&mut self, shift: f64, pressure: f64) {
        if let Some(cavity) = self.layout.cavity {
            // A correction by a measurement; never to vacuum.
            self.extra[cavity] = (self.extra[cavity] + shift).max(1.0);
        }
        if let Some(plunger) = &self.plant.additions.plunger {
            let before = pressure - shift;
            let swept = match self.layout.plunger {
                Some(index) => &mut self.extra[index],
                None => &mut self.swept,
            };
            *swept = plunger.shifted(*swept, before, pressure);
        }
        self.sensor.shift(shift);
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::{EffectSetting, LIBRARY};
    use crate::simulator::Engine;
    use crate::{Command, PlantParameters, Simulator};

    /// Returns pressures (Pa) and currents (A) over two seconds; `in_full` also integrates with the general laws where
    /// no effect changes them.
    fn trace(plant: &PlantParameters, in_full: bool) -> Vec<[f64; 3]> {
        let mut simulator = Simulator::new(plant);
        let Engine::Extended(solver) = &mut simulator.engine else {
            panic!("an effect is there");
        };
        if in_full {
            (solver.physics.has_coil_law, solver.physics.has_gas_law) = (true, true);
        }
        let sample = |n: u64| {
            let (duty_fill_pct, duty_vent_pct) = match n / 25 % 4 {
                0 => (60.0, 0.0),
                1 => (0.0, 0.0),
                2 => (0.0, 45.0),
                _ => (80.0, 70.0),
            };
            simulator.command(Command {
                duty_fill_pct,
                duty_vent_pct,
            });
            simulator.advance_to_ns((n + 1) * 10_000_000);
            let sample = simulator.sample();
            let [fill, vent] = sample.mean_current;
            [sample.measured_pressure, fill, vent]
        };
        (0..200).map(sample).collect()
    }

    #[test]
    fn a_law_that_no_effect_changes_is_that_of_all_effects_without_one() {
        for effect in LIBRARY {
            for variant in effect.about().variants {
                let setting = EffectSetting::typical_variant(effect, variant);
                let plant = PlantParameters::nominal().with_effect(setting);
                if matches!(Simulator::new(&plant).engine, Engine::Plain(_)) {
                    continue;
                }
                for (short, full) in trace(&plant, false).into_iter().zip(trace(&plant, true)) {
                    let within = |n: usize, bound: f64| (short[n] - full[n]).abs() < bound;
                    let is_same = within(0, 1.0) && within(1, 1e-6) && within(2, 1e-6);
                    let name = (effect.about().id, variant.name);
                    assert!(is_same, "{name:?}: {short:?} and {full:?}");
                }
            }
        }
    }
}
