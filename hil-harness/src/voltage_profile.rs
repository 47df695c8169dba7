//! Supply voltage of a vehicle over time.

use core::fmt;

/// Voltage at an instant.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    time_s: f64,
    volt: f64,
}

/// Supply voltage over time: linear between its knots, and repeated from its end on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoltageProfile {
    /// Name for the command line.
    pub name: &'static str,
    /// Description, in one sentence.
    pub about: &'static str,
    knots: &'static [Knot],
}

const fn at(time_s: f64, volt: f64) -> Knot {
    Knot { time_s, volt }
}

/// Profiles of a vehicle with 24 V. Shapes and ranges are those of the named standards; where a standard leaves a range,
/// the value in it is ours.
pub const VOLTAGE_PROFILES: &[VoltageProfile] = &[
    VoltageProfile {
        name: "ramp",
        about: "from 24 to 32, 18 and 24 V in 14 s: the range of ISO 16750-2, code H",
        knots: &[at(0.0, 24.0), at(4.0, 32.0), at(11.0, 18.0), at(14.0, 24.0)],
    },
    VoltageProfile {
        name: "cranking",
        about: "every 5 s from 24 V to 12 V for 50 ms, then 18 V for 1 s (ISO 7637-2, pulse 4, 24 V)",
        knots: &[
            at(0.0, 24.0),
            at(1.5, 24.0),
            at(1.51, 12.0),
            at(1.56, 12.0),
            at(1.61, 18.0),
            at(2.61, 18.0),
            at(2.71, 24.0),
            at(5.0, 24.0),
        ],
    },
    VoltageProfile {
        name: "load-dump",
        about: "every 5 s from 28 V (generator) to 58 V (suppressed) within 10 ms and back within 350 ms (ISO 16750-2)",
        knots: &[
            at(0.0, 28.0),
            at(1.5, 28.0),
            at(1.51, 58.0),
            at(1.86, 28.0),
            at(5.0, 28.0),
        ],
    },
];

impl VoltageProfile {
    /// Returns the built-in profile of this name.
    pub fn built_in(name: &str) -> Option<Self> {
        let mut profiles = VOLTAGE_PROFILES.iter();
        profiles.find(|profile| profile.name == name).copied()
    }

    /// Returns the voltage at `time_s` (V). Before time 0 it is that of time 0.
    pub fn at_s(&self, time_s: f64) -> f64 {
        let last = self.knots.last().map_or(0.0, |knot| knot.time_s);
        let time_s = time_s.max(0.0) % last;
        let interval = self.knots.windows(2).find(|pair| time_s <= pair[1].time_s);
        interval.map_or(f64::NAN, |pair| {
            let [from, to] = [pair[0], pair[1]];
            let share = (time_s - from.time_s) / (to.time_s - from.time_s);
            from.volt + share * (to.volt - from.volt)
        })
    }
}

impl fmt::Display for VoltageProfile {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.name, self.about)
    }
}

/// Supply voltage of a run from time 0 on. Before, it is that of the plant, so that the run starts as on the bench.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Supply {
    /// Constant (V).
    Constant(f64),
    /// Over time.
    Profile(VoltageProfile),
}

impl Supply {
    /// Returns the voltage at `time_s` (V), from 0 on.
    pub fn at_s(&self, time_s: f64) -> f64 {
        match self {
            Self::Constant(volt) => *volt,
            Self::Profile(profile) => profile.at_s(time_s),
        }
    }
}

impl fmt::Display for Supply {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Constant(volt) => write!(f, "{volt} V"),
            Self::Profile(profile) => profile.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_profile_is_linear_between_its_knots_and_repeats() {
        for (name, time_s, expected_v) in [
            ("ramp", -1.0, 24.0),
            ("ramp", 0.0, 24.0),
            ("ramp", 4.0, 32.0),
            ("ramp", 8.0, 24.0),
            ("ramp", 25.0, 18.0),
            ("cranking", 1.53, 12.0),
            ("cranking", 2.0, 18.0),
            ("cranking", 7.0, 18.0),
            ("load-dump", 1.505, 43.0),
            ("load-dump", 1.51, 58.0),
            ("load-dump", 1.685, 43.0),
            ("load-dump", 4.0, 28.0),
        ] {
            let volt = VoltageProfile::built_in(name).unwrap().at_s(time_s);
            assert!(
                (volt - expected_v).abs() < 1e-9,
                "{name} at {time_s} s: {volt} V"
            );
        }
        assert_eq!(VoltageProfile::built_in("steady"), None);
    }

    #[test]
    fn every_profile_begins_as_it_ends_and_its_time_grows() {
        for profile in VOLTAGE_PROFILES {
            let knots = profile.knots;
            assert_eq!(knots[0].volt, knots[knots.len() - 1].volt, "{profile}");
            assert!(
                knots.windows(2).all(|pair| pair[0].time_s < pair[1].time_s),
                "{profile}"
            );
        }
    }
}
