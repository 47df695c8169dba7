//! Mass and energy of the gas, from the supply through the chamber to the drain.
//!
//! dm/dt = Σ ṁ,  dU/dt = Σ ṁ h - Q - p dV/dt,  p = (k - 1) U / V,  T = U/(m c_v).
//! The plain chamber keeps the temperature of its wall, as the thesis assumes: Q is the heat that this needs.

use super::departures::{ChamberDepartures, Departures, Leak};
use super::nozzle::{Nozzle, Subsonic};
use super::rig::Rig;
use super::state::*;

/// Width of the transition from curtain to bore (m).
const PASSAGE: f64 = 1e-5;
const PA_PER_BAR: f64 = 1e5;

/// Opening of one valve.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Opening {
    /// C_d π d (m).
    width: f64,
    /// Lift at which the curtain has the area of the bore (m).
    bore_lift: f64,
}

impl Opening {
    fn new(diameter: f64, discharge: f64) -> Self {
        Self {
            width: discharge * std::f64::consts::PI * diameter,
            bore_lift: diameter / 4.0,
        }
    }

    /// Returns the effective area (m²): the curtain, with a smooth transition to the bore.
    fn area(&self, lift: f64) -> f64 {
        if lift <= 0.0 {
            return 0.0;
        }
        let lesser = |y: f64| 0.5 * (y + self.bore_lift - (y - self.bore_lift).hypot(PASSAGE));
        self.width * (lesser(lift) - lesser(0.0))
    }
}

/// All parts that gas flows through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct GasPath {
    nozzle: Nozzle,
    openings: [Opening; 2],
    gas_constant: f64,
    /// c_v (J/(kg K)), c_p over c_v.
    heat_capacity: f64,
    ratio: f64,
    temperature: f64,
    supply: f64,
    ambient: f64,
    volume: f64,
    /// Stroke of the armatures (m), and whether the vent valve is open without current.
    stroke: f64,
    is_vent_normally_open: bool,
    /// Time constant of the cooling of initially warm gas by the wall (s); 0 is immediate.
    relaxation: f64,
    departures: Departures,
}

/// Pressures (Pa abs) and other values that follow from the state alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pressures {
    source: f64,
    line: f64,
    /// Pressure upstream of the fill valve's seat.
    pub(super) inlet: f64,
    pub(super) chamber: f64,
    pub(super) cavity: f64,
    pub(super) drain: f64,
    /// Temperature of the gas in the chamber (K).
    pub(super) temperature: f64,
}

impl GasPath {
    pub(super) fn new(rig: &Rig) -> Self {
        let (sheet, departures) = (&rig.datasheet, rig.departures);
        let gas = &sheet.gas;
        let flow = &departures.flow;
        let subsonic = if flow.critical_ratio_drop == 0.0 {
            Subsonic::Isentropic
        } else {
            Subsonic::Iso6358 {
                critical_ratio: 0.5283 - flow.critical_ratio_drop,
                index: 0.5 + flow.subsonic_index_rise,
            }
        };
        Self {
            nozzle: Nozzle::new(gas, subsonic),
            openings: [
                Opening::new(sheet.flow.orifice_fill_m, sheet.flow.discharge_fill),
                Opening::new(sheet.flow.orifice_vent_m, sheet.flow.discharge_vent),
            ],
            gas_constant: gas.gas_constant_j_per_kg_k,
            heat_capacity: gas.gas_constant_j_per_kg_k / (gas.heat_capacity_ratio - 1.0),
            ratio: gas.heat_capacity_ratio,
            temperature: gas.temperature_k,
            supply: gas.supply_pressure_bar_gauge * PA_PER_BAR + gas.ambient_pressure_pa,
            ambient: gas.ambient_pressure_pa,
            volume: sheet.chamber.volume_m3,
            stroke: sheet.armature.stroke_m,
            is_vent_normally_open: rig.is_vent_normally_open,
            relaxation: 0.0,
            departures,
        }
    }

    /// Returns the ambient pressure (Pa abs).
    pub(super) fn ambient(&self) -> f64 {
        self.ambient
    }

    /// Returns whether a valve is open without current.
    pub(super) fn is_normally_open(&self, valve: usize) -> bool {
        valve == 1 && self.is_vent_normally_open
    }

    /// Returns the lift of a valve's seat (m) with the armature at `position`.
    pub(super) fn lift(&self, valve: usize, position: f64) -> f64 {
        if self.is_normally_open(valve) {
            self.stroke - position
        } else {
            position
        }
    }

    /// Makes the gas in the chamber warmer than the wall by `by_k` at the same pressure; it cools by the wall with the
    /// time constant `relaxation_s`.
    pub(super) fn warm(&mut self, by_k: f64, relaxation_s: f64, state: &mut State) {
        state[MASS] = state[ENERGY] / (self.heat_capacity * (self.temperature + by_k));
        self.relaxation = relaxation_s;
    }

