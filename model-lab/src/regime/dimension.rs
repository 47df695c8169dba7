//! Dimensions along which an error is placed; each sample falls into one bin of each.

use super::features::{FLOWS, Features, States, VALVE_STATES};
use crate::bins::Bins;

/// One dimension by which the samples are sorted.
pub(crate) struct Dimension {
    /// Stable name.
    pub(crate) id: &'static str,
    /// Title for people.
    pub(crate) title: &'static str,
    pub(crate) bins: Vec<Bin>,
    /// Bin of each sample; at most some hundred bins.
    pub(crate) bin_of: Bins,
    /// Whether the finder combines it with valve state and pressure; a dimension that follows from these adds nothing.
    pub(crate) combines: bool,
}

/// One bin of a dimension.
pub(crate) struct Bin {
    /// Label in a table under the title.
    pub(crate) label: String,
    /// Phrase in a sentence.
    pub(crate) phrase: String,
}

/// Upper ends of the bands of duty cycle (%); the first band is exactly 0.
const DUTY_PCT: [f64; 4] = [30.0, 50.0, 70.0, 90.0];
/// Upper ends of the bands of the time since the last switch (s).
const SINCE_SWITCH_S: [f64; 6] = [0.03, 0.06, 0.1, 0.2, 0.5, 1.0];
/// Upper ends of the bands of the time under current (s).
const ENERGISED_S: [f64; 5] = [1.0, 3.0, 6.0, 12.0, 24.0];
/// Rate of change below which a pressure counts as steady (bar/s).
const STEADY_BAR_PER_S: f64 = 0.05;

impl Features<'_> {
    /// Returns every dimension.
    pub(crate) fn dimensions(&self) -> Vec<Dimension> {
        let states = self.states;
        let trends = ["rising", "falling", "steady"];
        vec![
            Dimension::of_names(
                "valve_state",
                "valves",
                &VALVE_STATES,
                states.valve_state.clone(),
            ),
            self.duty_band(),
            Dimension::of_names("flow", "pressure ratio", &FLOWS, states.flow.clone()),
            Dimension::of_names(
                "pressure_trend",
                "pressure of the model",
                &trends,
                states.trend.clone(),
            ),
            self.since_switch(),
            self.under_current(),
            self.pressure_band(),
            self.tenth_of_log(),
        ]
    }

    fn duty_band(&self) -> Dimension {
        let bin = |label: String| Bin {
            phrase: format!("duty {label}"),
            label,
        };
        Dimension {
            id: "duty_band",
            title: "duty cycle of the acting valve",
            bins: duty_band_labels().into_iter().map(bin).collect(),
            bin_of: self
                .acting
                .iter()
                .map(|acting| acting.abs_diff(SHUT))
                .collect(),
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
        Dimension {
            id: "since_switch",
            title: "time since a command was switched on or off",
            bin_of: self.since_switch.clone(),
            bins,
            combines: true,
        }
    }

    fn under_current(&self) -> Dimension {
        Dimension {
            id: "under_current",
            title: "time the coil has been under current, on-times added up",
            bins: bands(&ENERGISED_S, 1.0, "s", |label| {
                format!("after {label} under current")
            }),
            bin_of: self.energised.clone(),
            combines: true,
        }
    }

    fn pressure_band(&self) -> Dimension {
        let bin = |label: String| Bin {
            phrase: label.clone(),
            label,
        };
        Dimension {
            id: "pressure_band",
            title: "chamber pressure of the model",
            bins: self
                .states
                .pressure_band_labels()
                .into_iter()
                .map(bin)
                .collect(),
            bin_of: self.states.pressure_band.clone(),
            combines: false,
        }
    }

    fn tenth_of_log(&self) -> Dimension {
        let end_s = self.states.end_s;
        let bin = |part: usize| {
            let [from, to] = [part, part + 1].map(|part| end_s * part as f64 / 10.0);
            let label = format!("{from:.1} to {to:.1} s");
            Bin {
                phrase: format!("{label} into the log"),
                label,
            }
        };
        Dimension {
            id: "tenth_of_log",
            title: "time in the log",
            bins: (0..10).map(bin).collect(),
            bin_of: self.states.tenth.clone(),
            combines: true,
        }
    }
}

