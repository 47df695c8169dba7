//! Rig that runs: Runge-Kutta of order 4 with fixed steps that end where a valve switches.

use super::gas::{Conditions, GasPath, LAGGED, State};
use super::rig::KindRig;
use super::valve::Valve;

/// Largest step (s).
const STEP_S: f64 = 1e-4;

/// Readings without noise (Pa abs).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KindReading {
    /// Pressures that the sensors in the first and in the second chamber show; both are the same without a second one.
    pub chambers_pa: [f64; 2],
    /// Pressure at the inlet of the fill valve.
    pub inlet_pa: f64,
    /// Position of the actuator (m).
    pub position_m: f64,
    /// Supply voltage (V).
    pub volt: f64,
}

/// Plant of a rig.
#[derive(Debug, Clone, PartialEq)]
pub struct KindPlant {
    rig: KindRig,
    gas: GasPath,
    valves: [Valve; 2],
    state: State,
    time_s: f64,
    step_s: f64,
}

impl KindPlant {
    /// Creates a rig at its start pressure with closed valves.
    pub fn new(rig: &KindRig) -> Self {
        Self::with_step(rig, STEP_S)
    }

    /// Creates a rig whose steps have at most this length (s).
    pub(super) fn with_step(rig: &KindRig, step_s: f64) -> Self {
        let gas = GasPath::new(rig);
        Self {
            state: gas.start(),
            valves: rig.valves.each_ref().map(Valve::new),
            gas,
            rig: rig.clone(),
            time_s: 0.0,
            step_s,
        }
    }

    /// Begins a period of the commands (%, fill and vent) at the present time: duty cycles of on/off valves, positions
    /// of proportional ones.
    pub fn begin_period(&mut self, commands_pct: [f64; 2]) {
        let begin_s = self.time_s + self.rig.command_delay_s;
        for (valve, command_pct) in self.valves.iter_mut().zip(commands_pct) {
            valve.begin_period(begin_s, self.rig.command_period_s, command_pct);
        }
        self.pass();
    }

    /// Runs to a time (s).
    pub fn run_until(&mut self, end_s: f64) {
        while self.time_s < end_s {
            let events = self.valves.iter();
            let events = events.map(|valve| valve.next_event_s(self.time_s));
            let next_s = events.fold(end_s, f64::min);
            self.integrate(next_s);
            self.time_s = next_s;
            self.pass();
        }
    }

    /// Applies what changes at the valves at the present time.
    fn pass(&mut self) {
        let KindRig {
            supply_pa,
            ambient_pa,
            ..
        } = self.rig;
        let (chamber_pa, _) = self.gas.conditions(&self.state, self.time_s).chambers[0];
        let differences = [supply_pa - chamber_pa, chamber_pa - ambient_pa];
        for (valve, difference_pa) in self.valves.iter_mut().zip(differences) {
            let pull_in = self.rig.hidden.pull_in.as_ref();
            let share = difference_pa / (supply_pa - ambient_pa);
            let volt = self.rig.voltage.at(self.time_s);
            let opening = pull_in.map_or(1.0, |pull_in| pull_in.delay(share, volt));
            valve.pass(self.time_s, opening);
        }
    }

    /// Returns the readings at the present time.
    pub fn reading(&self) -> KindReading {
        let Conditions { inlet, chambers } = self.gas.conditions(&self.state, self.time_s);
        let sensor = &self.rig.hidden.sensor;
        let shown = |chamber: usize| {
            let lagged = self.state[LAGGED[chamber]];
            sensor.shown(self.time_s, chambers[chamber].0, lagged)
        };
        KindReading {
            chambers_pa: [shown(0), shown(usize::from(self.rig.second.is_some()))],
            inlet_pa: inlet.0,
            position_m: self.rig.actuator.at(self.time_s),
            volt: self.rig.voltage.at(self.time_s),
        }
    }

    /// Integrates to the time `end_s`, before which no valve switches.
    fn integrate(&mut self, end_s: f64) {
        let length_s = end_s - self.time_s;
        let count = (length_s / self.step_s).ceil();
        let step_s = length_s / count;
        for n in 0..count as usize {
            self.step(self.time_s + n as f64 * step_s, step_s);
        }
    }

    fn step(&mut self, time_s: f64, step_s: f64) {
        let valves = self.valves.each_ref();
        let orifices = valves.map(|valve| &valve.orifice);
        let shares = |after_s: f64| valves.map(|valve| valve.open_share(time_s + after_s));
        let state = &self.state;
        let moved = |rate: &State, by_s: f64| -> State {
            std::array::from_fn(|n| state[n] + by_s * rate[n])
        };
        let [begin, middle, end] = [0.0, 0.5 * step_s, step_s].map(shares);
        let [at_begin_s, at_middle_s, at_end_s] =
            [0.0, 0.5, 1.0].map(|share| time_s + share * step_s);
        let a = self.gas.rates(state, at_begin_s, orifices, begin);
        let b = self
            .gas
            .rates(&moved(&a, 0.5 * step_s), at_middle_s, orifices, middle);
        let c = self
            .gas
            .rates(&moved(&b, 0.5 * step_s), at_middle_s, orifices, middle);
        let d = self.gas.rates(&moved(&c, step_s), at_end_s, orifices, end);
        let sum: State = std::array::from_fn(|n| a[n] + 2.0 * (b[n] + c[n]) + d[n]);
        self.state = moved(&sum, step_s / 6.0);
    }
}
