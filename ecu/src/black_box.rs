//! The black box: the last seconds before the first fault, and a little after it.
//!
//! ```text
//!             first fault            as many samples more as are kept after it
//!  Recording ─────────────► Triggered ───────────────────────────────────────► Frozen
//!      │ reset by watchdog, panic, exception, brownout                            ▲
//!      └────────────────────────────────────────────────► FrozenByReset     reset │ (from Triggered)
//! ```
//!
//! The first fault counts: what follows it is mostly its consequence. Frozen ends when somebody has read and cleared it.
//!
//! It lives in plain words that a warm reset leaves alone, and any bits may be found there; so it is its own ring and not one of
//! `heapless`, whose indices would have to be trusted. The header is written when the box is cleared, the trigger when it
//! changes, one record per sample: each has its own checksum, so the cost of a sample does not grow with the ring, and what
//! a reset tore is told from what is whole. Where the ring ends follows from the numbers of its records.

mod memory;

use hil_protocol::{
    BlackBoxPage, BlackBoxRecord, BlackBoxStatus, RECORDS_MAX, Refusal, ResetCause,
};
use memory::{Contents, Memory, Trigger};

pub use memory::words;

/// Samples that are recorded after the one with the first fault, as far as half of the ring has room for them: 1 s.
pub const SAMPLES_AFTER: u32 = 100;

/// A ring of records in `M`: an array of [`words()`] words, or a reference to one that resets leave alone.
#[derive(Clone, Debug)]
pub struct BlackBox<M> {
    memory: Memory<M>,
    /// Number of the record to come.
    next: u32,
    trigger: Trigger,
}

impl<M: AsRef<[u32]> + AsMut<[u32]>> BlackBox<M> {
    /// Takes over what is whole in this memory, or clears it if there is no black box in it. For the start after a reset.
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

    /// The ECU was reset: that ends what was going on, unless somebody asked for it.
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

    /// Forgets everything and records again.
    pub fn clear(&mut self) {
        self.memory.clear();
        self.next = 0;
        self.trigger = Trigger::None;
    }

    /// What it is doing.
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

    /// Takes the record of a sample; its number is given here. Call once per sample.
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

    /// One page of the records, oldest first.
    ///
    /// # Errors
    /// There are not so many.
    pub fn page(&self, page: u16) -> Result<BlackBoxPage, Refusal> {
        // After 2³² records the numbers go round; then only those since are counted.
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
                // A page has room for as many.
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
