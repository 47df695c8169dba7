//! Mass and energy of the gas in supply line and chambers.
//!
//! dm/dt = Σ ṁ,  dU/dt = Σ ṁ h - Q - p dV/dt,  p V = (k - 1) U,  T = U/(m c_v).
//! V is that of the walls with the present position of the actuator. In the plain plant, Q keeps the gas at the temperature of the walls.

use super::hose::Walls;
use super::orifice::{GAS_CONSTANT, HEAT_CAPACITY_RATIO, Orifice};
use super::rig::KindRig;

/// Mass (kg) and internal energy (J) of the first and of the second chamber, mass in the supply line (kg), and lagged
/// pressures of the sensors (Pa).
pub(super) type State = [f64; 7];
pub(super) const MASS: [usize; 2] = [0, 2];
pub(super) const ENERGY: [usize; 2] = [1, 3];
pub(super) const LINE: usize = 4;
pub(super) const LAGGED: [usize; 2] = [5, 6];

/// Heat capacity at constant volume (J/(kg K)).
const HEAT_CAPACITY: f64 = GAS_CONSTANT / (HEAT_CAPACITY_RATIO - 1.0);

/// Pressure (Pa abs) and temperature (K).
pub(super) type Condition = (f64, f64);

/// Conditions of the gas along its path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Conditions {
    /// At the inlet of the fill valve.
    pub(super) inlet: Condition,
    /// In the first and in the second chamber; both are the same without a second one.
    pub(super) chambers: [Condition; 2],
}

/// Part of the rig that gas flows through.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GasPath {
    rig: KindRig,
    supply_line: Option<(Orifice, f64)>,
    line: Option<(Orifice, f64)>,
    leak: Option<Orifice>,
}

impl GasPath {
    pub(super) fn new(rig: &KindRig) -> Self {
        let hidden = &rig.hidden;
        Self {
            supply_line: hidden
                .supply_line
                .map(|line| (Orifice::new(&line.restriction), line.volume_m3)),
            line: rig
                .second
                .map(|second| (Orifice::new(&second.line), second.volume_m3)),
            leak: hidden.leak.as_ref().map(Orifice::new),
            rig: rig.clone(),
        }
    }

    /// Returns the state at the beginning: all chambers at the start pressure, gas as warm as the walls.
    pub(super) fn start(&self) -> State {
        let KindRig {
            start_pa,
            ambient_pa,
            temperature_k,
            ..
        } = self.rig;
        let chamber_m3 = self.first_m3(0.0);
        let mass = |pressure: f64, volume: f64| pressure * volume / (GAS_CONSTANT * temperature_k);
        let (volume, _) = self.rig.walls.volume(chamber_m3, ambient_pa, start_pa);
        let volumes = [volume, self.line.map_or(0.0, |(_, volume)| volume)];
        let mut state = [0.0; 7];
        for (chamber, volume) in volumes.into_iter().enumerate() {
            state[MASS[chamber]] = mass(start_pa, volume);
            state[ENERGY[chamber]] = HEAT_CAPACITY * temperature_k * state[MASS[chamber]];
            state[LAGGED[chamber]] = start_pa;
        }
        if let Some((_, volume)) = self.supply_line {
            state[LINE] = mass(self.rig.supply_pa, volume);
        }
        state
    }

    /// Returns the volume of the first chamber at ambient pressure and at a time (s).
    fn first_m3(&self, time_s: f64) -> f64 {
        let rig = &self.rig;
        rig.chamber_m3 + rig.hidden.actuator_area_m2 * rig.actuator.at(time_s)
    }

    /// Returns the conditions of a state at a time (s).
    pub(super) fn conditions(&self, state: &State, time_s: f64) -> Conditions {
        let KindRig {
            supply_pa,
            ambient_pa,
            temperature_k,
            walls,
            ..
        } = self.rig;
        let at = |chamber: usize, volume: f64, walls: Walls| {
            let (mass, energy) = (state[MASS[chamber]], state[ENERGY[chamber]]);
            let product = (HEAT_CAPACITY_RATIO - 1.0) * energy;
            let pressure = walls.pressure(volume, ambient_pa, product, product / volume);
            (pressure, energy / (mass * HEAT_CAPACITY))
        };
        let first = at(0, self.first_m3(time_s), walls);
        let inlet = self.supply_line.map_or(supply_pa, |(_, volume)| {
            state[LINE] * GAS_CONSTANT * temperature_k / volume
        });
        Conditions {
            inlet: (inlet, temperature_k),
            chambers: [
                first,
                self.line
                    .map_or(first, |(_, volume)| at(1, volume, Walls::Rigid)),
            ],
        }
    }

