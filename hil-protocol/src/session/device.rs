//! The device's side.

use crate::counters::LinkCounters;
use crate::device::Device;
use crate::frame::FRAME_MAX;
use crate::message::Reply;

/// The device's side of a link.
#[derive(Clone, Debug)]
pub struct DeviceSession {
    counters: LinkCounters,
}

impl DeviceSession {
    /// No session yet. `boot` is a number that differs from boot to boot: a counter in RAM that a reset leaves alone will do.
    pub const fn new(boot: u32) -> Self {
        let _ = boot;
        Self {
            counters: LinkCounters {
                accepted: 0,
                corrupt: 0,
                unknown: 0,
                echoed: 0,
                duplicate: 0,
                stale: 0,
                foreign: 0,
                skipped: 0,
                repeated: 0,
            },
        }
    }

    /// Takes one byte from the wire; returns the frame to send, delimiter included, once a request is complete.
    pub fn receive_byte<D: Device>(&mut self, byte: u8, device: &mut D) -> Option<&[u8]> {
        let _ = (byte, device);
        None
    }

    /// Takes a whole frame, with or without its delimiter; returns the frame to send, if any.
    pub fn receive_frame<D: Device>(&mut self, frame: &[u8], device: &mut D) -> Option<&[u8]> {
        let _ = (frame, device);
        None
    }

    /// A frame that nobody asked for ([`Reply::Measured`]), for a timer that runs the control task.
    pub fn unasked<'a>(
        &mut self,
        reply: &Reply,
        buffer: &'a mut [u8; FRAME_MAX],
    ) -> Option<&'a [u8]> {
        let _ = (reply, buffer);
        None
    }

    /// Whether the control task runs once per request and not by its timer.
    pub const fn lock_step(&self) -> bool {
        false
    }

    /// What this side has seen.
    pub const fn counters(&self) -> LinkCounters {
        self.counters
    }
}
