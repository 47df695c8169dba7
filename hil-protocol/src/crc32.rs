//! CRC-32 of Ethernet and zlib (ISO-HDLC), which common tools compute as well.
//!
//! It is implemented here because the usual crate contains panics when overflow is checked. The tests compare it with
//! that crate.

/// Polynomial of IEEE 802.3, lowest bit first.
const POLYNOMIAL: u32 = 0xEDB8_8320;

/// Effect of each byte on the remainder.
static TABLE: [u32; 256] = table();

const fn table() -> [u32; 256] {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < table.len() {
        let mut remainder = byte as u32;
        let mut bit = 0;
        while bit < u8::BITS {
            let carry = remainder & 1;
            remainder = (remainder >> 1) ^ (POLYNOMIAL * carry);
            bit += 1;
        }
        table[byte] = remainder;
        byte += 1;
    }
    table
}

/// Returns the CRC-32 of bytes.
pub fn digest(bytes: &[u8]) -> u32 {
    let mut digest = Digest::new();
    for &byte in bytes {
        digest.update(byte);
    }
    digest.value()
}

/// Returns the CRC-32 of numbers, each as four bytes, lowest first.
pub fn values_digest(values: &[i32]) -> u32 {
    let mut digest = Digest::new();
    for value in values {
        digest.update_word(value.cast_unsigned());
    }
    digest.value()
}

/// CRC-32 of successive bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digest {
    remainder: u32,
}

impl Digest {
    /// Creates the digest of no bytes.
    pub const fn new() -> Self {
        Self {
            remainder: u32::MAX,
        }
    }

    /// Adds one byte.
    #[inline]
    pub const fn update(&mut self, byte: u8) {
        let [low, ..] = self.remainder.to_le_bytes();
        // An index of eight bits is within the table.
        self.remainder = (self.remainder >> 8) ^ TABLE[(low ^ byte) as usize];
    }

    /// Adds the four bytes of a word, lowest first.
    pub fn update_word(&mut self, word: u32) {
        for byte in word.to_le_bytes() {
            self.update(byte);
        }
    }

    /// Adds the bytes of a text and a terminating zero.
    pub const fn update_text(&mut self, text: &str) {
        let mut rest = text.as_bytes();
        while let Some((&byte, after)) = rest.split_first() {
            self.update(byte);
            rest = after;
        }
        self.update(0);
    }

    /// Returns the CRC-32 of all bytes added so far.
    pub const fn value(self) -> u32 {
        !self.remainder
    }
}

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use proptest::prelude::*;

    use super::*;

    const REFERENCE: crc::Crc<u32> = crc::Crc::<u32>::new(&crc::CRC_32_ISO_HDLC);

    proptest! {
        #[test]
        fn it_is_the_crc_of_zlib(bytes: Vec<u8>) {
            prop_assert_eq!(digest(&bytes), REFERENCE.checksum(&bytes));
        }

        #[test]
        fn numbers_count_as_their_bytes(values: Vec<i32>) {
            let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
            prop_assert_eq!(values_digest(&values), REFERENCE.checksum(&bytes));
        }
    }
}
