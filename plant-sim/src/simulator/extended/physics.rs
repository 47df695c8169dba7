//! Physics of the plant with effects, as the solver needs it.

use super::super::physics::{Physics, Width, WithinStep};
use super::super::smooth::Smooth;
use super::super::span::{Span, first_of};
use super::super::tolerance::Weights;
use super::super::{flux, gas};
use super::Extended;
use super::forces::ArmatureNow;
use crate::additions::{SHORTEST_FLIGHT, SLOWEST_BOUNCE};
use crate::coil::{Coil, Drive, RestingCurrent};
use crate::hooks;
use crate::plant::{FILL, Plant, PlantState, VENT};
use crate::resting_pressure::RestingPressure;
use crate::solver::root::first_positive;
use crate::valve::{Motion, ValveState};

/// Magnetising current (A) below which the flux of a coil without supply counts as zero.
const NO_CURRENT: f64 = 1e-6;

/// Minimum excess of the friction at rest over that in motion (-): otherwise an armature that has just broken away
/// would halt at once, and break away again.
const LEAST_BREAKAWAY: f64 = 1e-3;

impl Physics for Extended {
    const MAY_BE_STIFF: bool = true;

    fn plant(&self) -> &Plant {
        &self.plant
    }

    fn plant_mut(&mut self) -> &mut Plant {
        &mut self.plant
    }

    fn longest_flow_step_s(&self) -> f64 {
        // Where the plunger leaves a stop, its law has a kink that a long step does not resolve.
        if self.plant.additions.plunger.is_some() {
            1e-3
        } else {
            5e-3
        }
    }

    fn effect_states_width(&self) -> Width {
        self.layout.width()
    }

    fn must_be_integrated(&self, index: usize, valve: &ValveState) -> bool {
        if valve.motion == Motion::Moving {
            return true;
        }
        let additions = &self.plant.additions;
        let has_law = !self.is_linear() || !additions.hooks.is_empty();
        match valve.drive {
            Drive::Energised(_) => {
                has_law || additions.supply_resistance > 0.0 || additions.polarisation.is_some()
            }
            Drive::Freewheeling(_) => has_law,
            // The eddy currents sustain a flux for a short time.
            Drive::Blocked => additions.eddy_loop.is_there() && self.flux[index] > 0.0,
        }
    }

    fn current_of_resting_coil(&self, index: usize, valve: &ValveState) -> RestingCurrent {
        if self.must_be_integrated(index, valve) {
            return RestingCurrent::DECAYED;
        }
        let coil = &self.plant.valves[index].coil;
        let coil = Coil {
            resistance: flux::loop_resistance(&self.plant, index, valve.drive),
            ..*coil
        };
        coil.at_rest(valve.drive, valve.current, valve.x)
    }

    fn pressure_at_resting_valves(
        &self,
        areas: [f64; 2],
        pressure: f64,
    ) -> Option<RestingPressure> {
        gas::resting_pressure(&self.plant, areas, pressure)
    }

    fn breakaway_force(
        &self,
        index: usize,
        valve: &ValveState,
        current: f64,
        pressure: f64,
        extra: &[f64],
    ) -> f64 {
        let net = self.resting_force(index, valve, current, pressure, extra);
        let held = self
            .plant
            .additions
            .friction
            .map_or(0.0, |friction| (1.0 + LEAST_BREAKAWAY) * friction.at_rest);
        match valve.motion {
            Motion::AtRestStop => net - held,
            Motion::AtFullStroke => -net - held,
            Motion::Stuck => net.abs() - held,
            Motion::Moving => f64::NEG_INFINITY,
        }
    }

    fn breakaway_force_now(&self, index: usize, valve: &ValveState, pressure: f64) -> f64 {
        let current = self.pulling_current(index, valve);
        self.breakaway_force(index, valve, current, pressure, &self.extra)
    }

    fn breakaway_force_within<const N: usize, const M: usize>(
        &self,
        index: usize,
        valve: &ValveState,
        at: WithinStep<'_, N, M>,
    ) -> f64 {
        let y = at.span.at(at.time);
        let current = match at.smooth.slot_of(index) {
            Some(slot) => flux::pulling_current(&self.plant, index, y[first_of(slot)], valve.x),
            None => at.current.at(at.time),
        };
        self.breakaway_force(index, valve, current, y[0], &y[first_of(M)..])
    }

    fn direction_of_motion(&self, index: usize, valve: &ValveState, pressure: f64) -> f64 {
        if valve.motion != Motion::Moving {
            0.0
        } else if valve.v != 0.0 || !self.has_friction() {
            1.0_f64.copysign(valve.v)
        } else {
            let current = self.pulling_current(index, valve);
            let net = self.resting_force(index, valve, current, pressure, &self.extra);
            1.0_f64.copysign(net)
        }
    }

    fn has_friction(&self) -> bool {
        self.plant.additions.friction.is_some()
    }

