//! The same frames through memory that a host and an emulated device share.
//!
//! ```text
//! slot to the device │ sent │ taken │ length │ bytes, four to a word, lowest first │
//! slot to the host   │ sent │ taken │ length │ bytes ...                            │
//! ```
//!
//! Each slot holds one frame. Its writer owns `sent`, its reader `taken`, and both count frames: the slot is free while
//! they are equal and full while they differ, so nothing is read while it is written. Storing a count with Release after
//! the bytes were written, or read, and loading the other's with Acquire before, orders everything else.

use core::sync::atomic::{AtomicU32, Ordering};

use crate::frame::FRAME_MAX;

/// Where the emulated machine has the mailbox.
pub const ADDRESS: usize = 0x2100_0000;

/// Words of one slot.
pub const SLOT_WORDS: usize = 3 + FRAME_MAX / WORD_BYTES;

/// Words of a mailbox: the slot to the device, then the slot to the host.
pub const WORDS: usize = 2 * SLOT_WORDS;

const WORD_BYTES: usize = 4;

/// Memory that both sides see, in words: an array on the target, a mapped file on the host.
pub trait Words {
    /// The word with this number, 0 ..< [`WORDS`]; none beyond what there is.
    fn word(&self, index: usize) -> Option<&AtomicU32>;
}

impl Words for &[AtomicU32; WORDS] {
    fn word(&self, index: usize) -> Option<&AtomicU32> {
        self.get(index)
    }
}

/// One side's view of the mailbox: a slot to send through and one to receive from.
#[derive(Clone, Copy, Debug)]
pub struct Mailbox<W> {
    words: W,
    outgoing: Slot,
    incoming: Slot,
}

/// Why a frame was not sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
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

impl<W: Words> Mailbox<W> {
    /// The device's side. What was sent to it before is dropped: it belongs to a session that its reset has ended.
    pub fn device(words: W) -> Self {
        Self::new(words, Slot::TO_HOST, Slot::TO_DEVICE)
    }

    /// The host's side. What was sent to it before is dropped.
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

    /// Sends a frame, if the one before was taken.
    ///
    /// # Errors
    /// It was not, or the frame is too long. Nothing is written then.
    pub fn send(&self, frame: &[u8]) -> Result<(), MailboxError> {
        self.outgoing.send(&self.words, frame)
    }

    /// Takes the frame that came, if one did.
    pub fn receive<'b>(&self, buffer: &'b mut [u8; FRAME_MAX]) -> Option<&'b [u8]> {
        self.incoming.receive(&self.words, buffer)
    }
}

/// Room for one frame: the number of its first word.
#[derive(Clone, Copy, Debug)]
struct Slot(usize);

/// Word of a slot: frames that the writer has put there.
const SENT: usize = 0;
/// Word of a slot: frames that the reader has taken.
const TAKEN: usize = 1;
/// Word of a slot: length of the frame in bytes.
const LENGTH: usize = 2;
/// First word of a slot that holds bytes.
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
        // Acquire: the reader is through with the bytes.
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
        // Release: whoever sees the new count sees the bytes.
        self.store(words, SENT, sent.wrapping_add(1), Ordering::Release);
        Ok(())
    }

    fn receive<'b>(self, words: &impl Words, buffer: &'b mut [u8; FRAME_MAX]) -> Option<&'b [u8]> {
        // Acquire: the bytes are those of this count.
        let sent = self.load(words, SENT, Ordering::Acquire);
        if self.load(words, TAKEN, Ordering::Relaxed) == sent {
            return None;
        }
        let length = self.load(words, LENGTH, Ordering::Relaxed) as usize;
        // Memory that nobody has written yet may hold any length.
        let frame = buffer.get_mut(..length).unwrap_or(&mut []);
        for (index, chunk) in (BYTES..SLOT_WORDS).zip(frame.chunks_mut(WORD_BYTES)) {
            let bytes = self.load(words, index, Ordering::Relaxed).to_le_bytes();
            for (byte, source) in chunk.iter_mut().zip(bytes) {
                *byte = source;
            }
        }
        // Release: whoever sees the new count may write over the bytes.
        self.store(words, TAKEN, sent, Ordering::Release);
        Some(frame)
    }

    fn drop_pending(self, words: &impl Words) {
        let sent = self.load(words, SENT, Ordering::Acquire);
        self.store(words, TAKEN, sent, Ordering::Release);
    }

    /// A word that is not there reads as 0, so that a slot without memory stays empty for ever.
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
