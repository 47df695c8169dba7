//! The dimensions along which an error is placed; each sample falls into one bin of each.

use plant_sim::PlantParameters;
use plant_sim::parameters::PA_PER_BAR;
use plant_sim::plant::{FILL, VENT};

use crate::commands::Commands;
use crate::run::Activity;

/// One way to sort the samples.
pub(crate) struct Dimension {
    /// Stable name.
    pub(crate) id: &'static str,
    /// For people.
    pub(crate) title: &'static str,
    pub(crate) bins: Vec<Bin>,
    /// Bin of each sample.
    pub(crate) bin_of: Vec<usize>,
    /// Whether the finder combines it with valve state and pressure; those that follow from these do not help it.
    pub(crate) combines: bool,
}

/// One bin of a dimension.
pub(crate) struct Bin {
    /// In a table under the title.
    pub(crate) label: String,
    /// In a sentence.
    pub(crate) phrase: String,
}

/// What was going on at each sample.
pub(crate) struct Features {
    /// Index into [`VALVE_STATES`].
    pub(crate) valve_state: Vec<usize>,
    /// Chamber pressure of the model [bar gauge].
    pub(crate) pressure_bar: Vec<f64>,
    /// Larger duty cycle in force [%], negative where it is the vent valve's.
    pub(crate) acting_duty_pct: Vec<f64>,
    flow: Vec<usize>,
    pressure_rate_bar_per_s: Vec<f64>,
    since_switch_s: Vec<Option<f64>>,
    energised_s: [Vec<f64>; 2],
    times_s: Vec<f64>,
}

pub(crate) const VALVE_STATES: [&str; 4] =
    ["both valves shut", "filling", "venting", "both valves open"];
const FLOWS: [&str; 6] = [
    "no flow",
    "fill choked",
    "fill subsonic",
    "vent choked",
    "vent subsonic",
    "both valves open",
];
/// Upper ends of the bands of duty cycle [%]; the first band is exactly 0.
const DUTY_PCT: [f64; 4] = [30.0, 50.0, 70.0, 90.0];
/// Upper ends of the bands of the time since the last switch [s].
const SINCE_SWITCH_S: [f64; 6] = [0.03, 0.06, 0.1, 0.2, 0.5, 1.0];
/// Upper ends of the bands of the time under current [s].
const ENERGISED_S: [f64; 5] = [1.0, 3.0, 6.0, 12.0, 24.0];
/// A pressure that changes less counts as steady [bar/s].
const STEADY_BAR_PER_S: f64 = 0.05;

impl Features {
    /// `memory` is the number of samples over which the predictor remembers: what happened that lately still shows.
    pub(crate) fn new(
        parameters: &PlantParameters,
        commands: &Commands,
        activities: &[Activity],
        memory: usize,
    ) -> Self {
        let mut features = Self {
            valve_state: Vec::new(),
            pressure_bar: Vec::new(),
            acting_duty_pct: Vec::new(),
            flow: Vec::new(),
            pressure_rate_bar_per_s: Vec::new(),
            since_switch_s: since_switch(commands),
            energised_s: [FILL, VENT].map(|valve| energised(commands, valve)),
            times_s: commands.times_s.clone(),
        };
        let gas = &parameters.gas;
        for (row, now) in activities.iter().enumerate() {
            let lately = &activities[(row + 1).saturating_sub(memory)..=row];
            let open = [FILL, VENT].map(|valve| lately.iter().any(|activity| activity.open[valve]));
            let choked = [
                now.pressure <= parameters.flow.critical_ratio * gas.supply_pressure_pa(),
                gas.ambient_pressure_pa <= parameters.flow.critical_ratio * now.pressure,
            ];
            features
                .valve_state
                .push(usize::from(open[FILL]) + 2 * usize::from(open[VENT]));
            features.flow.push(match open {
                [false, false] => 0,
                [true, false] => 2 - usize::from(choked[FILL]),
                [false, true] => 4 - usize::from(choked[VENT]),
                [true, true] => 5,
            });
            let rates = lately
                .iter()
                .map(|activity| activity.pressure_rate / PA_PER_BAR);
            features
                .pressure_rate_bar_per_s
                .push(rates.sum::<f64>() / lately.len() as f64);
            features
                .pressure_bar
                .push((now.pressure - gas.ambient_pressure_pa) / PA_PER_BAR);
            // What moved the pressure until now was in force an interval ago.
            let before_s = commands.times_s[row.saturating_sub(1)];
            let duty = |valve: usize| {
                commands
                    .row_in_force(before_s)
                    .map_or(0.0, |row| commands.duty_pct[valve][row])
            };
            let (fill, vent) = (duty(FILL), duty(VENT));
            features
                .acting_duty_pct
                .push(if vent > fill { -vent } else { fill });
        }
        features
    }

