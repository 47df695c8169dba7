//! One copy of the settings, as bytes.

use hil_protocol::crc32::Digest;

use crate::calibration::{SETTING_COUNT, SETTINGS_DIGEST, SettingValues};

/// `RETA`, lowest byte first.
const MAGIC: u32 = 0x4154_4552;
/// Version of this layout, raised whenever its bytes change their meaning.
const VERSION: u16 = 1;

const WORD: usize = 4;
/// Words of a record: magic, version and length, sequence number, digest of the table; the numbers; checksum.
const WORDS: usize = 4 + SETTING_COUNT + 1;
const LENGTH: u16 = (WORDS * WORD) as u16;

/// Size of a record (bytes), filled up with 0xFF to a whole number of any flash memory's words.
pub(super) const RECORD_BYTES: usize = (WORDS * WORD).next_multiple_of(64);

const ERASED: u8 = 0xFF;

/// Content of a copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Record {
    pub(super) sequence: u32,
    pub(super) values: SettingValues,
}

/// Kind of content found in the bytes of a copy.
#[expect(
    clippy::large_enum_variant,
    reason = "one at a time exists, and there is no allocator to box with"
)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// Erased, or never written.
    Erased,
    /// No record, or one of another version or table.
    Damaged,
    Whole(Record),
}

impl Record {
    fn words(&self) -> impl Iterator<Item = u32> {
        let header = [
            MAGIC,
            u32::from(VERSION) | (u32::from(LENGTH) << 16),
            self.sequence,
            SETTINGS_DIGEST,
        ];
        let values = self.values.as_array().map(i32::cast_unsigned);
        let mut digest = Digest::new();
        for word in header.into_iter().chain(values) {
            digest.update_word(word);
        }
        header.into_iter().chain(values).chain([digest.value()])
    }

    pub(super) fn to_bytes(self) -> [u8; RECORD_BYTES] {
        let mut bytes = [ERASED; RECORD_BYTES];
        let (places, _) = bytes.as_chunks_mut::<WORD>();
        for (place, word) in places.iter_mut().zip(self.words()) {
            *place = word.to_le_bytes();
        }
        bytes
    }
}

impl Found {
    pub(super) fn in_bytes(bytes: &[u8; RECORD_BYTES]) -> Self {
        if bytes.iter().all(|&byte| byte == ERASED) {
            return Self::Erased;
        }
        let (chunks, _) = bytes.as_chunks::<WORD>();
        let mut words = chunks.iter().map(|&chunk| u32::from_le_bytes(chunk));
        let mut values = [0; SETTING_COUNT];
        // Values that do not matter to the comparison below are assumed to be correct.
        let (Some(_magic), Some(_version), Some(sequence), Some(_table)) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            return Self::Damaged;
        };
        for (value, word) in values.iter_mut().zip(words) {
            *value = word.cast_signed();
        }
        let record = Record {
            sequence,
            values: SettingValues::from_array(values),
        };
        // A record is whole if it equals what this image would have written: magic, version, length, table, checksum
        // and filling.
        if record.to_bytes() == *bytes {
            Self::Whole(record)
        } else {
            Self::Damaged
        }
    }
}
