//! Solver of the plant through an interval without a change of the outputs.

use super::lifts::Lifts;
use super::physics::{FEW, MANY, Physics, Width};
use super::smooth::Smooth;
use super::span::{Span, first_of};
use super::tolerance::{Tolerance, Weights};
use crate::coil::{Drive, RestingCurrent};
use crate::plant::{FILL, PlantState, VENT};
use crate::solver::dormand_prince::{self, Staged};
use crate::solver::rosenbrock;
use crate::valve::{Motion, ValveState};

/// Longest step while a valve is live (s): a third of the nominal travel time, so that an armature turns at most once
/// in a step, and the current is as accurate as its effects require.
const LONGEST_MOTION_STEP: f64 = 0.8e-3;
/// Largest first step after an event, relative to the time from the start of the previous step to the event.
const EVENTS_AHEAD: f64 = 10.0;
/// Lower limit (s) of a step shortened by [`EVENTS_AHEAD`].
const SHORTEST_STEP_AFTER_EVENT: f64 = 1e-6;
/// Longest step of the method for stiff plants (s), whose state within a step is interpolated by a straight line.
const LONGEST_STIFF_STEP: f64 = 0.2e-3;
/// Longest stiff step (s) if no valve is live and the previous step shows that the line deviates by less than the
/// tolerance.
const LONGEST_STRAIGHT_STEP: f64 = 2e-3;
/// Ratio of a step to the inverse of the fastest rate beyond which the explicit method is near its limit of stability,
/// 3.3.
const NEAR_INSTABILITY: f64 = 2.5;
/// The same ratio while no armature moves, for steps shorter than [`SHORT_STEPS`]. A small volume behind an open valve
/// has nearly the same pressure as the chamber. The slope of equation 3.19 is largest there, and falls to a fraction
/// within the tolerance: at ambient pressure the [linear zone](crate::orifice::LAMINAR_RATIO) is 10 Pa wide. The last
/// two stages of a step at the limit are further apart than that. The rate between them is up to five times smaller
/// than the rate in the zone.
const NEAR_INSTABILITY_AT_REST: f64 = 0.5;
/// Lengths (s) of explicit steps below which the method for stiff plants takes fewer: without and with live valves.
const SHORT_STEPS: [f64; 2] = [0.25 * LONGEST_STRAIGHT_STEP, 0.5 * LONGEST_STIFF_STEP];
/// Minimum excess of steps at the stability limit over steps below it for the plant to count as stiff.
const STIFF_STEPS_MIN: u32 = 15;
/// Minimum number of steps between two events for a new decision whether the plant is stiff. After fewer steps the
/// decision stays: otherwise events in quick succession would leave a stiff plant to the explicit method, whose noise
/// causes more events.
const RECONSIDERED: u32 = 3;
/// Shortest step (s): a rate that is infinite or NaN at this step is so at any shorter one.
const SHORTEST_STEP: f64 = 1e-15;
/// Minimum time (s) that passes with every located event; it lets a chattering armature make progress.
pub(super) const SHORTEST_EVENT: f64 = 1e-9;

/// Work done since the start.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Accepted integration steps.
    pub steps: u64,
    /// Steps repeated with a smaller size.
    pub rejected_steps: u64,
    /// Intervals passed by formula alone: nothing moved, and the pressure had a closed form.
    pub exact_intervals: u64,
    /// Located events.
    pub events: u64,
}

impl Statistics {
    /// Returns all work that takes computing time: steps, including repeated ones, and intervals passed by formula.
    pub fn work(&self) -> u64 {
        self.steps + self.rejected_steps + self.exact_intervals
    }
}

/// Physics with its state and the required history of the solution.
#[derive(Debug, Clone)]
pub(super) struct Solver<P> {
    pub(super) physics: P,
    pub(super) state: PlantState,
    /// ∫ i dt since the last sample (A s).
    pub(super) charge: [f64; 2],
    /// Lifts of both valves since the start.
    pub(super) lifts: [Lifts; 2],
    pub(super) statistics: Statistics,
    /// Work at which the simulation is aborted.
    pub(super) work_limit: u64,
    weights: Weights,
    /// Size of the next step to try (s): flow only, and with motion.
    proposal: [f64; 2],
    /// Number of steps at the limit of stability, minus those below it.
    stiffness: u32,
    /// Number of integrated steps since the last event.
    stretch: u32,
    /// Whether a rate was infinite or NaN at the shortest step, so that there is no next step.
    has_no_step: bool,
}

