//! What host and device say to each other.
//!
//! Every integer has a definite width; none depends on the machine. A number of a signal or a setting is an `i32` whose
//! meaning (name, unit, fraction bits, or the names of choices) stands in the device's tables; the digests of the tables
//! are part of the [`Identity`].

use heapless::{String, Vec};
use serde::{Deserialize, Serialize};

use crate::counters::LinkCounters;

/// Version of the wire format: messages, frames and sessions. Raised whenever a bit of them changes its meaning.
pub const VERSION: u16 = 1;

/// Words of the controller's state in the [`Telemetry`].
pub const STATE_WORDS: usize = 6;

/// Most numbers of signals or settings in one message.
pub const VALUES_MAX: usize = 64;

/// Most signals that are measured at once.
pub const MEASURED_MAX: usize = 16;

/// Most records of the black box in one page.
pub const RECORDS_MAX: usize = 16;

/// Most bytes of the log in one message.
pub const LOG_MAX: usize = 512;

/// Numbers of consecutive settings, or of signals in the order in which they were asked for.
pub type Values = Vec<i32, VALUES_MAX>;

/// Numbers of signals that are measured together.
pub type SignalIds = Vec<u16, MEASURED_MAX>;

/// Numbers of measured signals, in the order of their [`SignalIds`].
pub type Measured = Vec<i32, MEASURED_MAX>;

/// Name of a board, or a version.
pub type Name = String<32>;

/// A name, cut where it is longer than a [`Name`] can be; of ASCII, or it is empty.
///
/// The list's own way from text keeps a panic when overflow is checked.
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

/// What the ECU measures and is asked for in one sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Sensors {
    /// Number of the sample, from 0.
    pub sample: u32,
    /// Time since the sample before by the ECU's clock \[µs\]; 10 000 nominal.
    pub elapsed_us: u32,
    /// Reference of the chamber pressure [2⁻¹⁶ bar gauge]; none: no valid message in this sample.
    pub reference: Option<i32>,
    /// Code of the pressure sensor, 12 bits; none: the converter did not answer.
    pub pressure: Option<u16>,
    /// Current of the fill valve's coil, mean over the last PWM period \[mA\]; none: not measured.
    pub current_fill_ma: Option<u16>,
    /// Current of the vent valve's coil, mean over the last PWM period \[mA\]; none: not measured.
    pub current_vent_ma: Option<u16>,
    /// Supply voltage of the ECU \[mV\]; none: not measured.
    pub battery_mv: Option<u16>,
}

/// Duty cycles of the two coils until the next sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Actuators {
    /// Coil of the fill valve [2⁻¹⁶ %], 0 ..= 100 %.
    pub duty_fill: u32,
    /// Coil of the vent valve [2⁻¹⁶ %], 0 ..= 100 %.
    pub duty_vent: u32,
}

impl Actuators {
    /// Both coils without current.
    pub const OFF: Self = Self {
        duty_fill: 0,
        duty_vent: 0,
    };
}

/// What a sample left inside the ECU, to be logged and compared bit for bit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Telemetry {
    /// Control signal u [2⁻¹² %], -100 ..= 100 %.
    pub control_signal: i32,
    /// The controller's state after the sample.
    pub controller_state: [i32; STATE_WORDS],
    /// The supervisor's mode; `ecu::Mode` has the names.
    pub mode: u8,
    /// The faults that are present or latched, one bit each; `ecu::Fault` has the names.
    pub faults: u32,
    /// CRC-32 over every other word of the ECU's state.
    pub ecu_digest: u32,
}

/// What the ECU answers to [`Sensors`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Answer {
    /// Number of the sample that is answered.
    pub sample: u32,
    /// What the coils get.
    pub actuators: Actuators,
    /// What is inside.
    pub telemetry: Telemetry,
}

