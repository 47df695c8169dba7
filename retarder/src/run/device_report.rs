//! What came of a device, for whoever shows it.

use hil_harness::Difference;

/// What a device is, beside how its loop stands.
pub(crate) struct DeviceReport {
    /// Kind, version, and over what it was reached.
    pub(crate) identity: String,
    /// Decoded, oldest line first.
    pub(crate) log: Vec<String>,
    /// Samples that crossed the wire, with the lead-in.
    pub(crate) samples: usize,
    /// The first sample in which the ECU in process answers otherwise.
    pub(crate) difference: Option<Difference>,
}
