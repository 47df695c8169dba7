//! What the image tells: values on the target, text on the host.

use ecu::{FaultSet, Mode, ResetCause};
use hil_protocol::SettingsSource;

use crate::pace::Pace;
use crate::retained::Farewell;

/// One line of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Event {
    /// The image runs; the coils are off.
    Started {
        /// How often it started since the supply came.
        boot: u32,
        /// Why.
        cause: ResetCause,
        /// What the life before said.
        farewell: Option<Farewell>,
    },
    /// The settings were chosen.
    Settings {
        /// Where they come from.
        source: SettingsSource,
    },
    /// A host opened a session.
    Session {
        /// Who sets the pace from now on.
        pace: Pace,
    },
    /// The supervisor changed its mode, or the faults changed.
    Supervisor {
        /// Number of the sample.
        sample: u32,
        /// Mode from this sample on.
        mode: Mode,
        /// Faults that are present or latched.
        faults: FaultSet,
    },
    /// The sample timer came more than once since the last sample.
    TicksMissed {
        /// Number of the sample that came late.
        sample: u32,
        /// How many samples were missed.
        missed: u32,
    },
}