    fn velocity_after_stop(&self, index: usize, arrived: &ValveState, pressure: f64) -> f64 {
        let valve = &self.plant.valves[index];
        if !valve.function.has_armature() {
            return 0.0;
        }
        let rebound = -self.plant.additions.restitution * arrived.v;
        let away = self.breakaway_force_now(index, arrived, pressure);
        let mass = valve.armature.mass;
        // Up and down under a constant force: t = 2 m v / F.
        let too_short = -away * SHORTEST_FLIGHT > 2.0 * mass * rebound.abs();
        if rebound.abs() < SLOWEST_BOUNCE || too_short {
            0.0
        } else {
            rebound
        }
    }

    fn integrated_states(&self, index: usize, valve: &ValveState) -> [f64; 3] {
        let flux = if self.is_linear() {
            self.plant.valves[index].coil.inductance(valve.x) * valve.current
        } else {
            self.flux[index]
        };
        [flux, valve.x, valve.v]
    }

    fn effect_states(&self) -> &[f64] {
        &self.extra
    }

    fn rates<const N: usize, const M: usize>(&self, smooth: &Smooth<M>, y: &[f64; N]) -> [f64; N] {
        let additions = &self.plant.additions;
        let (pressure, extra) = (y[0], &y[first_of(M)..]);
        let mut rates = [0.0; N];

        let (mut currents, mut positions, mut velocities) =
            ([0.0; 2], smooth.resting_positions, [0.0; 2]);
        let mut areas = smooth.resting_areas;
        for slot in 0..M {
            let (index, first) = (smooth.live[slot], first_of(slot));
            let [flux, x, v] = [y[first], y[first + 1], y[first + 2]];
            currents[index] = flux::pulling_current(&self.plant, index, flux, x);
            if smooth.directions[slot] != 0.0 {
                (positions[index], velocities[index]) = (x, v);
                areas[index] = self.plant.valves[index].effective_area_by(smooth.limits[slot], x);
            }
        }
        let now = self.now(pressure, extra, (currents, positions, velocities));
        let now = now.as_ref();

        let more = now.map_or([0.0; 2], |now| {
            [FILL, VENT].map(|index| hooks::sum(&additions.hooks.voltage[index], now))
        });
        let coils = self.coils(smooth, y, more);
        let (valve_rates, extra_rates) = rates.split_at_mut(first_of(M));
        let gas = if self.has_gas_law {
            gas::rates(
                &self.plant,
                &self.layout,
                areas,
                gas::ChamberNow {
                    pressure,
                    swept: self.swept,
                },
                now,
                extra,
                extra_rates,
            )
        } else {
            gas::plain_rates(&self.plant, areas, pressure)
        };
        valve_rates[0] = gas.pressure_rate;
        for slot in 0..M {
            let (index, first) = (smooth.live[slot], first_of(slot));
            valve_rates[first] = coils[index].flux_rate;
            let direction = smooth.directions[slot];
            if direction == 0.0 {
                continue;
            }
            let (x, v) = (y[first + 1], y[first + 2]);
            let net = self.net_force(
                ArmatureNow { index, x, v },
                currents[index],
                gas.drops[index],
                now,
            );
            let friction = additions.friction.map_or(0.0, |friction| friction.sliding);
            valve_rates[first + 1] = v;
            valve_rates[first + 2] =
                (net - direction * friction) / self.plant.valves[index].armature.mass;
        }
        if let Some(index) = self.layout.polarisation
            && let Some(rate) = self.polarisation_rate(smooth, &coils, extra[index])
        {
            extra_rates[index] = rate;
        }
        self.eddy_rates(smooth, &coils, extra, extra_rates);
        if let (Some(time), Some(now)) = (self.layout.time, now) {
            // A law that is no number aborts the simulation also while nothing follows from it: the force on an armature
            // that does not move, the supply behind a closed valve.
            let is_moving = |index: &usize| {
                let mut moving = smooth.live.iter().zip(smooth.directions);
                moving.any(|(live, direction)| live == index && direction != 0.0)
            };
            let resting = [FILL, VENT].into_iter().filter(|index| !is_moving(index));
            let idle: f64 = resting
                .map(|index| hooks::sum(&additions.hooks.force[index], now))
                .sum();
            extra_rates[time] = 1.0 + 0.0 * (idle + gas.drops[FILL]);
            for (n, own) in additions.hooks.states.iter().enumerate() {
                extra_rates[self.layout.own.0 + n] = own.rate.at(now);
            }
        }
        rates
    }

    fn error_in_tolerances<const N: usize, const M: usize>(
        &self,
        weights: &Weights,
        error: &[f64; N],
    ) -> f64 {
        if error.iter().any(|error| !error.is_finite()) {
            return f64::INFINITY;
        }
        // The slots of the currents contain flux: the error is converted into one of the current, equally for both
        // coils.
        let mut valves = *error;
        for slot in 0..M {
            valves[first_of(slot)] *= self.per_inductance[slot];
        }
        let extra = error[first_of(M)..].iter().zip(self.extra_weights);
        extra.fold(
            weights.measure::<N, M>(&valves),
            |worst, (error, weight)| worst.max(error.abs() * weight),
        )
    }