impl<P: Physics> Solver<P> {
    pub(super) fn new(physics: P, tolerance: Tolerance) -> Self {
        Self {
            state: physics.plant().rest_state(),
            lifts: physics.plant().valves.each_ref().map(Lifts::at_rest),
            physics,
            charge: [0.0; 2],
            statistics: Statistics::default(),
            work_limit: u64::MAX,
            weights: tolerance.weights(),
            proposal: [1e-3, 0.25e-3],
            stiffness: 0,
            stretch: 0,
            has_no_step: false,
        }
    }

    pub(super) fn is_aborted(&self) -> bool {
        self.has_no_step || self.statistics.work() >= self.work_limit
    }

    /// Advances through `duration` (s), in which no output changes.
    pub(super) fn advance(&mut self, duration: f64) {
        let mut remaining = duration;
        while remaining > 0.0 && !self.is_aborted() {
            self.release_armatures();
            let live = [FILL, VENT].map(|index| {
                self.physics
                    .must_be_integrated(index, &self.state.valves[index])
            });
            remaining = match (live, self.physics.effect_states_width()) {
                ([false, false], _) => self.advance_resting(remaining),
                ([true, false], width) => self.advance_one(FILL, width, remaining),
                ([false, true], width) => self.advance_one(VENT, width, remaining),
                ([true, true], Width::None) => self.integrate::<7, 2>([FILL, VENT], remaining),
                ([true, true], Width::Few) => {
                    self.integrate::<{ 7 + FEW }, 2>([FILL, VENT], remaining)
                }
                ([true, true], Width::Many) => {
                    self.integrate::<{ 7 + MANY }, 2>([FILL, VENT], remaining)
                }
            };
        }
        self.physics.after_segment(duration);
    }

    fn advance_one(&mut self, index: usize, width: Width, remaining: f64) -> f64 {
        match width {
            Width::None => self.integrate::<4, 1>([index], remaining),
            Width::Few => self.integrate::<{ 4 + FEW }, 1>([index], remaining),
            Width::Many => self.integrate::<{ 4 + MANY }, 1>([index], remaining),
        }
    }

    /// Integrates the pressure while no valve is live and the pressure has no formula.
    fn advance_pressure(&mut self, remaining: f64) -> f64 {
        match self.physics.effect_states_width() {
            Width::None => self.integrate::<1, 0>([], remaining),
            Width::Few => self.integrate::<{ 1 + FEW }, 0>([], remaining),
            Width::Many => self.integrate::<{ 1 + MANY }, 0>([], remaining),
        }
    }

    /// Releases every armature that a force already pulls off its stop.
    fn release_armatures(&mut self) {
        for index in [FILL, VENT] {
            let valve = &mut self.state.valves[index];
            if valve.motion == Motion::Moving {
                continue;
            }
            let force = self
                .physics
                .breakaway_force_now(index, valve, self.state.pressure);
            if force > 0.0 {
                valve.motion = Motion::Moving;
            }
        }
    }

    /// Advances while both armatures rest: by formula if the pressure has a closed form, otherwise only the pressure is
    /// integrated.
    fn advance_resting(&mut self, remaining: f64) -> f64 {
        let areas = self.effective_areas();
        let trace = self
            .physics
            .pressure_at_resting_valves(areas, self.state.pressure);
        let Some(pressure) = trace.filter(|trace| trace.valid_for() > SHORTEST_EVENT) else {
            return self.advance_pressure(remaining);
        };
        let currents = self.resting_currents();
        let limit = remaining.min(pressure.valid_for());
        let force = |index: usize, t: f64| {
            let valve = &self.state.valves[index];
            let pressure = pressure.at(self.physics.plant(), t);
            let extra = self.physics.effect_states();
            self.physics
                .breakaway_force(index, valve, currents[index].at(t), pressure, extra)
        };
        let (taken, released) = match self.first_breakaway(limit, force) {
            Some((time, index)) => (time, Some(index)),
            None => (limit, None),
        };
        self.statistics.exact_intervals += 1;
        let start = self.state.pressure;
        self.state.pressure = pressure.at(self.physics.plant(), taken);
        self.physics
            .after_formula(areas, taken, [start, self.state.pressure]);
        for index in [FILL, VENT] {
            self.settle_current(index, &currents[index], taken);
        }
        if let Some(index) = released {
            self.statistics.events += 1;
            self.state.valves[index].motion = Motion::Moving;
        }
        remaining - taken
    }

    fn resting_currents(&self) -> [RestingCurrent; 2] {
        [FILL, VENT].map(|index| {
            self.physics
                .current_of_resting_coil(index, &self.state.valves[index])
        })
    }

    fn effective_areas(&self) -> [f64; 2] {
        [FILL, VENT].map(|index| {
            self.physics.plant().valves[index].effective_area(self.state.valves[index].x)
        })
    }

