//! Flows and pressures with effects.

use super::layout::Layout;
use crate::additions::{Balance, Cavity, Line, Volume};
use crate::hooks::{self, Now};
use crate::plant::{FILL, Plant, VENT};
use crate::resting_pressure::RestingPressure;
use crate::restriction::in_series;

/// Gas at an instant.
#[derive(Debug, Clone, Copy)]
pub(super) struct GasNow {
    /// d(chamber pressure)/dt (Pa/s).
    pub(super) pressure_rate: f64,
    /// Upstream minus downstream pressure of each armature (Pa).
    pub(super) drops: [f64; 2],
}

/// Returns the pressure upstream of the fill valve (Pa abs), or upstream of the line's restriction if the line has no
/// volume.
fn source(plant: &Plant, layout: &Layout, extra: &[f64], now: Option<&Now>) -> f64 {
    match layout.line {
        Some(line) => extra[line],
        None => reservoir(plant, now),
    }
}

/// Returns the pressure downstream of the vent valve (Pa abs).
fn sink(plant: &Plant, layout: &Layout, extra: &[f64]) -> f64 {
    layout
        .drain
        .map_or(plant.drain_pressure, |drain| extra[drain])
}

fn reservoir(plant: &Plant, now: Option<&Now>) -> f64 {
    let more = now.map_or(0.0, |now| {
        hooks::sum(&plant.additions.hooks.supply_pressure, now)
    });
    plant.supply_pressure + more
}

/// Returns the area of a valve with its user-defined factors (m²).
#[inline]
fn scaled(plant: &Plant, index: usize, area: f64, now: Option<&Now>) -> f64 {
    now.map_or(area, |now| {
        area * hooks::product(&plant.additions.hooks.area_factor[index], now)
    })
}

/// Returns the change of the chamber's volume by user-defined factors at an instant.
fn own_volume(plant: &Plant, now: Option<&Now>) -> Volume {
    let laws = &plant.additions.hooks.volume_factor;
    let Some(now) = now.filter(|_| !laws.is_empty()) else {
        return Volume::NONE;
    };
    let factor = |pressure: f64, time: f64| {
        let now = Now {
            pressure,
            time,
            ..*now
        };
        hooks::product(laws, &now)
    };
    let size = plant.chamber.volume;
    let (pressure, time) = (now.pressure, now.time);
    let step = VOLUME_PRESSURE_STEP;
    let by_pressure = factor(pressure + step, time) - factor(pressure - step, time);
    let by_time =
        factor(pressure, time + VOLUME_TIME_STEP) - factor(pressure, time - VOLUME_TIME_STEP);
    let now = factor(pressure, time);
    let slope = by_pressure / (2.0 * step);
    // A chamber whose p V falls with the pressure has no stable state: the simulation is aborted.
    let is_possible = now + pressure * slope > 0.0;
    Volume {
        size: if is_possible {
            size * (now - 1.0)
        } else {
            f64::NAN
        },
        compliance: size * slope,
        growth: size * by_time / (2.0 * VOLUME_TIME_STEP),
    }
}

/// Steps of the central differences of a user-defined volume: pressure (Pa) and time (s). The rounding of a factor, 1e-16,
/// over a step is far below the resolution of the solver, and no bench shows a kink of such a size.
const VOLUME_PRESSURE_STEP: f64 = 10.0;
const VOLUME_TIME_STEP: f64 = 1e-5;

/// Returns the effective area of a valve of `area` (m²) together with an orifice that forms one opening with it (m²).
fn narrowed(plant: &Plant, index: usize, area: f64) -> f64 {
    let Some(orifice) = plant.additions.combined[index] else {
        return area;
    };
    area * orifice.effective_area / area.hypot(orifice.effective_area)
}

/// Opening of a valve.
#[derive(Clone, Copy)]
pub(super) struct Opening {
    /// Index of the valve.
    pub(super) valve: usize,
    /// Effective area (m²); negative beyond the seat within a step.
    pub(super) area: f64,
}

impl Opening {
    fn negated(self) -> Self {
        Self {
            area: -self.area,
            ..self
        }
    }
}

/// Gas in the chamber.
#[derive(Clone, Copy)]
pub(super) struct ChamberNow {
    /// Pressure (Pa abs).
    pub(super) pressure: f64,
    /// Last share of its travel of a plunger that follows the pressure at once (0 to 1).
    pub(super) swept: f64,
}

