//! Information for the next start: a few words of RAM that a warm reset does not change.

use core::sync::atomic::{AtomicU32, Ordering};

use hil_protocol::ResetCause;
use hil_protocol::crc32::values_digest;

/// Reason for which the image reset the machine, stored before the reset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(target_os = "none", derive(defmt::Format))]
pub enum ResetReason {
    /// Request of a host.
    Requested,
    /// Watchdog that was about to reset the machine.
    Watchdog,
    /// Panic of the image in this line of a source file.
    Panic {
        /// Line number; 0: not known.
        line: u32,
    },
    /// Fault exception of the processor at this address.
    Exception {
        /// Program counter.
        pc: u32,
    },
}

/// Retained words, at the board's address. They may have any content: random content after a cold start is recognised.
#[derive(Clone, Copy)]
pub struct Retained<'a> {
    words: &'a [AtomicU32; WORDS],
}

/// Number of retained words.
pub const WORDS: usize = 4;

/// Information that a start finds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Start {
    /// Number of starts of this image since the words were lost, from 0.
    pub boot: u32,
    /// Whether the words were valid: the machine was reset, its supply did not fail.
    pub warm: bool,
    /// Reason of the last reset, if the image stored one.
    pub reset_reason: Option<ResetReason>,
}

const BOOT: usize = 0;
const REASON: usize = 1;
const DETAIL: usize = 2;
const CHECK: usize = 3;

const NO_REASON: u32 = 0;
const REQUESTED: u32 = 1;
const WATCHDOG: u32 = 2;
const PANIC: u32 = 3;
const EXCEPTION: u32 = 4;

impl<'a> Retained<'a> {
    /// Creates it from words that no start-up code clears.
    pub const fn new(words: &'a [AtomicU32; WORDS]) -> Self {
        Self { words }
    }

    /// Returns whether the words were written before the reset: the machine was reset, its supply did not fail.
    pub fn is_warm(&self) -> bool {
        self.word(CHECK) == self.check()
    }

    /// Begins a new run: reads the stored reason and increments the counter. Call it once per start.
    pub fn start(&self) -> Start {
        let warm = self.is_warm();
        let boot = if warm {
            self.word(BOOT).wrapping_add(1)
        } else {
            0
        };
        let reset_reason = if warm { self.reset_reason() } else { None };
        self.write(boot, NO_REASON, 0);
        Start {
            boot,
            warm,
            reset_reason,
        }
    }

    /// Stores the reason for the coming reset. It never waits and cannot fail; only the first reason counts.
    pub fn say(&self, reset_reason: ResetReason) {
        if self.word(REASON) != NO_REASON {
            return;
        }
        let (reason, detail) = match reset_reason {
            ResetReason::Requested => (REQUESTED, 0),
            ResetReason::Watchdog => (WATCHDOG, 0),
            ResetReason::Panic { line } => (PANIC, line),
            ResetReason::Exception { pc } => (EXCEPTION, pc),
        };
        self.write(self.word(BOOT), reason, detail);
    }

    fn reset_reason(&self) -> Option<ResetReason> {
        let detail = self.word(DETAIL);
        match self.word(REASON) {
            REQUESTED => Some(ResetReason::Requested),
            WATCHDOG => Some(ResetReason::Watchdog),
            PANIC => Some(ResetReason::Panic { line: detail }),
            EXCEPTION => Some(ResetReason::Exception { pc: detail }),
            _ => None,
        }
    }

    fn write(&self, boot: u32, reason: u32, detail: u32) {
        for (index, word) in [boot, reason, detail].into_iter().enumerate() {
            self.words[index].store(word, Ordering::Relaxed);
        }
        self.words[CHECK].store(self.check(), Ordering::Relaxed);
    }

    fn word(&self, index: usize) -> u32 {
        self.words[index].load(Ordering::Relaxed)
    }

    /// Returns the CRC-32 over the other words, so that random content after a cold start counts as valid once in 2³²
    /// times.
    fn check(&self) -> u32 {
        let words = [self.word(BOOT), self.word(REASON), self.word(DETAIL)];
        values_digest(&words.map(u32::cast_signed))
    }
}

impl ResetReason {
    /// Returns the cause of the reset for the link.
    pub const fn cause(self) -> ResetCause {
        match self {
            Self::Requested => ResetCause::Software,
            Self::Watchdog => ResetCause::Watchdog,
            Self::Panic { .. } => ResetCause::Panic,
            Self::Exception { .. } => ResetCause::Exception,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(bits: [u32; WORDS]) -> [AtomicU32; WORDS] {
        bits.map(AtomicU32::new)
    }

    #[test]
    fn what_a_cold_start_finds_is_no_message() {
        for bits in [[0; WORDS], [u32::MAX; WORDS], [1, PANIC, 42, 0xcccc_cccc]] {
            let words = words(bits);
            let start = Retained::new(&words).start();
            let expected = Start {
                boot: 0,
                warm: false,
                reset_reason: None,
            };
            assert_eq!(start, expected, "{bits:x?}");
        }
    }

    #[test]
    fn each_start_after_a_warm_reset_is_counted() {
        let words = words([0; WORDS]);
        let boots: Vec<u32> = (0..4).map(|_| Retained::new(&words).start().boot).collect();
        assert_eq!(boots, [0, 1, 2, 3]);
    }

    #[test]
    fn a_farewell_is_found_once_by_the_next_life() {
        for reset_reason in [
            ResetReason::Requested,
            ResetReason::Watchdog,
            ResetReason::Panic { line: 4711 },
            ResetReason::Exception { pc: 0x0000_1234 },
        ] {
            let words = words([0; WORDS]);
            let retained = Retained::new(&words);
            retained.start();
            retained.say(reset_reason);
            assert_eq!(retained.start().reset_reason, Some(reset_reason));
            assert_eq!(retained.start().reset_reason, None);
        }
    }

    /// A fault in the panic handler is a consequence, not the cause.
    #[test]
    fn only_the_first_farewell_counts() {
        let words = words([0; WORDS]);
        let retained = Retained::new(&words);
        retained.start();
        retained.say(ResetReason::Panic { line: 7 });
        retained.say(ResetReason::Exception { pc: 8 });
        assert_eq!(
            retained.start().reset_reason,
            Some(ResetReason::Panic { line: 7 })
        );
    }

    #[test]
    fn any_flipped_bit_makes_the_words_unknown() {
        for word in 0..WORDS {
            for bit in 0..32 {
                let words = words([0; WORDS]);
                let retained = Retained::new(&words);
                retained.start();
                retained.say(ResetReason::Watchdog);
                words[word].fetch_xor(1 << bit, Ordering::Relaxed);
                assert!(!retained.start().warm, "word {word}, bit {bit}");
            }
        }
    }
}
