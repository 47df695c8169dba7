//! Messages between host and device.
//!
//! Every integer has a fixed width; none depends on the machine. The value of a signal or a setting is an `i32` whose
//! meaning (name, unit, fraction bits, or the names of choices) is defined in the device's tables. The digests of the
//! tables are part of the [`Identity`].

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use crate::counters::LinkCounters;

/// Version of the wire format: messages, frames and sessions. It is raised whenever a bit of them changes its meaning.
pub const VERSION: u16 = 1;

/// Number of words of the controller's state in the [`Telemetry`].
pub const STATE_WORDS: usize = 6;

/// Maximum number of values of signals or settings in one message.
pub const VALUES_MAX: usize = 64;

/// Maximum number of signals that are measured at once.
pub const MEASURED_MAX: usize = 16;

/// Maximum number of black box records in one page.
pub const RECORDS_MAX: usize = 16;

/// Maximum number of log bytes in one message.
pub const LOG_MAX: usize = 512;

/// Values of consecutive settings, or of signals in the order in which they were requested.
pub type Values = Vec<i32, VALUES_MAX>;

/// Numbers of signals that are measured together.
pub type SignalIds = Vec<u16, MEASURED_MAX>;

/// Values of measured signals, in the order of their [`SignalIds`].
pub type Measured = Vec<i32, MEASURED_MAX>;

/// Name of a board, or a version.
pub type Name = String<32>;

/// Creates a [`Name`], cut off at its maximum length; a text that is not ASCII gives an empty name.
///
/// The list's own conversion from text contains a panic when overflow is checked.
pub fn name(text: &str) -> Name {
    let mut bytes = Vec::new();
    for byte in text.bytes() {
        if bytes.push(byte).is_err() {
            break;
        }
    }
    Name::from_utf8(bytes).unwrap_or_default()
}

/// Bytes of the device's log, as the logging framework encoded them.
pub type LogBytes = Vec<u8, LOG_MAX>;

/// Measured values and reference of the ECU in one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Sensors {
    /// Number of the sample, from 0.
    pub sample: u32,
    /// Time since the previous sample by the ECU's clock (µs); nominally 10 000.
    pub elapsed_us: u32,
    /// Reference for the chamber pressure (2⁻¹⁶ bar gauge); `None`: no valid message in this sample.
    pub reference: Option<i32>,
    /// Code of the pressure sensor, 12 bits; `None`: the converter did not answer.
    pub pressure: Option<u16>,
    /// Current of the fill valve's coil, mean over the last PWM period (mA); `None`: not measured.
    pub current_fill_ma: Option<u16>,
    /// Current of the vent valve's coil, mean over the last PWM period (mA); `None`: not measured.
    pub current_vent_ma: Option<u16>,
    /// Supply voltage of the ECU (mV); `None`: not measured.
    pub battery_mv: Option<u16>,
}

/// Duty cycles of the two coils until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Actuators {
    /// Duty cycle of the fill valve's coil (2⁻¹⁶ %), 0 ..= 100 %.
    pub duty_fill: u32,
    /// Duty cycle of the vent valve's coil (2⁻¹⁶ %), 0 ..= 100 %.
    pub duty_vent: u32,
}

impl Actuators {
    /// Both coils without current.
    pub const OFF: Self = Self {
        duty_fill: 0,
        duty_vent: 0,
    };
}

/// Internal values of the ECU after a sample, to be logged and compared bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Telemetry {
    /// Control signal u (2⁻¹² %), -100 ..= 100 %.
    pub control_signal: i32,
    /// State of the controller after the sample.
    pub controller_state: [i32; STATE_WORDS],
    /// Mode of the supervisor; `ecu::Mode` has the names.
    pub mode: u8,
    /// Faults that are present or latched, one bit each; `ecu::Fault` has the names.
    pub faults: u32,
    /// CRC-32 over every other word of the ECU's state.
    pub ecu_digest: u32,
}

/// Answer of the ECU to [`Sensors`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Answer {
    /// Number of the answered sample.
    pub sample: u32,
    /// Duty cycles of the coils.
    pub actuators: Actuators,
    /// Internal values of the ECU.
    pub telemetry: Telemetry,
}