/// Returns the mass flow through a valve, including series restrictions, and the pressure drop over the valve.
#[inline]
fn through_valve(
    plant: &Plant,
    layout: &Layout,
    opening: Opening,
    upstream: f64,
    downstream: f64,
) -> (f64, f64) {
    let Opening {
        valve: index,
        area: open,
    } = opening;
    if layout.is_alone[index] || open == 0.0 {
        let flow = plant.valves[index]
            .nozzle
            .mass_flow(open, upstream, downstream);
        (flow, upstream - downstream)
    } else if open < 0.0 {
        // Beyond the seat within a step, the law is continued smoothly, like the area.
        let (flow, drop) = through_orifices(plant, opening.negated(), upstream, downstream);
        (-flow, drop)
    } else {
        through_orifices(plant, opening, upstream, downstream)
    }
}

/// Returns mass flow and pressure drop of a valve whose flow other orifices limit as well.
fn through_orifices(plant: &Plant, opening: Opening, upstream: f64, downstream: f64) -> (f64, f64) {
    let additions = &plant.additions;
    let index = opening.valve;
    let nozzle = &plant.valves[index].nozzle;
    let area = narrowed(plant, index, opening.area);
    let behind = additions.restrictions[index];
    // A line without volume is an orifice upstream of the fill valve.
    let before = additions
        .supply_line
        .filter(|_| index == FILL)
        .and_then(Line::orifice);
    if let Some(before) = before {
        let areas = [before.in_series_with(behind).effective_area, area];
        let (flow, between) = in_series(nozzle, areas, upstream, downstream);
        (flow, between - downstream)
    } else if let Some(behind) = behind {
        let areas = [area, behind.effective_area];
        let (flow, between) = in_series(nozzle, areas, upstream, downstream);
        (flow, upstream - between)
    } else {
        let flow = nozzle.mass_flow(area, upstream, downstream);
        (flow, upstream - downstream)
    }
}

/// Returns the area of the leak in parallel with a valve, if it is an orifice (m²).
fn leak_area(plant: &Plant, leak: usize) -> f64 {
    let leak = plant.additions.leaks[leak];
    leak.and_then(|leak| leak.orifice_area()).unwrap_or(0.0)
}

/// Returns the valves' areas with those of parallel leaks that are orifices.
pub(super) fn widened(plant: &Plant, areas: [f64; 2]) -> [f64; 2] {
    [
        narrowed(plant, FILL, areas[FILL]) + leak_area(plant, 1),
        narrowed(plant, VENT, areas[VENT]) + leak_area(plant, 0),
    ]
}

/// Returns the pressure by formula, if no effect changes its law.
pub(super) fn resting_pressure(
    plant: &Plant,
    areas: [f64; 2],
    pressure: f64,
) -> Option<RestingPressure> {
    let additions = &plant.additions;
    let hooks = &additions.hooks;
    let follows_areas =
        |leak: usize| additions.leaks[leak].is_none_or(|leak| leak.orifice_area().is_some());
    // A chamber without any flow keeps its pressure, whatever its volume.
    let is_open = areas != [0.0; 2] || additions.leaks != [None; 2];
    let touched = additions.supply_line.is_some_and(|line| line.has_pressure() || areas[FILL] > 0.0)
        || additions.drain_line.is_some()
        // These do not concern the gas, but the formula allows no state with a law of its own.
        || additions.polarisation.is_some()
        || additions.wall_heat.is_some()
        || additions.cavity.is_some()
        || (additions.growth.is_some() && is_open)
        || additions.plunger.is_some()
        || additions.actuator.is_some_and(|one| is_open || one.velocity != 0.0)
        || !(follows_areas(0) && follows_areas(1))
        // The leak goes to ambient, independent of the drain.
        || (additions.leaks[0].is_some() && plant.drain_pressure != plant.ambient_pressure)
        || (additions.restrictions[FILL].is_some() && areas[FILL] > 0.0)
        || (additions.restrictions[VENT].is_some() && areas[VENT] > 0.0)
        || !hooks.is_empty();
    if touched {
        None
    } else {
        RestingPressure::of(plant, widened(plant, areas), pressure)
    }
}

/// Returns the pressure drop over an armature (Pa) while its valve has this opening.
pub(super) fn pressure_drop(
    plant: &Plant,
    layout: &Layout,
    opening: Opening,
    pressure: f64,
    extra: &[f64],
    now: Option<&Now>,
) -> f64 {
    let index = opening.valve;
    let area = scaled(plant, index, opening.area, now);
    let (upstream, downstream) = if index == FILL {
        (source(plant, layout, extra, now), pressure)
    } else {
        (pressure, sink(plant, layout, extra))
    };
    if layout.is_alone[index] || area == 0.0 {
        return upstream - downstream;
    }
    let opening = Opening { area, ..opening };
    through_valve(plant, layout, opening, upstream, downstream).1
}

