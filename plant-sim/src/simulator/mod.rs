//! Event-driven solution of the plant.
//!
//! Between two events the plant is smooth. Events that are known in advance (PWM edges, samples) end a segment. Events
//! that follow from the state are located within a step, which then ends there:
//!
//! - an armature breaks away from a stop: magnet and pressure overcome spring and preload, or no longer do;
//! - an armature arrives at a stop, where its velocity ends;
//! - the curtain of an orifice reaches the bore (equation 3.21), a kink in the flow;
//! - the current of a moving valve has decayed to zero and the freewheeling diode blocks.
//!
//! Quantities with a closed form are not integrated: the current of a resting coil is an exponential, and the pressure
//! of a chamber has a formula if its flows are choked or one valve is closed (see `resting_pressure`). The rest is
//! smooth and not stiff, so an explicit pair of order 5(4) solves it, with dimension 1 (flow only), 4 (one armature
//! moves) or 7.
//!
//! Effects override parts of the physics, integrate quantities that have lost their closed form, and add states. The
//! plain plant is compiled separately, without any code of the effects.

mod event;
mod extended;
mod flux;
mod gas;
mod layout;
mod lifts;
mod physics;
mod sensor;
mod smooth;
mod solver;
mod span;
mod tolerance;

pub use solver::Statistics;
pub use tolerance::Tolerance;

use crate::additions::Additions;
use crate::coil::Drive;
use crate::ecu_output::{Command, EcuOutput};
use crate::on_off_valve::Switching;
use crate::parameters::PlantParameters;
use crate::plant::{FILL, Plant, PlantState, VENT};
use crate::proportional_valve::Positioning;
use crate::valve::{Motion, Turn, ValveFunction};
pub use extended::EffectState;
use extended::Extended;
use physics::Physics;
use solver::Solver;

/// Sample of the plant's quantities.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time of the sample (ns).
    pub time_ns: u64,
    /// Chamber pressure (Pa abs).
    pub pressure: f64,
    /// Pressure where the sensor is (Pa abs): that of the second chamber, if there is one.
    pub pressure_at_sensor: f64,
    /// Pressure that the sensor shows (Pa abs): the chamber's without effects.
    pub measured_pressure: f64,
    /// Coil currents of fill and vent valve (A).
    pub current: [f64; 2],
    /// Mean coil currents since the last sample (A).
    pub mean_current: [f64; 2],
    /// Armature positions (m).
    pub position: [f64; 2],
    /// Gas temperature in the chamber (K): that of the plant file without effects.
    pub temperature: f64,
}

impl Sample {
    /// Returns the sample of an aborted simulation, in which only the time is known.
    fn unknown(time_ns: u64) -> Self {
        Self {
            time_ns,
            pressure: f64::NAN,
            pressure_at_sensor: f64::NAN,
            measured_pressure: f64::NAN,
            current: [f64::NAN; 2],
            mean_current: [f64::NAN; 2],
            position: [f64::NAN; 2],
            temperature: f64::NAN,
        }
    }
}

/// Simulator of a plant driven by duty cycles.
///
/// ```
/// use plant_sim::{Command, PlantParameters, Simulator};
///
/// let mut simulator = Simulator::new(&PlantParameters::nominal());
/// simulator.command(Command { duty_fill_pct: 100.0, duty_vent_pct: 0.0 });
/// simulator.advance_to_ns(200_000_000);
/// let sample = simulator.sample();
/// assert!(sample.pressure > 5e5, "the chamber fills: {} Pa", sample.pressure);
/// ```
#[derive(Debug, Clone)]
pub struct Simulator {
    engine: Engine,
    ecu_output: EcuOutput,
    /// Fill and vent valve, where they are on/off valves.
    switching: [Option<Switching>; 2],
    /// Positioning of the proportional valves.
    positioning: [Option<Positioning>; 2],
    supply_voltage: f64,
    /// Gas temperature of the plant file (K).
    gas_temperature: f64,
    time_ns: u64,
    last_sample_ns: u64,
}

/// Solver of the plain plant, or of a plant with effects.
#[derive(Debug, Clone)]
enum Engine {
    Plain(Box<Solver<Plant>>),
    Extended(Box<Solver<Extended>>),
}