    /// Advances the current of a resting coil by `time` and accounts for its charge.
    fn settle_current(&mut self, index: usize, trace: &RestingCurrent, time: f64) {
        let valve = &mut self.state.valves[index];
        let current = trace.at(time);
        let charge = trace.charge(time, current);
        self.charge[index] += charge;
        let currents = [valve.current, current];
        self.physics
            .after_resting_coil(index, valve.drive, charge, currents, valve.x);
        valve.current = current;
        if current == 0.0 && matches!(valve.drive, Drive::Freewheeling(_)) {
            valve.drive = Drive::Blocked;
        }
    }

    /// Integrates pressure and the `live` valves up to the next event, at most over `remaining` (s); returns the rest.
    fn integrate<const N: usize, const M: usize>(
        &mut self,
        live: [usize; M],
        mut remaining: f64,
    ) -> f64 {
        let smooth = self.smooth(live);
        let mut start = self.pack::<N, M>(live);
        let mut start_rate = self.physics.rates(&smooth, &start);
        let mut chord = None;
        while remaining > 0.0 {
            let begin = (start, start_rate);
            let Some((span, end_rate)) = self.step(&smooth, begin, &mut chord, remaining) else {
                return remaining;
            };
            self.stretch = self.stretch.saturating_add(1);
            let currents = self.resting_currents();
            if let Some((time, event)) = self.first_event(&smooth, &span, &currents) {
                self.commit(&smooth, &span, &span.at(time), time, &currents);
                self.statistics.events += 1;
                self.apply(event);
                // Reset only after an event: the end of a segment does not make a stiff plant less stiff.
                if core::mem::take(&mut self.stretch) >= RECONSIDERED {
                    self.stiffness = self.stiffness.min(STIFF_STEPS_MIN - RECONSIDERED);
                }
                // An event early in a step shows that the step was too long to resolve the motion around it: an
                // armature that hovers at its seat would chatter.
                let kind = usize::from(M > 0);
                let around = (EVENTS_AHEAD * time).max(SHORTEST_STEP_AFTER_EVENT);
                self.proposal[kind] = self.proposal[kind].min(around);
                return remaining - time;
            }
            self.commit(&smooth, &span, &span.end, span.h, &currents);
            (start, start_rate) = (span.end, end_rate);
            remaining -= span.h;
        }
        remaining
    }

    /// Returns the data that is constant until the next event.
    fn smooth<const M: usize>(&self, live: [usize; M]) -> Smooth<M> {
        let valves = &self.state.valves;
        Smooth {
            live,
            drives: live.map(|index| valves[index].drive),
            limits: live.map(|index| {
                let ValveState { x, v, .. } = valves[index];
                self.physics.plant().valves[index].limit(x, v)
            }),
            directions: live.map(|index| {
                self.physics
                    .direction_of_motion(index, &valves[index], self.state.pressure)
            }),
            resting_areas: self.effective_areas(),
            resting_positions: [valves[FILL].x, valves[VENT].x],
        }
    }

