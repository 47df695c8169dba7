//! Frames through shared memory.

use std::hint;
use std::sync::Arc;
use std::sync::atomic::AtomicU32;
use std::thread;
use std::time::Instant;

use hil_protocol::FRAME_MAX;
use hil_protocol::mailbox::{self, Mailbox, MailboxError, Words};

use super::memory::SharedMemory;
use crate::link::{Transport, TransportError};

/// Host's side of a mailbox in the emulated machine's memory.
#[derive(Debug)]
pub(super) struct MailboxLink {
    mailbox: Mailbox<Shared>,
}

#[derive(Debug)]
struct Shared(Arc<SharedMemory>);

impl Words for Shared {
    fn word(&self, index: usize) -> Option<&AtomicU32> {
        self.0.word_at(mailbox::ADDRESS + 4 * index)
    }
}

/// Number of polls within which an answer usually comes; after them the processor is yielded between two polls.
const LOOKS_AT_ONCE: u32 = 4000;
/// Number of polls per read of the clock.
const LOOKS_PER_CLOCK: u32 = 64;

impl MailboxLink {
    pub(super) fn new(memory: Arc<SharedMemory>) -> Self {
        Self {
            mailbox: Mailbox::host(Shared(memory)),
        }
    }
}

/// Polls until `look` returns a value, or until the deadline.
fn watch<T>(deadline: Instant, mut look: impl FnMut() -> Option<T>) -> Option<T> {
    let mut looks: u32 = 0;
    loop {
        if let Some(seen) = look() {
            return Some(seen);
        }
        looks = looks.saturating_add(1);
        if looks < LOOKS_AT_ONCE {
            hint::spin_loop();
        } else {
            thread::yield_now();
        }
        if looks.is_multiple_of(LOOKS_PER_CLOCK) && Instant::now() >= deadline {
            return None;
        }
        if looks == u32::MAX {
            looks = LOOKS_AT_ONCE;
        }
    }
}

impl Transport for MailboxLink {
    fn name(&self) -> String {
        "mailbox".to_owned()
    }

    fn send(&mut self, frame: &[u8], deadline: Instant) -> Result<(), TransportError> {
        let sent = watch(deadline, || match self.mailbox.send(frame) {
            Err(MailboxError::Full) => None,
            other => Some(other),
        });
        Ok(sent.ok_or(TransportError::NotTaken)??)
    }

    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        deadline: Instant,
    ) -> Result<usize, TransportError> {
        let received = watch(deadline, || Some(self.mailbox.receive(buffer)?.len()));
        Ok(received.unwrap_or(0))
    }
}