    /// Vents the chamber and fills the lines.
    pub(super) fn rest(&self, state: &mut State) {
        let mass =
            |pressure: f64, volume: f64| pressure * volume / (self.gas_constant * self.temperature);
        let Departures {
            supply, chamber, ..
        } = &self.departures;
        state[MASS] = mass(self.ambient, self.volume);
        state[ENERGY] = state[MASS] * self.heat_capacity * self.temperature;
        state[LINE] = mass(self.supply, supply.line_m3);
        state[INLET] = mass(self.supply, supply.inlet_m3);
        state[CAVITY] = mass(self.ambient, chamber.cavity_m3);
        state[FILTERED..=LAGGED_AGAIN].fill(self.ambient);
    }

    pub(super) fn pressures(&self, time: f64, state: &State) -> Pressures {
        let Departures {
            supply, chamber, ..
        } = &self.departures;
        let isothermal =
            |mass: f64, volume: f64| mass * self.gas_constant * self.temperature / volume;
        let mut volume = self.volume;
        if chamber.plunger_m3 > 0.0 {
            volume += chamber.plunger_m3 * state[PLUNGER];
        }
        if chamber.hose_per_pa > 0.0 {
            volume *= 1.0 + chamber.hose_per_pa * state[HOSE];
        }
        let mut source = self.supply - state[REGULATOR];
        if supply.pulsation_pa != 0.0 {
            source +=
                supply.pulsation_pa * (std::f64::consts::TAU * supply.pulsation_hz * time).sin();
        }
        let line = if supply.line_m3 > 0.0 {
            isothermal(state[LINE], supply.line_m3)
        } else {
            source
        };
        let pressure = (self.ratio - 1.0) * state[ENERGY] / volume;
        Pressures {
            source,
            line,
            inlet: if supply.inlet_m3 > 0.0 {
                isothermal(state[INLET], supply.inlet_m3)
            } else {
                line
            },
            chamber: pressure,
            cavity: if chamber.cavity_m3 > 0.0 {
                isothermal(state[CAVITY], chamber.cavity_m3)
            } else {
                pressure
            },
            drain: self.ambient + supply.drain_pa + state[DRAIN],
            temperature: state[ENERGY] / (state[MASS] * self.heat_capacity),
        }
    }

    /// Computes the mass flows (kg/s) at these lifts, and the rates of all gas volumes.
    pub(super) fn rates(&self, at: &Pressures, lifts: [f64; 2], state: &State, rate: &mut State) {
        let flow = &self.departures.flow;
        let chamber = (at.chamber, at.temperature);
        let inflow = self.nozzle.flow(
            self.fill_area(lifts[0]),
            (at.inlet, self.temperature),
            chamber,
        ) + self.leak(&flow.seat_leak, at.inlet, self.temperature, at.chamber);
        let vented = self.nozzle.flow(
            self.openings[1].area(lifts[1]),
            chamber,
            (at.drain, self.temperature),
        );
        let leaked = self.leak(&flow.chamber_leak, at.chamber, at.temperature, self.ambient);
        let into_cavity = self.cavity_flow(at);
        rate[CAVITY] = into_cavity;
        rate[MASS] = inflow - vented - leaked - into_cavity;
        self.supply_rates(at, inflow, vented, state, rate);
        self.volume_rates(at, state, rate);
        rate[ENERGY] = if self.departures.chamber.thermal_s > 0.0 {
            let flows = [inflow, -vented, -leaked, -into_cavity];
            self.energy_rate(at, flows, state, rate)
        } else {
            let of_wall = self.heat_capacity * self.temperature;
            let mut energy = of_wall * rate[MASS];
            if self.relaxation > 0.0 {
                energy -= (state[ENERGY] - of_wall * state[MASS]) / self.relaxation;
            }
            energy
        };
    }

    fn fill_area(&self, lift: f64) -> f64 {
        let area = self.openings[0].area(lift);
        let supply = &self.departures.supply;
        if supply.inlet_m2 > 0.0 && supply.inlet_m3 == 0.0 {
            // Two orifices in series share the pressure difference by the squares of their areas.
            area * supply.inlet_m2 / area.hypot(supply.inlet_m2)
        } else {
            area
        }
    }

    fn leak(&self, leak: &Leak, from: f64, temperature: f64, to: f64) -> f64 {
        let mut flow = self
            .nozzle
            .flow(leak.hole_m2, (from, temperature), (to, self.temperature));
        if leak.gap_kg_per_s_pa2 > 0.0 {
            flow += leak.gap_kg_per_s_pa2 * (from * from - to * to);
        }
        if leak.rough_kg_per_s > 0.0 {
            let difference = (from - to) / PA_PER_BAR;
            flow +=
                leak.rough_kg_per_s * difference.signum() * difference.abs().powf(leak.rough_power);
        }
        flow
    }

    fn cavity_flow(&self, at: &Pressures) -> f64 {
        let chamber = &self.departures.chamber;
        if chamber.cavity_m3 == 0.0 {
            return 0.0;
        }
        chamber.cavity_kg_per_s_pa * (at.chamber - at.cavity)
            + self.nozzle.flow(
                chamber.cavity_m2,
                (at.chamber, at.temperature),
                (at.cavity, self.temperature),
            )
    }

