//! Result of a device, for the outputs.

use hil_harness::Difference;

/// Identity and behaviour of a device, apart from the verdict on the loop.
pub(crate) struct DeviceReport {
    /// Kind, version and connection.
    pub(crate) identity: String,
    /// Decoded log, oldest line first.
    pub(crate) log: Vec<String>,
    /// Samples that crossed the wire, with the lead-in.
    pub(crate) samples: usize,
    /// First sample with a different answer of the ECU in process.
    pub(crate) difference: Option<Difference>,
}