/// Applies the same expression to either engine.
macro_rules! either {
    ($engine:expr, $solver:ident => $answer:expr) => {
        match $engine {
            Engine::Plain($solver) => $answer,
            Engine::Extended($solver) => $answer,
        }
    };
}

impl Simulator {
    /// Creates a simulator at rest at time zero. `parameters` must be valid for a plant file: [`PlantParameters`] that
    /// were read or set through its methods are valid, others need [`PlantParameters::check`] first.
    pub fn new(parameters: &PlantParameters) -> Self {
        Self::with_tolerance(parameters, Tolerance::default())
    }

    /// Creates a simulator with another accuracy.
    pub fn with_tolerance(parameters: &PlantParameters, tolerance: Tolerance) -> Self {
        let plant = parameters.plant();
        let engine = if plant.additions == Additions::default() {
            Engine::Plain(Box::new(Solver::new(plant, tolerance)))
        } else {
            let extended = Extended::new(plant, tolerance);
            Engine::Extended(Box::new(Solver::new(extended, tolerance)))
        };
        Self {
            engine,
            ecu_output: EcuOutput::new(
                parameters.ecu.pwm_period_ns(),
                parameters.ecu.command_delay_ns(),
            ),
            switching: [FILL, VENT].map(|valve| {
                let is_on_off = parameters.functions[valve] == ValveFunction::OnOff;
                is_on_off.then(|| Switching::new(parameters.on_off(valve)))
            }),
            positioning: [FILL, VENT].map(|valve| {
                let is_proportional = parameters.functions[valve] == ValveFunction::Proportional;
                is_proportional.then(|| Positioning::new(parameters.proportional(valve)))
            }),
            supply_voltage: parameters.ecu.supply_voltage_v,
            gas_temperature: parameters.gas.temperature_k,
            time_ns: 0,
            last_sample_ns: 0,
        }
    }

    /// Returns the simulated physics.
    pub fn plant(&self) -> &Plant {
        either!(&self.engine, solver => solver.physics.plant())
    }

    /// Returns the present state.
    pub fn state(&self) -> &PlantState {
        either!(&self.engine, solver => &solver.state)
    }

    fn state_mut(&mut self) -> &mut PlantState {
        either!(&mut self.engine, solver => &mut solver.state)
    }

    /// Iterates over the states that effects add, by name: gas and coil temperatures, pressures other than the
    /// chamber's.
    pub fn effect_states(&self) -> impl Iterator<Item = EffectState> {
        let states = match &self.engine {
            Engine::Plain(_) => Vec::new(),
            Engine::Extended(solver) => solver.physics.states(),
        };
        states.into_iter()
    }

    /// Returns the present time (ns).
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// Returns the work done since the start.
    pub fn statistics(&self) -> Statistics {
        either!(&self.engine, solver => solver.statistics)
    }

    /// Aborts the simulation once its [work](Statistics::work) has reached `limit`, if necessary in the middle of an
    /// advance. The plant then keeps its state, and samples show NaN. A larger limit lets the simulation continue from
    /// there.
    pub fn set_work_limit(&mut self, limit: u64) {
        either!(&mut self.engine, solver => solver.work_limit = limit);
    }

    /// Returns whether the simulation was aborted: the limit of the work is reached, or a rate is NaN, which a
    /// user-defined law may cause. Samples show NaN then.
    pub fn is_aborted(&self) -> bool {
        either!(&self.engine, solver => solver.is_aborted())
    }

    /// Commands duty cycles now; they take effect after the command delay.
    pub fn command(&mut self, command: Command) {
        self.command_at(self.time_ns, command);
    }

    /// Commands duty cycles at `instant_ns`, which may be in the past. They apply to the first PWM period that begins
    /// after the command delay; if that period is running, from now on. Commands must be given in the order of their
    /// instants.
    pub fn command_at(&mut self, instant_ns: u64, command: Command) {
        self.ecu_output.command(instant_ns, command);
    }

    /// Returns the numbers of lifts of the fill and the vent valve since the start: departures of the armature from its
    /// seat by more than a hundredth of the stroke, of which each bounce is one.
    pub fn lifts(&self) -> [u64; 2] {
        either!(&self.engine, solver => solver.lifts.map(lifts::Lifts::count))
    }

