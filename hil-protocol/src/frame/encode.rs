//! Encoding of a message into a frame, byte by byte, without a second buffer and without an index that could be out of
//! bounds.

use postcard::ser_flavors::Flavor;
use serde::Serialize;

use super::{CHECKSUM_LENGTH, DELIMITER, Header};
use crate::crc32;

/// Error: a message does not fit into a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[error("the message does not fit into a frame of {room} bytes")]
pub struct TooLong {
    /// Available size (bytes).
    pub room: usize,
}

/// Encodes a message into a frame, including the delimiter, at the beginning of `buffer`.
///
/// # Errors
/// Returns an error if the buffer is too small; its content is then no frame.
pub fn encode<'a, M: Serialize>(
    header: Header,
    message: &M,
    buffer: &'a mut [u8],
) -> Result<&'a [u8], TooLong> {
    let room = buffer.len();
    let checksummed = Checksummed {
        crc: crc32::Digest::new(),
        stuffed: Stuffed::new(buffer),
    };
    // A tuple is encoded as its elements, one after the other.
    postcard::serialize_with_flavor(&(header, message), checksummed).map_err(|_| TooLong { room })
}

/// Encoder stage that appends the checksum of all bytes.
struct Checksummed<'a> {
    crc: crc32::Digest,
    stuffed: Stuffed<'a>,
}

impl<'a> Flavor for Checksummed<'a> {
    type Output = &'a [u8];

    // It is called for each byte of each message: inlined there, it would be half of the image.
    #[inline(never)]
    fn try_push(&mut self, byte: u8) -> postcard::Result<()> {
        self.crc.update(byte);
        self.stuffed
            .push(byte)
            .ok_or(postcard::Error::SerializeBufferFull)
    }

    fn finalize(self) -> postcard::Result<&'a [u8]> {
        let Self { crc, mut stuffed } = self;
        let checksum: [u8; CHECKSUM_LENGTH] = crc.value().to_le_bytes();
        for byte in checksum {
            stuffed
                .push(byte)
                .ok_or(postcard::Error::SerializeBufferFull)?;
        }
        stuffed.finish().ok_or(postcard::Error::SerializeBufferFull)
    }
}

/// Consistent overhead byte stuffing (Cheshire and Baker, 1997). A block is a code and the code - 1 bytes that follow
/// it; a zero follows each block except the last one and those of 254 bytes.
struct Stuffed<'a> {
    buffer: &'a mut [u8],
    /// Number of used bytes.
    length: usize,
    /// Position of the open block's code.
    code_at: usize,
    code: u8,
}

/// Code of a block of 254 bytes, which is followed by no omitted zero.
pub(super) const FULL_BLOCK: u8 = 255;

impl<'a> Stuffed<'a> {
    fn new(buffer: &'a mut [u8]) -> Self {
        Self {
            buffer,
            length: 1,
            code_at: 0,
            code: 1,
        }
    }

    fn push(&mut self, byte: u8) -> Option<()> {
        if self.code == FULL_BLOCK {
            self.close_block()?;
        }
        if byte == DELIMITER {
            self.close_block()
        } else {
            self.append(byte)?;
            self.code = self.code.checked_add(1)?;
            Some(())
        }
    }

    fn finish(mut self) -> Option<&'a [u8]> {
        *self.buffer.get_mut(self.code_at)? = self.code;
        self.append(DELIMITER)?;
        self.buffer.get(..self.length)
    }

    fn close_block(&mut self) -> Option<()> {
        *self.buffer.get_mut(self.code_at)? = self.code;
        self.code_at = self.length;
        self.code = 1;
        self.length = self.length.checked_add(1)?;
        Some(())
    }

    fn append(&mut self, byte: u8) -> Option<()> {
        *self.buffer.get_mut(self.length)? = byte;
        self.length = self.length.checked_add(1)?;
        Some(())
    }
}
