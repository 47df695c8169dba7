/// Budgets of a reader: a file beyond them is refused. They also bound the memory of the reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the file (bytes), which is read into memory; default 1 GiB.
    pub file_bytes: u64,
    /// Number of columns or variables; default 4096.
    pub columns: usize,
    /// Number of values of all columns together, each 8 bytes in memory; default 10⁸.
    pub values: u64,
    /// Size of one packed variable or chunk after unpacking (bytes); default 1 GiB.
    pub unpacked_bytes: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            file_bytes: 1 << 30,
            columns: 4096,
            values: 100_000_000,
            unpacked_bytes: 1 << 30,
        }
    }
}
