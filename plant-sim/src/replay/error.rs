//! Why a log cannot be replayed.

use recording::{AddSignalError, ConversionError, MissingSignal};

use super::LONGEST_GAP_S;

/// What the log has instead of a command, and what to do.
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
    /// The simulation was given up before the row at `time_ns`.
    pub fn given_up(time_ns: u64) -> Self {
        Self::GivenUp {
            time_s: time_ns as f64 * 1e-9,
        }
    }
}

/// Why a log cannot be replayed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ReplayError {
    /// The simulation takes more steps than a log of this length may ask for.
    #[error(
        "the plant cannot be simulated on this log in a bounded number of steps: given up {time_s} s after its begin; \
         bring the parameters nearer to sizes that are met in practice, and look at the supply voltage and the time there"
    )]
    GivenUp {
        /// Time since the start of the log (s).
        time_s: f64,
    },
    /// A signal is absent or of another kind.
    #[error(transparent)]
    MissingSignal(#[from] MissingSignal),
    /// A coil of the plant has no command in the log.
    #[error(
        "{source_name} has no duty cycle `{name}`, but the plant has that coil{}",
        about_missing_command(name, present, meant)
    )]
    NoCommand {
        /// Source of the log.
        source_name: String,
        /// The command.
        name: &'static str,
        /// Signals of the log.
        present: Vec<String>,
        /// Those of them, and of the channels that were left out, that may be it.
        meant: Vec<String>,
    },
    /// The log has a command without any value.
    #[error(
        "every sample of the duty cycle `{name}` is missing: log it, or leave out the column and say in a mapping what it was: \
         constant.{name} = {{ value = 0, unit = \"pct\" }}"
    )]
    EmptyCommand {
        /// The command.
        name: &'static str,
    },
    /// A signal cannot be converted.
    #[error(transparent)]
    Conversion(#[from] ConversionError),
    /// The simulated signals do not make a recording.
    #[error(transparent)]
    Recording(#[from] AddSignalError),
    /// A gap that no bench log has.
    #[error(
        "no row for {gap_s} s after {after_s} s, longer than {LONGEST_GAP_S} s: cut the log there, or mend its time"
    )]
    Gap {
        /// Time of the last row before the gap (s).
        after_s: f64,
        /// Length of the gap (s).
        gap_s: f64,
    },
    /// The log commands what is not there.
    #[error(
        "the log has a command `{name}` above 0 %, but the plant has no such coil: take a plant file with the valve, or leave out the column"
    )]
    NoCoil {
        /// The signal.
        name: &'static str,
    },
    /// An ambient pressure over itself.
    #[error(
        "{source_name}: `p_amb` is a gauge pressure, which is 0 by definition: declare its unit as absolute, as in p_amb_bar_abs"
    )]
    GaugeAmbient {
        /// Source of the log.
        source_name: String,
    },
    /// Surroundings that no plant can have.
    #[error("{source_name}: `{name}` {problem}")]
    Surroundings {
        /// Source of the log.
        source_name: String,
        /// The signal.
        name: &'static str,
        /// Value, bounds and remedy.
        problem: String,
    },
    /// The commands have no time base.
    #[error("the duty cycles have no time base")]
    NoTimeBase,
    /// Commands and voltage must be sampled together.
    #[error(
        "`{name}` has another time base than the duty cycles: say in a mapping, under [rows], instants_of = \"duty_fill\""
    )]
    OtherTimeBase {
        /// The signal.
        name: &'static str,
    },
}
