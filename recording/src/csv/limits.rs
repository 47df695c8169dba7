/// Budgets of a reader: a file beyond them is refused at once. They also bound the memory of the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file (bytes); default 4 GiB.
    pub file_bytes: u64,
    /// Length of a record (a line, or several inside quotes), in bytes; default 1 MiB.
    pub record_bytes: usize,
    /// Length of a field (bytes); default 64 KiB.
    pub field_bytes: usize,
    /// Number of columns; default 4096.
    pub columns: usize,
    /// Number of samples per signal; default 10⁸.
    pub samples: u64,
    /// Number of rows that cannot be accepted and are skipped and listed; default 0.
    pub bad_rows: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 4 << 30,
            record_bytes: 1 << 20,
            field_bytes: 64 << 10,
            columns: 4096,
            samples: 100_000_000,
            bad_rows: 0,
        }
    }
}