/// Returns the volume of the gas while the pressure rises or falls, with the actuator at `position` (m).
fn volume(
    plant: &Plant,
    chamber: ChamberNow,
    position: f64,
    rises: bool,
    now: Option<&Now>,
) -> Volume {
    let ChamberNow { pressure, swept } = chamber;
    let additions = &plant.additions;
    let swept = additions.plunger.map_or(Volume::NONE, |plunger| {
        plunger.volume(swept, pressure, rises)
    });
    let grown = additions
        .growth
        .map_or(Volume::NONE, |growth| growth.volume(pressure));
    let moved = additions.actuator.map_or(Volume::NONE, |actuator| {
        actuator.volume(position, plant.chamber.volume)
    });
    let own = own_volume(plant, now);
    Volume {
        size: plant.chamber.volume + swept.size + grown.size + moved.size + own.size,
        compliance: swept.compliance + grown.compliance + own.compliance,
        growth: swept.growth + moved.growth + own.growth,
    }
}

/// Returns the rate of the pressure where no effect other than leaks changes its law.
#[inline]
pub(super) fn plain_rates(plant: &Plant, areas: [f64; 2], pressure: f64) -> GasNow {
    let leaks = plant.additions.leaks;
    let nozzle = &plant.nozzle;
    let (supply, drain) = (plant.supply_pressure, plant.drain_pressure);
    let [fill, vent] = &plant.valves;
    let fill = fill.nozzle.mass_flow(areas[FILL], supply, pressure);
    let vent = vent.nozzle.mass_flow(areas[VENT], pressure, drain);
    let leak = leaks[0].map_or(0.0, |leak| {
        leak.mass_flow(nozzle, pressure, plant.ambient_pressure)
    });
    let seat = leaks[1].map_or(0.0, |leak| leak.mass_flow(nozzle, supply, pressure));
    GasNow {
        pressure_rate: plant.chamber.pressure_per_mass * (fill - vent - leak + seat),
        drops: [supply - pressure, pressure - drain],
    }
}

/// Air that a second chamber takes from the first one.
struct Second {
    /// Mass flow (kg/s).
    inflow: f64,
    /// Mass flow into the first chamber, times the excess of its temperature over that of the surroundings (kg K/s).
    warmth: f64,
}

/// Sets the rates of pressure and temperature of a second chamber, from which `leak` (kg/s) escapes (E66).
fn second_chamber(
    plant: &Plant,
    layout: &Layout,
    cavity: &Cavity,
    pressure: f64,
    leak: f64,
    extra: &[f64],
    extra_rates: &mut [f64],
) -> Second {
    let (Some(heat), Some(index), Some(first), Some(second)) = (
        plant.additions.wall_heat,
        layout.cavity,
        layout.temperature,
        layout.second_temperature,
    ) else {
        return Second {
            inflow: 0.0,
            warmth: 0.0,
        };
    };
    let [near, far, around] = [extra[first], extra[second], heat.surroundings];
    let far_pressure = extra[index];
    let flow = cavity.inflow(&plant.nozzle, pressure, far_pressure);
    let upstream = if flow > 0.0 { near } else { far };
    let flow = flow * (around / upstream).sqrt();
    let leak = leak * (around / far).sqrt();
    let (inflow, outflow) = (flow.max(0.0), (-flow).max(0.0) + leak);
    let heat = heat.of_volume(cavity.volume / plant.chamber.volume);
    // What flows in has the temperature of the first chamber.
    let warm = inflow * near / around;
    let power = heat.pressure_power([warm, outflow], far_pressure, far, around);
    let balance = Balance {
        inflow,
        outflow,
        volume: Volume {
            size: cavity.volume,
            ..Volume::NONE
        },
    };
    [extra_rates[index], extra_rates[second], _] =
        heat.rates(&balance, power, far_pressure, far, around);
    Second {
        inflow: flow,
        warmth: (-flow).max(0.0) * (far - around),
    }
}

