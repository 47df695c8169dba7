//! The event-driven solution of the plant.
//!
//! Between two events the plant is smooth. Events that are known in advance (PWM edges, samples) end a
//! segment; events that follow from the state are located within a step, which is then repeated up to
//! the event:
//!
//! - an armature departs from a stop: magnet and pressure overcome spring and preload, or no longer do;
//! - an armature arrives at a stop, where its velocity ends;
//! - the curtain of an orifice reaches the bore (equation 3.21), a kink in the flow;
//! - the current of a moving valve is extinct and the free-wheel diode blocks.
//!
//! What has a closed form is not integrated: the current of a resting coil is an exponential, and so is the
//! pressure of a chamber that is closed or whose flows are choked. What is left is smooth and not stiff, so an explicit pair of order
//! 5(4) solves it, with dimension 1 (flow only), 4 (one armature moves) or 7.

use crate::coil::{Drive, RestingCurrent};
use crate::ecu_output::{Command, EcuOutput};
use crate::parameters::PlantParameters;
use crate::plant::{FILL, Plant, PlantState, VENT};
use crate::solver::dormand_prince::{self, Step};
use crate::solver::hermite::{Cubic, Quintic};
use crate::solver::root::first_positive;
use crate::valve::{Motion, ValveState};

/// Local error allowed per step, for pressure [Pa], current [A], position [m], velocity [m/s].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tolerance {
    /// Chamber pressure [Pa].
    pub pressure: f64,
    /// Coil current [A].
    pub current: f64,
    /// Armature position [m].
    pub position: f64,
    /// Armature velocity [m/s].
    pub velocity: f64,
}

impl Tolerance {
    /// The default times `factor`; a small factor makes a converged reference.
    pub fn scaled(factor: f64) -> Self {
        let default = Self::default();
        Self {
            pressure: default.pressure * factor,
            current: default.current * factor,
            position: default.position * factor,
            velocity: default.velocity * factor,
        }
    }
}

impl Default for Tolerance {
    /// Chosen so that the pressure stays within 0.2 mbar rms of a converged reference on a bench log;
    /// docs/evidence.md has the figures.
    fn default() -> Self {
        Self {
            pressure: 2.0,
            current: 1e-5,
            position: 1e-8,
            velocity: 1e-4,
        }
    }
}

/// Longest step while an armature moves [s]: a quarter of its travel time, so that no arrival and
/// return fit into one step.
const LONGEST_MOTION_STEP: f64 = 0.5e-3;
/// Longest step of the pressure alone [s].
const LONGEST_FLOW_STEP: f64 = 5e-3;
/// Time that passes at least with every located event [s]; keeps a chattering armature going forward.
const SHORTEST_EVENT: f64 = 1e-9;

/// Work done since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Accepted integration steps.
    pub steps: u64,
    /// Steps repeated with a smaller size.
    pub rejected_steps: u64,
    /// Intervals passed by formula alone: nothing moved, and flows were choked or absent.
    pub exact_intervals: u64,
    /// Located events.
    pub events: u64,
}

/// What a sample of the plant shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Time of the sample [ns].
    pub time_ns: u64,
    /// Chamber pressure [Pa abs].
    pub pressure: f64,
    /// Coil currents of fill and vent valve [A].
    pub current: [f64; 2],
    /// Mean coil currents since the last sample [A].
    pub mean_current: [f64; 2],
    /// Armature positions [m].
    pub position: [f64; 2],
}

/// What ended a step.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Event {
    Departs(usize),
    ArrivesAtRestStop(usize),
    ArrivesAtFullStroke(usize),
    PassesKink(usize, f64),
    CurrentExtinct(usize),
}

/// Simulates a plant from duty cycles.
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
    plant: Plant,
    tolerance: Tolerance,
    ecu_output: EcuOutput,
    supply_voltage: f64,
    time_ns: u64,
    state: PlantState,
    /// ∫ i dt since the last sample [A s].
    charge: [f64; 2],
    last_sample_ns: u64,
    /// Step size to try next [s]: flow only, and with motion.
    proposal: [f64; 2],
    statistics: Statistics,
}

impl Simulator {
    /// A simulator at rest at time zero.
    pub fn new(parameters: &PlantParameters) -> Self {
        Self::with_tolerance(parameters, Tolerance::default())
    }

