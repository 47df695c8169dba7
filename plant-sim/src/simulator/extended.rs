//! The plant with effects, as the solver asks for it.

use super::flux::{self, CoilNow};
use super::gas;
use super::layout::Layout;
use super::physics::{MANY, Physics, Width};
use super::sensor::Sensor;
use super::smooth::Smooth;
use super::span::{Span, first_of};
use super::tolerance::{Tolerance, Weights};
use crate::coil::{Coil, Drive, RestingCurrent};
use crate::effects::end_stop_bounce::{SHORTEST_FLIGHT, SLOWEST_BOUNCE};
use crate::hooks::{self, Now};
use crate::plant::{FILL, Plant, PlantState, VENT};
use crate::resting_pressure::RestingPressure;
use crate::solver::hermite::Cubic;
use crate::solver::root::first_positive;
use crate::valve::{Motion, ValveState};

/// Magnetising current (A) below which a dead coil has no flux left.
const NO_CURRENT: f64 = 1e-6;

/// What friction at rest is at least more than in motion (-): an armature that has just departed would halt at once, and
/// depart again.
const LEAST_BREAKAWAY: f64 = 1e-3;

/// A state that an effect adds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EffectState {
    /// `t_gas`, `t_wall`, `t_coil_fill`, `t_coil_vent`, `p_line`, `p_cavity`, or `own` for your own.
    pub name: &'static str,
    /// Its value: K or Pa abs, or the unit of your own.
    pub value: f64,
}

/// The plant with its additions, and their states.
#[derive(Debug, Clone)]
pub(super) struct Extended {
    plant: Plant,
    layout: Layout,
    extra: [f64; MANY],
    /// Inverse tolerances of `extra`.
    extra_weights: [f64; MANY],
    /// Flux linkage of each coil (Wb), where its current does not tell it.
    flux: [f64; 2],
    /// What each coil is warmer than 20 °C (K), and the heat since it was brought up to date (J).
    warmth: [f64; 2],
    heat: [f64; 2],
    /// Resistance of each coil as installed (Ω).
    installed: [f64; 2],
    /// The plunger's share of its travel.
    swept: f64,
    sensor: Sensor,
}

impl Extended {
    pub(super) fn new(plant: Plant, tolerance: Tolerance) -> Self {
        let layout = Layout::new(&plant);
        let [extra, extra_weights] = layout.start(&plant, tolerance.pressure);
        let warmth = plant
            .additions
            .heating
            .map_or(0.0, |heating| heating.ambient());
        let start = plant.rest_state().pressure;
        Self {
            extra,
            extra_weights,
            flux: [0.0; 2],
            warmth: [warmth; 2],
            heat: [0.0; 2],
            installed: [FILL, VENT].map(|index| plant.valves[index].coil.resistance),
            swept: plant
                .additions
                .plunger
                .map_or(0.0, |plunger| plunger.share(0.0, start)),
            sensor: Sensor::new(start),
            layout,
            plant,
        }
    }

    /// Whether flux and current of a coil are in proportion.
    fn is_linear(&self) -> bool {
        let additions = &self.plant.additions;
        additions.saturation.is_none() && additions.eddy_conductance == 0.0
    }

    /// The current that makes the force of a valve (A).
    fn pulling_current(&self, index: usize, valve: &ValveState) -> f64 {
        if self.is_linear() {
            valve.current
        } else {
            flux::pulling_current(&self.plant, index, self.flux[index], valve.x)
        }
    }

    /// Forces on an armature without friction (N).
    fn net_force(
        &self,
        (index, x, v): (usize, f64, f64),
        pulling_current: f64,
        pressure_drop: f64,
        now: Option<&Now>,
    ) -> f64 {
        let valve = &self.plant.valves[index];
        let additions = &self.plant.additions;
        let lift = valve.lift(x) / valve.armature.stroke;
        let drop = pressure_drop * (1.0 - additions.flow_force * lift);
        let own = now.map_or(0.0, |now| hooks::sum(&additions.hooks.force[index], now));
        valve.magnet.force(pulling_current, x) + valve.armature.static_force(x, drop)
            - valve.armature.viscous_friction * v
            + own
    }

    /// The net force on an armature that does not move (N).
    fn resting_force(
        &self,
        index: usize,
        valve: &ValveState,
        current: f64,
        pressure: f64,
        extra: &[f64],
    ) -> f64 {
        let mut currents = [0.0; 2];
        currents[index] = current;
        let now = self.now(pressure, extra, (currents, [valve.x; 2], [0.0; 2]));
        let area = self.plant.valves[index].effective_area(valve.x);
        let place = (index, area);
        let drop = gas::pressure_drop(
            &self.plant,
            &self.layout,
            place,
            pressure,
            extra,
            now.as_ref(),
        );
        self.net_force((index, valve.x, 0.0), current, drop, now.as_ref())
    }

