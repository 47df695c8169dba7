//! Physics as the solver needs it. The defaults are those of the thesis' model. Effects override the methods that they
//! change, so that the plain plant is compiled without any code of the effects.

use super::smooth::Smooth;
use super::span::{Span, first_of};
use super::tolerance::Weights;
use crate::coil::{Drive, RestingCurrent};
use crate::plant::{Plant, PlantState};
use crate::resting_pressure::RestingPressure;
use crate::solver::hermite::Cubic;
use crate::valve::{Motion, ValveState};

/// Number of states that effects add, as compiled into the solver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Width {
    None,
    Few,
    Many,
}

/// Capacity of [`Width::Few`] (states).
pub(super) const FEW: usize = 2;
/// Capacity of [`Width::Many`] (states).
pub(super) const MANY: usize = 12;

/// Instant within a step that was just computed.
#[derive(Clone, Copy)]
pub(super) struct WithinStep<'a, const N: usize, const M: usize> {
    pub(super) smooth: &'a Smooth<M>,
    pub(super) span: &'a Span<N, M>,
    /// Pressure over the step (Pa).
    pub(super) pressure: &'a Cubic,
    /// Current of the resting coil in question over the step (A).
    pub(super) current: &'a RestingCurrent,
    /// Time since the begin of the step (s).
    pub(super) time: f64,
}

/// Physics between two events. Three kinds of methods follow each other: what the solver asks before a step, what it asks
/// in each stage and at the end of a step, and `after_...`, which it calls once for each accepted interval or event.
pub(super) trait Physics: Sized {
    /// Whether some parameters make it stiff: the explicit method is then monitored.
    const MAY_BE_STIFF: bool = false;

    fn plant(&self) -> &Plant;

    fn plant_mut(&mut self) -> &mut Plant;

    // Before a step.

    /// Returns the longest step of the pressure alone (s).
    #[inline(always)]
    fn longest_flow_step_s(&self) -> f64 {
        5e-3
    }

    /// Returns the compiled capacity for the states that effects add.
    #[inline(always)]
    fn effect_states_width(&self) -> Width {
        Width::None
    }

    /// Returns whether the states of a valve have to be integrated: it moves, or its current has no closed form.
    #[inline(always)]
    fn must_be_integrated(&self, _: usize, valve: &ValveState) -> bool {
        valve.motion == Motion::Moving
    }

    /// Returns the current over time of a coil whose valve need not be integrated.
    #[inline(always)]
    fn current_of_resting_coil(&self, index: usize, valve: &ValveState) -> RestingCurrent {
        self.plant().valves[index].resting_current(valve)
    }

    /// Returns the pressure over time while no valve must be integrated, with the valves' effective areas (m²); `None` if it
    /// has no closed form.
    #[inline(always)]
    fn pressure_at_resting_valves(
        &self,
        areas: [f64; 2],
        pressure: f64,
    ) -> Option<RestingPressure> {
        RestingPressure::of(self.plant(), areas, pressure)
    }

    /// Returns the breakaway force of a resting armature (N): it is released if the force is positive. `current` is the
    /// current that causes the magnetic force, `extra` the states of effects.
    #[inline(always)]
    fn breakaway_force(
        &self,
        index: usize,
        valve: &ValveState,
        current: f64,
        pressure: f64,
        _extra: &[f64],
    ) -> f64 {
        let drop = self.plant().pressure_drop(index, pressure);
        self.plant().valves[index].breakaway_force(valve.motion, valve.x, current, drop)
    }

    /// Returns the breakaway force in the present state.
    #[inline(always)]
    fn breakaway_force_now(&self, index: usize, valve: &ValveState, pressure: f64) -> f64 {
        self.breakaway_force(index, valve, valve.current, pressure, &[])
    }

    /// Returns the breakaway force of a resting armature within a step.
    #[inline(always)]
    fn breakaway_force_within<const N: usize, const M: usize>(
        &self,
        index: usize,
        valve: &ValveState,
        at: WithinStep<'_, N, M>,
    ) -> f64 {
        let (current, pressure) = (at.current.at(at.time), at.pressure.at(at.time));
        self.breakaway_force(index, valve, current, pressure, &[])
    }

    /// Returns the direction in which a live armature moves: 1 or -1, and 0 at rest. Only friction needs the sign.
    #[inline(always)]
    fn direction_of_motion(&self, _: usize, _: &ValveState, _: f64) -> f64 {
        1.0
    }

    /// Returns whether a moving armature may stop where its velocity changes its sign.
    #[inline(always)]
    fn has_friction(&self) -> bool {
        false
    }

    /// Returns the velocity (m/s) after the armature met the stop of `arrived`; 0 if it stays there.
    #[inline(always)]
    fn velocity_after_stop(&self, _: usize, _arrived: &ValveState, _pressure: f64) -> f64 {
        0.0
    }