    /// Sets the supply voltage at the ECU (V) from now on.
    pub fn set_supply_voltage(&mut self, volt: f64) {
        self.supply_voltage = volt;
        for valve in &mut self.state_mut().valves {
            if let Drive::Energised(_) = valve.drive {
                valve.drive = Drive::Energised(volt);
            }
        }
    }

    /// Sets the pressure of the air supply (Pa abs) from now on: the pressure upstream of a supply line, or of the fill
    /// valve without one. At time zero, the line is at rest at this pressure.
    ///
    /// # Panics
    /// Panics if `pressure` is not positive and finite.
    pub fn set_supply_pressure(&mut self, pressure: f64) {
        assert!(
            pressure > 0.0 && pressure.is_finite(),
            "an absolute pressure is positive, not {pressure}"
        );
        either!(&mut self.engine, solver => solver.physics.plant_mut().supply_pressure = pressure);
        if let Engine::Extended(solver) = &mut self.engine
            && self.time_ns == 0
        {
            solver.physics.rest_supply_line(pressure);
        }
    }

    /// Moves an actuator that changes the volume of the chamber to `position` (m) at a constant velocity, at which it arrives
    /// after `within_s` (s); at once if that is 0. Call it again there, or it goes on. Without the effect `actuator_volume`
    /// nothing changes.
    ///
    /// # Panics
    /// Panics if a value is not finite, or the time negative.
    pub fn move_actuator(&mut self, position: f64, within_s: f64) {
        assert!(
            position.is_finite() && within_s.is_finite() && within_s >= 0.0,
            "an actuator cannot move to {position} m within {within_s} s"
        );
        if let Engine::Extended(solver) = &mut self.engine {
            solver.physics.move_actuator(position, within_s);
        }
    }

    /// Returns whether the gas temperature is a state, which the effect `gas_temperature` adds.
    pub fn has_gas_temperature(&self) -> bool {
        match &self.engine {
            Engine::Plain(_) => false,
            Engine::Extended(solver) => solver.physics.temperature().is_some(),
        }
    }

    /// Sets the temperature of the gas in the chamber (K) at its present pressure. Returns whether the plant has such a
    /// state, which the effect `gas_temperature` adds; without it nothing changes.
    ///
    /// # Panics
    /// Panics if `kelvin` is not positive and finite.
    pub fn set_gas_temperature(&mut self, kelvin: f64) -> bool {
        assert!(
            kelvin > 0.0 && kelvin.is_finite(),
            "an absolute temperature is positive, not {kelvin}"
        );
        match &mut self.engine {
            Engine::Plain(_) => false,
            Engine::Extended(solver) => solver.physics.set_temperature(kelvin),
        }
    }

    /// Moves the chamber pressure to `pressure` (Pa abs): a correction by a measurement, or a start from another
    /// pressure than ambient. States that an effect adds to the pressure's dynamics, such as a slow sensor, move along.
    ///
    /// # Panics
    /// Panics if `pressure` is not positive and finite.
    pub fn set_chamber_pressure(&mut self, pressure: f64) {
        assert!(
            pressure > 0.0 && pressure.is_finite(),
            "an absolute pressure is positive, not {pressure}"
        );
        match &mut self.engine {
            Engine::Plain(solver) => solver.state.pressure = pressure,
            Engine::Extended(solver) => {
                let shift = pressure - solver.state.pressure;
                solver.state.pressure = pressure;
                solver.physics.shift_pressure(shift, pressure);
            }
        }
    }

    /// Takes a sample; the mean currents refer to the time since the last one.
    pub fn sample(&mut self) -> Sample {
        let span = (self.time_ns - self.last_sample_ns) as f64 * 1e-9;
        let (pressure_at_sensor, measured_pressure, temperature) = match &self.engine {
            Engine::Plain(solver) => (solver.state.pressure, solver.state.pressure, None),
            Engine::Extended(solver) => (
                solver.physics.pressure_at_sensor(&solver.state),
                solver.physics.measured_pressure(&solver.state),
                solver.physics.temperature(),
            ),
        };
        let temperature = temperature.unwrap_or(self.gas_temperature);
        let charge = either!(&mut self.engine, solver => core::mem::take(&mut solver.charge));
        let state = self.state();
        let current = state.valves.map(|valve| valve.current);
        let known = Sample {
            time_ns: self.time_ns,
            pressure: state.pressure,
            pressure_at_sensor,
            measured_pressure,
            current,
            mean_current: if span > 0.0 {
                charge.map(|charge| charge / span)
            } else {
                current
            },
            position: state.valves.map(|valve| valve.x),
            temperature,
        };
        self.last_sample_ns = self.time_ns;
        if self.is_aborted() {
            Sample::unknown(self.time_ns)
        } else {
            known
        }
    }

