use std::fmt::Write as _;

use crate::StartTime;

/// Key of the notes that a reader adds to those of the file.
pub const READER_NOTE: &str = "reader";

/// Origin of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// File name, or a name in its place: `practice-00-id.csv`, `plant-sim`.
    pub source: String,
    /// Producer of the values: a logger, a program with its version.
    pub producer: Option<String>,
    /// Instant at which its time is 0 s; `None` where it is unknown, as in CSV and in a simulation.
    pub start: Option<StartTime>,
    /// Further remarks, in the given order.
    pub notes: Vec<Note>,
    /// Size and hash of the file from which the values were read.
    pub input: Option<InputFile>,
}

impl Provenance {
    /// Creates a provenance with a source only.
    pub fn from_source(source: impl Into<String>) -> Self {
        Self {
            source: source.into(),
            ..Self::default()
        }
    }

    /// Returns the provenance with one more remark.
    #[must_use]
    pub fn with_note(mut self, key: impl Into<String>, value: impl Into<String>) -> Self {
        self.notes.push(Note {
            key: key.into(),
            value: value.into(),
        });
        self
    }
}

/// Remark, `key: value`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// Subject of the remark.
    pub key: String,
    /// Text of the remark.
    pub value: String,
}

/// Identity of an input file, the only protection against an unnoticed change of a byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Size (bytes).
    pub size_bytes: u64,
    /// SHA-256 of all bytes.
    pub sha256: [u8; 32],
}

impl InputFile {
    /// Returns the hash as 64 lower-case hexadecimal digits.
    pub fn sha256_hex(&self) -> String {
        self.sha256
            .iter()
            .fold(String::with_capacity(64), |mut text, byte| {
                // Writing to a String cannot fail.
                let _ = write!(text, "{byte:02x}");
                text
            })
    }
}
