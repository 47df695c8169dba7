//! Features of the plant's state at each sample.

use std::collections::VecDeque;

use plant_sim::PlantParameters;
use plant_sim::parameters::PA_PER_BAR;
use plant_sim::plant::{FILL, VENT};

use super::dimension::{acting_band, energised_band, pressure_band, since_switch_band, trend};
use super::finder::cell_bar;
use crate::bins::{Bins, BinsBuilder};
use crate::commands::Commands;
use crate::run::Activity;

pub(crate) const VALVE_STATES: [&str; 4] =
    ["both valves shut", "filling", "venting", "both valves open"];
pub(crate) const FLOWS: [&str; 6] = [
    "no flow",
    "fill choked",
    "fill subsonic",
    "vent choked",
    "vent subsonic",
    "both valves open",
];

/// State of the plant at each sample, the same for every signal.
#[derive(Clone)]
pub(crate) struct States {
    /// Index into [`VALVE_STATES`].
    pub(crate) valve_state: Bins,
    /// Index into [`FLOWS`].
    pub(crate) flow: Bins,
    /// Bin of the change of the model's pressure: rising, falling or steady.
    pub(crate) trend: Bins,
    /// Chamber pressure of the model, in cells of [`States::cell_bar`].
    pub(crate) pressure_cell: Bins,
    /// Chamber pressure of the model, in whole bars.
    pub(crate) pressure_band: Bins,
    /// Tenth of the log.
    pub(crate) tenth: Bins,
    /// Width of a cell of pressure (bar).
    pub(crate) cell_bar: f64,
    /// Highest pressure (bar gauge).
    pub(crate) highest_bar: f64,
    /// Last instant (s).
    pub(crate) end_s: f64,
}

impl States {
    /// Sorts the samples by valve state, flow, trend and pressure (bar gauge) at `times_s`.
    pub(crate) fn new(
        [valve_state, flow, trend]: [Bins; 3],
        pressure_bar: &[f64],
        times_s: &[f64],
    ) -> Self {
        let highest_bar = pressure_bar.iter().copied().fold(0.0, f64::max);
        let cell_bar = cell_bar(highest_bar);
        let cell = |&pressure: &f64| (pressure.max(0.0) / cell_bar) as u16;
        let band = |&pressure: &f64| pressure_band(pressure) as u16;
        let end_s = times_s.last().copied().unwrap_or(0.0);
        let tenth = |time_s: &f64| ((time_s / end_s.max(f64::MIN_POSITIVE) * 10.0) as u16).min(9);
        Self {
            valve_state,
            flow,
            trend,
            pressure_cell: pressure_bar.iter().map(cell).collect(),
            pressure_band: pressure_bar.iter().map(band).collect(),
            tenth: times_s.iter().map(tenth).collect(),
            cell_bar,
            highest_bar,
            end_s,
        }
    }
}

/// Collector of [`States`] during a run.
pub(crate) struct Watched<'a> {
    parameters: &'a PlantParameters,
    /// Recent activity, in order of time, and the number of samples that count as recent.
    lately: VecDeque<Activity>,
    memory: usize,
    bins: [BinsBuilder; 3],
    pressure_bar: Vec<f64>,
}

impl<'a> Watched<'a> {
    /// Creates the collector. `memory` is the number of samples over which the predictor remembers: activity within it still affects the
    /// error.
    pub(crate) fn new(parameters: &'a PlantParameters, rows: usize, memory: usize) -> Self {
        Self {
            parameters,
            lately: VecDeque::new(),
            memory,
            bins: std::array::from_fn(|_| BinsBuilder::for_about(rows)),
            pressure_bar: Vec::with_capacity(rows),
        }
    }