    /// Returns the rates of all masses, energies and lagged pressures at a time (s) with these open shares of the valves.
    pub(super) fn rates(
        &self,
        state: &State,
        time_s: f64,
        valves: [&Orifice; 2],
        open_shares: [f64; 2],
    ) -> State {
        let Conditions { inlet, chambers } = self.conditions(state, time_s);
        let outside = (self.rig.ambient_pa, self.rig.temperature_k);
        let mut rate = [0.0; 7];
        let mut flow = |from: Option<usize>, to: Option<usize>, flow: f64, warmth: [f64; 2]| {
            let temperature = if flow > 0.0 { warmth[0] } else { warmth[1] };
            let enthalpy = flow * HEAT_CAPACITY_RATIO * HEAT_CAPACITY * temperature;
            for (chamber, sign) in [(from, -1.0), (to, 1.0)] {
                if let Some(chamber) = chamber {
                    rate[MASS[chamber]] += sign * flow;
                    rate[ENERGY[chamber]] += sign * enthalpy;
                }
            }
        };
        let inflow = valves[0].flow(open_shares[0], inlet, chambers[0]);
        flow(None, Some(0), inflow, [inlet.1, chambers[0].1]);
        let vented = valves[1].flow(open_shares[1], chambers[0], outside);
        flow(Some(0), None, vented, [chambers[0].1, outside.1]);
        if let Some((line, _)) = &self.line {
            let passed = line.flow(1.0, chambers[0], chambers[1]);
            flow(Some(0), Some(1), passed, chambers.map(|chamber| chamber.1));
        }
        if let Some(leak) = &self.leak {
            let far = usize::from(self.line.is_some());
            let leaked = leak.flow(1.0, chambers[far], outside);
            flow(Some(far), None, leaked, [chambers[far].1, outside.1]);
        }
        if let Some((restriction, _)) = &self.supply_line {
            let source = (self.rig.supply_pa, self.rig.temperature_k);
            rate[LINE] = restriction.flow(1.0, source, inlet) - inflow;
        }
        self.warmth_rates(time_s, &chambers, &mut rate);
        for (chamber, at) in chambers.iter().enumerate() {
            let sensor = &self.rig.hidden.sensor;
            rate[LAGGED[chamber]] = sensor.rate(at.0, state[LAGGED[chamber]]);
        }
        rate
    }

    /// Takes heat to the walls and work on walls that move from the rates of the energies, which are those of the enthalpies.
    fn warmth_rates(&self, time_s: f64, chambers: &[Condition; 2], rate: &mut State) {
        let temperature_k = self.rig.temperature_k;
        let Some(transfers) = self.rig.hidden.heat_w_per_k else {
            for chamber in [0, 1] {
                rate[ENERGY[chamber]] = HEAT_CAPACITY * temperature_k * rate[MASS[chamber]];
            }
            return;
        };
        for chamber in [0, 1] {
            rate[ENERGY[chamber]] -= transfers[chamber] * (chambers[chamber].1 - temperature_k);
        }
        // p dV/dt from p V = (k - 1) U with V(p, t), solved for dp/dt.
        let (pressure, _) = chambers[0];
        let rig = &self.rig;
        let (volume, slope) = rig
            .walls
            .volume(self.first_m3(time_s), rig.ambient_pa, pressure);
        let widening = rig.hidden.actuator_area_m2 * rig.actuator.rate(time_s);
        let pressure_rate = ((HEAT_CAPACITY_RATIO - 1.0) * rate[ENERGY[0]]
            - HEAT_CAPACITY_RATIO * pressure * widening)
            / (volume + HEAT_CAPACITY_RATIO * pressure * slope);
        rate[ENERGY[0]] -= pressure * (slope * pressure_rate + widening);
    }
}