    fn supply_rates(
        &self,
        at: &Pressures,
        inflow: f64,
        vented: f64,
        state: &State,
        rate: &mut State,
    ) {
        let supply = &self.departures.supply;
        let restricted = |area: f64, from: f64, to: f64| {
            self.nozzle
                .flow(area, (from, self.temperature), (to, self.temperature))
        };
        let mut drawn = inflow;
        if supply.inlet_m3 > 0.0 {
            let into_inlet = restricted(supply.inlet_m2, at.line, at.inlet);
            rate[INLET] = into_inlet - drawn;
            drawn = into_inlet;
        }
        if supply.line_m3 > 0.0 {
            let into_line = restricted(supply.line_m2, at.source, at.line);
            rate[LINE] = into_line - drawn;
            drawn = into_line;
        }
        if supply.regulator_pa_s_per_kg > 0.0 {
            let lost = supply.regulator_pa_s_per_kg * drawn;
            rate[REGULATOR] = (lost - state[REGULATOR]) / supply.regulator_s;
        }
        if supply.drain_pa_s_per_kg > 0.0 {
            let dammed = supply.drain_pa_s_per_kg * vented;
            rate[DRAIN] = (dammed - state[DRAIN]) / supply.drain_s;
        }
    }

    fn volume_rates(&self, at: &Pressures, state: &State, rate: &mut State) {
        let chamber = &self.departures.chamber;
        let gauge = at.chamber - self.ambient;
        if chamber.plunger_m3 > 0.0 {
            rate[PLUNGER] = plunger_rate(chamber, gauge, state[PLUNGER]);
        }
        if chamber.hose_per_pa > 0.0 {
            rate[HOSE] = (gauge - state[HOSE]) / chamber.hose_s;
        }
    }

    /// Returns the rate of the internal energy (W): enthalpy of the `flows` into the chamber (kg/s), minus heat to the wall
    /// and work on plunger and hose.
    fn energy_rate(&self, at: &Pressures, flows: [f64; 4], state: &State, rate: &mut State) -> f64 {
        let chamber = &self.departures.chamber;
        let enthalpy: f64 = flows
            .into_iter()
            .map(|flow| {
                let temperature = if flow > 0.0 {
                    self.temperature
                } else {
                    at.temperature
                };
                flow * self.ratio * self.heat_capacity * temperature
            })
            .sum();
        let ambient_mass = self.ambient * self.volume / (self.gas_constant * self.temperature);
        let mut transfer = self.heat_capacity * ambient_mass / chamber.thermal_s;
        if chamber.thermal_density_power != 0.0 {
            transfer *= (state[MASS] / ambient_mass).powf(chamber.thermal_density_power);
        }
        let heat = transfer * (at.temperature - self.temperature - state[WALL]);
        if chamber.wall_j_per_k > 0.0 {
            rate[WALL] = heat / chamber.wall_j_per_k - state[WALL] / chamber.wall_s;
        }
        let growth =
            chamber.plunger_m3 * rate[PLUNGER] + self.volume * chamber.hose_per_pa * rate[HOSE];
        enthalpy - heat - at.chamber * growth
    }
}

/// Returns the rate of a plunger on its spring, which follows the pressure with friction.
fn plunger_rate(chamber: &ChamberDepartures, gauge: f64, share: f64) -> f64 {
    let [begin, end] = chamber.plunger_pa;
    let way = ((gauge - begin) / (end - begin)).clamp(0.0, 1.0);
    let target = way * way * (3.0 - 2.0 * way);
    let pull = target - share;
    let held = chamber.plunger_hysteresis;
    let free = pull - pull.clamp(-held, held);
    free / chamber.plunger_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_area_grows_with_the_curtain_and_ends_at_the_bore() {
        let opening = Opening::new(1.9e-3, 0.95);
        let curtain = 0.95 * std::f64::consts::PI * 1.9e-3;
        let bore = 0.95 * std::f64::consts::PI * 1.9e-3 * 1.9e-3 / 4.0;
        assert_eq!(opening.area(0.0), 0.0);
        assert!((opening.area(2e-4) / (curtain * 2e-4) - 1.0).abs() < 2e-3);
        assert!((opening.area(1e-3) / bore - 1.0).abs() < 2e-3);
    }

    #[test]
    fn friction_holds_the_plunger_within_its_band() {
        let chamber = ChamberDepartures {
            plunger_pa: [1e5, 5e5],
            plunger_s: 0.01,
            plunger_hysteresis: 0.1,
            ..ChamberDepartures::default()
        };
        assert_eq!(plunger_rate(&chamber, 3e5, 0.45), 0.0);
        assert!(plunger_rate(&chamber, 3e5, 0.3) > 0.0);
        assert!(plunger_rate(&chamber, 3e5, 0.7) < 0.0);
    }
}
