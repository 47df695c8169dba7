use std::fmt::Write as _;

use crate::StartTime;

/// Where a recording comes from.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Provenance {
    /// File name, or what stands for one: `practice-00-id.csv`, `plant-sim`.
    pub source: String,
    /// Who or what produced the values: a logger, a program with its version.
    pub producer: Option<String>,
    /// Instant at which its time is 0 s \[ns since 1970\]; none where nobody knows, as in CSV and in a simulation.
    pub start: Option<StartTime>,
    /// Further remarks in the order given.
    pub notes: Vec<Note>,
    /// Size and hash of the file the values were read from.
    pub input: Option<InputFile>,
}

impl Provenance {
    /// Provenance with a source and nothing else.
    pub fn from_source(source: impl Into<String>) -> Self {
        Self {
            source: source.into(),
            ..Self::default()
        }
    }

    /// The same with one more remark.
    #[must_use]
    pub fn with_note(mut self, key: impl Into<String>, value: impl Into<String>) -> Self {
        self.notes.push(Note {
            key: key.into(),
            value: value.into(),
        });
        self
    }
}

/// A remark, `key: value`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note {
    /// What the remark is about.
    pub key: String,
    /// What it says.
    pub value: String,
}

/// Identity of an input file: the only defence against a byte that changed unseen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InputFile {
    /// Size in bytes.
    pub size_bytes: u64,
    /// SHA-256 of all bytes.
    pub sha256: [u8; 32],
}

impl InputFile {
    /// The hash as 64 lower-case hexadecimal digits.
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
