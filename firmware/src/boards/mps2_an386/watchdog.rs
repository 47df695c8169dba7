//! Watchdog: a non-maskable interrupt if it was not fed in time, then a reset.

use firmware::Pace;

use super::register::Register;

/// CMSDK watchdog (Cortex-M System Design Kit TRM DDI 0479, section 4.4).
const LOAD: Register = Register::at(0x4000_8000);
const CONTROL: Register = Register::at(0x4000_8008);
const INTERRUPT_CLEAR: Register = Register::at(0x4000_800c);
const CONTROL_ALL: u32 = 0b11;

const CLOCK_HZ: u32 = 25_000_000;
/// Timeout while the timer sets the pace: three samples.
const BITES_AT_TIMER: u32 = CLOCK_HZ * 3 / 100;
/// Timeout while the host sets the pace: 10 s, longer than any pause of the host of an emulator.
const BITES_AT_HOST: u32 = CLOCK_HZ * 10;

/// Starts or feeds the watchdog.
pub(super) fn feed(pace: Pace) {
    LOAD.write(match pace {
        Pace::Timer => BITES_AT_TIMER,
        Pace::Host => BITES_AT_HOST,
    });
    INTERRUPT_CLEAR.write(1);
    CONTROL.write(CONTROL_ALL);
}
