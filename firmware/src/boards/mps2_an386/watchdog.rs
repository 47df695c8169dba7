//! The watchdog: an interrupt that cannot be masked when it was not fed in time, and a reset if that does not help.

use firmware::Pace;

use super::register::Register;

/// CMSDK watchdog (Cortex-M System Design Kit TRM DDI 0479, section 4.4).
const LOAD: Register = Register::at(0x4000_8000);
const CONTROL: Register = Register::at(0x4000_8008);
const INTERRUPT_CLEAR: Register = Register::at(0x4000_800c);
const CONTROL_ALL: u32 = 0b11;

const CLOCK_HZ: u32 = 25_000_000;
/// Three samples.
const BITES_AT_TIMER: u32 = CLOCK_HZ * 3 / 100;
/// Longer than any pause that an emulator's host makes, shorter than a person waits.
const BITES_AT_HOST: u32 = CLOCK_HZ * 10;

/// Starts the watchdog, or tells it that all is well.
pub(super) fn feed(pace: Pace) {
    LOAD.write(match pace {
        Pace::Timer => BITES_AT_TIMER,
        Pace::Host => BITES_AT_HOST,
    });
    INTERRUPT_CLEAR.write(1);
    CONTROL.write(CONTROL_ALL);
}