/// From the host to the device.
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
        /// Its number in the table of signals.
        id: u16,
    },
    /// Chooses what comes with each sample from now on; none ends it. Answered by [`Reply::Done`].
    Measure {
        /// Their numbers in the table of signals.
        ids: SignalIds,
    },
    /// Reads settings that are in effect. Answered by [`Reply::Values`]: as many as there are and fit.
    Settings {
        /// Number of the first one in the table of settings.
        first: u16,
    },
    /// Writes settings into the shadow copy; nothing takes effect yet. Answered by [`Reply::Done`].
    Write {
        /// Number of the first one in the table of settings.
        first: u16,
        /// New numbers of this one and of those that follow.
        values: Values,
    },
    /// Validates the shadow copy as a whole and puts it into effect with the next sample. Answered by [`Reply::Done`].
    Apply {
        /// CRC-32 over all numbers of the shadow copy as the host means it ([`values_digest`](crate::crc32::values_digest)).
        digest: u32,
    },
    /// Makes the shadow copy equal to what is in effect. Answered by [`Reply::Done`].
    Discard,
    /// Makes the shadow copy equal to the built-in settings. Answered by [`Reply::Done`].
    Defaults,
    /// Keeps what is in effect for the next start. Answered by [`Reply::Done`].
    Save,
    /// Reads a page of the black box. Answered by [`Reply::BlackBox`].
    BlackBox {
        /// Number of the page, from 0, oldest first.
        page: u16,
    },
    /// Empties the black box and lets it record again. Answered by [`Reply::Done`].
    ClearBlackBox,
    /// Takes bytes from the device's log. Answered by [`Reply::Log`].
    Log,
    /// Reads what the device counted on the link. Answered by [`Reply::Counters`].
    Counters,
    /// Starts the ECU's logic again, as after a reset with this cause; machine and session go on. Answered by [`Reply::Done`].
    Restart {
        /// What the ECU is told.
        cause: ResetCause,
    },
    /// Resets the machine after the answer, which is [`Reply::Done`]; the session ends.
    Reset,
}

/// From the device to the host.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Reply {
    /// Who answers: to [`Request::Hello`].
    Identity(Identity),
    /// The request had no effect.
    Refused(Refusal),
    /// To [`Request::Sample`].
    Sample {
        /// Duty cycles and state.
        answer: Answer,
        /// Signals chosen by [`Request::Measure`], after this sample.
        measured: Measured,
    },
    /// To [`Request::Signal`] and [`Request::Settings`].
    Values {
        /// Number of the first one in its table.
        first: u16,
        /// Its number, and those of the ones that follow.
        values: Values,
    },
    /// The request was carried out.
    Done,
    /// To [`Request::BlackBox`].
    BlackBox(BlackBoxPage),
    /// To [`Request::Log`].
    Log {
        /// The oldest bytes not taken before.
        bytes: LogBytes,
        /// Bytes that were overwritten before anybody took them, since the start.
        lost: u32,
    },
    /// To [`Request::Counters`].
    Counters(LinkCounters),
    /// Without request, once per sample while signals are measured and the timer runs the control task.
    Measured {
        /// Number of the sample.
        sample: u32,
        /// The signals, after this sample.
        values: Measured,
    },
}

/// Who answers, in which state it was found.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    /// Version of the device's wire format.
    pub version: u16,
    /// A number that differs from boot to boot of this device; part of the session's number from here on.
    pub boot: u32,
    /// The image.
    pub image: ImageIdentity,
    /// Why it started.
    pub reset_cause: ResetCause,
    /// Where its settings come from.
    pub settings_source: SettingsSource,
    /// CRC-32 over the numbers of the settings in effect.
    pub settings_digest: u32,
}

/// Which image runs, on what.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ImageIdentity {
    /// The board's name.
    pub board: Name,
    /// Version of the firmware.
    pub version: Name,
    /// A number that differs from build to build; 0: not known.
    pub build: u32,
    /// CRC-32 over the table of signals: host and device mean the same if it is the same.
    pub signals: u32,
    /// CRC-32 over the table of settings.
    pub settings: u32,
}

/// Why a device started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ResetCause {
    /// The supply came.
    PowerOn,
    /// The supply sagged below what the part needs.
    Brownout,
    /// Somebody pulled the reset pin.
    Pin,
    /// The image asked for it, by request of the host.
    Software,
    /// The watchdog was not served.
    Watchdog,
    /// The image panicked.
    Panic,
    /// The processor took a fault exception.
    Exception,
    /// The part does not tell.
    Unknown,
}

/// Where the settings in effect come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SettingsSource {
    /// A stored copy.
    Stored {
        /// 0 or 1.
        copy: u8,
        /// Counts the saves.
        sequence: u32,
        /// Whether the other copy is damaged: the next save mends it.
        other_damaged: bool,
    },
    /// Built in: nothing was ever saved.
    DefaultsNeverSaved,
    /// Built in: what was saved is damaged, or not of this image. To be reported.
    DefaultsDamaged,
    /// Set over the link since the start.
    Link,
}