/// Request from the host to the device.
#[expect(
    clippy::large_enum_variant,
    reason = "one at a time exists, and there is no allocator to box with"
)]
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Request {
    /// Opens a session; the first request of each. Answered by [`Reply::Identity`].
    Hello {
        /// Version of the host's wire format.
        version: u16,
        /// Whether the control task runs once per [`Request::Sample`] and not by its timer.
        lock_step: bool,
    },
    /// One sample in lock step. Answered by [`Reply::Sample`].
    Sample(Sensors),
    /// Reads one signal. Answered by [`Reply::Values`] with one number.
    Signal {
        /// Number of the signal in the table of signals.
        id: u16,
    },
    /// Chooses the signals that are sent with each sample from now on; an empty list ends it. Answered by
    /// [`Reply::Done`].
    Measure {
        /// Numbers of the signals in the table of signals.
        ids: SignalIds,
    },
    /// Reads settings in effect. Answered by [`Reply::Values`] with all that exist and fit.
    Settings {
        /// Number of the first setting in the table of settings.
        first: u16,
    },
    /// Writes settings into the shadow copy; nothing takes effect yet. Answered by [`Reply::Done`].
    Write {
        /// Number of the first setting in the table of settings.
        first: u16,
        /// New values of this setting and of those that follow.
        values: Values,
    },
    /// Validates the shadow copy as a whole and applies it from the next sample on. Answered by [`Reply::Done`].
    Apply {
        /// CRC-32 over all values of the shadow copy as the host expects it
        /// ([`values_digest`](crate::crc32::values_digest)).
        digest: u32,
    },
    /// Resets the shadow copy to the settings in effect. Answered by [`Reply::Done`].
    Discard,
    /// Resets the shadow copy to the built-in settings. Answered by [`Reply::Done`].
    Defaults,
    /// Saves the settings in effect for the next start. Answered by [`Reply::Done`].
    Save,
    /// Reads a page of the black box. Answered by [`Reply::BlackBox`].
    BlackBox {
        /// Number of the page, from 0, oldest first.
        page: u16,
    },
    /// Clears the black box, which then records again. Answered by [`Reply::Done`].
    ClearBlackBox,
    /// Takes bytes from the device's log. Answered by [`Reply::Log`].
    Log,
    /// Reads the device's frame counters. Answered by [`Reply::Counters`].
    Counters,
    /// Restarts the ECU's logic, as after a reset with this cause; machine and session continue. Answered by
    /// [`Reply::Done`].
    Restart {
        /// Cause that the ECU gets.
        cause: ResetCause,
    },
    /// Resets the machine after the answer, which is [`Reply::Done`]; the session ends.
    Reset,
}

/// Reply from the device to the host.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reply {
    /// Identity of the device: answer to [`Request::Hello`].
    Identity(Identity),
    /// Refusal: the request had no effect.
    Refused(Refusal),
    /// Answer to [`Request::Sample`].
    Sample {
        /// Duty cycles and state.
        answer: Answer,
        /// Signals chosen by [`Request::Measure`], after this sample.
        measured: Measured,
    },
    /// Answer to [`Request::Signal`] and [`Request::Settings`].
    Values {
        /// Number of the first one in its table.
        first: u16,
        /// Value of the first one, and values of those that follow.
        values: Values,
    },
    /// Confirmation of the request.
    Done,
    /// Answer to [`Request::BlackBox`].
    BlackBox(BlackBoxPage),
    /// Answer to [`Request::Log`].
    Log {
        /// Oldest bytes not taken before.
        bytes: LogBytes,
        /// Number of bytes that were overwritten before they were taken, since the start.
        lost: u32,
    },
    /// Answer to [`Request::Counters`].
    Counters(LinkCounters),
    /// Unsolicited message, once per sample while signals are measured and the timer runs the control task.
    Measured {
        /// Number of the sample.
        sample: u32,
        /// Values of the signals, after this sample.
        values: Measured,
    },
}

/// Identity of the device, and its state when the session was opened.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the device's wire format.
    pub version: u16,
    /// Number that differs from boot to boot of this device; part of the session's number from here on.
    pub boot: u32,
    /// Image of the device.
    pub image: ImageIdentity,
    /// Cause of the last reset.
    pub reset_cause: ResetCause,
    /// Source of its settings.
    pub settings_source: SettingsSource,
    /// CRC-32 over the values of the settings in effect.
    pub settings_digest: u32,
}

/// Identity of the running image and its board.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageIdentity {
    /// Name of the board.
    pub board: Name,
    /// Version of the firmware.
    pub version: Name,
    /// Number that differs from build to build; 0: not known.
    pub build: u32,
    /// CRC-32 over the table of signals: if it is equal, host and device have the same table.
    pub signals: u32,
    /// CRC-32 over the table of settings.
    pub settings: u32,
}

/// Cause of a device's start.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetCause {
    /// The supply was switched on.
    PowerOn,
    /// The supply voltage fell below the part's minimum.
    Brownout,
    /// The reset pin was activated.
    Pin,
    /// The image reset the machine on request of the host.
    Software,
    /// The watchdog was not fed.
    Watchdog,
    /// The image panicked.
    Panic,
    /// The processor took a fault exception.
    Exception,
    /// The hardware does not report the cause.
    Unknown,
}

/// Source of the settings in effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SettingsSource {
    /// Stored copy.
    Stored {
        /// Number of the copy, 0 or 1.
        copy: u8,
        /// Number of saves.
        sequence: u32,
        /// Whether the other copy is damaged; the next save repairs it.
        other_damaged: bool,
    },
    /// Built-in settings: nothing was ever saved.
    DefaultsNeverSaved,
    /// Built-in settings: the saved ones are damaged, or not of this image. To be reported.
    DefaultsDamaged,
    /// Settings written over the link since the start.
    Link,
}