/// Returns the flows, and the rates of the pressure and of the states of effects.
#[inline]
pub(super) fn rates(
    plant: &Plant,
    layout: &Layout,
    areas: [f64; 2],
    chamber: ChamberNow,
    now: Option<&Now>,
    extra: &[f64],
    extra_rates: &mut [f64],
) -> GasNow {
    let ChamberNow { pressure, swept } = chamber;
    let additions = &plant.additions;
    let nozzle = &plant.nozzle;
    let areas = [FILL, VENT].map(|index| scaled(plant, index, areas[index], now));
    let plain = plant.chamber.pressure_per_mass;
    let source = source(plant, layout, extra, now);
    let swept = layout.plunger.map_or(swept, |plunger| extra[plunger]);
    let chamber = ChamberNow { pressure, swept };
    if let (Some(index), Some(actuator)) = (layout.actuator, &additions.actuator) {
        extra_rates[index] = actuator.velocity;
    }
    if let (Some(index), Some(plunger)) = (layout.plunger, &additions.plunger) {
        extra_rates[index] = plunger.rate(swept, pressure);
    }

    let opening = |valve: usize| Opening {
        valve,
        area: areas[valve],
    };
    let (fill, fill_drop) = through_valve(plant, layout, opening(FILL), source, pressure);
    let sink = sink(plant, layout, extra);
    let (vent, vent_drop) = through_valve(plant, layout, opening(VENT), pressure, sink);
    let seat = additions.leaks[1].map_or(0.0, |leak| leak.mass_flow(nozzle, source, pressure));
    let far = match (&additions.cavity, layout.cavity) {
        (Some(cavity), Some(index)) if cavity.has_the_leak => Some(extra[index]),
        _ => None,
    };
    let leak = additions.leaks[0].map_or(0.0, |leak| {
        leak.mass_flow(nozzle, far.unwrap_or(pressure), plant.ambient_pressure)
    });
    let own = now.map_or(0.0, |now| hooks::sum(&additions.hooks.inflow, now));
    let mut cavity_warmth = 0.0;
    let cavity = match (&additions.cavity, layout.cavity) {
        (Some(cavity), Some(_)) if layout.second_temperature.is_some() => {
            let second = second_chamber(plant, layout, cavity, pressure, leak, extra, extra_rates);
            cavity_warmth = second.warmth;
            second.inflow
        }
        (Some(cavity), Some(index)) => {
            let flow = cavity.inflow(nozzle, pressure, extra[index]);
            let lost = if cavity.has_the_leak { leak } else { 0.0 };
            extra_rates[index] = plain * plant.chamber.volume / cavity.volume * (flow - lost);
            flow
        }
        _ => 0.0,
    };

    // Warm gas has a low density: the outflow is inversely proportional to the square root of the gas temperature.
    let thin = match (&additions.wall_heat, layout.temperature) {
        (Some(heat), Some(temperature)) => (heat.surroundings / extra[temperature]).sqrt(),
        _ => 1.0,
    };
    let (mut inflow, mut outflow) = ((-cavity).max(0.0), cavity.max(0.0));
    // Accounts for a flow into the chamber. The pressures decide whether it comes from outside, because a flow also
    // changes its sign beyond the seat.
    let mut account = |flow: f64, from_outside: bool| {
        if from_outside {
            inflow += flow;
            flow
        } else {
            outflow -= flow * thin;
            flow * thin
        }
    };
    let filled = account(fill, source >= pressure);
    let vented = account(-vent, sink > pressure);
    let seeped = account(seat, source >= pressure);
    if far.is_none() {
        account(-leak, plant.ambient_pressure > pressure);
    }
    account(own, own >= 0.0);

    let position = layout.actuator.map_or(0.0, |actuator| extra[actuator]);
    let pressure_rate = match (&additions.wall_heat, layout.temperature) {
        (Some(heat), Some(index)) => {
            let wall = layout.wall.map_or(heat.surroundings, |wall| extra[wall]);
            let temperature = extra[index];
            let power = heat.pressure_power([inflow, outflow], pressure, temperature, wall)
                + heat.heat_capacity_ratio * heat.gas_constant * cavity_warmth;
            let balance = Balance {
                inflow,
                outflow,
                volume: volume(plant, chamber, position, power > 0.0, now),
            };
            let [rate, temperature_rate, wall_rate] =
                heat.rates(&balance, power, pressure, temperature, wall);
            extra_rates[index] = temperature_rate;
            if let Some(wall) = layout.wall {
                extra_rates[wall] = wall_rate;
            }
            rate
        }
        _ => {
            let volume = volume(plant, chamber, position, inflow > outflow, now);
            let stretched = (volume.size + pressure * volume.compliance) / plant.chamber.volume;
            let thinned = pressure * volume.growth / plant.chamber.volume;
            (plain * (inflow - outflow) - thinned) / stretched
        }
    };
    let gas = (nozzle, plain * plant.chamber.volume);
    if let (Some(index), Some(line)) = (layout.line, additions.supply_line) {
        let drawn = filled + seeped;
        let gas = (additions.tube.as_deref().unwrap_or(gas.0), gas.1);
        extra_rates[index] = line.pressure_rate(gas, reservoir(plant, now), source, drawn);
    }
    if let (Some(index), Some(line)) = (layout.drain, additions.drain_line) {
        extra_rates[index] = line.pressure_rate(gas, plant.drain_pressure, sink, vented);
    }
    GasNow {
        pressure_rate,
        drops: [fill_drop, vent_drop],
    }
}