    fn time_of_zero_current<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        slot: usize,
    ) -> Option<f64> {
        let index = smooth.live[slot];
        let freewheels = match smooth.drives[slot] {
            Drive::Freewheeling(_) => true,
            Drive::Blocked if span.start[first_of(slot)] > 0.0 => false,
            Drive::Energised(_) | Drive::Blocked => return None,
        };
        let missing = |y: &[f64; N]| {
            let first = first_of(slot);
            let current = flux::magnetising_current(&self.plant, index, y[first], y[first + 1]);
            if freewheels {
                -self.excess_of_freewheeling(index, current, &y[first_of(M)..])
            } else {
                NO_CURRENT - current
            }
        };
        (missing(&span.end) > 0.0)
            .then(|| first_positive(|time| missing(&span.at(time)), 0.0, span.h))
    }

    fn after_step_of_valves<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        taken: f64,
        end: &[f64; N],
        state: &mut PlantState,
        charge: &mut [f64; 2],
    ) {
        self.commit_charge(smooth, span, taken, end, charge);
        let coils = self.coils(smooth, end, [0.0; 2]);
        for slot in 0..M {
            let (index, first) = (smooth.live[slot], first_of(slot));
            let valve = &mut state.valves[index];
            if smooth.directions[slot] != 0.0 {
                (valve.x, valve.v) = (end[first + 1], end[first + 2]);
            }
            valve.current = coils[index].current.max(0.0);
            self.flux[index] = end[first];
        }
    }

    fn after_step<const N: usize, const M: usize>(
        &mut self,
        span: &Span<N, M>,
        taken: f64,
        end: &[f64; N],
    ) {
        let extra = &end[first_of(M)..];
        self.extra[..extra.len()].copy_from_slice(extra);
        if let Some(plunger) = &self.plant.additions.plunger {
            self.swept = plunger.share(self.swept, end[0]);
        }
        let sensed = self
            .sensed_cavity()
            .map_or(0, |cavity| first_of(M) + cavity);
        if self.plant.additions.sensor_lag.is_none() {
            self.sensor
                .follow_at_once(&self.plant.additions, end[sensed]);
            return;
        }
        let trace = span.cubic(sensed);
        let start = [span.start[sensed], span.start_rate[sensed]];
        let end = [end[sensed], trace.rate_at(taken)];
        self.sensor.follow(&self.plant.additions, taken, start, end);
    }

    fn after_formula(&mut self, areas: [f64; 2], taken: f64, pressures: [f64; 2]) {
        if self.plant.additions.sensor_lag.is_none() {
            self.sensor
                .follow_at_once(&self.plant.additions, pressures[1]);
            return;
        }
        let areas = gas::widened(&self.plant, areas);
        let [start, end] =
            pressures.map(|pressure| [pressure, self.plant.pressure_rate(areas, pressure)]);
        self.sensor.follow(&self.plant.additions, taken, start, end);
    }

    fn after_resting_coil(
        &mut self,
        index: usize,
        drive: Drive,
        charge: f64,
        [start, end]: [f64; 2],
        x: f64,
    ) {
        if self.plant.additions.heating.is_some()
            && let Some(voltage) = drive.voltage()
        {
            // Energy balance: the energy from the source and from the field becomes heat, in all of the loop.
            let coil = &self.plant.valves[index].coil;
            let field = 0.5 * coil.inductance(x) * (start * start - end * end);
            let share = coil.resistance / flux::loop_resistance(&self.plant, index, drive);
            self.heat[index] += (voltage * charge + field) * share;
        }
    }

    fn after_current_ended(&mut self, index: usize, drive: Drive) {
        let eddy_currents_go_on =
            matches!(drive, Drive::Freewheeling(_)) && self.plant.additions.eddy_loop.is_there();
        if !eddy_currents_go_on {
            self.flux[index] = 0.0;
            if let Some(first) = self.layout.eddy_currents {
                self.extra[first + index] = 0.0;
            }
        }
    }

    fn after_segment(&mut self, duration: f64) {
        self.elapsed += duration;
        let Some(heating) = self.plant.additions.heating else {
            return;
        };
        for index in [FILL, VENT] {
            let heat = core::mem::take(&mut self.heat[index]);
            self.coils[index] = heating.after(self.coils[index], heat, duration, self.elapsed);
            let risen = heating.risen(self.coils[index]);
            self.plant.valves[index].coil.resistance = self.installed[index] + risen;
        }
    }

    fn current_freewheels(&self, index: usize, valve: &ValveState) -> bool {
        if self.is_linear() {
            return valve.current > 0.0;
        }
        let current = flux::magnetising_current(&self.plant, index, self.flux[index], valve.x);
        self.excess_of_freewheeling(index, current, &self.extra) > 0.0
    }
}