/// Reason why a request had no effect, with the found and the required value.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The device has another protocol version.
    #[error(
        "the device speaks version {device} of the protocol, not {VERSION}: use the tools that came with its image"
    )]
    Version {
        /// Version of the device's wire format.
        device: u16,
    },
    /// The session is unknown to the device: it was reset, or another host opened one.
    #[error(
        "the device knows no such session: it was reset, or another host opened one; open a new one"
    )]
    NoSession,
    /// An earlier request is missing.
    #[error("request {found} came where {expected} was due")]
    Skipped {
        /// Expected number.
        expected: u32,
        /// Received number.
        found: u32,
    },
    /// The frame is undamaged, but the device does not know its message.
    #[error("the device does not know this message")]
    UnknownMessage,
    /// A sample was sent while the timer runs the control task.
    #[error("samples are taken from the link in lock step only: open the session with it")]
    NotInLockStep,
    /// The signal does not exist.
    #[error("signal {id} does not exist: the last one is {last}")]
    UnknownSignal {
        /// Requested number.
        id: u16,
        /// Largest number in the table.
        last: u16,
    },
    /// The setting does not exist.
    #[error("setting {id} does not exist: the last one is {last}")]
    UnknownSetting {
        /// Requested number.
        id: u16,
        /// Largest number in the table.
        last: u16,
    },
    /// The shadow copy differs from what the host expects: part of a change is missing, or another host's change is in
    /// it.
    #[error(
        "the change is torn: its digest is {found:#010x}, the host's {expected:#010x}; discard it and write it again"
    )]
    Torn {
        /// Digest expected by the host.
        expected: u32,
        /// Digest of the device's shadow copy.
        found: u32,
    },
    /// A setting is outside its range, or outside the range that another setting leaves.
    #[error(
        "setting {id} = {value} is out of range: must be {min} ..= {max}, in units of its table"
    )]
    OutOfRange {
        /// Number of the setting in the table of settings.
        id: u16,
        /// Value in the shadow copy.
        value: i32,
        /// Smallest allowed value.
        min: i32,
        /// Largest allowed value.
        max: i32,
        /// Setting that gives the bound, if the bound is not fixed.
        bound_by: Option<u16>,
    },
    /// Coefficient beyond the range of the arithmetic, computed from settings that are each within their own range.
    #[error(
        "setting {id} and those it is multiplied with give {value}, in units of 2^-32: must be {min} ..= {max}"
    )]
    Product {
        /// Setting to change first.
        id: u16,
        /// Value of the product.
        value: i64,
        /// Smallest allowed value.
        min: i64,
        /// Largest allowed value.
        max: i64,
    },
    /// A valve is in use, so flash must not be written: erasing can stop the processor for many samples.
    #[error("settings are saved only while both coils are off and nothing is asked for")]
    ValvesInUse,
    /// The storage reported a fault.
    #[error(
        "the settings could not be saved: the storage reports a fault; what was saved before is still there"
    )]
    Storage,
    /// The page does not exist.
    #[error("page {page} does not exist: the black box has {pages}")]
    UnknownPage {
        /// Requested page.
        page: u16,
        /// Number of pages.
        pages: u16,
    },
    /// The device does not support the request.
    #[error("this device cannot do that")]
    Unsupported,
}

/// Page of the black box, with the data common to all pages.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlackBoxPage {
    /// Status of the black box.
    pub status: BlackBoxStatus,
    /// Number of this page.
    pub page: u16,
    /// Number of pages.
    pub pages: u16,
    /// Number of torn records in this page's range; they are left out.
    pub torn: u16,
    /// Records, oldest first.
    pub records: Vec<BlackBoxRecord, RECORDS_MAX>,
}

/// Status of the black box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BlackBoxStatus {
    /// Recording; no fault occurred.
    Recording,
    /// Recording continues for a limited time after the first fault.
    Triggered {
        /// Number of the record with the first fault.
        number: u32,
        /// Faults in this record.
        faults: u32,
    },
    /// Frozen after a fault.
    Frozen {
        /// Number of the record with the first fault.
        number: u32,
        /// Faults in this record.
        faults: u32,
    },
    /// Frozen by a reset of the device during the recording.
    FrozenByReset,
}

/// Record of one sample in the black box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct BlackBoxRecord {
    /// Number of the record since the black box was cleared.
    pub number: u32,
    /// Reference (2⁻¹⁶ bar gauge); `None`: no valid message.
    pub reference: Option<i32>,
    /// Code of the pressure sensor; `None`: the converter did not answer.
    pub pressure: Option<u16>,
    /// Duty cycle of the fill valve's coil (2⁻¹⁶ %).
    pub duty_fill: u32,
    /// Duty cycle of the vent valve's coil (2⁻¹⁶ %).
    pub duty_vent: u32,
    /// Control signal u (2⁻¹² %).
    pub control_signal: i32,
    /// Mode of the supervisor.
    pub mode: u8,
    /// Faults, one bit each.
    pub faults: u32,
}
