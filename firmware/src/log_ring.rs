//! Ring buffer of the log, between the macros and the link.

/// Ring of log frames, `N` bytes in total. When it is full, the oldest frames are dropped, whole ones only.
///
/// Frames have the encoding of the logging framework: no byte of a frame is zero except its last (defmt's rzCOBS). A
/// reader that missed some frames therefore resumes with a whole one.
pub struct LogRing<const N: usize> {
    bytes: [u8; N],
    /// Total numbers of bytes written and taken; the ring contains the bytes in between.
    put: u32,
    taken: u32,
    /// Position at which the current frame began.
    frame_start: u32,
    /// Whether the current frame is longer than the whole ring.
    overlong: bool,
    /// Number of bytes lost since the start.
    lost: u32,
}

/// Byte that ends a frame.
const DELIMITER: u8 = 0;

impl<const N: usize> LogRing<N> {
    const SIZE: u32 = {
        assert!(N.is_power_of_two() && N <= 1 << 16);
        N as u32
    };

    /// Creates an empty ring.
    #[expect(
        clippy::new_without_default,
        reason = "meant for a static, which needs a constant"
    )]
    pub const fn new() -> Self {
        Self {
            bytes: [0; N],
            put: 0,
            taken: 0,
            frame_start: 0,
            overlong: false,
            lost: 0,
        }
    }

    /// Begins a frame.
    pub fn start_frame(&mut self) {
        self.frame_start = self.put;
        self.overlong = false;
    }

    /// Appends a byte to the frame.
    pub fn put(&mut self, byte: u8) {
        if !self.overlong && self.fill() == Self::SIZE && !self.drop_oldest() {
            self.give_up();
        }
        if self.overlong {
            self.lost = self.lost.saturating_add(1);
            return;
        }
        self.bytes[self.put as usize % N] = byte;
        self.put = self.put.wrapping_add(1);
    }

    /// Ends the frame; from now on it may be taken.
    pub fn end_frame(&mut self) {
        self.frame_start = self.put;
    }

    /// Takes the oldest byte of a complete frame.
    pub fn take(&mut self) -> Option<u8> {
        if self.taken == self.frame_start {
            return None;
        }
        let byte = self.bytes[self.taken as usize % N];
        self.taken = self.taken.wrapping_add(1);
        Some(byte)
    }

    /// Returns the number of bytes lost since the start; it saturates.
    pub const fn lost(&self) -> u32 {
        self.lost
    }

    const fn fill(&self) -> u32 {
        self.put.wrapping_sub(self.taken)
    }

    /// Drops the oldest complete frame, if there is one, and returns whether there was.
    fn drop_oldest(&mut self) -> bool {
        let mut dropped = false;
        while let Some(byte) = self.take() {
            self.lost = self.lost.saturating_add(1);
            dropped = true;
            if byte == DELIMITER {
                break;
            }
        }
        dropped
    }

    /// Removes the current frame, which alone is longer than the ring.
    fn give_up(&mut self) {
        let begun = self.put.wrapping_sub(self.frame_start);
        self.lost = self.lost.saturating_add(begun);
        self.put = self.frame_start;
        self.overlong = true;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(ring: &mut LogRing<16>, frame: &[u8]) {
        ring.start_frame();
        frame.iter().for_each(|&byte| ring.put(byte));
        ring.end_frame();
    }

    fn taken(ring: &mut LogRing<16>) -> Vec<u8> {
        std::iter::from_fn(|| ring.take()).collect()
    }

    #[test]
    fn frames_come_out_as_they_went_in() {
        let mut ring = LogRing::new();
        log(&mut ring, &[1, 2, 3, 0]);
        log(&mut ring, &[4, 0]);
        assert_eq!(taken(&mut ring), [1, 2, 3, 0, 4, 0]);
        assert_eq!((taken(&mut ring), ring.lost()), (vec![], 0));
    }

    #[test]
    fn a_frame_in_work_is_not_given_away() {
        let mut ring = LogRing::new();
        log(&mut ring, &[1, 0]);
        ring.start_frame();
        ring.put(2);
        ring.put(3);
        assert_eq!(taken(&mut ring), [1, 0]);
        ring.put(0);
        ring.end_frame();
        assert_eq!(taken(&mut ring), [2, 3, 0]);
    }

    #[test]
    fn the_oldest_whole_frames_make_room_and_their_bytes_are_counted() {
        let mut ring = LogRing::new();
        log(&mut ring, &[1, 1, 1, 1, 1, 0]);
        log(&mut ring, &[2, 2, 2, 2, 2, 0]);
        // Four bytes are free; the fifth one needs the place of the first frame.
        log(&mut ring, &[3, 3, 3, 3, 0]);
        assert_eq!(ring.lost(), 6);
        assert_eq!(taken(&mut ring), [2, 2, 2, 2, 2, 0, 3, 3, 3, 3, 0]);
    }

    #[test]
    fn a_frame_that_was_taken_in_part_is_dropped_to_its_end() {
        let mut ring = LogRing::new();
        log(&mut ring, &[1, 1, 1, 1, 1, 0]);
        log(&mut ring, &[2, 2, 2, 2, 2, 2, 2, 0]);
        assert_eq!(ring.take(), Some(1));
        log(&mut ring, &[3, 3, 3, 3, 0]);
        assert_eq!(ring.lost(), 5);
        assert_eq!(taken(&mut ring), [2, 2, 2, 2, 2, 2, 2, 0, 3, 3, 3, 3, 0]);
    }

    #[test]
    fn a_frame_longer_than_the_ring_is_dropped_alone_and_counted() {
        let mut ring = LogRing::new();
        let overlong = [[7; 17].as_slice(), &[0]].concat();
        log(&mut ring, &overlong);
        assert_eq!(ring.lost(), 18);
        log(&mut ring, &[1, 0]);
        assert_eq!(taken(&mut ring), [1, 0]);
    }

    /// A frame that fits exactly is not lost, a frame of one byte more is.
    #[test]
    fn the_ring_holds_as_many_bytes_as_it_says() {
        let mut ring = LogRing::new();
        log(&mut ring, &[&[7; 15][..], &[0]].concat());
        assert_eq!((ring.lost(), taken(&mut ring).len()), (0, 16));
        log(&mut ring, &[&[7; 16][..], &[0]].concat());
        assert_eq!((ring.lost(), taken(&mut ring).len()), (17, 0));
    }

    #[test]
    fn the_counters_may_pass_the_end_of_their_type() {
        let mut ring = LogRing::<16>::new();
        (ring.put, ring.taken, ring.frame_start) = (u32::MAX - 2, u32::MAX - 2, u32::MAX - 2);
        log(&mut ring, &[1, 2, 3, 4, 5, 0]);
        assert_eq!(taken(&mut ring), [1, 2, 3, 4, 5, 0]);
    }
}
