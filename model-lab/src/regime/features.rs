//! What was going on at each sample.

use plant_sim::PlantParameters;
use plant_sim::parameters::PA_PER_BAR;
use plant_sim::plant::{FILL, VENT};

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

/// What was going on at each sample, as one signal sees it: a current has its own coil, a pressure both valves.
pub(crate) struct Features {
    /// Index into [`VALVE_STATES`].
    pub(crate) valve_state: Vec<u8>,
    /// Index into [`FLOWS`].
    pub(crate) flow: Vec<u8>,
    /// Chamber pressure of the model [bar gauge].
    pub(crate) pressure_bar: Vec<f64>,
    /// Its mean rate of change [bar/s].
    pub(crate) pressure_rate_bar_per_s: Vec<f64>,
    /// Duty cycle in force [%], the larger of the two valves; negative where it is the vent valve's.
    pub(crate) duty_pct: Vec<f64>,
    /// Time since a command last went to zero or left it [s].
    pub(crate) since_switch_s: Vec<Option<f64>>,
    /// Time for which the output was commanded high, on-times added up [s]; of the coil that has more in the end.
    pub(crate) energised_s: Vec<f64>,
    /// Instants [s].
    pub(crate) times_s: Vec<f64>,
}

impl Features {
    /// `memory` is the number of samples over which the predictor remembers: what happened that lately still shows.
    /// With `coil`, only the commands of that valve count.
    pub(crate) fn new(
        parameters: &PlantParameters,
        commands: &Commands,
        activities: &[Activity],
        memory: usize,
        coil: Option<usize>,
    ) -> Self {
        let gas = &parameters.gas;
        let valves: Vec<usize> = coil.map_or(vec![FILL, VENT], |coil| vec![coil]);
        let energised_s = valves.iter().map(|&valve| energised_s(commands, valve));
        let mut features = Self {
            valve_state: Vec::with_capacity(activities.len()),
            flow: Vec::with_capacity(activities.len()),
            pressure_bar: Vec::with_capacity(activities.len()),
            pressure_rate_bar_per_s: Vec::with_capacity(activities.len()),
            duty_pct: (0..commands.len())
                .map(|row| duty_in_force(commands, &valves, row))
                .collect(),
            since_switch_s: since_switch_s(commands, &valves),
            energised_s: energised_s
                .max_by(|a, b| f64::total_cmp(&a[a.len() - 1], &b[b.len() - 1]))
                .unwrap_or_default(),
            times_s: commands.times_s.clone(),
        };
        for (row, now) in activities.iter().enumerate() {
            let lately = &activities[(row + 1).saturating_sub(memory)..=row];
            let open = [FILL, VENT].map(|valve| lately.iter().any(|activity| activity.open[valve]));
            let choked = [
                now.pressure <= parameters.flow.critical_ratio * gas.supply_pressure_pa(),
                gas.ambient_pressure_pa <= parameters.flow.critical_ratio * now.pressure,
            ];
            features
                .valve_state
                .push(u8::from(open[FILL]) + 2 * u8::from(open[VENT]));
            features.flow.push(match open {
                [false, false] => 0,
                [true, false] => 2 - u8::from(choked[FILL]),
                [false, true] => 4 - u8::from(choked[VENT]),
                [true, true] => 5,
            });
            features
                .pressure_bar
                .push((now.pressure - gas.ambient_pressure_pa) / PA_PER_BAR);
            let rates = lately
                .iter()
                .map(|activity| activity.pressure_rate / PA_PER_BAR);
            features
                .pressure_rate_bar_per_s
                .push(rates.sum::<f64>() / lately.len() as f64);
        }
        features
    }
}

/// What moved the plant until the sample of `row` was in force an interval ago.
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

fn since_switch_s(commands: &Commands, valves: &[usize]) -> Vec<Option<f64>> {
    let on = |row: usize| -> Vec<bool> {
        valves
            .iter()
            .map(|&valve| commands.duty_pct[valve][row] > 0.0)
            .collect()
    };
    let mut state = vec![false; valves.len()];
    let mut switched_s = None;
    (0..commands.len())
        .map(|row| {
            // A command given now cannot show in the sample of now.
            let since = switched_s.map(|switched_s| commands.times_s[row] - switched_s);
            let now = on(row);
            if now != state {
                state = now;
                switched_s = Some(commands.times_s[row]);
            }
            since
        })
        .collect()
}

fn energised_s(commands: &Commands, valve: usize) -> Vec<f64> {
    let mut sum_s = 0.0;
    (0..commands.len())
        .map(|row| {
            if row > 0 {
                let span_s = commands.times_s[row] - commands.times_s[row - 1];
                sum_s += span_s * commands.duty_pct[valve][row - 1] / 100.0;
            }
            sum_s
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::shut_for;

    fn features(commands: &Commands, activities: &[Activity], coil: Option<usize>) -> Features {
        Features::new(&PlantParameters::nominal(), commands, activities, 4, coil)
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
            let features = features(&shut_for(1, 0.01), &[at(pressure_bar, open)], None);
            assert_eq!(
                FLOWS[usize::from(features.flow[0])],
                expected,
                "{pressure_bar} bar, {open:?}"
            );
        }
    }

    #[test]
    fn a_valve_counts_as_open_for_as_long_as_the_predictor_remembers() {
        let mut activities = [at(2.0, [false, false]); 8];
        activities[2].open = [true, false];
        let features = features(&shut_for(8, 0.01), &activities, None);
        assert_eq!(features.valve_state, [0, 0, 1, 1, 1, 1, 0, 0]);
    }

    #[test]
    fn a_switch_is_a_command_that_leaves_zero_or_returns_to_it() {
        let mut commands = shut_for(300, 0.01);
        commands.duty_pct[FILL][100..200].fill(50.0);
        commands.duty_pct[FILL][150..200].fill(80.0);
        let since = features(&commands, &[at(0.0, [false; 2]); 300], None).since_switch_s;
        assert_eq!(since[100], None);
        assert!(
            (since[160].unwrap() - 0.6).abs() < 1e-9,
            "another duty cycle is no switch"
        );
        assert!((since[201].unwrap() - 0.01).abs() < 1e-9);
        assert_eq!(
            features(&commands, &[at(0.0, [false; 2]); 300], Some(VENT)).since_switch_s[250],
            None
        );
    }

    #[test]
    fn on_times_of_the_coil_add_up() {
        let mut commands = shut_for(300, 0.01);
        commands.duty_pct[FILL][100..150].fill(50.0);
        commands.duty_pct[FILL][150..200].fill(80.0);
        let total = |coil| features(&commands, &[at(0.0, [false; 2]); 300], coil).energised_s[299];
        assert!((total(None) - (0.25 + 0.4)).abs() < 1e-9);
        assert_eq!(total(Some(VENT)), 0.0);
    }

    #[test]
    fn the_duty_in_force_is_late_and_signed_by_its_valve() {
        let mut commands = shut_for(20, 0.01);
        commands.duty_pct[FILL][5..].fill(30.0);
        commands.duty_pct[VENT][5..].fill(60.0);
        let activities = [at(0.0, [false; 2]); 20];
        let duty = |coil| features(&commands, &activities, coil).duty_pct;
        // Commanded at 50 ms, in force from 65 ms, acting on the sample at 80 ms.
        assert_eq!(duty(None)[7..9], [0.0, -60.0]);
        assert_eq!(duty(Some(FILL))[8], 30.0);
    }
}
