//! Errors of a replay.

use recording::{AddSignalError, ConversionError, MissingSignal};

use super::LONGEST_GAP_S;

/// Returns the part of the message that lists the signals that the log has instead of a missing command, and the next
/// step.
fn about_missing_command(name: &str, present: &[String], meant: &[String]) -> String {
    let instead = match (meant, present) {
        ([], []) => ".".to_owned(),
        ([], present) => format!("; it has {}.", present.join(", ")),
        (meant, _) => format!("; is it {}?", meant.join(" or ")),
    };
    format!(
        "{instead} Map its column to `{name}`, or where the valve was not commanded, say so in a mapping: \
         constant.{name} = {{ value = 0, unit = \"pct\" }}"
    )
}

impl ReplayError {
    /// Creates the error of a simulation that was aborted before the row at `time_ns`.
    pub fn aborted(time_ns: u64) -> Self {
        Self::Aborted {
            time_s: time_ns as f64 * 1e-9,
        }
    }
}

/// Reason why a log cannot be replayed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The simulation takes more steps than a log of this length may require.
    #[error(
        "the plant cannot be simulated on this log in a bounded number of steps: aborted {time_s} s after its begin; \
         bring the parameters nearer to sizes that are met in practice, and look at the supply voltage and the time there"
    )]
    Aborted {
        /// Time since the start of the log (s).
        time_s: f64,
    },
    /// A signal is missing or has another quantity.
    #[error(transparent)]
    MissingSignal(#[from] MissingSignal),
    /// The log has no command for a coil of the plant.
    #[error(
        "{source_name} has no duty cycle `{name}`, but the plant has that coil{}",
        about_missing_command(name, present, meant)
    )]
    NoCommand {
        /// Source of the log.
        source_name: String,
        /// Name of the command.
        name: &'static str,
        /// Signals of the log.
        present: Vec<String>,
        /// Signals and omitted channels that may be the command.
        meant: Vec<String>,
    },
    /// The log has a command without any value.
    #[error(
        "every sample of the duty cycle `{name}` is missing: log it, or leave out the column and say in a mapping what it was: \
         constant.{name} = {{ value = 0, unit = \"pct\" }}"
    )]
    EmptyCommand {
        /// Name of the command.
        name: &'static str,
    },
    /// A signal cannot be converted.
    #[error(transparent)]
    Conversion(#[from] ConversionError),
    /// The simulated signals do not form a valid recording.
    #[error(transparent)]
    Recording(#[from] AddSignalError),
    /// The log has a gap that is too long.
    #[error(
        "no row for {gap_s} s after {after_s} s, longer than {LONGEST_GAP_S} s: cut the log there, or mend its time"
    )]
    Gap {
        /// Time of the last row before the gap (s).
        after_s: f64,
        /// Length of the gap (s).
        gap_s: f64,
    },
    /// The log commands a valve that the plant does not have.
    #[error(
        "the log has a command `{name}` above 0 %, but the plant has no such valve: take a plant file with the valve, or leave out the column"
    )]
    NoCoil {
        /// Name of the signal.
        name: &'static str,
    },
    /// The log has no position of the actuator, or one of another quantity.
    #[error(
        "{0}; the plant's effect actuator_volume is driven by it, so the other way is a plant file without this effect"
    )]
    NoPosition(MissingSignal),
    /// The position of the actuator has no value.
    #[error(
        "every sample of the position `x_actuator` is missing: log it, or leave out the column"
    )]
    EmptyPosition,
    /// The chamber has no volume left at a position of the actuator.
    #[error(
        "at x_actuator = {} mm, the actuator of {} cm2 leaves the chamber no volume: look at the sign and the size of \
         effects.actuator_volume.area_m2, at the unit of x_actuator, and at chamber.volume_m3, which is the volume at position 0",
        (position * 1e4).round() / 10.0, (area * 1e6).round() / 100.0
    )]
    NoVolume {
        /// Position (m).
        position: f64,
        /// Area of the actuator (m²).
        area: f64,
    },
    /// The ambient pressure is a gauge pressure.
    #[error(
        "{source_name}: `p_amb` is a gauge pressure, which is 0 by definition: declare its unit as absolute, as in p_amb_bar_abs"
    )]
    GaugeAmbient {
        /// Source of the log.
        source_name: String,
    },
    /// The surroundings are impossible for a plant.
    #[error("{source_name}: `{name}` {problem}")]
    Surroundings {
        /// Source of the log.
        source_name: String,
        /// Name of the signal.
        name: &'static str,
        /// Value, bounds and remedy.
        problem: String,
    },
    /// The commands have no time base.
    #[error("the duty cycles have no time base")]
    NoTimeBase,
    /// Commands and voltage have different time bases.
    #[error(
        "`{name}` has another time base than the other signals: unite the time bases of the log first"
    )]
    OtherTimeBase {
        /// Name of the signal.
        name: &'static str,
    },
}