/// Why a request had no effect, with what was found and what would have been right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Refusal {
    /// The device speaks another version.
    #[error(
        "the device speaks version {device} of the protocol, not {VERSION}: use the tools that came with its image"
    )]
    Version {
        /// Version of the device's wire format.
        device: u16,
    },
    /// The device knows no such session: it was reset, or another host opened one.
    #[error(
        "the device knows no such session: it was reset, or another host opened one; open a new one"
    )]
    NoSession,
    /// A request is missing before this one.
    #[error("request {found} came where {expected} was due")]
    Skipped {
        /// Number that was due.
        expected: u32,
        /// Number that came.
        found: u32,
    },
    /// The frame was undamaged, its message is none that the device knows.
    #[error("the device does not know this message")]
    UnknownMessage,
    /// A sample was sent, and the timer runs the control task.
    #[error("samples are taken from the link in lock step only: open the session with it")]
    NotInLockStep,
    /// No such signal.
    #[error("signal {id} does not exist: the last one is {last}")]
    UnknownSignal {
        /// What was asked for.
        id: u16,
        /// Largest number in the table.
        last: u16,
    },
    /// No such setting.
    #[error("setting {id} does not exist: the last one is {last}")]
    UnknownSetting {
        /// What was asked for.
        id: u16,
        /// Largest number in the table.
        last: u16,
    },
    /// The shadow copy is not what the host means: part of a change is missing, or somebody else's is in it.
    #[error(
        "the change is torn: its digest is {found:#010x}, the host's {expected:#010x}; discard it and write it again"
    )]
    Torn {
        /// The host's digest.
        expected: u32,
        /// The device's digest of its shadow copy.
        found: u32,
    },
    /// A setting is out of its range, or of the range that another one leaves it.
    #[error(
        "setting {id} = {value} is out of range: must be {min} ..= {max}, in units of its table"
    )]
    OutOfRange {
        /// Its number in the table of settings.
        id: u16,
        /// What the shadow copy holds.
        value: i32,
        /// Smallest allowed value.
        min: i32,
        /// Largest allowed value.
        max: i32,
        /// The setting that gives the bound, if it is not a fixed one.
        bound_by: Option<u16>,
    },
    /// Settings that are fine alone and together give a coefficient that the arithmetic does not hold.
    #[error(
        "setting {id} and those it is multiplied with give {value}, in units of 2^-32: must be {min} ..= {max}"
    )]
    Product {
        /// The setting to change first.
        id: u16,
        /// What the product comes to.
        value: i64,
        /// Smallest allowed value.
        min: i64,
        /// Largest allowed value.
        max: i64,
    },
    /// Flash must not be written while a valve is in use: erasing can stop the processor for many samples.
    #[error("settings are saved only while both coils are off and nothing is asked for")]
    ValvesInUse,
    /// The storage refused.
    #[error(
        "the settings could not be saved: the storage reports a fault; what was saved before is still there"
    )]
    Storage,
    /// No such page.
    #[error("page {page} does not exist: the black box has {pages}")]
    UnknownPage {
        /// What was asked for.
        page: u16,
        /// How many there are.
        pages: u16,
    },
    /// This device cannot do that.
    #[error("this device cannot do that")]
    Unsupported,
}

/// A page of the black box, and what all pages have in common.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct BlackBoxPage {
    /// What it is doing.
    pub status: BlackBoxStatus,
    /// Number of this page.
    pub page: u16,
    /// How many pages there are.
    pub pages: u16,
    /// Records of this page that a reset tore; they are left out.
    pub torn: u16,
    /// Oldest first.
    pub records: Vec<BlackBoxRecord, RECORDS_MAX>,
}

/// What the black box is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BlackBoxStatus {
    /// It records; nothing happened.
    Recording,
    /// A first fault came; it records a little longer.
    Triggered {
        /// Number of the record in which it came.
        number: u32,
        /// The faults then.
        faults: u32,
    },
    /// It keeps what it has.
    Frozen {
        /// Number of the record in which the first fault came.
        number: u32,
        /// The faults then.
        faults: u32,
    },
    /// It was recording when the device was reset, and keeps what it has.
    FrozenByReset,
}

/// One sample in the black box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct BlackBoxRecord {
    /// Counts the records since the black box was emptied.
    pub number: u32,
    /// Reference [2⁻¹⁶ bar gauge]; none: no valid message.
    pub reference: Option<i32>,
    /// Code of the pressure sensor; none: the converter did not answer.
    pub pressure: Option<u16>,
    /// Coil of the fill valve [2⁻¹⁶ %].
    pub duty_fill: u32,
    /// Coil of the vent valve [2⁻¹⁶ %].
    pub duty_vent: u32,
    /// Control signal u [2⁻¹² %].
    pub control_signal: i32,
    /// The supervisor's mode.
    pub mode: u8,
    /// The faults.
    pub faults: u32,
}