    /// What laws of your own see; none where there are none.
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
            own: &extra[first..first + number],
        })
    }

    /// The live coils at a state, with their magnetising currents.
    fn coils<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        y: &[f64; N],
        more: [f64; 2],
    ) -> [CoilNow; 2] {
        let mut coils = [None; 2];
        for slot in 0..M {
            let (index, first) = (smooth.live[slot], first_of(slot));
            let current = flux::magnetising_current(&self.plant, index, y[first], y[first + 1]);
            coils[index] = Some((smooth.drives[slot], current, more[index]));
        }
        flux::coils_now(&self.plant, coils)
    }

    /// The states of effects, named.
    pub(super) fn states(&self) -> Vec<EffectState> {
        let Layout {
            line,
            temperature,
            wall,
            cavity,
            own: (first, number),
            ..
        } = self.layout;
        let named = [
            ("p_line", line),
            ("t_gas", temperature),
            ("t_wall", wall),
            ("p_cavity", cavity),
        ];
        let state = |name, value| EffectState { name, value };
        let mut states: Vec<_> = named
            .into_iter()
            .filter_map(|(name, index)| Some(state(name, self.extra[index?])))
            .collect();
        if self.plant.additions.heating.is_some() {
            states.push(state("t_coil_fill", self.warmth[FILL] + 293.15));
            states.push(state("t_coil_vent", self.warmth[VENT] + 293.15));
        }
        let own = &self.extra[first..first + number];
        states.extend(own.iter().map(|value| state("own", *value)));
        states
    }

    /// What the sensor shows (Pa abs).
    pub(super) fn measured_pressure(&self, state: &PlantState) -> f64 {
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
            own: &self.extra[self.layout.own.0..][..self.layout.own.1],
        };
        self.sensor.shown(&self.plant.additions, &now)
    }

    /// Gas temperature (K), where it is a state.
    pub(super) fn temperature(&self) -> Option<f64> {
        Some(self.extra[self.layout.temperature?])
    }

    /// The chamber pressure was moved by `shift` to `pressure` (Pa): what follows it moves along.
    pub(super) fn shift_pressure(&mut self, shift: f64, pressure: f64) {
        if let Some(cavity) = self.layout.cavity {
            // A correction by a measurement; never to vacuum.
            self.extra[cavity] = (self.extra[cavity] + shift).max(1.0);
        }
        if let Some(plunger) = &self.plant.additions.plunger {
            self.swept = plunger.share(self.swept, pressure);
        }
        self.sensor.shift(shift);
    }

    /// The outputs have switched: with eddy currents, the current at the terminals jumps.
    pub(super) fn switched(&self, state: &mut PlantState) {
        if self.plant.additions.eddy_conductance == 0.0 {
            return;
        }
        let coils = [FILL, VENT].map(|index| {
            let valve = &state.valves[index];
            let current = flux::magnetising_current(&self.plant, index, self.flux[index], valve.x);
            Some((valve.drive, current, 0.0))
        });
        let now = flux::coils_now(&self.plant, coils);
        for (valve, coil) in state.valves.iter_mut().zip(now) {
            valve.current = coil.current.max(0.0);
        }
    }

    fn commit_charge<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        (taken, end): (f64, &[f64; N]),
        charge: &mut [f64; 2],
    ) {
        let additions = &self.plant.additions;
        let simpson = additions.heating.is_some() || !additions.hooks.is_empty();
        if simpson {
            let middle = span.at(0.5 * taken);
            let states = [&span.start, &middle, end];
            let [start, middle, end] = states.map(|y| self.coils(smooth, y, [0.0; 2]));
            for &index in &smooth.live {
                let mean = |power: i32| {
                    let [start, middle, end] =
                        [start, middle, end].map(|now| now[index].current.powi(power));
                    (start + 4.0 * middle + end) / 6.0 * taken
                };
                charge[index] += mean(1);
                self.heat[index] += self.plant.valves[index].coil.resistance * mean(2);
            }
            return;
        }
        // Flux balance: R ∫i dt = ∫u dt - Δλ, where all energised coils share a part of u.
        let balances: [_; M] = core::array::from_fn(|slot| {
            let (index, drive) = (smooth.live[slot], smooth.drives[slot]);
            let voltage = drive.voltage()?;
            let first = first_of(slot);
            let balance = voltage * taken - (end[first] - span.start[first]);
            let resistance = flux::loop_resistance(&self.plant, index, drive);
            Some((balance / resistance, resistance))
        });
        let shared = additions.supply_resistance;
        let energised = || {
            let drives = smooth.drives.iter().zip(balances);
            drives.filter_map(|(drive, balance)| {
                matches!(drive, Drive::Energised(_)).then_some(balance?)
            })
        };
        let conductance: f64 = energised().map(|(_, resistance)| resistance.recip()).sum();
        let together =
            energised().map(|(alone, _)| alone).sum::<f64>() / (1.0 + shared * conductance);
        for (slot, balance) in balances.into_iter().enumerate() {
            let Some((alone, resistance)) = balance else {
                continue;
            };
            let lost = match smooth.drives[slot] {
                Drive::Energised(_) => shared * together / resistance,
                _ => 0.0,
            };
            charge[smooth.live[slot]] += alone - lost;
        }
    }
}

