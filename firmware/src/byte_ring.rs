//! Queue of bytes between an interrupt and the main loop.

use core::sync::atomic::{AtomicU8, AtomicU32, Ordering};

/// Queue of `N` bytes between one writer and one reader, neither of which ever waits.
///
/// `N` is a power of two. The two counters run freely, and their difference is the fill level. Each is written by one
/// side only, so that plain loads and stores suffice (Lamport, "Proving the Correctness of Multiprocess Programs",
/// 1977).
pub struct ByteRing<const N: usize> {
    bytes: [AtomicU8; N],
    written: AtomicU32,
    read: AtomicU32,
}

impl<const N: usize> ByteRing<N> {
    const SIZE: u32 = {
        assert!(N.is_power_of_two() && N <= 1 << 16);
        N as u32
    };

    /// Creates an empty queue.
    #[expect(
        clippy::new_without_default,
        reason = "meant for a static, which needs a constant"
    )]
    pub const fn new() -> Self {
        Self {
            bytes: [const { AtomicU8::new(0) }; N],
            written: AtomicU32::new(0),
            read: AtomicU32::new(0),
        }
    }

    /// Returns the number of bytes that the writer may still push.
    pub fn room(&self) -> usize {
        let read = self.read.load(Ordering::Acquire);
        let fill = self.written.load(Ordering::Relaxed).wrapping_sub(read);
        Self::SIZE.saturating_sub(fill) as usize
    }

    /// Returns whether the queue is empty.
    pub fn is_empty(&self) -> bool {
        self.room() == N
    }

    /// Appends a byte, if there is room, and returns whether there was. Call it on the writer's side.
    pub fn push(&self, byte: u8) -> bool {
        if self.room() == 0 {
            return false;
        }
        let written = self.written.load(Ordering::Relaxed);
        self.bytes[written as usize % N].store(byte, Ordering::Relaxed);
        self.written
            .store(written.wrapping_add(1), Ordering::Release);
        true
    }

    /// Takes the oldest byte. Call it on the reader's side.
    pub fn pop(&self) -> Option<u8> {
        let read = self.read.load(Ordering::Relaxed);
        if self.written.load(Ordering::Acquire) == read {
            return None;
        }
        let byte = self.bytes[read as usize % N].load(Ordering::Relaxed);
        self.read.store(read.wrapping_add(1), Ordering::Release);
        Some(byte)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::collections::VecDeque;

    proptest! {
        /// Comparison with the standard library's queue, across many turns of the ring.
        #[test]
        fn bytes_come_out_once_and_in_order_and_a_full_ring_takes_no_more(
            moves in proptest::collection::vec((any::<bool>(), any::<u8>()), 0..400),
        ) {
            let ring = ByteRing::<8>::new();
            let mut model = VecDeque::new();
            for (push, byte) in moves {
                if push {
                    let has_room = model.len() < 8;
                    prop_assert_eq!(ring.push(byte), has_room);
                    if has_room {
                        model.push_back(byte);
                    }
                } else {
                    prop_assert_eq!(ring.pop(), model.pop_front());
                }
                prop_assert_eq!(ring.room(), 8 - model.len());
                prop_assert_eq!(ring.is_empty(), model.is_empty());
            }
        }
    }

    #[test]
    fn the_counters_may_pass_the_end_of_their_type() {
        let ring = ByteRing::<4>::new();
        ring.written.store(u32::MAX - 1, Ordering::Relaxed);
        ring.read.store(u32::MAX - 1, Ordering::Relaxed);
        for byte in 0..4 {
            assert!(ring.push(byte));
        }
        assert!(!ring.push(9));
        let out: Vec<u8> = core::iter::from_fn(|| ring.pop()).collect();
        assert_eq!(out, [0, 1, 2, 3]);
    }
}
