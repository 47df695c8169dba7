//! Events that the image logs: values on the target, text on the host.

use ecu::{FaultSet, Mode, ResetCause};
use hil_protocol::SettingsSource;

use crate::pace::Pace;
use crate::retained::ResetReason;

/// Line of the log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum Event {
    /// The image started; the coils are off.
    Started {
        /// Number of starts since power-on.
        boot: u32,
        /// Cause of the start.
        cause: ResetCause,
        /// Reason that the image stored before the reset.
        reset_reason: Option<ResetReason>,
    },
    /// The settings were chosen.
    Settings {
        /// Source of the settings.
        source: SettingsSource,
    },
    /// A host opened a session.
    Session {
        /// Source of the pace from now on.
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
        /// Number of missed samples.
        missed: u32,
    },
}