    /// A simulator with another accuracy.
    pub fn with_tolerance(parameters: &PlantParameters, tolerance: Tolerance) -> Self {
        let plant = parameters.plant();
        Self {
            state: plant.rest_state(),
            plant,
            tolerance,
            ecu_output: EcuOutput::new(
                parameters.ecu.pwm_period_ns(),
                parameters.ecu.command_delay_ns(),
            ),
            supply_voltage: parameters.ecu.supply_voltage_v,
            time_ns: 0,
            charge: [0.0; 2],
            last_sample_ns: 0,
            proposal: [1e-3, 0.25e-3],
            statistics: Statistics::default(),
        }
    }

    /// The physics that is simulated.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// The present state.
    pub fn state(&self) -> &PlantState {
        &self.state
    }

    /// The present time [ns].
    pub fn time_ns(&self) -> u64 {
        self.time_ns
    }

    /// Work done since the start.
    pub fn statistics(&self) -> Statistics {
        self.statistics
    }

    /// Commands duty cycles now; they take effect after the command delay.
    pub fn command(&mut self, command: Command) {
        self.ecu_output.command(self.time_ns, command);
    }

    /// Sets the supply voltage at the ECU [V] from now on.
    pub fn set_supply_voltage(&mut self, volt: f64) {
        self.supply_voltage = volt;
        for valve in &mut self.state.valves {
            if let Drive::Energised(_) = valve.drive {
                valve.drive = Drive::Energised(volt);
            }
        }
    }

    /// Moves the chamber pressure to `pressure` [Pa abs]: a correction by a measurement, or a start
    /// from another pressure than ambient.
    pub fn set_chamber_pressure(&mut self, pressure: f64) {
        self.state.pressure = pressure;
    }

    /// Takes a sample; the mean currents refer to the time since the last one.
    pub fn sample(&mut self) -> Sample {
        let span = (self.time_ns - self.last_sample_ns) as f64 * 1e-9;
        let current = self.state.valves.map(|valve| valve.current);
        let sample = Sample {
            time_ns: self.time_ns,
            pressure: self.state.pressure,
            current,
            mean_current: if span > 0.0 {
                self.charge.map(|charge| charge / span)
            } else {
                current
            },
            position: self.state.valves.map(|valve| valve.x),
        };
        self.charge = [0.0; 2];
        self.last_sample_ns = self.time_ns;
        sample
    }

    /// Advances to `end_ns`; an instant in the past changes nothing.
    pub fn advance_to_ns(&mut self, end_ns: u64) {
        while self.time_ns < end_ns {
            let high = self.ecu_output.update(self.time_ns);
            self.apply_outputs(high);
            let next_ns = self.ecu_output.next_edge_ns(self.time_ns).min(end_ns);
            self.advance_segment((next_ns - self.time_ns) as f64 * 1e-9);
            self.time_ns = next_ns;
        }
    }

    fn apply_outputs(&mut self, high: [bool; 2]) {
        for (valve, high) in self.state.valves.iter_mut().zip(high) {
            valve.drive = if high {
                Drive::Energised(self.supply_voltage)
            } else if valve.current > 0.0 {
                Drive::FreeWheeling(self.plant.diode_drop)
            } else {
                Drive::Blocked
            };
        }
    }

    /// Advances through `duration` [s] in which no output changes.
    fn advance_segment(&mut self, duration: f64) {
        let mut remaining = duration;
        while remaining > 0.0 {
            self.release_departing();
            let moving = self
                .state
                .valves
                .map(|valve| valve.motion == Motion::Moving);
            remaining = match moving {
                [false, false] => self.advance_resting(remaining),
                [true, false] => self.integrate::<4, 1>([FILL], remaining),
                [false, true] => self.integrate::<4, 1>([VENT], remaining),
                [true, true] => self.integrate::<7, 2>([FILL, VENT], remaining),
            };
        }
    }

    /// Sets free every armature that a force already pulls off its stop.
    fn release_departing(&mut self) {
        for index in [FILL, VENT] {
            let drop = self.plant.pressure_drop(index, self.state.pressure);
            let valve = &mut self.state.valves[index];
            let force = self.plant.valves[index].departing_force(
                valve.motion,
                valve.x,
                valve.current,
                drop,
            );
            if force > 0.0 {
                valve.motion = Motion::Moving;
            }
        }
    }