impl Physics for Extended {
    const MAY_BE_STIFF: bool = true;

    fn plant(&self) -> &Plant {
        &self.plant
    }

    fn longest_flow_step(&self) -> f64 {
        // Where the plunger leaves a stop, its law has a kink that a long step hardly sees.
        if self.plant.additions.plunger.is_some() {
            1e-3
        } else {
            5e-3
        }
    }

    fn width(&self) -> Width {
        self.layout.width()
    }

    fn is_live(&self, index: usize, valve: &ValveState) -> bool {
        if valve.motion == Motion::Moving {
            return true;
        }
        let additions = &self.plant.additions;
        let has_law = !self.is_linear() || !additions.hooks.is_empty();
        match valve.drive {
            Drive::Energised(_) => has_law || additions.supply_resistance > 0.0,
            Drive::FreeWheeling(_) => has_law,
            // The eddy currents hold a flux for a moment.
            Drive::Blocked => additions.eddy_conductance > 0.0 && self.flux[index] > 0.0,
        }
    }

    fn resting_current(&self, index: usize, valve: &ValveState) -> RestingCurrent {
        if self.is_live(index, valve) {
            return RestingCurrent::EXTINCT;
        }
        let coil = &self.plant.valves[index].coil;
        let coil = Coil {
            resistance: flux::loop_resistance(&self.plant, index, valve.drive),
            ..*coil
        };
        coil.at_rest(valve.drive, valve.current, valve.x)
    }

    fn resting_pressure(&self, areas: [f64; 2], pressure: f64) -> Option<RestingPressure> {
        gas::resting_pressure(&self.plant, areas, pressure)
    }