impl States {
    /// Returns the labels of the whole bars up to the highest pressure.
    pub(crate) fn pressure_band_labels(&self) -> Vec<String> {
        (0..=pressure_band(self.highest_bar))
            .map(|bar| format!("{bar} to {} bar", bar + 1))
            .collect()
    }
}

impl Dimension {
    fn of_names(id: &'static str, title: &'static str, names: &[&str], bin_of: Bins) -> Self {
        let bin = |name: &&str| Bin {
            label: (*name).to_owned(),
            phrase: (*name).to_owned(),
        };
        Self {
            id,
            title,
            bins: names.iter().map(bin).collect(),
            bin_of,
            combines: false,
        }
    }
}

/// Number of bands of pressure, at most.
const PRESSURE_BANDS_MAX: usize = 1000;

/// Returns the band of a pressure (bar gauge); a pressure below ambient counts to the lowest.
pub(crate) fn pressure_band(pressure_bar: f64) -> usize {
    (pressure_bar.max(0.0) as usize).min(PRESSURE_BANDS_MAX - 1)
}

/// Returns the bin of a mean rate of change of the pressure (bar/s): rising, falling or steady.
pub(crate) fn trend(rate_bar_per_s: f64) -> u16 {
    match rate_bar_per_s {
        rate if rate > STEADY_BAR_PER_S => 0,
        rate if rate < -STEADY_BAR_PER_S => 1,
        _ => 2,
    }
}

/// Returns the bin of a time since the last switch (s); the last bin is before any switch.
pub(crate) fn since_switch_band(since_s: Option<f64>) -> u16 {
    since_s.map_or(SINCE_SWITCH_S.len() + 1, |since_s| {
        band(&SINCE_SWITCH_S, since_s)
    }) as u16
}

/// Returns the bin of a time under current (s).
pub(crate) fn energised_band(time_s: f64) -> u16 {
    band(&ENERGISED_S, time_s) as u16
}

/// Returns the bin of a duty cycle with its valve (%): positive the fill valve's, negative the vent valve's. It is [`SHUT`], plus the band
/// of the fill valve, or minus that of the vent valve.
pub(crate) fn acting_band(duty_pct: f64) -> u16 {
    if duty_pct < 0.0 {
        SHUT - duty_band(-duty_pct) as u16
    } else {
        SHUT + duty_band(duty_pct) as u16
    }
}

/// Value of [`acting_band`] at 0 %: the vent valve has this number of bands below it.
pub(crate) const SHUT: u16 = DUTY_PCT.len() as u16 + 1;

/// Returns the labels of the duty bands.
pub(crate) fn duty_band_labels() -> Vec<String> {
    let mut labels = vec!["0 %".to_owned()];
    labels.extend(
        bands(&DUTY_PCT, 1.0, "%", str::to_owned)
            .into_iter()
            .map(|bin| bin.label),
    );
    labels
}

/// Returns the band of a duty cycle (%).
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

#[cfg(test)]
mod tests {
    use plant_sim::PlantParameters;

    use super::super::features::Watched;
    use super::*;
    use crate::bench::shut_for;
    use crate::run::Activity;

    #[test]
    fn every_sample_falls_into_a_bin_of_every_dimension() {
        let at = |n: u32| Activity {
            open: [n & 1 == 0, n & 2 == 0],
            pressure: 60_000.0 + 11_000.0 * f64::from(n),
            pressure_rate: f64::from(n % 5) * 1e5 - 2e5,
        };
        let parameters = PlantParameters::nominal();
        let mut watched = Watched::new(&parameters, 100, 1);
        (0..100).map(at).for_each(|now| watched.push(now));
        let commands = shut_for(100, 0.01);
        let states = watched.finish(&commands.times_s);
        let features = Features::new(&states, &commands, None);
        for dimension in features.dimensions() {
            assert_eq!(dimension.bin_of.len(), 100, "{}", dimension.id);
            assert!(
                dimension
                    .bin_of
                    .iter()
                    .all(|bin| usize::from(bin) < dimension.bins.len()),
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
        assert_eq!(duty_band_labels()[5], "90 % and more");
        assert_eq!([-0.1, 0.99, 1.0, 8.4].map(pressure_band), [0, 0, 1, 8]);
    }
}