    /// Advances to `end_ns`; an instant in the past changes nothing.
    pub fn advance_to_ns(&mut self, end_ns: u64) {
        while self.time_ns < end_ns {
            let high = self.ecu_output.update(self.time_ns);
            self.apply_outputs(high);
            let switching = self.switching.iter().flatten();
            let positioning = self.positioning.iter().flatten();
            let next_ns = switching
                .filter_map(Switching::next_turn_ns)
                .chain(positioning.filter_map(Positioning::next_turn_ns))
                .fold(self.ecu_output.next_edge_ns(self.time_ns), u64::min)
                .min(end_ns);
            let duration = (next_ns - self.time_ns) as f64 * 1e-9;
            either!(&mut self.engine, solver => solver.advance(duration));
            self.time_ns = next_ns;
        }
    }

    fn apply_outputs(&mut self, high: [bool; 2]) {
        let coils = [FILL, VENT].map(|valve| {
            high[valve] && self.switching[valve].is_none() && self.positioning[valve].is_none()
        });
        either!(&mut self.engine, solver => drive(solver, coils, self.supply_voltage));
        for (valve, high) in high.into_iter().enumerate() {
            let factor = self.opening_factor(valve);
            let switching = self.switching[valve].as_mut();
            if let Some(to) = switching.and_then(|one| one.update(self.time_ns, high, factor)) {
                either!(&mut self.engine, solver => turn(solver, valve, to));
            }
        }
        for (valve, command_pct) in self.ecu_output.in_force_pct().into_iter().enumerate() {
            let share = self.state().valves[valve].x / self.plant().valves[valve].armature.stroke;
            let positioning = self.positioning[valve].as_mut();
            let update = |one: &mut Positioning| one.update(self.time_ns, command_pct, share);
            if let Some(to) = positioning.and_then(update) {
                either!(&mut self.engine, solver => turn(solver, valve, to));
            }
        }
        if let Engine::Extended(solver) = &mut self.engine {
            solver.physics.set_duty_pct(self.ecu_output.in_force_pct());
            solver.physics.switched(&mut solver.state);
        }
    }

    /// Returns the opening delay of an on/off valve over that of the plant file.
    fn opening_factor(&self, valve: usize) -> f64 {
        let plant = self.plant();
        let delay = plant.additions.opening_delay.as_ref();
        delay.map_or(1.0, |delay| {
            let drop = plant.pressure_drop(valve, self.state().pressure);
            delay.factor(drop, self.supply_voltage)
        })
    }
}

/// Changes the motion of a valve without a coil.
fn turn<P: Physics>(solver: &mut Solver<P>, valve: usize, to: Turn) {
    let stroke = solver.physics.plant().valves[valve].armature.stroke;
    let state = &mut solver.state.valves[valve];
    match to {
        // It stays at its stop.
        Turn::Moves(velocity) if velocity > 0.0 && state.x >= stroke => {}
        Turn::Moves(velocity) if velocity <= 0.0 && state.x <= 0.0 => {}
        Turn::Moves(velocity) => {
            (state.v, state.motion) = (velocity * stroke, Motion::Moving);
        }
        Turn::RestsAt(share) => {
            (state.x, state.v) = (share * stroke, 0.0);
            state.motion = Motion::Stuck;
        }
    }
}

/// Applies the outputs to the coils.
#[inline]
fn drive<P: Physics>(solver: &mut Solver<P>, high: [bool; 2], supply_voltage: f64) {
    for (index, high) in high.into_iter().enumerate() {
        let valve = &mut solver.state.valves[index];
        valve.drive = if high {
            Drive::Energised(supply_voltage)
        } else if solver.physics.current_freewheels(index, valve) {
            Drive::Freewheeling(solver.physics.plant().diode_drop)
        } else {
            Drive::Blocked
        };
    }
}
