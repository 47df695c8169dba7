//! The independent watchdog: it has a clock of its own, 32 kHz within 8 %, and cannot be stopped.

use firmware::Pace;
use stm32g4xx_hal::stm32::{IWDG, iwdg};

/// The keys of section 44.4.1.
const FEED: u16 = 0xaaaa;
const UNLOCK: u16 = 0x5555;
const START: u16 = 0xcccc;

/// How soon it bites.
struct Patience {
    /// Code of the clock's divider.
    divider: u8,
    /// Counts until it bites, less one.
    reload: u16,
}

/// 60 counts of 16 periods, 30 ms: three samples.
const AT_TIMER: Patience = Patience {
    divider: 2,
    reload: 59,
};
/// 1250 counts of 256 periods, 10 s.
const AT_HOST: Patience = Patience {
    divider: 6,
    reload: 1249,
};

/// Starts the watchdog, or tells it that all is well.
pub(super) fn feed(pace: Pace) {
    let patience = match pace {
        Pace::Timer => AT_TIMER,
        Pace::Host => AT_HOST,
    };
    let watchdog = watchdog();
    if watchdog.rlr().read().rl().bits() != patience.reload {
        write_key(START);
        write_key(UNLOCK);
        watchdog.pr().write(|w| {
            // SAFETY: a divider of the table in section 44.4.2.
            unsafe { w.pr().bits(patience.divider) }
        });
        watchdog.rlr().write(|w| {
            // SAFETY: 12 bits, any of which are allowed.
            unsafe { w.rl().bits(patience.reload) }
        });
    }
    write_key(FEED);
}

/// The same once more, with the patience it has. A watchdog that was not started stays so.
pub(super) fn feed_again() {
    write_key(FEED);
}

fn write_key(key: u16) {
    watchdog().kr().write(|w| {
        // SAFETY: each of the three keys may come at any time.
        unsafe { w.key().bits(key) }
    });
}

fn watchdog() -> &'static iwdg::RegisterBlock {
    // SAFETY: this file alone uses the watchdog, and the main loop alone this file.
    unsafe { &*IWDG::ptr() }
}
