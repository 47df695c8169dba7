//! Solves the plant through a stretch in which no output changes.

use super::span::{Span, first_of};
use super::tolerance::{Tolerance, Weights};
use crate::coil::{Drive, RestingCurrent};
use crate::orifice::Limit;
use crate::plant::{FILL, Plant, PlantState, VENT};
use crate::resting_pressure::RestingPressure;
use crate::solver::dormand_prince;
use crate::valve::{Motion, ValveState};

/// Longest step while an armature moves (s): a third of the nominal travel time, so that it turns at most
/// once in a step.
const LONGEST_MOTION_STEP: f64 = 0.8e-3;
/// Longest step of the pressure alone (s).
const LONGEST_FLOW_STEP: f64 = 5e-3;
/// The first step after an event is at most this many times as long as the last one was until the event.
const EVENTS_AHEAD: f64 = 10.0;
/// And never shortened below this (s).
const SHORTEST_STEP_AFTER_EVENT: f64 = 1e-6;
/// Time that passes at least with every located event (s); keeps a chattering armature going forward.
pub(super) const SHORTEST_EVENT: f64 = 1e-9;

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

/// The plant, its state and what the solution needs to know of its past.
#[derive(Debug, Clone)]
pub(super) struct Solver {
    pub(super) plant: Plant,
    pub(super) state: PlantState,
    /// ∫ i dt since the last sample (A s).
    pub(super) charge: [f64; 2],
    pub(super) statistics: Statistics,
    weights: Weights,
    /// Step size to try next (s): flow only, and with motion.
    proposal: [f64; 2],
}

impl Solver {
    pub(super) fn new(plant: Plant, tolerance: Tolerance) -> Self {
        Self {
            state: plant.rest_state(),
            plant,
            charge: [0.0; 2],
            statistics: Statistics::default(),
            weights: tolerance.weights(),
            proposal: [1e-3, 0.25e-3],
        }
    }

    /// Advances through `duration` (s) in which no output changes.
    pub(super) fn advance(&mut self, duration: f64) {
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
        let course = RestingPressure::of(&self.plant, areas, self.state.pressure);
        let Some(pressure) = course.filter(|course| course.valid_for() > SHORTEST_EVENT) else {
            return self.integrate::<1, 0>([], remaining);
        };
        let currents = self.resting_currents();
        let limit = remaining.min(pressure.valid_for());
        let (taken, departing) =
            match self.first_departure(limit, &currents, |t| pressure.at(&self.plant, t)) {
                Some((time, index)) => (time, Some(index)),
                None => (limit, None),
            };
        self.statistics.exact_intervals += 1;
        self.state.pressure = pressure.at(&self.plant, taken);
        for index in [FILL, VENT] {
            self.settle_current(index, &currents[index], taken);
        }
        if let Some(index) = departing {
            self.statistics.events += 1;
            self.state.valves[index].motion = Motion::Moving;
        }
        remaining - taken
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

    /// Integrates pressure and the `moving` valves up to the next event, at most over `remaining` (s); what is
    /// left.
    fn integrate<const N: usize, const M: usize>(
        &mut self,
        moving: [usize; M],
        mut remaining: f64,
    ) -> f64 {
        let smooth = Smooth {
            moving,
            drives: moving.map(|index| self.state.valves[index].drive),
            limits: moving.map(|index| {
                let ValveState { x, v, .. } = self.state.valves[index];
                self.plant.valves[index].limit(x, v)
            }),
            resting_areas: self.effective_areas(),
        };
        let mut start = self.pack::<N, M>(moving);
        let mut start_rate = smooth.rates(&self.plant, &start);
        while remaining > 0.0 {
            let span = self.step(&smooth, start, start_rate, remaining);
            let currents = self.resting_currents();
            if let Some((time, event)) = self.first_event(&smooth, &span, &currents) {
                self.commit(moving, &start, &span.at(time), time, &currents);
                self.statistics.events += 1;
                self.apply(event);
                // An event early in a step says that the step was too long to see what happens around it: an
                // armature that hovers at its seat would chatter.
                let kind = usize::from(M > 0);
                let around = (EVENTS_AHEAD * time).max(SHORTEST_STEP_AFTER_EVENT);
                self.proposal[kind] = self.proposal[kind].min(around);
                return remaining - time;
            }
            self.commit(moving, &start, &span.end, span.h, &currents);
            (start, start_rate) = (span.end, span.end_rate);
            remaining -= span.h;
        }
        remaining
    }

    /// One step that keeps the tolerance, at most `remaining` (s) long.
    fn step<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        start: [f64; N],
        start_rate: [f64; N],
        remaining: f64,
    ) -> Span<N> {
        let kind = usize::from(M > 0);
        let longest = [LONGEST_FLOW_STEP, LONGEST_MOTION_STEP][kind];
        loop {
            let h = self.proposal[kind].min(longest).min(remaining);
            let rates = |y: &[f64; N]| smooth.rates(&self.plant, y);
            let step = dormand_prince::step(rates, &start, &start_rate, h);
            let error = self.weights.measure(&step.error);
            // The fourth root for the fifth: cheaper, and more careful after a large error.
            let factor = (0.9 / error.sqrt().sqrt()).clamp(0.2, 4.0);
            if error <= 1.0 {
                // A step cut short by the segment's end says nothing against the longer one.
                let cut_short = h < self.proposal[kind];
                let floor = if cut_short { self.proposal[kind] } else { 0.0 };
                self.proposal[kind] = (h * factor).max(floor).min(longest);
                self.statistics.steps += 1;
                return Span {
                    h,
                    start,
                    start_rate,
                    end: step.end,
                    end_rate: step.end_rate,
                };
            }
            self.proposal[kind] = h * factor.min(0.9);
            self.statistics.rejected_steps += 1;
        }
    }

