//! What a calibration tool sees of an ECU while it runs: signals that it reads, settings that it reads and changes.
//!
//! Two tables name them, with their units. A number on the wire is an `i32`; its meaning stands in its row. The numbers of
//! the rows are the ids of the messages; the digests of the tables tell a host whether it has the same tables.

mod checked;
mod setting;
mod setting_values;
mod signal;

pub use checked::CheckedSettings;
pub use setting::{SETTING_COUNT, SETTINGS, SETTINGS_DIGEST, Setting, SettingId};
pub use setting_values::SettingValues;
pub use signal::{MISSING, SIGNAL_COUNT, SIGNALS, SIGNALS_DIGEST, Signal, SignalId, Snapshot};
