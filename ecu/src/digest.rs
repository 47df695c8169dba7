//! Digest of the complete state of an ECU, as one number.

use core::hash::{Hash, Hasher};

use hil_protocol::crc32;

/// Returns the CRC-32 over every field of `state`, in the order of their declaration, equal on host and target.
pub(crate) fn digest(state: &impl Hash) -> u32 {
    let mut bytes = Bytes {
        bytes: [0; BYTES_MAX],
        length: 0,
    };
    state.hash(&mut bytes);
    bytes.finish() as u32
}

/// Buffer size, larger than all fields together; a test checks it.
pub(crate) const BYTES_MAX: usize = 320;

/// Buffer for the bytes that a derived `Hash` writes.
struct Bytes {
    bytes: [u8; BYTES_MAX],
    length: usize,
}

impl Hasher for Bytes {
    fn write(&mut self, bytes: &[u8]) {
        for (free, &byte) in self.bytes.iter_mut().skip(self.length).zip(bytes) {
            *free = byte;
        }
        self.length = self.length.saturating_add(bytes.len());
    }

    // The number of a variant is the only integer that a derived `Hash` writes in the width of the machine.
    fn write_isize(&mut self, variant: isize) {
        self.write_i32(variant as i32);
    }

    fn finish(&self) -> u64 {
        let written = self.bytes.get(..self.length).unwrap_or(&self.bytes);
        crc32::digest(written).into()
    }
}
