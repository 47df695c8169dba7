//! Independent watchdog: it has its own clock, 32 kHz within 8 %, and cannot be stopped.

use firmware::Pace;
use stm32g4xx_hal::stm32::{IWDG, iwdg};

/// Keys of section 44.4.1.
const FEED: u16 = 0xaaaa;
const UNLOCK: u16 = 0x5555;
const START: u16 = 0xcccc;

/// Timeout of the watchdog.
struct Patience {
    /// Code of the clock's divider.
    divider: u8,
    /// Number of counts until the reset, less one.
    reload: u16,
}

/// Timeout while the timer sets the pace: 60 counts of 16 periods, 30 ms, three samples.
const AT_TIMER: Patience = Patience {
    divider: 2,
    reload: 59,
};
/// Timeout while the host sets the pace: 1250 counts of 256 periods, 10 s.
const AT_HOST: Patience = Patience {
    divider: 6,
    reload: 1249,
};

/// Starts or feeds the watchdog.
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

/// Feeds the watchdog with its present timeout. A watchdog that was not started stays off.
pub(super) fn feed_again() {
    write_key(FEED);
}

fn write_key(key: u16) {
    watchdog().kr().write(|w| {
        // SAFETY: each of the three keys may be written at any time.
        unsafe { w.key().bits(key) }
    });
}

fn watchdog() -> &'static iwdg::RegisterBlock {
    // SAFETY: only this file uses the watchdog, and only the main loop uses this file.
    unsafe { &*IWDG::ptr() }
}