    /// Computes one step that meets the tolerance, at most `remaining` (s) long, and the rates at its end; `None` if
    /// the simulation is aborted. `chord` has the mean rates of the previous stiff step, if there was one since the
    /// last event.
    fn step<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        (start, start_rate): ([f64; N], [f64; N]),
        chord: &mut Option<[f64; N]>,
        remaining: f64,
    ) -> Option<(Span<N, M>, [f64; N])> {
        let kind = usize::from(M > 0);
        let stiff = P::MAY_BE_STIFF && self.stiffness >= STIFF_STEPS_MIN;
        let longest = match stiff {
            true if M == 0 && chord.is_some() => {
                LONGEST_STRAIGHT_STEP.min(self.physics.longest_flow_step_s())
            }
            true => LONGEST_STIFF_STEP,
            false => [self.physics.longest_flow_step_s(), LONGEST_MOTION_STEP][kind],
        };
        while !self.is_aborted() {
            let h = self.proposal[kind].min(longest).min(remaining);
            let rates = |y: &[f64; N]| self.physics.rates(smooth, y);
            let step = if stiff {
                let increments = self.increments::<N, M>(&start);
                rosenbrock::step(rates, &start, &start_rate, h, &increments)
            } else {
                let staged = dormand_prince::step(rates, &start, &start_rate, h);
                if P::MAY_BE_STIFF {
                    self.watch(smooth, &staged, h);
                }
                staged.step
            };
            let error = self
                .physics
                .error_in_tolerances::<N, M>(&self.weights, &step.error);
            // The fourth root in place of the fifth: cheaper, and more careful after a large error.
            let factor = (0.9 / error.sqrt().sqrt()).clamp(0.2, 4.0);
            if error <= 1.0 {
                // A step cut short by the segment's end is not evidence against the longer one.
                let cut_short = h < self.proposal[kind];
                let floor = if cut_short { self.proposal[kind] } else { 0.0 };
                self.proposal[kind] = (h * factor).max(floor).min(longest);
                self.statistics.steps += 1;
                let mut span = Span {
                    h,
                    start,
                    start_rate,
                    end: step.end,
                    end_rate: step.end_rate,
                };
                if stiff {
                    // The rates of a stiff state do not describe its mean change over the step.
                    span.start_rate = core::array::from_fn(|n| (step.end[n] - start[n]) / h);
                    span.end_rate = span.start_rate;
                    if M == 0 {
                        let rate = chord.replace(span.start_rate).unwrap_or(span.start_rate);
                        self.keep_straight::<N, M>(h, [rate, span.start_rate]);
                    }
                }
                return Some((span, step.end_rate));
            }
            self.has_no_step = h < SHORTEST_STEP && !error.is_finite();
            self.proposal[kind] = h * factor.min(0.9);
            self.statistics.rejected_steps += 1;
        }
        None
    }

    /// Shortens the next stiff step without live valves if a straight line would deviate from the state by more than
    /// the tolerance: by h² |y''| / 8, with the second derivative from the mean `rates` of the last two steps.
    fn keep_straight<const N: usize, const M: usize>(&mut self, h: f64, rates: [[f64; N]; 2]) {
        let deviation = core::array::from_fn(|n| (rates[1][n] - rates[0][n]) * h / 8.0);
        let deviation = self
            .physics
            .error_in_tolerances::<N, M>(&self.weights, &deviation);
        let straight = (h / deviation.sqrt()).max(LONGEST_STIFF_STEP);
        self.proposal[0] = self.proposal[0].min(straight);
    }

    /// Counts the steps at the limit of stability.
    fn watch<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        staged: &Staged<N>,
        h: f64,
    ) {
        let [state, rate] = &staged.last_stage;
        let apart = |a: &[f64; N], b: &[f64; N]| {
            let difference = core::array::from_fn(|n| a[n] - b[n]);
            self.physics
                .error_in_tolerances::<N, M>(&self.weights, &difference)
        };
        let fastest = apart(&staged.step.end_rate, rate) / apart(&staged.step.end, state);
        let is_at_rest = smooth.directions.iter().all(|direction| *direction == 0.0);
        let limit = if is_at_rest && h < SHORT_STEPS[usize::from(M > 0)] {
            NEAR_INSTABILITY_AT_REST
        } else {
            NEAR_INSTABILITY
        };
        self.stiffness = if h * fastest > limit {
            self.stiffness + 1
        } else {
            self.stiffness.saturating_sub(1)
        };
    }

    /// Returns the increments of the states for the differences of a Jacobian: a thousandth of the tolerance, and at
    /// least the minimum that rounding requires.
    fn increments<const N: usize, const M: usize>(&self, y: &[f64; N]) -> [f64; N] {
        core::array::from_fn(|n| {
            let mut unit = [0.0; N];
            unit[n] = 1.0;
            let weight = self
                .physics
                .error_in_tolerances::<N, M>(&self.weights, &unit);
            1e-7 * y[n].abs() + 1e-3 / weight.max(1e-3)
        })
    }

    fn pack<const N: usize, const M: usize>(&self, live: [usize; M]) -> [f64; N] {
        let mut y = [0.0; N];
        y[0] = self.state.pressure;
        for (slot, &index) in live.iter().enumerate() {
            let states = self
                .physics
                .integrated_states(index, &self.state.valves[index]);
            y[first_of(slot)..first_of(slot + 1)].copy_from_slice(&states);
        }
        let extra = self.physics.effect_states();
        y[first_of(M)..].copy_from_slice(&extra[..N - first_of(M)]);
        y
    }

    fn commit<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        end: &[f64; N],
        taken: f64,
        currents: &[RestingCurrent; 2],
    ) {
        self.state.pressure = end[0];
        for (slot, &index) in smooth.live.iter().enumerate() {
            let valve = &self.physics.plant().valves[index];
            self.lifts[index].follow(valve, span, slot, taken, end);
        }
        for index in [FILL, VENT] {
            if !smooth.live.contains(&index) {
                self.settle_current(index, &currents[index], taken);
            }
        }
        self.physics.after_step_of_valves(
            smooth,
            span,
            taken,
            end,
            &mut self.state,
            &mut self.charge,
        );
        self.physics.after_step(span, taken, end);
    }
}
