//! Simulated PWM timer of the two coils: it stores the compare values in memory that the host can read, and switches
//! the LEDs.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU32, Ordering};

use embedded_hal::pwm::{ErrorType, SetDutyCycle};

use super::memory::PIN_WORDS;
use super::pins::COMPARE;
use super::register::Register;

/// One channel of the PWM.
pub(super) struct Pwm {
    channel: usize,
}

/// LEDs of the board's FPGA (AN386, "FPGA system control and I/O"): bit 0 is LED 0, bit 1 is LED 1.
const LEDS: Register = Register::at(0x4002_8000);

const CHANNELS: usize = 2;

/// Present state of the LEDs.
static LIT: AtomicU32 = AtomicU32::new(0);

impl Pwm {
    pub(super) const FILL: Self = Self { channel: 0 };
    pub(super) const VENT: Self = Self { channel: 1 };

    /// Switches all channels off.
    pub(super) fn all_off() {
        for channel in 0..CHANNELS {
            PIN_WORDS[COMPARE + channel].store(0, Ordering::Relaxed);
        }
        LIT.store(0, Ordering::Relaxed);
        LEDS.write(0);
    }
}

impl ErrorType for Pwm {
    type Error = Infallible;
}

impl SetDutyCycle for Pwm {
    fn max_duty_cycle(&self) -> u16 {
        u16::MAX
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        PIN_WORDS[COMPARE + self.channel % CHANNELS].store(duty.into(), Ordering::Relaxed);
        show();
        Ok(())
    }
}

/// Switches the LEDs, only on a change: each access to a device costs the emulator as much as a thousand instructions.
fn show() {
    let mut lit = 0;
    for channel in 0..CHANNELS {
        if PIN_WORDS[COMPARE + channel].load(Ordering::Relaxed) != 0 {
            lit |= 1 << channel;
        }
    }
    if LIT.swap(lit, Ordering::Relaxed) != lit {
        LEDS.write(lit);
    }
}
