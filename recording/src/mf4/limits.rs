/// Budgets of a reader: a file beyond them is refused at once. They also bound the memory of the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file (bytes); default 4 GiB.
    pub file_bytes: u64,
    /// Size of all blocks without data, such as groups, channels, conversions and texts (bytes); default 64 MiB.
    pub metadata_bytes: u64,
    /// Number of channels; default 10 000.
    pub channels: u64,
    /// Number of samples per channel; default 10⁸.
    pub samples: u64,
    /// Number of samples of all signals together, each 8 bytes in memory; default 2.5 · 10⁸.
    pub values: u64,
    /// Size of one packed block after unpacking (bytes); default 32 MiB.
    pub unpacked_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 4 << 30,
            metadata_bytes: 64 << 20,
            channels: 10_000,
            samples: 100_000_000,
            values: 250_000_000,
            unpacked_bytes: 32 << 20,
        }
    }
}
