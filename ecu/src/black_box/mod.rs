//! Black box: record of the last seconds before the first fault and of a short time after it.
//!
//! ```text
//!             first fault            as many samples more as are kept after it
//!  Recording ─────────────► Triggered ───────────────────────────────────────► Frozen
//!      │ reset by watchdog, panic, exception, brownout                            ▲
//!      └────────────────────────────────────────────────► FrozenByReset     reset │ (from Triggered)
//! ```
//!
//! The first fault is the trigger, because later faults are mostly its consequences. A frozen box stays frozen until it
//! is read and cleared.
//!
//! The box is stored in plain words that a warm reset does not change, and after a cold start they may have any
//! content. Therefore the ring is implemented here: the indices of a `heapless` ring would have to be trusted. The
//! header is written when the box is cleared, the trigger when it changes, and one record per sample. Each has its own
//! checksum, so the cost of a sample does not grow with the ring, and records torn by a reset are distinguished from
//! whole ones. The end of the ring follows from the numbers of its records.

mod memory;

use hil_protocol::{
    BlackBoxPage, BlackBoxRecord, BlackBoxStatus, RECORDS_MAX, Refusal, ResetCause,
};
use memory::{Contents, Memory, Trigger};

pub use memory::words;

/// Samples recorded after the one with the first fault: 1 s, but at most half of the ring.
pub const SAMPLES_AFTER: u32 = 100;

/// Ring of records in `M`: an array of [`words()`] words, or a reference to one that resets do not change.
#[derive(Clone, Debug)]
pub struct BlackBox<M> {
    memory: Memory<M>,
    /// Number of the next record.
    next: u32,
    trigger: Trigger,
}

impl<M: AsRef<[u32]> + AsMut<[u32]>> BlackBox<M> {
    /// Takes over the whole records in this memory, or clears it if it contains no black box. Call it at the start
    /// after a reset.
    pub fn adopt(memory: M, cause: ResetCause) -> Self {
        let mut memory = Memory::new(memory);
        let (trigger, newest) = match memory.contents() {
            Contents::Other => {
                memory.clear();
                (Trigger::None, None)
            }
            Contents::Recording(trigger) => (trigger, memory.newest()),
        };
        let mut black_box = Self {
            memory,
            next: newest.map_or(0, |newest| newest.wrapping_add(1)),
            trigger,
        };
        black_box.reset(cause);
        black_box
    }

    /// Reports a reset of the ECU. Any reset ends a recording that a fault has triggered. Without a fault, only an unintended reset
    /// ends the recording, and only after the first record: watchdog, panic, exception, brownout or unknown cause.
    pub fn reset(&mut self, cause: ResetCause) {
        let trigger = match (self.trigger, cause) {
            (Trigger::Fault { number, faults }, _) => Trigger::FaultAndReset { number, faults },
            (
                Trigger::None,
                ResetCause::Watchdog
                | ResetCause::Panic
                | ResetCause::Exception
                | ResetCause::Brownout
                | ResetCause::Unknown,
            ) if self.next != 0 => Trigger::Reset,
            (trigger, _) => trigger,
        };
        self.set_trigger(trigger);
    }

    /// Deletes all records and starts recording again.
    pub fn clear(&mut self) {
        self.memory.clear();
        self.next = 0;
        self.trigger = Trigger::None;
    }

    /// Returns the status of the recording.
    pub fn status(&self) -> BlackBoxStatus {
        match self.trigger {
            Trigger::None => BlackBoxStatus::Recording,
            Trigger::Fault { number, faults } if self.is_recording() => {
                BlackBoxStatus::Triggered { number, faults }
            }
            Trigger::Fault { number, faults } | Trigger::FaultAndReset { number, faults } => {
                BlackBoxStatus::Frozen { number, faults }
            }
            Trigger::Reset => BlackBoxStatus::FrozenByReset,
        }
    }

    /// Records a sample and assigns its number. Call it once per sample.
    pub fn record(&mut self, record: BlackBoxRecord) {
        if !self.is_recording() {
            return;
        }
        let number = self.next;
        self.memory.write(&BlackBoxRecord { number, ..record });
        self.next = number.wrapping_add(1);
        if self.trigger == Trigger::None && record.faults != 0 {
            self.set_trigger(Trigger::Fault {
                number,
                faults: record.faults,
            });
        }
    }

    fn is_recording(&self) -> bool {
        match self.trigger {
            Trigger::None => true,
            Trigger::Fault { number, .. } => {
                let after = SAMPLES_AFTER.min(self.memory.capacity() / 2);
                self.next.wrapping_sub(number) <= after
            }
            Trigger::FaultAndReset { .. } | Trigger::Reset => false,
        }
    }

    fn set_trigger(&mut self, trigger: Trigger) {
        if trigger != self.trigger {
            self.memory.set_trigger(trigger);
            self.trigger = trigger;
        }
    }

    /// Returns one page of the records, oldest first.
    ///
    /// # Errors
    /// Returns an error if there are fewer pages.
    pub fn page(&self, page: u16) -> Result<BlackBoxPage, Refusal> {
        // After 2³² records the numbers wrap; then only the records since the wrap are counted.
        let kept = self.next.min(self.memory.capacity());
        let pages = kept.div_ceil(RECORDS_MAX as u32).max(1);
        let pages = u16::try_from(pages).unwrap_or(u16::MAX);
        if page >= pages {
            return Err(Refusal::UnknownPage { page, pages });
        }
        let first = self.next.wrapping_sub(kept);
        let begin = u32::from(page).wrapping_mul(RECORDS_MAX as u32);
        let end = begin.wrapping_add(RECORDS_MAX as u32).min(kept);
        let mut torn = 0_u16;
        let mut records = hil_protocol::heapless::Vec::new();
        for index in begin..end {
            match self.memory.read(first.wrapping_add(index)) {
                // A page has room for this number of records.
                Some(record) => drop(records.push(record)),
                None => torn = torn.saturating_add(1),
            }
        }
        Ok(BlackBoxPage {
            status: self.status(),
            page,
            pages,
            torn,
            records,
        })
    }
}
