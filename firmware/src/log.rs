//! Transport of the log from the macros into a ring in RAM, from which the link takes it.

use core::cell::UnsafeCell;

use critical_section::RestoreState;
use defmt::{Logger, global_logger};
use firmware::{Event, LogRing, Rzcobs};
use hil_protocol::LogBytes;

/// Size of the ring (bytes): about a hundred events.
const RING: usize = 2048;

struct Log {
    encoder: Rzcobs,
    ring: LogRing<RING>,
    restore: RestoreState,
}

struct Shared(UnsafeCell<Log>);

// SAFETY: the log is accessed only in `with` and between `acquire` and `release`. Both run with interrupts off on the
// only core, and the closure of `with` does not call the log.
unsafe impl Sync for Shared {}

static LOG: Shared = Shared(UnsafeCell::new(Log {
    encoder: Rzcobs::new(),
    ring: LogRing::new(),
    restore: RestoreState::invalid(),
}));

#[global_logger]
struct IntoRing;

// SAFETY: between `acquire` and `release` interrupts are off on the only core, so that frames do not mix.
unsafe impl Logger for IntoRing {
    fn acquire() {
        // SAFETY: released in `release`, which defmt calls after each `acquire`, without nesting.
        let restore = unsafe { critical_section::acquire() };
        // SAFETY: interrupts are off, and no other reference to the log exists.
        let log = unsafe { &mut *LOG.0.get() };
        log.restore = restore;
        log.ring.start_frame();
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: defmt calls this between `acquire` and `release` only.
        let log = unsafe { &mut *LOG.0.get() };
        for &byte in bytes {
            log.encoder.write(byte, |byte| log.ring.put(byte));
        }
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: as in `write`.
        let log = unsafe { &mut *LOG.0.get() };
        log.encoder.end(|byte| log.ring.put(byte));
        log.ring.end_frame();
        let restore = log.restore;
        // SAFETY: the state is the one that `acquire` got.
        unsafe { critical_section::release(restore) }
    }
}

/// Writes an event to the log.
pub(crate) fn log(event: Event) {
    match event {
        Event::TicksMissed { .. } => defmt::warn!("{}", event),
        _ => defmt::info!("{}", event),
    }
}

/// Takes the oldest bytes and returns the number of bytes lost since the start.
pub(crate) fn take(bytes: &mut LogBytes) -> u32 {
    critical_section::with(|_| {
        // SAFETY: interrupts are off, and no macro of the log runs in here.
        let log = unsafe { &mut *LOG.0.get() };
        while !bytes.is_full() {
            let Some(byte) = log.ring.take() else { break };
            // There is room, as checked by the loop.
            let _ = bytes.push(byte);
        }
        log.ring.lost()
    })
}
