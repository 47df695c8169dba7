//! Candidates that the bench measures, in the order of the table.

use std::fmt;

/// Functions of a candidate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Duty {
    /// Prediction, PID, anti-windup, boost, tolerance, Scheme 1 with constant lower limits: all have the same output.
    FullStep,
    /// The full step with lower limits that follow the pressure, and the other tasks of an ECU.
    Ecu,
    /// The model-based pulses, which replace PID controller and distributor.
    Pulses,
    /// A PID controller alone.
    Kernel,
}

impl fmt::Display for Duty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::FullStep => "full step of the thesis",
            Self::Ecu => "full step with limits by pressure",
            Self::Pulses => "model-based pulses",
            Self::Kernel => "PID controller alone",
        })
    }
}

/// Candidate of the bench.
#[derive(Debug)]
pub(crate) struct Candidate {
    /// Name in the bench.
    pub(crate) name: &'static str,
    /// Name in the table.
    pub(crate) title: &'static str,
    pub(crate) duty: Duty,
}

const fn candidate(name: &'static str, title: &'static str, duty: Duty) -> Candidate {
    Candidate { name, title, duty }
}

/// Step that the budgets are for.
pub(crate) const THESIS_STEP: &str = "full_step";
/// Step with limits by pressure, plausibility of the pressure and telemetry.
pub(crate) const CHECKED_LOOP: &str = "checked_loop";
/// All work of an ECU in a sample.
pub(crate) const ECU_SAMPLE: &str = "ecu_sample";
/// Model-based pulses.
pub(crate) const PULSES: &str = "pulses";
/// Baselines that saturate each operation, in the order O2, Os.
pub(crate) const SATURATING: [&str; 2] = ["saturating_o2", "saturating_os"];

/// All candidates.
pub(crate) const CANDIDATES: [Candidate; 18] = [
    candidate(
        "full_step",
        "controller, only numbers in RAM",
        Duty::FullStep,
    ),
    candidate(
        "full_step_any",
        "controller, mechanisms in RAM, too",
        Duty::FullStep,
    ),
    candidate(
        "saturating_o2",
        "C int32, each operation saturated, -O2",
        Duty::FullStep,
    ),
    candidate("saturating_os", "the same, -Os", Duty::FullStep),
    candidate("tuned_o2", "C int32, tuned by hand, -O2", Duty::FullStep),
    candidate("tuned_os", "the same, -Os", Duty::FullStep),
    candidate("float_o2", "C float, on the FPU, -O2", Duty::FullStep),
    candidate("float_os", "the same, -Os", Duty::FullStep),
    candidate("traced_step", "controller with its trace", Duty::Ecu),
    candidate(
        "checked_loop",
        "ecu::CheckedLoop: plausible, telemetry",
        Duty::Ecu,
    ),
    candidate(
        "ecu_sample",
        "ecu::Ecu: all detectors, supervisor",
        Duty::Ecu,
    ),
    candidate("pulses", "controller, model-based pulses", Duty::Pulses),
    candidate(
        "pid_alone",
        "controller with tolerance, distributor",
        Duty::Kernel,
    ),
    candidate("idsp_fixed", "idsp 0.23 BiquadClamp, Q29", Duty::Kernel),
    candidate(
        "idsp_fixed_wide",
        "idsp 0.23 BiquadClamp, Q29, wide state",
        Duty::Kernel,
    ),
    candidate("idsp_float", "idsp 0.23 BiquadClamp, f32", Duty::Kernel),
    candidate("pid", "pid 4.0, f32", Duty::Kernel),
    candidate("advanced_pid", "advanced-pid 0.2, f32", Duty::Kernel),
];

impl Candidate {
    /// Returns the position in the table.
    pub(crate) fn place(&self) -> usize {
        let place = CANDIDATES.iter().position(|other| other.name == self.name);
        place.unwrap_or(CANDIDATES.len())
    }

    /// Returns the candidate of this name.
    pub(crate) fn named(name: &str) -> Option<&'static Self> {
        CANDIDATES.iter().find(|candidate| candidate.name == name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Titles have 40 of the 120 columns of the table; the figures need the rest.
    #[test]
    fn every_title_leaves_room_for_the_figures_and_no_name_comes_twice() {
        for (place, candidate) in CANDIDATES.iter().enumerate() {
            assert!(candidate.title.chars().count() <= 40, "{candidate:?}");
            assert_eq!(candidate.place(), place, "{candidate:?}");
        }
    }
}