    pub(crate) fn push(&mut self, now: Activity) {
        if self.lately.len() >= self.memory {
            self.lately.pop_front();
        }
        self.lately.push_back(now);
        let (gas, flow) = (&self.parameters.gas, &self.parameters.flow);
        let open =
            [FILL, VENT].map(|valve| self.lately.iter().any(|activity| activity.open[valve]));
        let choked = [
            now.pressure <= flow.critical_ratio * gas.supply_pressure_pa(),
            gas.ambient_pressure_pa <= flow.critical_ratio * now.pressure,
        ];
        let rates = self.lately.iter();
        let rates = rates.map(|activity| activity.pressure_rate / PA_PER_BAR);
        let rate_bar_per_s = rates.sum::<f64>() / self.lately.len() as f64;
        let valve_state = u16::from(open[FILL]) + 2 * u16::from(open[VENT]);
        let flow = match open {
            [false, false] => 0,
            [true, false] => 2 - u16::from(choked[FILL]),
            [false, true] => 4 - u16::from(choked[VENT]),
            [true, true] => 5,
        };
        let bins = [valve_state, flow, trend(rate_bar_per_s)];
        for (builder, bin) in self.bins.iter_mut().zip(bins) {
            builder.push(bin);
        }
        self.pressure_bar
            .push((now.pressure - gas.ambient_pressure_pa) / PA_PER_BAR);
    }

    pub(crate) fn finish(self, times_s: &[f64]) -> States {
        States::new(
            self.bins.map(BinsBuilder::finish),
            &self.pressure_bar,
            times_s,
        )
    }
}

/// Features of each sample for one signal: a current depends on its own coil, a pressure on both valves.
pub(crate) struct Features<'a> {
    pub(crate) states: &'a States,
    /// Band of the duty cycle in force, the larger of the two valves; see [`acting_band`].
    pub(crate) acting: Bins,
    /// Band of the time since a command last became zero or left it.
    pub(crate) since_switch: Bins,
    /// Band of the accumulated time for which the output was commanded high; of the coil with the larger total.
    pub(crate) energised: Bins,
}

impl<'a> Features<'a> {
    /// Returns the features; with `coil`, only the commands of that valve count.
    pub(crate) fn new(states: &'a States, commands: &Commands, coil: Option<usize>) -> Self {
        let valves: Vec<usize> = coil.map_or(vec![FILL, VENT], |coil| vec![coil]);
        let duty_pct = (0..commands.len()).map(|row| duty_in_force(commands, &valves, row));
        let total_s = |valve: usize| energised_s(commands, valve).last().unwrap_or(0.0);
        let most = valves
            .iter()
            .copied()
            .max_by(|&a, &b| f64::total_cmp(&total_s(a), &total_s(b)))
            .unwrap_or(FILL);
        Self::sorted(
            states,
            duty_pct,
            since_switch_s(commands, &valves),
            energised_s(commands, most),
        )
    }

    /// Sorts duty cycles in force (%; negative for the vent valve), times since a switch (s) and times under current (s).
    pub(crate) fn sorted(
        states: &'a States,
        duty_pct: impl Iterator<Item = f64>,
        since_switch_s: impl Iterator<Item = Option<f64>>,
        energised_s: impl Iterator<Item = f64>,
    ) -> Self {
        Self {
            states,
            acting: duty_pct.map(acting_band).collect(),
            since_switch: since_switch_s.map(since_switch_band).collect(),
            energised: energised_s.map(energised_band).collect(),
        }
    }
}

/// Returns the duty cycle (%) that moved the plant during the interval before the sample of `row`.
fn duty_in_force(commands: &Commands, valves: &[usize], row: usize) -> f64 {
    let Some(commanded) = commands.row_in_force(commands.times_s[row.saturating_sub(1)]) else {
        return 0.0;
    };
    valves.iter().fold(0.0_f64, |larger, &valve| {
        let duty = commands.duty_pct[valve][commanded];
        match valve {
            _ if duty <= larger.abs() => larger,
            VENT => -duty,
            _ => duty,
        }
    })
}

fn since_switch_s(
    commands: &Commands,
    valves: &[usize],
) -> impl ExactSizeIterator<Item = Option<f64>> {
    let mut state = [false; 2];
    let mut switched_s = None;
    (0..commands.len()).map(move |row| {
        // A command given now cannot affect the sample of the same instant.
        let since = switched_s.map(|switched_s| commands.times_s[row] - switched_s);
        let now = [FILL, VENT]
            .map(|valve| valves.contains(&valve) && commands.duty_pct[valve][row] > 0.0);
        if now != state {
            state = now;
            switched_s = Some(commands.times_s[row]);
        }
        since
    })
}

