use std::fmt;
use std::io;

use crate::Implausible;
use crate::csv::Excerpt;
use crate::plausibility::Code;

/// Budget of [`Limits`](super::Limits).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Budget {
    /// Size of the file (bytes).
    FileBytes,
    /// Size of blocks without data (bytes).
    MetadataBytes,
    /// Number of channels.
    Channels,
    /// Number of samples per channel.
    Samples,
    /// Number of samples of all signals together.
    Values,
    /// Size of one block after unpacking (bytes).
    UnpackedBytes,
}

/// Problem of an MF4 file. Each variant has a stable code.
#[derive(Debug)]
#[non_exhaustive]
pub enum Problem {
    /// The file cannot be read.
    Io(io::Error),
    /// The file does not begin as an MDF file.
    NoMdf {
        /// First bytes of the file.
        found: Excerpt,
    },
    /// The version is not 4.
    Version {
        /// Version in the file, times 100.
        found: u16,
    },
    /// A budget is exceeded.
    Limit {
        /// Exceeded budget.
        budget: Budget,
        /// Value required by the file.
        found: u64,
        /// Bound of the budget.
        bound: u64,
    },
    /// A link leads outside of the file, or to an address where no block may begin.
    Link {
        /// Target of the link, in bytes from the beginning of the file.
        target: u64,
        /// Size of the file (bytes).
        file_bytes: u64,
    },
    /// A block has another identifier than expected.
    BlockId {
        /// Expected identifier.
        expected: &'static str,
        /// Four bytes found in its place.
        found: Excerpt,
    },
    /// A block is longer than the file, or too short for its content.
    BlockLength {
        /// Length given in the block (bytes).
        found: u64,
        /// Smallest possible length (bytes).
        at_least: u64,
        /// Number of bytes up to the end of the file.
        at_most: u64,
    },
    /// A block follows itself, directly or through other blocks.
    Loop,
    /// A field has a value that the format does not allow, or that contradicts another field.
    Field {
        /// Name of the field.
        field: &'static str,
        /// Value of the field.
        found: u64,
        /// Allowed values.
        expected: String,
    },
    /// Packed data cannot be unpacked.
    Packed {
        /// Reason of the failure.
        reason: &'static str,
    },
    /// There is less data than the samples need.
    DataShort {
        /// Number of samples given by the group.
        samples: u64,
        /// Number of samples found.
        found: u64,
    },
    /// A record belongs to a missing group.
    RecordId {
        /// Number of the record's group.
        found: u64,
    },
    /// No channel becomes a signal.
    NoSignal {
        /// First left-out channels, with their reasons.
        left_out: String,
    },
    /// The mapping names a missing channel.
    MappedChannelMissing {
        /// Channel as named by the mapping.
        wanted: String,
        /// Existing channels.
        found: Excerpt,
    },
    /// The mapping names a channel that exists in several groups.
    MappedChannelTwice {
        /// Channel as named by the mapping.
        wanted: String,
        /// Two of the groups, numbered from 1.
        groups: [usize; 2],
    },
    /// The mapping names a channel that cannot be a signal.
    MappedChannelUnusable {
        /// Channel as named by the mapping.
        wanted: String,
        /// Reason why it cannot be a signal.
        reason: String,
    },
    /// The mapping names a column by its number.
    MappedByNumber {
        /// Number in the mapping.
        number: u32,
    },
    /// The mapping defines the time, which MF4 files define themselves.
    MappedTime,
    /// A signal is constant in the mapping, and the file contains it.
    ConstantLogged {
        /// Name of the signal.
        name: String,
    },
    /// The mapping has a constant, and several time bases are possible for it.
    ConstantTimeBase {
        /// Name of the constant.
        name: String,
    },
    /// The mapping keeps no row of the file.
    NoRowKept,
    /// The mapping takes its instants from a missing signal.
    NoInstants {
        /// Name of the signal.
        name: String,
    },
    /// No signal of this unit has such values.
    Implausible {
        /// Number of the sample, from 0.
        sample: u64,
        /// Problem of the sample.
        implausible: Implausible,
    },
}

