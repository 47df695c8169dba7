//! Sample timer and clock.

use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;

use super::register::Register;

/// Number of the interrupt of timer 0 (AN386, "Interrupts").
pub(super) const TICK: i16 = 8;

/// System clock, which drives the timers.
const CLOCK_HZ: u32 = 25_000_000;
/// T_ECU = 10 ms.
const PERIOD: u32 = CLOCK_HZ / 100;

/// CMSDK timer 0 (Cortex-M System Design Kit TRM DDI 0479, section 4.1).
const CONTROL: Register = Register::at(0x4000_0000);
const VALUE: Register = Register::at(0x4000_0004);
const RELOAD: Register = Register::at(0x4000_0008);
const INTERRUPT_CLEAR: Register = Register::at(0x4000_000c);
const CONTROL_ENABLE: u32 = 1 << 0;
const CONTROL_INTERRUPT: u32 = 1 << 3;

/// The FPGA's counter and its prescaler (AN386, "FPGA system control and I/O").
const COUNTER: Register = Register::at(0x4002_8018);
const PRESCALE: Register = Register::at(0x4002_801c);

static TICKS: AtomicU32 = AtomicU32::new(0);

#[derive(Clone, Copy)]
struct Tick;

// SAFETY: the number is that of the timer's interrupt on this machine.
unsafe impl InterruptNumber for Tick {
    fn number(self) -> u16 {
        TICK as u16
    }
}

/// Starts the clock, and the sample timer with its interrupt.
pub(super) fn start() {
    PRESCALE.write(CLOCK_HZ / 1_000_000 - 1);
    RELOAD.write(PERIOD - 1);
    VALUE.write(PERIOD - 1);
    CONTROL.write(CONTROL_ENABLE | CONTROL_INTERRUPT);
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Tick) }
}

/// Returns the time since the start (µs); wraps to 0.
pub(crate) fn now_us() -> u32 {
    COUNTER.read()
}

/// Returns the time since the last tick of the timer (µs). The timer counts down, ticks at 0, and restarts from its
/// reload value.
pub(super) fn since_tick_us() -> u32 {
    PERIOD.wrapping_sub(VALUE.read()) % PERIOD / (CLOCK_HZ / 1_000_000)
}

pub(super) fn on_tick() {
    INTERRUPT_CLEAR.write(1);
    TICKS.store(
        TICKS.load(Ordering::Relaxed).wrapping_add(1),
        Ordering::Relaxed,
    );
}

/// Returns the number of ticks since the last call.
pub(super) fn take_ticks() -> u32 {
    TICKS.swap(0, Ordering::Relaxed)
}