    /// Every dimension, with the heating time of `coil`; none takes the one that was under current longer.
    pub(crate) fn dimensions(&self, coil: Option<usize>) -> Vec<Dimension> {
        let named = |id, title, names: &[&str], bin_of: &[usize]| Dimension {
            id,
            title,
            bins: names
                .iter()
                .map(|name| Bin {
                    label: (*name).to_owned(),
                    phrase: (*name).to_owned(),
                })
                .collect(),
            bin_of: bin_of.to_vec(),
            combines: false,
        };
        let trend = |&rate: &f64| match rate {
            rate if rate > STEADY_BAR_PER_S => 0,
            rate if rate < -STEADY_BAR_PER_S => 1,
            _ => 2,
        };
        let trend_of: Vec<usize> = self.pressure_rate_bar_per_s.iter().map(trend).collect();
        vec![
            named("valve_state", "valves", &VALVE_STATES, &self.valve_state),
            self.duty_band(),
            named("flow", "pressure ratio", &FLOWS, &self.flow),
            named(
                "pressure_trend",
                "pressure of the model",
                &["rising", "falling", "steady"],
                &trend_of,
            ),
            self.since_switch(),
            self.under_current(coil),
            self.pressure_band(),
            self.tenth_of_log(),
        ]
    }

    fn duty_band(&self) -> Dimension {
        let bin_of = self
            .acting_duty_pct
            .iter()
            .map(|duty| duty_band(duty.abs()))
            .collect();
        let bin = |label: String| Bin {
            phrase: format!("duty {label}"),
            label,
        };
        let bins = duty_band_labels().into_iter().map(bin).collect();
        Dimension {
            id: "duty_band",
            title: "duty cycle of the acting valve",
            bins,
            bin_of,
            combines: true,
        }
    }

    fn since_switch(&self) -> Dimension {
        let mut bins = bands(&SINCE_SWITCH_S, 1e3, "ms", |label| {
            format!("{label} after a switch")
        });
        bins.push(Bin {
            label: "before any".to_owned(),
            phrase: "before any command".to_owned(),
        });
        let bin = |since: &Option<f64>| {
            since.map_or(bins.len() - 1, |since| band(&SINCE_SWITCH_S, since))
        };
        let bin_of = self.since_switch_s.iter().map(bin).collect();
        Dimension {
            id: "since_switch",
            title: "time since a command was switched on or off",
            bins,
            bin_of,
            combines: true,
        }
    }

    fn under_current(&self, coil: Option<usize>) -> Dimension {
        let [fill, vent] = &self.energised_s;
        let longer = || usize::from(vent.last() > fill.last());
        let energised = &self.energised_s[coil.unwrap_or_else(longer)];
        let bins = bands(&ENERGISED_S, 1.0, "s", |label| {
            format!("after {label} under current")
        });
        let bin_of = energised
            .iter()
            .map(|&time_s| band(&ENERGISED_S, time_s))
            .collect();
        Dimension {
            id: "under_current",
            title: "time the coil has been under current, on-times added up",
            bins,
            bin_of,
            combines: true,
        }
    }

