//! Clock and sample timer. The sample timer is the timer of the PWM, so that a sample begins with a PWM period. Its
//! duty cycles act from the next period on, independent of the time at which they are computed.

use core::sync::atomic::{AtomicU32, Ordering};

use stm32g4xx_hal::rcc::{Enable, Rcc};
use stm32g4xx_hal::stm32::{TIM1, TIM2, interrupt};

use super::clock;

static TICKS: AtomicU32 = AtomicU32::new(0);

/// Starts the clock: microseconds from timer 2, 32 bits.
pub(super) fn start_clock(timer: TIM2, rcc: &mut Rcc) {
    TIM2::enable(rcc);
    let per_us = rcc.clocks.apb1_tim_clk.raw() / 1_000_000;
    timer
        .psc()
        .write(|w| w.psc().set(per_us.saturating_sub(1) as u16));
    timer.arr().reset();
    // The prescaler takes effect with an update.
    timer.egr().write(|w| w.ug().set_bit());
    timer.cr1().write(|w| w.cen().set_bit());
}

/// Enables an interrupt with each PWM period.
pub(super) fn start_ticks() {
    // SAFETY: one bit of a register that no other code writes.
    let timer = unsafe { &*TIM1::ptr() };
    timer.dier().modify(|_, w| w.uie().set_bit());
}

/// Returns the time since the start (µs); wraps to 0.
pub(crate) fn now_us() -> u32 {
    // SAFETY: only reads.
    unsafe { &*TIM2::ptr() }.cnt().read().bits()
}

/// Returns the time since the PWM period began (µs). The prescaler gives counts of some 0.15 µs.
pub(super) fn since_tick_us() -> u32 {
    // SAFETY: only reads.
    let timer = unsafe { &*TIM1::ptr() };
    let clocks_per_count = u32::from(timer.psc().read().psc().bits()).wrapping_add(1);
    let counts = u32::from(timer.cnt().read().cnt().bits());
    counts.wrapping_mul(clocks_per_count) / (clock::HZ / 1_000_000)
}

/// Returns the number of ticks since the last call.
pub(super) fn take_ticks() -> u32 {
    TICKS.swap(0, Ordering::Relaxed)
}

#[interrupt]
fn TIM1_UP_TIM16() {
    // SAFETY: the flag is cleared only here.
    let timer = unsafe { &*TIM1::ptr() };
    timer.sr().write(|w| {
        // SAFETY: flags written as one are left alone, reserved bits have no effect.
        unsafe { w.bits(!1) }
    });
    TICKS.store(
        TICKS.load(Ordering::Relaxed).wrapping_add(1),
        Ordering::Relaxed,
    );
}
