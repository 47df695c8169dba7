//! Mailbox: the same frames through memory that a host and an emulated device share.
//!
//! ```text
//! slot to the device │ sent │ taken │ length │ bytes, four to a word, lowest first │
//! slot to the host   │ sent │ taken │ length │ bytes ...                            │
//! ```
//!
//! Each slot contains one frame. Its writer owns `sent`, its reader owns `taken`, and both count frames. The slot is
//! free while the counts are equal and full while they differ, so no frame is read while it is written. A count is
//! stored with Release after the bytes were written or read, and the other side's count is loaded with Acquire before.
//! This orders all other accesses.

use core::sync::atomic::{AtomicU32, Ordering};

use crate::frame::FRAME_MAX;

/// Address of the mailbox in the emulated machine.
pub const ADDRESS: usize = 0x2100_0000;

/// Number of words of one slot.
pub const SLOT_WORDS: usize = 3 + FRAME_MAX / WORD_BYTES;

/// Number of words of a mailbox: the slot to the device, then the slot to the host.
pub const WORDS: usize = 2 * SLOT_WORDS;

const WORD_BYTES: usize = 4;

/// Memory shared by both sides, in words: an array on the target, a mapped file on the host.
pub trait Words {
    /// Returns the word with this number, 0 ..< [`WORDS`]; `None` beyond the memory.
    fn word(&self, index: usize) -> Option<&AtomicU32>;
}

impl Words for &[AtomicU32; WORDS] {
    fn word(&self, index: usize) -> Option<&AtomicU32> {
        self.get(index)
    }
}

/// View of the mailbox from one side: a slot to send through and one to receive from.
#[derive(Clone, Copy, Debug)]
pub struct Mailbox<W> {
    words: W,
    outgoing: Slot,
    incoming: Slot,
}

/// Reason why a frame was not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MailboxError {
    /// The previous frame was not taken yet.
    #[error("the frame before was not taken yet")]
    Full,
    /// The frame is longer than the maximum size.
    #[error("{length} bytes are more than a frame can have ({FRAME_MAX})")]
    TooLong {
        /// Size of the rejected frame (bytes).
        length: usize,
    },
}

impl<W: Words> Mailbox<W> {
    /// Creates the device's side. Frames sent to it before are dropped: they belong to a session that its reset has
    /// ended.
    pub fn device(words: W) -> Self {
        Self::new(words, Slot::TO_HOST, Slot::TO_DEVICE)
    }

    /// Creates the host's side. Frames sent to it before are dropped.
    pub fn host(words: W) -> Self {
        Self::new(words, Slot::TO_DEVICE, Slot::TO_HOST)
    }

    fn new(words: W, outgoing: Slot, incoming: Slot) -> Self {
        incoming.drop_pending(&words);
        Self {
            words,
            outgoing,
            incoming,
        }
    }

    /// Sends a frame, if the previous one was taken.
    ///
    /// # Errors
    /// Returns an error if the previous frame was not taken, or the frame is too long. Nothing is written then.
    pub fn send(&self, frame: &[u8]) -> Result<(), MailboxError> {
        self.outgoing.send(&self.words, frame)
    }

    /// Takes the received frame, if there is one.
    pub fn receive<'b>(&self, buffer: &'b mut [u8; FRAME_MAX]) -> Option<&'b [u8]> {
        self.incoming.receive(&self.words, buffer)
    }
}

/// Room for one frame, given by the number of its first word.
#[derive(Clone, Copy, Debug)]
struct Slot(usize);

/// Word of a slot: number of frames that the writer has stored.
const SENT: usize = 0;
/// Word of a slot: number of frames that the reader has taken.
const TAKEN: usize = 1;
/// Word of a slot: length of the frame (bytes).
const LENGTH: usize = 2;
/// First word of a slot with bytes of the frame.
const BYTES: usize = 3;

impl Slot {
    const TO_DEVICE: Self = Self(0);
    const TO_HOST: Self = Self(SLOT_WORDS);

    fn send(self, words: &impl Words, frame: &[u8]) -> Result<(), MailboxError> {
        let length = match u32::try_from(frame.len()) {
            Ok(length) if frame.len() <= FRAME_MAX => length,
            _ => {
                return Err(MailboxError::TooLong {
                    length: frame.len(),
                });
            }
        };
        let sent = self.load(words, SENT, Ordering::Relaxed);
        // Acquire: the reader has finished with the bytes.
        if self.load(words, TAKEN, Ordering::Acquire) != sent {
            return Err(MailboxError::Full);
        }
        for (index, chunk) in (BYTES..SLOT_WORDS).zip(frame.chunks(WORD_BYTES)) {
            let mut bytes = [0; WORD_BYTES];
            for (byte, &source) in bytes.iter_mut().zip(chunk) {
                *byte = source;
            }
            self.store(words, index, u32::from_le_bytes(bytes), Ordering::Relaxed);
        }
        self.store(words, LENGTH, length, Ordering::Relaxed);
        // Release: a side that sees the new count sees the bytes.
        self.store(words, SENT, sent.wrapping_add(1), Ordering::Release);
        Ok(())
    }

    fn receive<'b>(self, words: &impl Words, buffer: &'b mut [u8; FRAME_MAX]) -> Option<&'b [u8]> {
        // Acquire: the bytes belong to this count.
        let sent = self.load(words, SENT, Ordering::Acquire);
        if self.load(words, TAKEN, Ordering::Relaxed) == sent {
            return None;
        }
        let length = self.load(words, LENGTH, Ordering::Relaxed) as usize;
        // Unwritten memory may contain any length.
        let frame = buffer.get_mut(..length).unwrap_or(&mut []);
        for (index, chunk) in (BYTES..SLOT_WORDS).zip(frame.chunks_mut(WORD_BYTES)) {
            let bytes = self.load(words, index, Ordering::Relaxed).to_le_bytes();
            for (byte, source) in chunk.iter_mut().zip(bytes) {
                *byte = source;
            }
        }
        // Release: a side that sees the new count may overwrite the bytes.
        self.store(words, TAKEN, sent, Ordering::Release);
        Some(frame)
    }

    fn drop_pending(self, words: &impl Words) {
        let sent = self.load(words, SENT, Ordering::Acquire);
        self.store(words, TAKEN, sent, Ordering::Release);
    }

    /// Loads a word. A missing word reads as 0, so that a slot without memory always stays empty.
    fn load(self, words: &impl Words, index: usize, order: Ordering) -> u32 {
        words
            .word(self.0.wrapping_add(index))
            .map_or(0, |word| word.load(order))
    }

    fn store(self, words: &impl Words, index: usize, value: u32, order: Ordering) {
        if let Some(word) = words.word(self.0.wrapping_add(index)) {
            word.store(value, order);
        }
    }
}
