//! The independent watchdog: it has a clock of its own and cannot be stopped.

use firmware::Pace;
use stm32g4xx_hal::stm32::IWDG;

/// The keys of section 44.4.1.
const FEED: u16 = 0xaaaa;
const UNLOCK: u16 = 0x5555;
const START: u16 = 0xcccc;

/// Divides the 32 kHz by 256: 8 ms per count (PR = 6).
const DIVIDE_BY_256: u8 = 6;
/// Four counts, 24 to 32 ms: after three samples without one, even with the oscillator 6 % fast.
const BITES_AT_TIMER: u16 = 4;
/// Ten seconds.
const BITES_AT_HOST: u16 = 1250;

/// Starts the watchdog, or tells it that all is well.
pub(super) fn feed(pace: Pace) {
    let reload = match pace {
        Pace::Timer => BITES_AT_TIMER,
        Pace::Host => BITES_AT_HOST,
    };
    // SAFETY: nobody else uses the watchdog.
    let watchdog = unsafe { &*IWDG::ptr() };
    if watchdog.rlr().read().rl().bits() != reload {
        watchdog.kr().write(|w| unsafe { w.key().bits(START) });
        watchdog.kr().write(|w| unsafe { w.key().bits(UNLOCK) });
        watchdog
            .pr()
            .write(|w| unsafe { w.pr().bits(DIVIDE_BY_256) });
        watchdog.rlr().write(|w| unsafe { w.rl().bits(reload) });
    }
    watchdog.kr().write(|w| unsafe { w.key().bits(FEED) });
}