    fn pressure_band(&self) -> Dimension {
        let labels = self.pressure_band_labels();
        let bins = labels
            .into_iter()
            .map(|label| Bin {
                phrase: label.clone(),
                label,
            })
            .collect();
        let bin_of = self
            .pressure_bar
            .iter()
            .map(|&pressure| self.pressure_band_of(pressure))
            .collect();
        Dimension {
            id: "pressure_band",
            title: "chamber pressure of the model",
            bins,
            bin_of,
            combines: false,
        }
    }

    fn tenth_of_log(&self) -> Dimension {
        let end_s = self.times_s.last().copied().unwrap_or(0.0);
        let bin = |part: usize| {
            let [from, to] = [part, part + 1].map(|part| end_s * part as f64 / 10.0);
            let label = format!("{from:.1} to {to:.1} s");
            Bin {
                phrase: format!("{label} into the log"),
                label,
            }
        };
        let tenth = |time_s: &f64| ((time_s / end_s.max(f64::MIN_POSITIVE) * 10.0) as usize).min(9);
        Dimension {
            id: "tenth_of_log",
            title: "time in the log",
            bins: (0..10).map(bin).collect(),
            bin_of: self.times_s.iter().map(tenth).collect(),
            combines: true,
        }
    }

    /// Whole bars up to the highest pressure.
    pub(crate) fn pressure_band_labels(&self) -> Vec<String> {
        let highest = self.pressure_bar.iter().copied().fold(0.0, f64::max);
        (0..=highest as usize)
            .map(|bar| format!("{bar} to {} bar", bar + 1))
            .collect()
    }

    pub(crate) fn pressure_band_of(&self, pressure_bar: f64) -> usize {
        pressure_bar.max(0.0) as usize
    }
}

/// Labels of the duty bands.
pub(crate) fn duty_band_labels() -> Vec<String> {
    let mut labels = vec!["0 %".to_owned()];
    labels.extend(
        bands(&DUTY_PCT, 1.0, "%", str::to_owned)
            .into_iter()
            .map(|bin| bin.label),
    );
    labels
}

/// Band of a duty cycle [%].
pub(crate) fn duty_band(duty_pct: f64) -> usize {
    if duty_pct == 0.0 {
        0
    } else {
        1 + band(&DUTY_PCT, duty_pct)
    }
}

fn band(edges: &[f64], value: f64) -> usize {
    edges.partition_point(|&edge| edge <= value)
}

fn bands(edges: &[f64], scale: f64, unit: &str, phrase: impl Fn(&str) -> String) -> Vec<Bin> {
    let edge = |index: usize| edges[index] * scale;
    let label = |index: usize| match index {
        0 => format!("below {} {unit}", edge(0)),
        last if last == edges.len() => format!("{} {unit} and more", edge(last - 1)),
        _ => format!("{} to {} {unit}", edge(index - 1), edge(index)),
    };
    (0..=edges.len())
        .map(|index| {
            let label = label(index);
            Bin {
                phrase: phrase(&label),
                label,
            }
        })
        .collect()
}

/// Time since a command last went to zero or left it [s].
fn since_switch(commands: &Commands) -> Vec<Option<f64>> {
    let on = |row: usize| [FILL, VENT].map(|valve| commands.duty_pct[valve][row] > 0.0);
    let mut state = [false, false];
    let mut switched_s = None;
    (0..commands.len())
        .map(|row| {
            // A command given now cannot show in the sample of now.
            let since = switched_s.map(|switched_s| commands.times_s[row] - switched_s);
            if on(row) != state {
                state = on(row);
                switched_s = Some(commands.times_s[row]);
            }
            since
        })
        .collect()
}