fn energised_s(commands: &Commands, valve: usize) -> impl ExactSizeIterator<Item = f64> {
    let mut sum_s = 0.0;
    (0..commands.len()).map(move |row| {
        if row > 0 {
            let span_s = commands.times_s[row] - commands.times_s[row - 1];
            sum_s += span_s * commands.duty_pct[valve][row - 1] / 100.0;
        }
        sum_s
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::shut_for;

    fn states(activities: &[Activity]) -> States {
        let parameters = PlantParameters::nominal();
        let mut watched = Watched::new(&parameters, activities.len(), 4);
        activities.iter().for_each(|&now| watched.push(now));
        let times_s: Vec<f64> = (0..activities.len()).map(|row| row as f64 * 0.01).collect();
        watched.finish(&times_s)
    }

    fn fill(commands: &mut Commands, valve: usize, rows: std::ops::Range<usize>, duty_pct: f64) {
        std::sync::Arc::make_mut(&mut commands.duty_pct[valve])[rows].fill(duty_pct);
    }

    fn at(pressure_bar: f64, open: [bool; 2]) -> Activity {
        Activity {
            open,
            pressure: pressure_bar * 1e5 + 101_325.0,
            pressure_rate: 0.0,
        }
    }

    #[test]
    fn flow_is_choked_by_the_pressure_ratio_of_the_open_valve() {
        // Critical: filling below 0.528 * 9.413 - 1.013 = 3.957 bar, venting above 1.01325 / 0.528 - 1.013 = 0.906 bar.
        for (pressure_bar, open, expected) in [
            (3.9, [true, false], "fill choked"),
            (4.0, [true, false], "fill subsonic"),
            (0.95, [false, true], "vent choked"),
            (0.85, [false, true], "vent subsonic"),
            (2.0, [true, true], "both valves open"),
            (2.0, [false, false], "no flow"),
        ] {
            let states = states(&[at(pressure_bar, open)]);
            assert_eq!(
                FLOWS[usize::from(states.flow.iter().next().unwrap())],
                expected,
                "{pressure_bar} bar, {open:?}"
            );
        }
    }

    #[test]
    fn a_valve_counts_as_open_for_as_long_as_the_predictor_remembers() {
        let mut activities = [at(2.0, [false, false]); 8];
        activities[2].open = [true, false];
        let states: Vec<u16> = states(&activities).valve_state.iter().collect();
        assert_eq!(states, [0, 0, 1, 1, 1, 1, 0, 0]);
    }

    #[test]
    fn a_switch_is_a_command_that_leaves_zero_or_returns_to_it() {
        let mut commands = shut_for(300, 0.01);
        fill(&mut commands, FILL, 100..200, 50.0);
        fill(&mut commands, FILL, 150..200, 80.0);
        let since: Vec<Option<f64>> = since_switch_s(&commands, &[FILL, VENT]).collect();
        assert_eq!(since[100], None);
        assert!(
            (since[160].unwrap() - 0.6).abs() < 1e-9,
            "another duty cycle is no switch"
        );
        assert!((since[201].unwrap() - 0.01).abs() < 1e-9);
        assert_eq!(since_switch_s(&commands, &[VENT]).nth(250), Some(None));
    }

    #[test]
    fn on_times_of_the_coil_add_up() {
        let mut commands = shut_for(300, 0.01);
        fill(&mut commands, FILL, 100..150, 50.0);
        fill(&mut commands, FILL, 150..200, 80.0);
        let total_s = |valve| energised_s(&commands, valve).last().unwrap();
        assert!((total_s(FILL) - (0.25 + 0.4)).abs() < 1e-9);
        assert_eq!(total_s(VENT), 0.0);
    }

    #[test]
    fn the_duty_in_force_is_late_and_signed_by_its_valve() {
        let mut commands = shut_for(20, 0.01);
        fill(&mut commands, FILL, 5..20, 30.0);
        fill(&mut commands, VENT, 5..20, 60.0);
        let duty = |valves: &[usize], row| duty_in_force(&commands, valves, row);
        // Commanded at 50 ms, in force from 65 ms, acting on the sample at 80 ms.
        assert_eq!([7, 8].map(|row| duty(&[FILL, VENT], row)), [0.0, -60.0]);
        assert_eq!(duty(&[FILL], 8), 30.0);
    }
}
