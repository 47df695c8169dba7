//! CRC-32 as in Ethernet and zlib (ISO-HDLC), which every tool can compute.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// CRC-32 of bytes.
pub fn digest(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// CRC-32 of numbers, each as four bytes, lowest first.
pub fn values_digest(values: &[i32]) -> u32 {
    let mut digest = Digest::new();
    for value in values {
        digest.update_all(&value.to_le_bytes());
    }
    digest.value()
}

/// CRC-32 of bytes that come one after the other.
#[derive(Clone)]
pub struct Digest(crc::Digest<'static, u32, Table<1>>);

impl Digest {
    /// Of no byte yet.
    pub fn new() -> Self {
        Self(CRC.digest())
    }

    /// Takes one byte.
    pub fn update(&mut self, byte: u8) {
        self.0.update(&[byte]);
    }

    /// Takes bytes.
    pub fn update_all(&mut self, bytes: &[u8]) {
        self.0.update(bytes);
    }

    /// Of what was taken.
    pub fn value(self) -> u32 {
        self.0.finalize()
    }
}

impl Default for Digest {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_the_crc_of_zlib() {
        // The check value of the catalogue of parametrised CRC algorithms.
        assert_eq!(digest(b"123456789"), 0xCBF4_3926);
        assert_eq!(
            values_digest(&[0x3433_3231, 0x3837_3635]),
            digest(b"12345678")
        );
    }
}
