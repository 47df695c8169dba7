//! Bad wire: frames are lost, damaged, repeated, late, or out of order.

use std::collections::VecDeque;
use std::time::Instant;

use hil_protocol::FRAME_MAX;
use hil_protocol::frame::DELIMITER;

use super::transport::{Transport, TransportError};
use crate::random::{Draws, Random, Stream};

/// Wire on which some of the frames are disturbed, in both directions, chosen by a seed.
#[derive(Debug)]
pub struct Disturbed<T> {
    wire: T,
    /// One frame in this number is disturbed, for each kind.
    one_in: u32,
    to_device: Direction,
    to_host: Direction,
    /// Received part of an incomplete frame.
    begun: Vec<u8>,
    /// Bytes that the host has not taken yet.
    ready: VecDeque<u8>,
}

/// Numbers of disturbed frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Disturbances {
    /// Number of frames that never arrived.
    pub lost: u32,
    /// Number of frames with one flipped bit.
    pub damaged: u32,
    /// Number of frames that came twice.
    pub repeated: u32,
    /// Number of frames that came after up to four newer ones: late, and out of order.
    pub late: u32,
}

/// One direction of the wire.
#[derive(Debug)]
struct Direction {
    draws: Draws,
    disturbances: Disturbances,
    /// Late frames, with the number of newer ones that come before them.
    held: Vec<(u32, Vec<u8>)>,
}

impl Direction {
    fn new(seed: u64) -> Self {
        Self {
            draws: Draws::new(Random::new(seed, Stream::Wire)),
            disturbances: Disturbances::default(),
            held: Vec::new(),
        }
    }

    /// Returns the frames that arrive when this frame is sent, oldest first.
    fn carry(&mut self, frame: Vec<u8>, one_in: u32) -> Vec<Vec<u8>> {
        let count = &mut self.disturbances;
        let mut arriving = Vec::new();
        match self.draws.below(one_in) {
            0 => count.lost += 1,
            1 => {
                count.damaged += 1;
                let bit = self.draws.below(8 * frame.len() as u32) as usize;
                let mut damaged = frame;
                damaged[bit / 8] ^= 1 << (bit % 8);
                arriving.push(damaged);
            }
            2 => {
                count.repeated += 1;
                arriving.extend([frame.clone(), frame]);
            }
            3 => {
                count.late += 1;
                self.held.push((1 + self.draws.below(4), frame));
                return arriving;
            }
            _ => arriving.push(frame),
        }
        for (newer, _) in &mut self.held {
            *newer -= 1;
        }
        let due = self.held.extract_if(.., |(newer, _)| *newer == 0);
        arriving.extend(due.map(|(_, frame)| frame));
        arriving
    }
}

impl<T: Transport> Disturbed<T> {
    /// Creates a bad wire in place of a good one: of `one_in` frames in each direction, on average one is lost, one
    /// damaged, one repeated and one late.
    pub fn new(wire: T, seed: u64, one_in: u32) -> Self {
        let [to_device, to_host] = [seed, !seed].map(Direction::new);
        Self {
            wire,
            one_in,
            to_device,
            to_host,
            begun: Vec::new(),
            ready: VecDeque::new(),
        }
    }

    /// Returns the disturbances of frames to the device, and to the host.
    pub fn disturbances(&self) -> [Disturbances; 2] {
        [self.to_device.disturbances, self.to_host.disturbances]
    }
}

impl<T: Transport> Transport for Disturbed<T> {
    fn name(&self) -> String {
        format!("{}, disturbed", self.wire.name())
    }

    fn send(&mut self, frame: &[u8], deadline: Instant) -> Result<(), TransportError> {
        let arriving = self.to_device.carry(frame.to_vec(), self.one_in);
        arriving
            .iter()
            .try_for_each(|frame| self.wire.send(frame, deadline))
    }

    fn receive(
        &mut self,
        buffer: &mut [u8; FRAME_MAX],
        deadline: Instant,
    ) -> Result<usize, TransportError> {
        while self.ready.is_empty() {
            let count = self.wire.receive(buffer, deadline)?;
            if count == 0 {
                return Ok(0);
            }
            for &byte in &buffer[..count] {
                self.begun.push(byte);
                if byte == DELIMITER {
                    let frame = std::mem::take(&mut self.begun);
                    let arriving = self.to_host.carry(frame, self.one_in);
                    self.ready.extend(arriving.into_iter().flatten());
                }
            }
        }
        let count = buffer.len().min(self.ready.len());
        for (place, byte) in buffer.iter_mut().zip(self.ready.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn last_words(&self) -> Vec<String> {
        self.wire.last_words()
    }
}
