//! Conversion of messages into bytes on a wire, and back.
//!
//! ```text
//! COBS( postcard(Header) ++ postcard(message) ++ CRC-32, lowest byte first ) ++ 0x00
//! ```
//!
//! The checksum covers header and message. COBS reserves the zero byte for the end of a frame, so a receiver that lost
//! synchronisation finds it again with the next frame.

mod decode;
mod encode;

use serde::{Deserialize, Serialize};

pub use decode::{Damage, Decoder, header, message};
pub use encode::{TooLong, encode};

/// Maximum size of a frame (bytes), including its delimiter.
pub const FRAME_MAX: usize = 1024;

/// Maximum size of header and message (bytes): a frame without delimiter, checksum and the bytes that COBS adds, which
/// are one and one more for every 254.
pub const PAYLOAD_MAX: usize = FRAME_MAX - 1 - CHECKSUM_LENGTH - 5;

/// Byte that ends a frame and occurs nowhere inside.
pub const DELIMITER: u8 = 0;

const CHECKSUM_LENGTH: usize = 4;

/// Header of each message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Header {
    /// Direction of the frame.
    pub direction: Direction,
    /// Number of the session: the host's nonce in a Hello and its answer, afterwards the nonce plus the device's boot
    /// number, modulo 2³².
    pub session: u32,
    /// Number of the request in its session, from 0; an answer has the number of its request.
    pub sequence: u32,
}

/// Direction of a frame. It reveals a wire that sends frames back.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Direction {
    /// Request to the device.
    ToDevice,
    /// Answer to the host.
    ToHost,
}