/// Time for which the output of `valve` was commanded high until each sample, on-times added up [s].
fn energised(commands: &Commands, valve: usize) -> Vec<f64> {
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

    fn features(commands: &Commands, activities: &[Activity], memory: usize) -> Features {
        Features::new(&PlantParameters::nominal(), commands, activities, memory)
    }

    fn at(pressure_bar: f64, open: [bool; 2]) -> Activity {
        Activity {
            open,
            pressure: pressure_bar * 1e5 + 101_325.0,
            pressure_rate: 0.0,
        }
    }

    fn label(dimension: &Dimension, sample: usize) -> &str {
        &dimension.bins[dimension.bin_of[sample]].label
    }

    #[test]
    fn flow_is_choked_by_the_pressure_ratio_of_the_open_valve() {
        // Critical: filling below 0.528 * 9.413 - 1.013 = 3.957 bar, venting above 1.01325 / 0.528 - 1.013 = 0.906 bar.
        let activities = [
            at(3.9, [true, false]),
            at(4.0, [true, false]),
            at(0.95, [false, true]),
            at(0.85, [false, true]),
            at(2.0, [true, true]),
            at(2.0, [false, false]),
        ];
        let features = features(&shut_for(6, 0.01), &activities, 1);
        let flow = &features.dimensions(None)[2];
        let labels: Vec<&str> = (0..6).map(|sample| label(flow, sample)).collect();
        let expected = [
            "fill choked",
            "fill subsonic",
            "vent choked",
            "vent subsonic",
            "both valves open",
            "no flow",
        ];
        assert_eq!(labels, expected);
    }

    #[test]
    fn a_valve_counts_as_open_for_as_long_as_the_predictor_remembers() {
        let mut activities = [at(2.0, [false, false]); 8];
        activities[2].open = [true, false];
        let features = features(&shut_for(8, 0.01), &activities, 4);
        assert_eq!(features.valve_state, [0, 0, 1, 1, 1, 1, 0, 0]);
    }

    #[test]
    fn times_since_a_switch_and_under_current_follow_the_commands() {
        let mut commands = shut_for(300, 0.01);
        commands.duty_pct[FILL][100..200].fill(50.0);
        commands.duty_pct[FILL][150..200].fill(80.0);
        let features = features(&commands, &[at(0.0, [false, false]); 300], 1);
        let dimensions = features.dimensions(Some(FILL));
        let since = dimensions
            .iter()
            .find(|dimension| dimension.id == "since_switch")
            .unwrap();
        assert_eq!(label(since, 100), "before any");
        assert_eq!(label(since, 101), "below 30 ms");
        assert_eq!(
            label(since, 160),
            "500 to 1000 ms",
            "another duty cycle is no switch"
        );
        assert_eq!(label(since, 201), "below 30 ms");
        assert!((features.energised_s[FILL][299] - 0.9).abs() < 1e-9);
        assert_eq!(features.energised_s[VENT][299], 0.0);
    }

    #[test]
    fn the_acting_duty_is_signed_and_late() {
        let mut commands = shut_for(20, 0.01);
        commands.duty_pct[VENT][5..].fill(60.0);
        let features = features(&commands, &[at(0.0, [false, false]); 20], 1);
        // Commanded at 50 ms, in force from 65 ms, acting on the sample at 80 ms.
        assert_eq!(features.acting_duty_pct[7], 0.0);
        assert_eq!(features.acting_duty_pct[8], -60.0);
    }

    #[test]
    fn every_sample_falls_into_a_bin_of_every_dimension() {
        let activities: Vec<Activity> = (0..100)
            .map(|n| at(f64::from(n) * 0.11 - 0.5, [n % 2 == 0, false]))
            .collect();
        for dimension in features(&shut_for(100, 0.01), &activities, 1).dimensions(None) {
            assert_eq!(dimension.bin_of.len(), 100, "{}", dimension.id);
            assert!(
                dimension
                    .bin_of
                    .iter()
                    .all(|&bin| bin < dimension.bins.len()),
                "{}",
                dimension.id
            );
        }
    }

    #[test]
    fn bands_begin_with_their_lower_end() {
        assert_eq!(
            [0.0, 1.0, 30.0, 49.9, 90.0, 100.0].map(duty_band),
            [0, 1, 2, 2, 5, 5]
        );
        assert_eq!(duty_band_labels()[1..3], ["below 30 %", "30 to 50 %"]);
    }
}