    /// Both armatures rest: by formula where the chamber is closed or its flows are choked, else the pressure
    /// alone is integrated.
    fn advance_resting(&mut self, remaining: f64) -> f64 {
        let areas = self.effective_areas();
        let course = self.plant.resting_pressure(areas, self.state.pressure);
        let Some(pressure) = course.filter(|course| course.valid_for() > SHORTEST_EVENT) else {
            return self.integrate::<1, 0>([], remaining);
        };
        let currents = self.resting_currents();
        let limit = remaining.min(pressure.valid_for());
        let (taken, departing) = match self.first_departure(limit, &currents, |t| pressure.at(t)) {
            Some((time, index)) => (time, Some(index)),
            None => (limit, None),
        };
        self.statistics.exact_intervals += 1;
        self.state.pressure = pressure.at(taken);
        for index in [FILL, VENT] {
            self.settle_current(index, &currents[index], taken);
        }
        if let Some(index) = departing {
            self.statistics.events += 1;
            self.state.valves[index].motion = Motion::Moving;
        }
        remaining - taken
    }

    /// The first resting armature that departs in (0, h], under a pressure that is known over time.
    fn first_departure(
        &self,
        h: f64,
        currents: &[RestingCurrent; 2],
        pressure: impl Fn(f64) -> f64,
    ) -> Option<(f64, usize)> {
        let departure = |index: usize| {
            let valve = &self.plant.valves[index];
            let ValveState { motion, x, .. } = self.state.valves[index];
            if motion == Motion::Moving {
                return None;
            }
            let force = |t: f64| {
                let drop = self.plant.pressure_drop(index, pressure(t));
                valve.departing_force(motion, x, currents[index].at(t), drop)
            };
            let departs = force(h) > 0.0;
            departs.then(|| {
                (
                    first_positive(force, 0.0, h).max(SHORTEST_EVENT).min(h),
                    index,
                )
            })
        };
        match (departure(FILL), departure(VENT)) {
            (Some(fill), Some(vent)) => Some(if vent.0 < fill.0 { vent } else { fill }),
            (fill, vent) => fill.or(vent),
        }
    }

    fn resting_currents(&self) -> [RestingCurrent; 2] {
        [FILL, VENT]
            .map(|index| self.plant.valves[index].resting_current(&self.state.valves[index]))
    }

    fn effective_areas(&self) -> [f64; 2] {
        [FILL, VENT]
            .map(|index| self.plant.valves[index].effective_area(self.state.valves[index].x))
    }

    /// Moves the current of a resting coil on by `time` and accounts for its charge.
    fn settle_current(&mut self, index: usize, course: &RestingCurrent, time: f64) {
        let valve = &mut self.state.valves[index];
        let current = course.at(time);
        self.charge[index] += course.charge(time, current);
        valve.current = current;
        if current == 0.0 && matches!(valve.drive, Drive::FreeWheeling(_)) {
            valve.drive = Drive::Blocked;
        }
    }