    /// Returns the states of a live valve at the begin of a step: current (A) or flux linkage (V s), lift (m), velocity (m/s).
    #[inline(always)]
    fn integrated_states(&self, _: usize, valve: &ValveState) -> [f64; 3] {
        [valve.current, valve.x, valve.v]
    }

    /// Returns the states that effects add, at the begin of a step.
    #[inline(always)]
    fn effect_states(&self) -> &[f64] {
        &[]
    }

    // In each stage and at the end of a step.

    /// Returns the right-hand side: the rates of change of the states `y`.
    #[inline(always)]
    fn rates<const N: usize, const M: usize>(&self, smooth: &Smooth<M>, y: &[f64; N]) -> [f64; N] {
        let plant = self.plant();
        let pressure = y[0];
        let mut areas = smooth.resting_areas;
        let mut rates = [0.0; N];
        for slot in 0..M {
            let index = smooth.live[slot];
            let valve = &plant.valves[index];
            let first = first_of(slot);
            let [current, x, v] = [y[first], y[first + 1], y[first + 2]];
            areas[index] = valve.effective_area_by(smooth.limits[slot], x);
            let drop = plant.pressure_drop(index, pressure);
            let valve_rates = valve.rates(smooth.drives[slot], current, x, v, drop);
            rates[first..first + 3].copy_from_slice(&valve_rates);
        }
        rates[0] = plant.pressure_rate(areas, pressure);
        rates
    }

    /// Returns the largest local error in units of the tolerance.
    #[inline(always)]
    fn error_in_tolerances<const N: usize, const M: usize>(
        &self,
        weights: &Weights,
        error: &[f64; N],
    ) -> f64 {
        weights.measure::<N, M>(error)
    }

    /// Returns the time within a step at which the current of a coil without supply ends, if it does.
    #[inline(always)]
    fn time_of_zero_current<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        slot: usize,
    ) -> Option<f64> {
        let freewheels = matches!(smooth.drives[slot], Drive::Freewheeling(_));
        (freewheels && span.end[first_of(slot)] < 0.0).then(|| {
            let current = span.current(slot);
            crate::solver::root::first_positive(|t| -current.at(t), 0.0, span.h)
        })
    }

    // After a step, an interval or an event.

    /// Takes over the live valves after `taken` (s), and accounts for their charge.
    #[inline(always)]
    fn after_step_of_valves<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        taken: f64,
        end: &[f64; N],
        state: &mut PlantState,
        charge: &mut [f64; 2],
    ) {
        for slot in 0..M {
            let index = smooth.live[slot];
            let coil = &self.plant().valves[index].coil;
            let valve = &mut state.valves[index];
            let first = first_of(slot);
            [valve.current, valve.x, valve.v] = [end[first], end[first + 1], end[first + 2]];
            if let Some(voltage) = valve.drive.voltage() {
                // Flux balance: R ∫i dt = ∫u dt - Δ(L i), exact for any motion of the armature.
                let flux = |y: &[f64; N]| coil.inductance(y[first + 1]) * y[first];
                charge[index] +=
                    (voltage * taken - (flux(end) - flux(&span.start))) / coil.resistance;
            }
        }
    }

    /// Takes over the rest of an integrated interval: the pressure and the states of effects.
    #[inline(always)]
    fn after_step<const N: usize, const M: usize>(
        &mut self,
        _: &Span<N, M>,
        _taken: f64,
        _end: &[f64; N],
    ) {
    }

    /// Takes over an interval of the duration `_taken` (s) that was computed by formula, with the valves' areas (m²) and the
    /// pressures at its begin and end (Pa).
    #[inline(always)]
    fn after_formula(&mut self, _areas: [f64; 2], _taken: f64, _pressures: [f64; 2]) {}

    /// Takes over the interval of a resting coil: charge (A s), the currents at both ends (A), and the lift (m).
    #[inline(always)]
    fn after_resting_coil(
        &mut self,
        _: usize,
        _: Drive,
        _charge: f64,
        _currents: [f64; 2],
        _x: f64,
    ) {
    }

    /// Takes over that the current of a coil with the drive `_drive` has decayed to zero.
    #[inline(always)]
    fn after_current_ended(&mut self, _: usize, _drive: Drive) {}

    /// Takes over the end of a segment between two known instants, of the duration `_duration` (s).
    #[inline(always)]
    fn after_segment(&mut self, _duration: f64) {}

    /// Returns whether a current continues in the freewheeling diode when the output goes low; asked at that instant.
    #[inline(always)]
    fn current_freewheels(&self, _: usize, valve: &ValveState) -> bool {
        valve.current > 0.0
    }
}

impl Physics for Plant {
    #[inline(always)]
    fn plant(&self) -> &Plant {
        self
    }

    fn plant_mut(&mut self) -> &mut Plant {
        self
    }
}
