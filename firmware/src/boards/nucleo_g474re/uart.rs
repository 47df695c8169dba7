//! USART 2 as a link, through the debugger's serial port: bytes go in and out by interrupt, through two queues.

use cortex_m::peripheral::NVIC;
use firmware::ByteRing;
use stm32g4xx_hal::gpio::{AF7, PA2, PA3};
use stm32g4xx_hal::prelude::*;
use stm32g4xx_hal::rcc::Rcc;
use stm32g4xx_hal::serial::FullConfig;
use stm32g4xx_hal::stm32::{Interrupt, USART2, interrupt};

/// Baud rate, which the debugger's serial port can handle.
const BAUD: u32 = 921_600;

/// Size of each queue: two frames each way, one being processed and one on its way.
const QUEUE: usize = 2048;

static IN: ByteRing<QUEUE> = ByteRing::new();
static OUT: ByteRing<QUEUE> = ByteRing::new();

pub(super) fn start(port: USART2, send: PA2<AF7>, receive: PA3<AF7>, rcc: &mut Rcc) {
    let config = FullConfig::default().baudrate(BAUD.bps()).fifo_enable();
    // This fails only if the clock is too slow for the baud rate; then only the link is missing.
    let _ = port.usart(send, receive, config, rcc);
    registers().cr1().modify(|_, w| w.rxneie().set_bit());
}

pub(super) fn receive() -> Option<u8> {
    IN.pop()
}

/// Returns whether a byte is still being sent.
pub(super) fn is_sending() -> bool {
    !OUT.is_empty() || registers().isr().read().tc().bit_is_clear()
}

/// Queues a frame, whole or not at all.
pub(super) fn send(frame: &[u8]) {
    if OUT.room() < frame.len() {
        return;
    }
    for &byte in frame {
        OUT.push(byte);
    }
    // The interrupt sends the first byte, like all others.
    NVIC::pend(Interrupt::USART2);
}

#[interrupt]
fn USART2() {
    let port = registers();
    // After an overrun, or a byte damaged on the line, the frame fails its checksum.
    port.icr().write(|w| {
        w.orecf()
            .clear_bit_by_one()
            .fecf()
            .clear_bit_by_one()
            .ncf()
            .clear_bit_by_one()
    });
    while port.isr().read().rxne().bit_is_set() {
        // A byte without room in the queue is lost, and with it a frame; the link detects it.
        IN.push(port.rdr().read().rdr().bits() as u8);
    }
    while port.isr().read().txe().bit_is_set() {
        let Some(byte) = OUT.pop() else {
            port.cr1().modify(|_, w| w.txeie().clear_bit());
            return;
        };
        port.tdr().write(|w| w.tdr().set(byte.into()));
    }
    port.cr1().modify(|_, w| w.txeie().set_bit());
}

fn registers() -> &'static stm32g4xx_hal::stm32::usart1::RegisterBlock {
    // SAFETY: after the start the port's registers are used by the interrupt alone.
    unsafe { &*USART2::ptr() }
}
