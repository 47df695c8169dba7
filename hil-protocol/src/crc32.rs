//! CRC-32 as in Ethernet and zlib (ISO-HDLC), which every tool can compute.

use crc::{CRC_32_ISO_HDLC, Crc, Table};

static CRC: Crc<u32, Table<1>> = Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC);

/// CRC-32 of bytes.
pub fn digest(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}

/// CRC-32 of numbers, each as four bytes, lowest first.
pub fn values_digest(values: &[i32]) -> u32 {
    let mut digest = CRC.digest();
    for value in values {
        digest.update(&value.to_le_bytes());
    }
    digest.finalize()
}
