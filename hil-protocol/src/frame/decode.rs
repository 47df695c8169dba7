//! Decoding of bytes into undamaged payloads.

use postcard::Deserializer;
use postcard::de_flavors::Flavor;
use serde::de::DeserializeOwned;

use super::encode::FULL_BLOCK;
use super::{CHECKSUM_LENGTH, DELIMITER, FRAME_MAX, Header};
use crate::crc32;

/// Reason why bytes are no valid frame. The next frame is decoded independently.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Damage {
    /// The frame ends inside a block, or contains only its checksum: part of it is missing.
    #[error("the frame ends too early: part of it was lost")]
    Truncated,
    /// More bytes than the maximum frame size came without a delimiter.
    #[error(
        "no delimiter within {FRAME_MAX} bytes: two frames ran together, or the other side does not send frames"
    )]
    TooLong,
    /// Header or message were changed on the wire.
    #[error("the checksum is {found:#010x}, the frame's bytes give {computed:#010x}")]
    Checksum {
        /// Checksum in the frame.
        found: u32,
        /// Checksum of the frame's bytes.
        computed: u32,
    },
}

/// Decoder that takes the bytes of frames one at a time, undoes the stuffing, and checks the frame at each delimiter.
#[derive(Clone, Debug)]
pub struct Decoder {
    payload: [u8; FRAME_MAX],
    length: usize,
    /// Number of bytes left in the block.
    block: u8,
    /// Whether a zero follows between this block and the next.
    zero_follows: bool,
    /// Whether a byte was received since the last delimiter.
    begun: bool,
    overflowed: bool,
}

impl Decoder {
    /// Creates a decoder at the beginning of a frame.
    pub const fn new() -> Self {
        Self {
            payload: [0; FRAME_MAX],
            length: 0,
            block: 0,
            zero_follows: false,
            begun: false,
            overflowed: false,
        }
    }

    /// Takes one byte. After the last byte of a frame it returns the undamaged header and message, or the damage.
    ///
    /// Delimiters without bytes in between are no frames: any number of them may fill a pause.
    pub fn push(&mut self, byte: u8) -> Option<Result<&[u8], Damage>> {
        if byte == DELIMITER {
            return self.end();
        }
        self.begun = true;
        if let Some(left) = self.block.checked_sub(1) {
            self.block = left;
            self.append(byte);
        } else {
            if self.zero_follows {
                self.append(DELIMITER);
            }
            self.zero_follows = byte != FULL_BLOCK;
            self.block = byte.wrapping_sub(1);
        }
        None
    }

    fn append(&mut self, byte: u8) {
        match self.payload.get_mut(self.length) {
            Some(place) => {
                *place = byte;
                self.length = self.length.wrapping_add(1);
            }
            None => self.overflowed = true,
        }
    }

    fn end(&mut self) -> Option<Result<&[u8], Damage>> {
        let Self {
            length,
            block,
            begun,
            overflowed,
            ..
        } = *self;
        self.length = 0;
        self.block = 0;
        self.zero_follows = false;
        self.begun = false;
        self.overflowed = false;
        if !begun {
            return None;
        }
        if overflowed {
            return Some(Err(Damage::TooLong));
        }
        if block != 0 {
            return Some(Err(Damage::Truncated));
        }
        Some(checked(self.payload.get(..length).unwrap_or(&[])))
    }
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the bytes before the checksum, if the checksum is right.
fn checked(bytes: &[u8]) -> Result<&[u8], Damage> {
    let Some((payload, checksum)) = bytes.split_last_chunk::<CHECKSUM_LENGTH>() else {
        return Err(Damage::Truncated);
    };
    // The checksum of no bytes is 0: four zeros, which two flipped bits can cut out of a frame.
    if payload.is_empty() {
        return Err(Damage::Truncated);
    }
    let found = u32::from_le_bytes(*checksum);
    let computed = crc32::digest(payload);
    if found == computed {
        Ok(payload)
    } else {
        Err(Damage::Checksum { found, computed })
    }
}

/// Returns the header of an undamaged payload and the bytes of its message; `None` if the header is unknown.
pub fn header(payload: &[u8]) -> Option<(Header, &[u8])> {
    take(payload)
}

/// Returns the message that consists of exactly these bytes; `None` if it is unknown.
pub fn message<M: DeserializeOwned>(bytes: &[u8]) -> Option<M> {
    match take(bytes) {
        Some((message, [])) => Some(message),
        _ => None,
    }
}

fn take<T: DeserializeOwned>(bytes: &[u8]) -> Option<(T, &[u8])> {
    let mut deserializer = Deserializer::from_flavor(Remaining(bytes));
    let value = T::deserialize(&mut deserializer).ok()?;
    Some((value, deserializer.finalize().ok()?))
}

/// Bytes still to be read. The serializer's own reader subtracts pointers, which contains a panic when overflow is
/// checked.
struct Remaining<'a>(&'a [u8]);

impl<'a> Flavor<'a> for Remaining<'a> {
    type Remainder = &'a [u8];
    type Source = &'a [u8];

    fn pop(&mut self) -> postcard::Result<u8> {
        let (&first, rest) = self
            .0
            .split_first()
            .ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
        self.0 = rest;
        Ok(first)
    }

    fn try_take_n(&mut self, count: usize) -> postcard::Result<&'a [u8]> {
        let (taken, rest) = self
            .0
            .split_at_checked(count)
            .ok_or(postcard::Error::DeserializeUnexpectedEnd)?;
        self.0 = rest;
        Ok(taken)
    }

    fn finalize(self) -> postcard::Result<&'a [u8]> {
        Ok(self.0)
    }
}