impl Problem {
    /// Returns the stable code.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Io(_) => "E-MF4-IO",
            Self::NoMdf { .. } => "E-MF4-ID",
            Self::Version { .. } => "E-MF4-VERSION",
            Self::Limit { budget, .. } => match budget {
                Budget::FileBytes => "E-MF4-LIMIT-FILE",
                Budget::MetadataBytes => "E-MF4-LIMIT-METADATA",
                Budget::Channels => "E-MF4-LIMIT-CHANNELS",
                Budget::Samples => "E-MF4-LIMIT-SAMPLES",
                Budget::Values => "E-MF4-LIMIT-VALUES",
                Budget::UnpackedBytes => "E-MF4-LIMIT-UNPACKED",
            },
            Self::Link { .. } => "E-MF4-LINK",
            Self::BlockId { .. } => "E-MF4-BLOCK",
            Self::BlockLength { .. } => "E-MF4-LENGTH",
            Self::Loop => "E-MF4-LOOP",
            Self::Field { .. } => "E-MF4-FIELD",
            Self::Packed { .. } => "E-MF4-PACKED",
            Self::DataShort { .. } => "E-MF4-DATA-SHORT",
            Self::RecordId { .. } => "E-MF4-RECORD-ID",
            Self::NoSignal { .. } => "E-MF4-NO-SIGNAL",
            Self::MappedChannelMissing { .. } => "E-MF4-MAPPED-CHANNEL",
            Self::MappedChannelTwice { .. } => "E-MF4-MAPPED-CHANNEL-TWICE",
            Self::MappedChannelUnusable { .. } => "E-MF4-MAPPED-UNUSABLE",
            Self::MappedByNumber { .. } => "E-MF4-MAPPED-NUMBER",
            Self::MappedTime => "E-MF4-MAPPED-TIME",
            Self::ConstantLogged { .. } => "E-MF4-CONSTANT-LOGGED",
            Self::ConstantTimeBase { .. } => "E-MF4-CONSTANT-TIME-BASE",
            Self::NoRowKept => "E-MF4-NO-ROW-KEPT",
            Self::NoInstants { .. } => "E-MF4-NO-INSTANTS",
            Self::Implausible { implausible, .. } => match implausible.code() {
                Code::DutyRange => "E-MF4-DUTY-RANGE",
                Code::BelowVacuum => "E-MF4-BELOW-VACUUM",
                Code::Bounds => "E-MF4-BOUNDS",
                Code::Scale => "E-MF4-SCALE",
            },
        }
    }

    /// Returns the next step, as an instruction.
    pub fn next_step(&self) -> String {
        let fixed = match self {
            Self::Io(_) => "check that the file exists and may be read",
            Self::NoMdf { .. } => "check that it is the right file, and that it was copied whole",
            Self::Version { .. } => "convert it to MDF 4.1 with the tool that wrote it",
            Self::Limit { .. } => "cut the file, or raise the limit if it is meant",
            Self::Link { .. }
            | Self::BlockId { .. }
            | Self::BlockLength { .. }
            | Self::Loop
            | Self::Field { .. }
            | Self::Packed { .. }
            | Self::DataShort { .. }
            | Self::RecordId { .. } => {
                "the file is damaged: copy it again, or have the tool that wrote it repair it"
            }
            Self::NoSignal { .. } => {
                "map the channels that matter under [signal.NAME] in a mapping"
            }
            Self::MappedChannelMissing { .. } => {
                "use the name of a channel as it stands in the file"
            }
            Self::MappedChannelTwice { wanted, groups } => {
                return format!(
                    "write {:?} for the first of them",
                    format!("{}/{wanted}", groups[0])
                );
            }
            Self::MappedChannelUnusable { .. } => "map another channel",
            Self::MappedByNumber { .. } => "name the channel",
            Self::MappedTime => "leave [time] out: each group of the file has a master channel",
            Self::ConstantLogged { .. } => {
                "take it out of [constant] in the mapping, or list the channel under `ignore`"
            }
            Self::ConstantTimeBase { .. } => {
                "choose the instants by instants_of under [rows] in the mapping"
            }
            Self::NoRowKept => "correct from_s and until_s under [rows] in the mapping",
            Self::NoInstants { .. } => "name a signal of the file by instants_of under [rows]",
            Self::Implausible { implausible, .. } => return implausible.next_step(),
        };
        fixed.to_owned()
    }
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Io(error) => write!(f, "{error}"),
            Self::NoMdf { found } => write!(f, "it begins with {found}, expected \"MDF     \""),
            Self::Version { found } => {
                write!(
                    f,
                    "it is version {}.{:02}, expected 4",
                    found / 100,
                    found % 100
                )
            }
            Self::Limit {
                budget,
                found,
                bound,
            } => {
                let what = match budget {
                    Budget::FileBytes => "the file has",
                    Budget::MetadataBytes => "groups, channels and texts have",
                    Budget::Channels => "channels:",
                    Budget::Samples => "samples in one group:",
                    Budget::Values => "samples in all signals:",
                    Budget::UnpackedBytes => "the unpacked block has",
                };
                let unit = match budget {
                    Budget::FileBytes | Budget::MetadataBytes | Budget::UnpackedBytes => " bytes",
                    Budget::Channels | Budget::Samples | Budget::Values => "",
                };
                write!(f, "{what} {found}{unit}, expected at most {bound}")
            }
            Self::Link { target, file_bytes } => write!(
                f,
                "a link leads to byte {target}, expected a multiple of 8 from 64 to the end of the file at {file_bytes}"
            ),
            Self::BlockId { expected, found } => write!(f, "found {found}, expected {expected:?}"),
            Self::BlockLength {
                found,
                at_least,
                at_most,
            } => write!(
                f,
                "the block says it has {found} bytes, expected {at_least} to {at_most}"
            ),
            Self::Loop => write!(
                f,
                "the block was read already, expected each once in its list"
            ),
            Self::Field {
                field,
                found,
                expected,
            } => write!(f, "{field} is {found}, expected {expected}"),
            Self::Packed { reason } => write!(f, "the packed data {reason}"),
            Self::DataShort { samples, found } => {
                write!(f, "there are {found} whole records, expected {samples}")
            }
            Self::RecordId { found } => {
                write!(
                    f,
                    "found a record of group {found}, expected a group of this list"
                )
            }
            Self::NoSignal { left_out } => {
                write!(f, "no channel can be read as a signal{left_out}")
            }
            Self::MappedChannelMissing { wanted, found } => write!(
                f,
                "found {found}, expected the channel {} of the mapping",
                Excerpt::of(wanted)
            ),
            Self::MappedChannelTwice { wanted, groups } => write!(
                f,
                "groups {} and {} both have {}, expected one channel",
                groups[0],
                groups[1],
                Excerpt::of(wanted)
            ),
            Self::MappedChannelUnusable { wanted, reason } => {
                write!(f, "the mapped channel {}: {reason}", Excerpt::of(wanted))
            }
            Self::MappedByNumber { number } => {
                write!(
                    f,
                    "the mapping says column {number}, expected the name of a channel"
                )
            }
            Self::MappedTime => write!(f, "the mapping chooses a time"),
            Self::ConstantLogged { name } => write!(
                f,
                "found {} in the file, expected it in the mapping alone, where it is constant",
                Excerpt::of(name)
            ),
            Self::ConstantTimeBase { name } => write!(
                f,
                "the constant {} could have the instants of several groups",
                Excerpt::of(name)
            ),
            Self::NoRowKept => {
                write!(f, "every sample is left out, expected at least one to keep")
            }
            Self::NoInstants { name } => write!(f, "there is no signal {}", Excerpt::of(name)),
            Self::Implausible {
                sample,
                implausible,
            } => write!(f, "sample {sample}: {implausible}"),
        }
    }
}
