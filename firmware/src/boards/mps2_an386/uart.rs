//! UART 0 as a link: bytes come in by interrupt and go out one at a time in the main loop, through two queues.
//!
//! The emulated UART needs no time to send a byte. With interrupts it would send a whole frame at once, and a sample
//! would wait for it.

use cortex_m::interrupt::InterruptNumber;
use cortex_m::peripheral::NVIC;
use firmware::ByteRing;

use super::register::Register;

/// Number of the interrupt of UART 0 for a received byte (AN386, "Interrupts").
pub(super) const RECEIVED: i16 = 0;

/// CMSDK UART 0 (Cortex-M System Design Kit TRM DDI 0479, section 4.3).
const DATA: Register = Register::at(0x4000_4000);
const STATE: Register = Register::at(0x4000_4004);
const CONTROL: Register = Register::at(0x4000_4008);
const INTERRUPT: Register = Register::at(0x4000_400c);
const BAUD_DIVISOR: Register = Register::at(0x4000_4010);
const STATE_SEND_FULL: u32 = 1 << 0;
const STATE_RECEIVE_FULL: u32 = 1 << 1;
/// Bits for send, receive, and the interrupt for received bytes.
const CONTROL_SEND_RECEIVE: u32 = 0b1011;
const INTERRUPT_RECEIVED: u32 = 1 << 1;

/// Divisor for 921 600 baud from 25 MHz, 0.5 % off, the nearest whole divisor. The emulator ignores it.
const DIVISOR: u32 = 27;

/// Size of each queue: two frames each way, one being processed and one on its way.
const QUEUE: usize = 2048;

static IN: ByteRing<QUEUE> = ByteRing::new();
static OUT: ByteRing<QUEUE> = ByteRing::new();

#[derive(Clone, Copy)]
struct Received;

// SAFETY: the number is that of the UART's interrupt on this machine.
unsafe impl InterruptNumber for Received {
    fn number(self) -> u16 {
        RECEIVED as u16
    }
}

pub(super) fn start() {
    BAUD_DIVISOR.write(DIVISOR);
    CONTROL.write(CONTROL_SEND_RECEIVE);
    // SAFETY: no critical section relies on this interrupt being masked.
    unsafe { NVIC::unmask(Received) }
}

pub(super) fn on_received() {
    INTERRUPT.write(INTERRUPT_RECEIVED);
    while STATE.read() & STATE_RECEIVE_FULL != 0 {
        // A byte without room in the queue is lost, and with it a frame; the link detects it.
        IN.push(DATA.read() as u8);
    }
}

/// Sends the next byte, if there is one and the last one is sent.
pub(super) fn poll() {
    if !OUT.is_empty()
        && STATE.read() & STATE_SEND_FULL == 0
        && let Some(byte) = OUT.pop()
    {
        DATA.write(byte.into());
    }
}

pub(super) fn receive() -> Option<u8> {
    IN.pop()
}

/// Returns whether a byte is still being sent.
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
}
