//! How a message becomes bytes on a wire, and back.
//!
//! ```text
//! COBS( postcard(Header) ++ postcard(message) ++ CRC-32, lowest byte first ) ++ 0x00
//! ```
//!
//! The checksum covers header and message. COBS keeps the zero byte for the end of a frame, so a receiver that lost its
//! place finds it again with the next frame.

mod decode;
mod encode;

use serde::{Deserialize, Serialize};

pub use decode::{Damage, Decoder, header, message};
pub use encode::{TooLong, encode};

/// Most bytes of a frame, its delimiter included.
pub const FRAME_MAX: usize = 1024;

/// Most bytes of header and message: what is left of a frame without delimiter, checksum and the bytes that COBS adds,
/// one and one more for every 254.
pub const PAYLOAD_MAX: usize = FRAME_MAX - 1 - CHECKSUM_LENGTH - 5;

/// Ends a frame and occurs nowhere in it.
pub const DELIMITER: u8 = 0;

const CHECKSUM_LENGTH: usize = 4;

/// What stands before each message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Header {
    /// Which way it goes.
    pub direction: Direction,
    /// The host's nonce in a Hello and its answer; afterwards the nonce plus the device's boot number, modulo 2³².
    pub session: u32,
    /// Number of the request in its session, from 0; an answer carries that of its request.
    pub sequence: u32,
}

/// Which way a frame goes. A wire that sends a frame back is seen by it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Direction {
    /// A request.
    ToDevice,
    /// An answer.
    ToHost,
}
