//! One direction of a bad link, in virtual time.

use std::collections::BTreeMap;

/// Probability in millionths.
type Chance = u32;

/// Strengths of the disturbances, equal for both directions.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Amplitudes {
    loss: Chance,
    duplicate: Chance,
    flip: Chance,
    truncate: Chance,
    stall: Chance,
    pub(crate) reset: Chance,
    /// Longest transmission time, in ticks; frames overtake each other within it.
    delay_max: u64,
}

impl Amplitudes {
    pub(crate) fn random(random: &mut Random) -> Self {
        let mut up_to = |max: u64| random.below(max + 1) as Chance;
        Self {
            loss: up_to(300_000),
            duplicate: up_to(500_000),
            flip: up_to(150_000),
            truncate: up_to(100_000),
            stall: up_to(3_000),
            reset: up_to(3_000),
            delay_max: 1 + u64::from(up_to(19)),
        }
    }
}

#[derive(Debug, Default)]
pub(crate) struct Wire {
    /// Frames by time of arrival, then in the order in which they were sent.
    frames: BTreeMap<(u64, u64), Vec<u8>>,
    sent: u64,
    stalled_until: u64,
    pub(crate) faults: u32,
}

impl Wire {
    pub(crate) fn send(&mut self, now: u64, frame: &[u8], how: Amplitudes, random: &mut Random) {
        if random.chance(how.stall) {
            self.faults += 1;
            self.stalled_until = now + 50 + random.below(200);
        }
        if random.chance(how.loss) {
            self.faults += 1;
            return;
        }
        self.enqueue(now, frame, how, random);
        if random.chance(how.duplicate) {
            self.faults += 1;
            self.enqueue(now, frame, how, random);
        }
    }

    fn enqueue(&mut self, now: u64, frame: &[u8], how: Amplitudes, random: &mut Random) {
        let mut bytes = frame.to_vec();
        if random.chance(how.flip) {
            self.faults += 1;
            for _ in 0..=random.below(4) {
                let bit = random.below(8 * bytes.len() as u64) as usize;
                bytes[bit / 8] ^= 1 << (bit % 8);
            }
        }
        if random.chance(how.truncate) {
            self.faults += 1;
            bytes.truncate(random.below(bytes.len() as u64) as usize);
        }
        let arrival = (now + 1 + random.below(how.delay_max)).max(self.stalled_until);
        self.sent += 1;
        let overtakes = self.frames.keys().any(|&(other, _)| other > arrival);
        self.faults += u32::from(overtakes);
        self.frames.insert((arrival, self.sent), bytes);
    }

    /// Takes a frame that has arrived; call it once for each.
    pub(crate) fn due(&mut self, now: u64) -> Option<Vec<u8>> {
        let first = self.frames.first_entry()?;
        (first.key().0 <= now).then(|| first.remove())
    }
}

/// SplitMix64 (Steele, Lea and Flood, 2014).
#[derive(Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (z ^ (z >> 31)) % bound
    }

    pub(crate) fn chance(&mut self, chance: Chance) -> bool {
        self.below(1_000_000) < u64::from(chance)
    }
}
