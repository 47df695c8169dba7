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

/// Physics between two events.
pub(super) trait Physics: Sized {
    /// Whether some parameters make it stiff: the explicit method is then monitored.
    const MAY_BE_STIFF: bool = false;

    fn plant(&self) -> &Plant;

    fn plant_mut(&mut self) -> &mut Plant;

    /// Longest step of the pressure alone (s).
    #[inline(always)]
    fn longest_flow_step(&self) -> f64 {
        5e-3
    }

    #[inline(always)]
    fn width(&self) -> Width {
        Width::None
    }

    /// Returns whether the states of a valve have to be integrated: it moves, or its current has no closed form.
    #[inline(always)]
    fn is_live(&self, _: usize, valve: &ValveState) -> bool {
        valve.motion == Motion::Moving
    }

    /// Returns the current of a valve that is not live.
    #[inline(always)]
    fn resting_current(&self, index: usize, valve: &ValveState) -> RestingCurrent {
        self.plant().valves[index].resting_current(valve)
    }

    /// Returns the pressure while no valve is live, with the valves' effective areas (m²).
    #[inline(always)]
    fn resting_pressure(&self, areas: [f64; 2], pressure: f64) -> Option<RestingPressure> {
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

    /// Returns the breakaway force at `time` within a step, at the pressure `pressure`.
    #[inline(always)]
    fn breakaway_force_within<const N: usize, const M: usize>(
        &self,
        index: usize,
        valve: &ValveState,
        _: (&Smooth<M>, &Span<N, M>),
        (pressure, current): (&Cubic, &RestingCurrent),
        time: f64,
    ) -> f64 {
        self.breakaway_force(index, valve, current.at(time), pressure.at(time), &[])
    }

    /// Returns the direction in which a live armature moves: 1 or -1, and 0 at rest. Only friction needs the sign.
    #[inline(always)]
    fn direction(&self, _: usize, _: &ValveState, _: f64) -> f64 {
        1.0
    }

    /// Returns whether a moving armature may stop where its velocity changes its sign.
    #[inline(always)]
    fn has_friction(&self) -> bool {
        false
    }

    /// Returns the velocity (m/s) after the armature met the stop of `arrived`; 0 if it stays there.
    #[inline(always)]
    fn rebound(&self, _: usize, _arrived: &ValveState, _pressure: f64) -> f64 {
        0.0
    }

    /// Returns the integrated states of a live valve.
    #[inline(always)]
    fn pack(&self, _: usize, valve: &ValveState) -> [f64; 3] {
        [valve.current, valve.x, valve.v]
    }

    /// Returns the states that effects add.
    #[inline(always)]
    fn extra(&self) -> &[f64] {
        &[]
    }

    /// Returns the right-hand side.
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
    fn measure<const N: usize, const M: usize>(&self, weights: &Weights, error: &[f64; N]) -> f64 {
        weights.measure::<N, M>(error)
    }

    /// Returns the time within a step at which the current of a coil without supply ends, if it does.
    #[inline(always)]
    fn zero_current_time<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        slot: usize,
    ) -> Option<f64> {
        let free_wheels = matches!(smooth.drives[slot], Drive::FreeWheeling(_));
        (free_wheels && span.end[first_of(slot)] < 0.0).then(|| {
            let current = span.current(slot);
            crate::solver::root::first_positive(|t| -current.at(t), 0.0, span.h)
        })
    }

    /// Takes over the live valves after `taken` (s), and accounts for their charge.
    #[inline(always)]
    fn commit_valves<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        (taken, end): (f64, &[f64; N]),
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
    fn commit_step<const N: usize, const M: usize>(
        &mut self,
        _: &Span<N, M>,
        _taken: f64,
        _end: &[f64; N],
    ) {
    }

    /// Takes over an interval that was passed by formula, from and to a pressure, with the valves' areas.
    #[inline(always)]
    fn commit_formula(&mut self, _areas: [f64; 2], _taken: f64, _pressures: [f64; 2]) {}

    /// Takes over the interval of a resting coil: charge (A s) and the currents at both ends.
    #[inline(always)]
    fn commit_resting_coil(
        &mut self,
        _: usize,
        _: Drive,
        _charge: f64,
        _currents: [f64; 2],
        _x: f64,
    ) {
    }

    /// Reports that the current of a coil with the drive `_drive` has ended.
    #[inline(always)]
    fn current_ended(&mut self, _: usize, _drive: Drive) {}

    /// Reports the end of a segment.
    #[inline(always)]
    fn end_segment(&mut self, _duration: f64) {}

    /// Returns whether a current continues when the output goes low.
    #[inline(always)]
    fn free_wheels(&self, _: usize, valve: &ValveState) -> bool {
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