    /// One step of pressure and the `moving` valves, at most `remaining` [s] long; what is left.
    fn integrate<const N: usize, const M: usize>(
        &mut self,
        moving: [usize; M],
        remaining: f64,
    ) -> f64 {
        let plant = &self.plant;
        let drives = self.state.valves.map(|valve| valve.drive);
        let resting_areas = self.effective_areas();
        let rates = |y: &[f64; N]| {
            let pressure = y[0];
            let mut areas = resting_areas;
            let mut rates = [0.0; N];
            for (slot, &index) in moving.iter().enumerate() {
                let valve = &plant.valves[index];
                let [current, x, v] = [y[1 + 3 * slot], y[2 + 3 * slot], y[3 + 3 * slot]];
                areas[index] = valve.effective_area(x);
                let drop = plant.pressure_drop(index, pressure);
                rates[1 + 3 * slot..4 + 3 * slot].copy_from_slice(&valve.rates(
                    drives[index],
                    current,
                    x,
                    v,
                    drop,
                ));
            }
            rates[0] = plant.pressure_rate(areas, pressure);
            rates
        };

        let start = self.pack::<N, M>(moving);
        let start_rate = rates(&start);
        let (kind, longest) = if M == 0 {
            (0, LONGEST_FLOW_STEP)
        } else {
            (1, LONGEST_MOTION_STEP)
        };
        let mut rejected = 0;
        let (h, step) = loop {
            let h = self.proposal[kind].min(longest).min(remaining);
            let step = dormand_prince::step(rates, &start, &start_rate, h);
            let error = self.tolerance.measure(&step.error);
            // The fourth root for the fifth: cheaper, and more careful after a large error.
            let factor = (0.9 / error.sqrt().sqrt()).clamp(0.2, 4.0);
            if error <= 1.0 {
                // A step cut short by the segment's end says nothing against the longer one.
                let cut_short = h < self.proposal[kind];
                let floor = if cut_short { self.proposal[kind] } else { 0.0 };
                self.proposal[kind] = (h * factor).max(floor).min(longest);
                break (h, step);
            }
            self.proposal[kind] = h * factor.min(0.9);
            rejected += 1;
        };

        let currents = self.resting_currents();
        let located = self.first_event(moving, h, &start, &start_rate, &step, &currents);
        let (taken, end) = match located {
            Some((time, _)) if time < h => (
                time,
                dormand_prince::step(rates, &start, &start_rate, time).end,
            ),
            _ => (h, step.end),
        };
        self.statistics.rejected_steps += rejected;
        self.statistics.steps += 1;
        self.commit(moving, &start, &end, taken, &currents);
        if let Some((_, event)) = located {
            self.statistics.events += 1;
            self.apply(event);
        }
        remaining - taken
    }

    fn pack<const N: usize, const M: usize>(&self, moving: [usize; M]) -> [f64; N] {
        let mut y = [0.0; N];
        y[0] = self.state.pressure;
        for (slot, &index) in moving.iter().enumerate() {
            let ValveState { current, x, v, .. } = self.state.valves[index];
            y[1 + 3 * slot..4 + 3 * slot].copy_from_slice(&[current, x, v]);
        }
        y
    }

    /// The earliest event in (0, h], with its time.
    fn first_event<const N: usize, const M: usize>(
        &self,
        moving: [usize; M],
        h: f64,
        start: &[f64; N],
        start_rate: &[f64; N],
        step: &Step<N>,
        currents: &[RestingCurrent; 2],
    ) -> Option<(f64, Event)> {
        let mut first: Option<(f64, Event)> = None;
        let mut offer = |time: f64, event: Event| {
            let time = time.max(SHORTEST_EVENT).min(h);
            if first.is_none_or(|(earliest, _)| time < earliest) {
                first = Some((time, event));
            }
        };

        let pressure = Cubic::new(h, start[0], start_rate[0], step.end[0], step.end_rate[0]);
        if let Some((time, index)) = self.first_departure(h, currents, |t| pressure.at(t)) {
            offer(time, Event::Departs(index));
        }
        for (slot, &index) in moving.iter().enumerate() {
            let valve = &self.plant.valves[index];
            let at = |y: &[f64; N], offset: usize| y[1 + 3 * slot + offset];
            let (x0, x1) = (at(start, 1), at(&step.end, 1));
            let position = || {
                Quintic::new(
                    h,
                    [x0, at(start, 2), at(start_rate, 2)],
                    [x1, at(&step.end, 2), at(&step.end_rate, 2)],
                )
            };
            let stroke = valve.armature.stroke;
            let kink = valve.saturation_position();
            let (v0, v1) = (at(start, 2), at(&step.end, 2));
            // An armature that turns within the step may have touched a stop on the way.
            let turns = v0 * v1 < 0.0;
            if x1 < 0.0 || turns && v0 < 0.0 {
                let x = position();
                if let Some(time) = arrival(|t| -x.at(t), |t| x.rate_at(t), turns, h) {
                    offer(time, Event::ArrivesAtRestStop(index));
                }
            }
            if x1 > stroke || turns && v0 > 0.0 {
                let x = position();
                if let Some(time) = arrival(|t| x.at(t) - stroke, |t| -x.rate_at(t), turns, h) {
                    offer(time, Event::ArrivesAtFullStroke(index));
                }
            }
            if (x0 - kink) * (x1 - kink) < 0.0 {
                let x = position();
                let sign = (x1 - kink).signum();
                let time = first_positive(|t| sign * (x.at(t) - kink), 0.0, h);
                offer(time, Event::PassesKink(index, kink));
            }
            let freewheeling = matches!(self.state.valves[index].drive, Drive::FreeWheeling(_));
            if freewheeling && at(&step.end, 0) < 0.0 {
                let current = Cubic::new(
                    h,
                    at(start, 0),
                    at(start_rate, 0),
                    at(&step.end, 0),
                    at(&step.end_rate, 0),
                );
                let time = first_positive(|t| -current.at(t), 0.0, h);
                offer(time, Event::CurrentExtinct(index));
            }
        }
        first
    }