    fn departing_force(
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

    fn departing_force_now(&self, index: usize, valve: &ValveState, pressure: f64) -> f64 {
        let current = self.pulling_current(index, valve);
        self.departing_force(index, valve, current, pressure, &self.extra)
    }

    fn departing_force_within<const N: usize, const M: usize>(
        &self,
        index: usize,
        valve: &ValveState,
        (smooth, span): (&Smooth<M>, &Span<N, M>),
        (_, current): (&Cubic, &RestingCurrent),
        time: f64,
    ) -> f64 {
        let y = span.at(time);
        let current = match smooth.slot_of(index) {
            Some(slot) => flux::pulling_current(&self.plant, index, y[first_of(slot)], valve.x),
            None => current.at(time),
        };
        self.departing_force(index, valve, current, y[0], &y[first_of(M)..])
    }

    fn direction(&self, index: usize, valve: &ValveState, pressure: f64) -> f64 {
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

    fn rebound(&self, index: usize, arrived: &ValveState, pressure: f64) -> f64 {
        let rebound = -self.plant.additions.restitution * arrived.v;
        let away = self.departing_force_now(index, arrived, pressure);
        let mass = self.plant.valves[index].armature.mass;
        // Up and down under a steady force: t = 2 m v / F.
        let too_short = -away * SHORTEST_FLIGHT > 2.0 * mass * rebound.abs();
        if rebound.abs() < SLOWEST_BOUNCE || too_short {
            0.0
        } else {
            rebound
        }
    }

    fn pack(&self, index: usize, valve: &ValveState) -> [f64; 3] {
        let flux = if self.is_linear() {
            self.plant.valves[index].coil.inductance(valve.x) * valve.current
        } else {
            self.flux[index]
        };
        [flux, valve.x, valve.v]
    }

    fn extra(&self) -> &[f64] {
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
        let gas = gas::rates(
            &self.plant,
            &self.layout,
            areas,
            (pressure, self.swept),
            now,
            extra,
            extra_rates,
        );
        valve_rates[0] = gas.pressure_rate;
        for slot in 0..M {
            let (index, first) = (smooth.live[slot], first_of(slot));
            valve_rates[first] = coils[index].flux_rate;
            let direction = smooth.directions[slot];
            if direction == 0.0 {
                continue;
            }
            let (x, v) = (y[first + 1], y[first + 2]);
            let net = self.net_force((index, x, v), currents[index], gas.drops[index], now);
            let friction = additions.friction.map_or(0.0, |friction| friction.sliding);
            valve_rates[first + 1] = v;
            valve_rates[first + 2] =
                (net - direction * friction) / self.plant.valves[index].armature.mass;
        }
        if let (Some(time), Some(now)) = (self.layout.time, now) {
            extra_rates[time] = 1.0;
            for (n, own) in additions.hooks.states.iter().enumerate() {
                extra_rates[self.layout.own.0 + n] = own.rate.at(now);
            }
        }
        rates
    }

    fn measure<const N: usize, const M: usize>(&self, weights: &Weights, error: &[f64; N]) -> f64 {
        if error.iter().any(|error| !error.is_finite()) {
            return f64::INFINITY;
        }
        // In the slots of the currents stands flux: as large an error of the current, and both coils are alike.
        let mut valves = *error;
        for slot in 0..M {
            valves[first_of(slot)] /= self.plant.valves[slot].coil.inductance_at_rest;
        }
        let extra = error[first_of(M)..].iter().zip(self.extra_weights);
        extra.fold(
            weights.measure::<N, M>(&valves),
            |worst, (error, weight)| worst.max(error.abs() * weight),
        )
    }

    fn extinction<const N: usize, const M: usize>(
        &self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        slot: usize,
    ) -> Option<f64> {
        let index = smooth.live[slot];
        let least = match smooth.drives[slot] {
            Drive::FreeWheeling(_) => self.least_current(),
            Drive::Blocked if span.start[first_of(slot)] > 0.0 => NO_CURRENT,
            Drive::Energised(_) | Drive::Blocked => return None,
        };
        let missing = |y: &[f64; N]| {
            let first = first_of(slot);
            let current = flux::magnetising_current(&self.plant, index, y[first], y[first + 1]);
            least - current
        };
        (missing(&span.end) > 0.0)
            .then(|| first_positive(|time| missing(&span.at(time)), 0.0, span.h))
    }

    fn commit_valves<const N: usize, const M: usize>(
        &mut self,
        smooth: &Smooth<M>,
        span: &Span<N, M>,
        (taken, end): (f64, &[f64; N]),
        state: &mut PlantState,
        charge: &mut [f64; 2],
    ) {
        self.commit_charge(smooth, span, (taken, end), charge);
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

    fn commit_step<const N: usize, const M: usize>(
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
        let sensed = self.layout.cavity.map_or(0, |cavity| first_of(M) + cavity);
        let course = span.cubic(sensed);
        let start = [span.start[sensed], span.start_rate[sensed]];
        let end = [end[sensed], course.rate_at(taken)];
        let time_constant = self.plant.additions.sensor_lag;
        self.sensor.follow(time_constant, taken, start, end);
    }

    fn commit_formula(&mut self, areas: [f64; 2], taken: f64, pressures: [f64; 2]) {
        let areas = gas::widened(&self.plant, areas);
        let [start, end] =
            pressures.map(|pressure| [pressure, self.plant.pressure_rate(areas, pressure)]);
        let time_constant = self.plant.additions.sensor_lag;
        self.sensor.follow(time_constant, taken, start, end);
    }

    fn commit_resting_coil(
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
            // Energy balance: what the source gives and the field loses is heat, in all of the loop.
            let coil = &self.plant.valves[index].coil;
            let field = 0.5 * coil.inductance(x) * (start * start - end * end);
            let share = coil.resistance / flux::loop_resistance(&self.plant, index, drive);
            self.heat[index] += (voltage * charge + field) * share;
        }
    }

    fn current_ended(&mut self, index: usize, drive: Drive) {
        let eddy_currents_go_on =
            matches!(drive, Drive::FreeWheeling(_)) && self.plant.additions.eddy_conductance > 0.0;
        if !eddy_currents_go_on {
            self.flux[index] = 0.0;
        }
    }

    fn end_segment(&mut self, duration: f64) {
        let Some(heating) = self.plant.additions.heating else {
            return;
        };
        for index in [FILL, VENT] {
            let heat = core::mem::take(&mut self.heat[index]);
            self.warmth[index] = heating.after(self.warmth[index], heat, duration);
            let risen =
                heating.resistance(self.warmth[index]) - heating.resistance(heating.ambient());
            self.plant.valves[index].coil.resistance = self.installed[index] + risen;
        }
    }

    fn free_wheels(&self, index: usize, valve: &ValveState) -> bool {
        if self.is_linear() {
            return valve.current > 0.0;
        }
        let current = flux::magnetising_current(&self.plant, index, self.flux[index], valve.x);
        current > self.least_current()
    }
}

impl Extended {
    /// The magnetising current (A) at which that of a free-wheeling coil ends: the eddy currents carry the rest.
    fn least_current(&self) -> f64 {
        self.plant.diode_drop * self.plant.additions.eddy_conductance
    }
}
