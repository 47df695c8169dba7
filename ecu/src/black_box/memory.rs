//! Memory layout of the black box: header, trigger and records, each with its checksum.

use hil_protocol::BlackBoxRecord;
use hil_protocol::crc32::Digest;

/// `BLKB`, lowest byte first; the last letter is the version of this layout.
const MAGIC: u32 = 0x424B_4C42;

/// Words of the header: magic, generation, capacity; checksum.
const HEADER: usize = 4;
/// Words of the trigger: kind, number, faults; checksum.
const TRIGGER: usize = 4;
/// Words of a record: number, reference, code with mode and presence bits, both duty cycles, control signal, faults;
/// checksum.
const RECORD: usize = 8;

const REFERENCE_PRESENT: u32 = 1 << 24;
const PRESSURE_PRESENT: u32 = 1 << 25;

/// Returns the number of words for a ring of `records`. The ring uses the largest power of two of them.
pub const fn words(records: usize) -> usize {
    HEADER + TRIGGER + RECORD * records
}

/// Reason why the ring is frozen, or will be.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Trigger {
    None,
    /// First fault, with the number of its record.
    Fault {
        number: u32,
        faults: u32,
    },
    /// Reset while the samples after the fault were recorded.
    FaultAndReset {
        number: u32,
        faults: u32,
    },
    /// Reset without a fault before it.
    Reset,
}

/// Kind of content found in the words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Contents {
    /// No black box, or one of another size.
    Other,
    /// Black box with its trigger.
    Recording(Trigger),
}

#[derive(Clone, Debug)]
pub(super) struct Memory<M> {
    words: M,
    /// Generation, part of every checksum except the header's: it invalidates records written before the last clearing.
    generation: u32,
    /// Number of records that fit, less one: a power of two less one.
    mask: u32,
}

impl<M: AsRef<[u32]> + AsMut<[u32]>> Memory<M> {
    pub(super) fn new(words: M) -> Self {
        let room = words.as_ref().len().saturating_sub(HEADER + TRIGGER) / RECORD;
        // The largest power of two that is not above the room; without room the mask is 0, and no record fits.
        let mask = match u32::try_from(room).unwrap_or(u32::MAX).checked_ilog2() {
            Some(bits) => (1_u32 << bits).wrapping_sub(1),
            None => 0,
        };
        let mut memory = Self {
            words,
            generation: 0,
            mask,
        };
        if let Some([_, generation, ..]) = memory.words.as_ref().first_chunk::<HEADER>() {
            memory.generation = *generation;
        }
        memory
    }

    /// Returns the number of records in the ring.
    pub(super) const fn capacity(&self) -> u32 {
        self.mask.wrapping_add(1)
    }

    /// Invalidates the whole content.
    pub(super) fn clear(&mut self) {
        self.generation = self.generation.wrapping_add(1);
        let header = self.header();
        if let Some(place) = self.words.as_mut().first_chunk_mut() {
            *place = header;
        }
        self.set_trigger(Trigger::None);
    }

    fn header(&self) -> [u32; HEADER] {
        let Self {
            generation, mask, ..
        } = *self;
        [
            MAGIC,
            generation,
            mask,
            checksum(generation, &[MAGIC, mask]),
        ]
    }

    pub(super) fn contents(&self) -> Contents {
        let Some((header, rest)) = self.words.as_ref().split_first_chunk::<HEADER>() else {
            return Contents::Other;
        };
        let Some(&[kind, number, faults, check]) = rest.first_chunk::<TRIGGER>() else {
            return Contents::Other;
        };
        if *header != self.header() {
            return Contents::Other;
        }
        let whole = check == checksum(self.generation, &[kind, number, faults]);
        Contents::Recording(match kind {
            0 if whole => Trigger::None,
            1 if whole => Trigger::Fault { number, faults },
            2 if whole => Trigger::FaultAndReset { number, faults },
            // Kind 3, or a trigger torn by a reset: the records are still valid.
            _ => Trigger::Reset,
        })
    }

    pub(super) fn set_trigger(&mut self, trigger: Trigger) {
        let [kind, number, faults] = match trigger {
            Trigger::None => [0, 0, 0],
            Trigger::Fault { number, faults } => [1, number, faults],
            Trigger::FaultAndReset { number, faults } => [2, number, faults],
            Trigger::Reset => [3, 0, 0],
        };
        let check = checksum(self.generation, &[kind, number, faults]);
        if let Some(place) = self
            .words
            .as_mut()
            .get_mut(HEADER..)
            .and_then(<[u32]>::first_chunk_mut)
        {
            *place = [kind, number, faults, check];
        }
    }

    /// Returns the number of the newest whole record.
    pub(super) fn newest(&self) -> Option<u32> {
        let whole = (0..self.capacity()).filter_map(|slot| self.whole_in(slot));
        // Numbers wrap, and the numbers in the ring are close to each other.
        whole.map(|record| record.number).reduce(|newest, number| {
            if number.wrapping_sub(newest).cast_signed() > 0 {
                number
            } else {
                newest
            }
        })
    }

    /// Returns the record of this number, if it exists and is whole.
    pub(super) fn read(&self, number: u32) -> Option<BlackBoxRecord> {
        self.whole_in(number & self.mask)
            .filter(|record| record.number == number)
    }

    fn whole_in(&self, slot: u32) -> Option<BlackBoxRecord> {
        let words = *self
            .words
            .as_ref()
            .get(place(slot)..)?
            .first_chunk::<RECORD>()?;
        let [content @ .., check] = words;
        if check != checksum(self.generation, &content) {
            return None;
        }
        let [
            number,
            reference,
            packed,
            duty_fill,
            duty_vent,
            control_signal,
            faults,
        ] = content;
        let [code_low, code_high, mode, _] = packed.to_le_bytes();
        Some(BlackBoxRecord {
            number,
            reference: (packed & REFERENCE_PRESENT != 0).then_some(reference.cast_signed()),
            pressure: (packed & PRESSURE_PRESENT != 0)
                .then_some(u16::from_le_bytes([code_low, code_high])),
            duty_fill,
            duty_vent,
            control_signal: control_signal.cast_signed(),
            mode,
            faults,
        })
    }

    pub(super) fn write(&mut self, record: &BlackBoxRecord) {
        let mut packed = u32::from(record.pressure.unwrap_or(0)) | (u32::from(record.mode) << 16);
        if record.reference.is_some() {
            packed |= REFERENCE_PRESENT;
        }
        if record.pressure.is_some() {
            packed |= PRESSURE_PRESENT;
        }
        let [a, b, c, d, e, f, g] = [
            record.number,
            record.reference.unwrap_or(0).cast_unsigned(),
            packed,
            record.duty_fill,
            record.duty_vent,
            record.control_signal.cast_unsigned(),
            record.faults,
        ];
        let check = checksum(self.generation, &[a, b, c, d, e, f, g]);
        let slot = record.number & self.mask;
        if let Some(place) = self
            .words
            .as_mut()
            .get_mut(place(slot)..)
            .and_then(<[u32]>::first_chunk_mut)
        {
            *place = [a, b, c, d, e, f, g, check];
        }
    }
}

/// Returns the offset of a slot's record.
const fn place(slot: u32) -> usize {
    (slot as usize)
        .wrapping_mul(RECORD)
        .wrapping_add(HEADER + TRIGGER)
}

fn checksum(generation: u32, words: &[u32]) -> u32 {
    let mut digest = Digest::new();
    digest.update_word(generation);
    for &word in words {
        digest.update_word(word);
    }
    digest.value()
}