    fn commit<const N: usize, const M: usize>(
        &mut self,
        moving: [usize; M],
        start: &[f64; N],
        end: &[f64; N],
        taken: f64,
        currents: &[RestingCurrent; 2],
    ) {
        self.state.pressure = end[0];
        for index in [FILL, VENT] {
            if self.state.valves[index].motion != Motion::Moving {
                self.settle_current(index, &currents[index], taken);
            }
        }
        for (slot, &index) in moving.iter().enumerate() {
            let coil = &self.plant.valves[index].coil;
            let valve = &mut self.state.valves[index];
            [valve.current, valve.x, valve.v] =
                [end[1 + 3 * slot], end[2 + 3 * slot], end[3 + 3 * slot]];
            if let Some(voltage) = valve.drive.voltage() {
                // Flux balance: R ∫i dt = ∫u dt - Δ(L i), exact whatever the armature did.
                let flux = |y: &[f64; N]| coil.inductance(y[2 + 3 * slot]) * y[1 + 3 * slot];
                self.charge[index] +=
                    (voltage * taken - (flux(end) - flux(start))) / coil.resistance;
            }
        }
    }

    fn apply(&mut self, event: Event) {
        let (index, x, motion) = match event {
            Event::Departs(index) => {
                self.state.valves[index].motion = Motion::Moving;
                return;
            }
            Event::CurrentExtinct(index) => {
                let valve = &mut self.state.valves[index];
                valve.current = 0.0;
                valve.drive = Drive::Blocked;
                return;
            }
            Event::PassesKink(index, kink) => {
                self.state.valves[index].x = kink;
                return;
            }
            Event::ArrivesAtRestStop(index) => (index, 0.0, Motion::AtRestStop),
            Event::ArrivesAtFullStroke(index) => {
                let stroke = self.plant.valves[index].armature.stroke;
                (index, stroke, Motion::AtFullStroke)
            }
        };
        let valve = &mut self.state.valves[index];
        *valve = ValveState {
            x,
            v: 0.0,
            motion,
            ..*valve
        };
    }
}

/// When a moving armature passes a stop, if it does: `beyond` is positive outside, `retreat` is the velocity
/// away from the stop, and `turns` says that the velocity changes its sign within the step.
fn arrival(
    beyond: impl Fn(f64) -> f64,
    retreat: impl Fn(f64) -> f64,
    turns: bool,
    h: f64,
) -> Option<f64> {
    let deepest = if turns {
        first_positive(retreat, 0.0, h)
    } else {
        h
    };
    if beyond(deepest) <= 0.0 {
        return None;
    }
    // It may have just left this very stop, so the search starts where it is inside.
    let inside = (1..=6)
        .map(|halvings| deepest / f64::from(1 << halvings))
        .find(|&t| beyond(t) < 0.0);
    Some(inside.map_or(SHORTEST_EVENT, |lo| first_positive(beyond, lo, deepest)))
}

impl Tolerance {
    /// Largest local error in units of the tolerance; 1 is just allowed.
    #[inline]
    fn measure<const N: usize>(&self, error: &[f64; N]) -> f64 {
        let weights = [self.current, self.position, self.velocity];
        let valves = error[1..]
            .iter()
            .enumerate()
            .map(|(n, error)| error.abs() / weights[n % 3]);
        valves
            .fold(error[0].abs() / self.pressure, f64::max)
            .max(1e-6)
    }
}
