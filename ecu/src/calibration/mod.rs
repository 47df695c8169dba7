//! Calibration interface of a running ECU: signals that a tool reads, settings that it reads and changes.
//!
//! Two tables contain their names and units. A number on the wire is an `i32`; its row defines its meaning. The row
//! numbers are the ids in the messages. The digests of the tables show a host whether it has the same tables.

mod checked;
mod setting;
mod setting_values;
mod signal;

pub use checked::CheckedSettings;
pub use setting::{SETTING_COUNT, SETTINGS, SETTINGS_DIGEST, SettingId};
pub use setting_values::SettingValues;
pub use signal::{MISSING, SIGNAL_COUNT, SIGNALS, SIGNALS_DIGEST, Signal, SignalId, Snapshot};