    fn pack<const N: usize, const M: usize>(&self, moving: [usize; M]) -> [f64; N] {
        let mut y = [0.0; N];
        y[0] = self.state.pressure;
        for (slot, &index) in moving.iter().enumerate() {
            let ValveState { current, x, v, .. } = self.state.valves[index];
            y[first_of(slot)..first_of(slot + 1)].copy_from_slice(&[current, x, v]);
        }
        y
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
        for (slot, index) in moving.into_iter().enumerate() {
            let coil = &self.plant.valves[index].coil;
            let valve = &mut self.state.valves[index];
            let first = first_of(slot);
            [valve.current, valve.x, valve.v] = [end[first], end[first + 1], end[first + 2]];
            if let Some(voltage) = valve.drive.voltage() {
                // Flux balance: R ∫i dt = ∫u dt - Δ(L i), exact whatever the armature did.
                let flux = |y: &[f64; N]| coil.inductance(y[first + 1]) * y[first];
                self.charge[index] +=
                    (voltage * taken - (flux(end) - flux(start))) / coil.resistance;
            }
        }
    }
}

/// The right-hand side between two events, where it is smooth: `M` valves move, the others stay.
pub(super) struct Smooth<const M: usize> {
    pub(super) moving: [usize; M],
    pub(super) drives: [Drive; M],
    /// Which part of the area law the step stays on.
    pub(super) limits: [Limit; M],
    resting_areas: [f64; 2],
}

impl<const M: usize> Smooth<M> {
    #[inline(always)]
    fn rates<const N: usize>(&self, plant: &Plant, y: &[f64; N]) -> [f64; N] {
        let pressure = y[0];
        let mut areas = self.resting_areas;
        let mut rates = [0.0; N];
        for slot in 0..M {
            let index = self.moving[slot];
            let valve = &plant.valves[index];
            let first = first_of(slot);
            let [current, x, v] = [y[first], y[first + 1], y[first + 2]];
            areas[index] = valve.effective_area_by(self.limits[slot], x);
            let drop = plant.pressure_drop(index, pressure);
            let valve_rates = valve.rates(self.drives[slot], current, x, v, drop);
            rates[first..first + 3].copy_from_slice(&valve_rates);
        }
        rates[0] = plant.pressure_rate(areas, pressure);
        rates
    }
}
