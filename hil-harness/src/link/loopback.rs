//! Device in this process with real frames.

use std::collections::VecDeque;
use std::time::Instant;

use hil_protocol::{Device, DeviceSession, FRAME_MAX};

use super::transport::{Transport, TransportError};

/// Both ends of a wire in this process: every frame is answered at once.
#[derive(Debug)]
pub struct Loopback<D> {
    device: D,
    session: DeviceSession,
    answers: VecDeque<u8>,
}

impl<D: Device> Loopback<D> {
    /// Creates the wire to a device that has just started.
    pub fn new(device: D) -> Self {
        Self {
            device,
            session: DeviceSession::new(1),
            answers: VecDeque::new(),
        }
    }

    /// Returns the device.
    pub fn device(&self) -> &D {
        &self.device
    }
}

impl<D: Device> Transport for Loopback<D> {
    fn name(&self) -> String {
        "frames in process".to_owned()
    }

    fn send(&mut self, frame: &[u8], _: Instant) -> Result<(), TransportError> {
        for &byte in frame {
            if let Some(answer) = self.session.receive_byte(byte, &mut self.device) {
                self.answers.extend(answer);
            }
        }
        Ok(())
    }

    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        _: Instant,
    ) -> Result<usize, TransportError> {
        let count = buffer.len().min(self.answers.len());
        for (place, byte) in buffer.iter_mut().zip(self.answers.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }
}
