//! UART 0 as a link: bytes in and out by interrupt, through two queues.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use firmware::ByteRing;

use super::register::Register;

/// Numbers of the interrupts of UART 0 (AN386, "Interrupts").
pub(super) const RECEIVED: i16 = 0;
pub(super) const SENT: i16 = 1;

/// CMSDK UART 0 (Cortex-M System Design Kit TRM DDI 0479, section 4.3).
const DATA: Register = Register::at(0x4000_4000);
const STATE: Register = Register::at(0x4000_4004);
const CONTROL: Register = Register::at(0x4000_4008);
const INTERRUPT: Register = Register::at(0x4000_400c);
const BAUD_DIVISOR: Register = Register::at(0x4000_4010);
const STATE_SEND_FULL: u32 = 1 << 0;
const STATE_RECEIVE_FULL: u32 = 1 << 1;
/// Send, receive, and an interrupt for either.
const CONTROL_ALL: u32 = 0b1111;
const INTERRUPT_SENT: u32 = 1 << 0;
const INTERRUPT_RECEIVED: u32 = 1 << 1;

/// 921 600 baud of 25 MHz, as near as a whole divisor gets: 0.5 % off. An emulator takes no notice.
const DIVISOR: u32 = 27;

/// Two frames each way: one in work, one on its way.
const QUEUE: usize = 2048;

static IN: ByteRing<QUEUE> = ByteRing::new();
static OUT: ByteRing<QUEUE> = ByteRing::new();

#[derive(Clone, Copy)]
struct Interrupt(i16);

// SAFETY: made in this file only, with the numbers of the UART's interrupts on this machine.
unsafe impl InterruptNumber for Interrupt {
    fn number(self) -> u16 {
        self.0 as u16
    }
}

pub(super) fn start() {
    BAUD_DIVISOR.write(DIVISOR);
    CONTROL.write(CONTROL_ALL);
    for number in [RECEIVED, SENT] {
        // SAFETY: no critical section relies on these interrupts being masked.
        unsafe { NVIC::unmask(Interrupt(number)) }
    }
}

pub(super) fn on_received() {
    INTERRUPT.write(INTERRUPT_RECEIVED);
    while STATE.read() & STATE_RECEIVE_FULL != 0 {
        // A byte for which there is no room is lost, and with it a frame; the link notices.
        IN.push(DATA.read() as u8);
    }
}

pub(super) fn on_sent() {
    INTERRUPT.write(INTERRUPT_SENT);
    while STATE.read() & STATE_SEND_FULL == 0 {
        let Some(byte) = OUT.pop() else { break };
        DATA.write(byte.into());
    }
}

pub(super) fn receive() -> Option<u8> {
    IN.pop()
}

/// Whether a byte is still on its way out.
pub(super) fn is_sending() -> bool {
    !OUT.is_empty() || STATE.read() & STATE_SEND_FULL != 0
}

/// Queues a frame, whole or not at all.
pub(super) fn send(frame: &[u8]) {
    if OUT.room() < frame.len() {
        return;
    }
    for &byte in frame {
        OUT.push(byte);
    }
    // The first byte is sent by the same code as all others; each byte sent then raises the interrupt for the next.
    NVIC::pend(Interrupt(SENT));
}
