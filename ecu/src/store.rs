//! Settings that outlive the supply: two copies, of which one is always whole.
//!
//! ```text
//! copy 0 │ magic │ version, length │ sequence │ digest of the table │ numbers ... │ CRC-32 │ 0xFF ... to the end of its pages
//! copy 1 │ the same                                                                        │
//! ```
//!
//! A save erases the older copy and writes it anew with the next sequence number, the checksum at its end. Whenever the
//! supply fails, the newer copy was not touched. A start takes the newest copy that is whole, of this image's table of
//! settings, and possible; if there is none, the built-in settings, and says so.

mod ram_flash;
mod record;

use embedded_storage::nor_flash::NorFlash;
use hil_protocol::SettingsSource;

use crate::calibration::{CheckedSettings, SettingValues};
pub use ram_flash::{RamFlash, RamFlashError};
use record::{Found, RECORD_BYTES, Record};

/// The two copies, in a flash memory of their own or in the part of one that is handed over.
#[derive(Clone, Debug)]
pub struct SettingsStore<F> {
    flash: F,
}

/// Why settings were not saved. What was saved before is still there.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError {
    /// The memory cannot hold two copies.
    #[error("the settings' memory has {bytes} bytes, two copies need {needed}")]
    TooSmall {
        /// How much there is.
        bytes: usize,
        /// How much there should be.
        needed: usize,
    },
    /// The memory refused to erase or to write.
    #[error("the settings' memory could not be erased or written")]
    Flash,
    /// What was written reads otherwise: the memory is worn out or damaged.
    #[error(
        "copy {copy} of the settings reads otherwise than it was written: the memory is worn out or damaged"
    )]
    Verify {
        /// 0 or 1.
        copy: u8,
    },
}

impl<F: NorFlash> SettingsStore<F> {
    /// Bytes from one copy to the other: as many whole pages as a record needs.
    const STRIDE: usize = RECORD_BYTES.next_multiple_of(F::ERASE_SIZE);

    /// Bytes of memory that two copies need.
    pub const BYTES: usize = 2 * Self::STRIDE;

    /// The copies in this memory, whatever is in it.
    pub const fn new(flash: F) -> Self {
        const {
            assert!(
                RECORD_BYTES.is_multiple_of(F::WRITE_SIZE)
                    && RECORD_BYTES.is_multiple_of(F::READ_SIZE),
                "a record is a whole number of the memory's words"
            );
        }
        Self { flash }
    }

    /// The settings to start with, and where they come from: the newest good copy, else `defaults`. Writes nothing.
    pub fn load(&mut self, defaults: &CheckedSettings) -> (CheckedSettings, SettingsSource) {
        let copies = [self.read(0), self.read(1)];
        let source = match newest(&copies) {
            Some((copy, record)) => {
                let source = stored(copy, record.sequence, &copies);
                if let Ok(settings) = record.values.checked() {
                    return (settings, source);
                }
                SettingsSource::DefaultsDamaged
            }
            None if matches!(copies, [Found::Erased, Found::Erased]) => {
                SettingsSource::DefaultsNeverSaved
            }
            None => SettingsSource::DefaultsDamaged,
        };
        (*defaults, source)
    }

    /// Keeps these settings for the next start, in place of the older copy.
    ///
    /// Erasing takes the time that the memory needs, on many parts with the processor at rest: only while nothing depends on
    /// the next sample.
    ///
    /// # Errors
    /// The memory failed; the newer copy was not touched.
    pub fn save(&mut self, values: &SettingValues) -> Result<SettingsSource, StoreError> {
        let bytes = self.flash.capacity();
        if bytes < Self::BYTES {
            return Err(StoreError::TooSmall {
                bytes,
                needed: Self::BYTES,
            });
        }
        let copies = [self.read(0), self.read(1)];
        let (copy, sequence) = match newest(&copies) {
            Some((newest, record)) => (1_u8.wrapping_sub(newest), record.sequence.wrapping_add(1)),
            None => (0, 0),
        };
        let record = Record {
            sequence,
            values: *values,
        };
        let start = Self::offset(copy);
        let end = start.saturating_add(Self::STRIDE as u32);
        self.flash
            .erase(start, end)
            .map_err(|_| StoreError::Flash)?;
        self.flash
            .write(start, &record.to_bytes())
            .map_err(|_| StoreError::Flash)?;
        if self.read(copy) != Found::Whole(record) {
            return Err(StoreError::Verify { copy });
        }
        Ok(stored(copy, sequence, &copies))
    }

    /// The memory, to be used otherwise.
    pub fn into_flash(self) -> F {
        self.flash
    }

    fn read(&mut self, copy: u8) -> Found {
        let mut bytes = [0; RECORD_BYTES];
        match self.flash.read(Self::offset(copy), &mut bytes) {
            Ok(()) => match Found::in_bytes(&bytes) {
                // Whole, but another version of this image wrote it, whose ranges were others.
                Found::Whole(record) if record.values.checked().is_err() => Found::Damaged,
                found => found,
            },
            Err(_) => Found::Damaged,
        }
    }

    const fn offset(copy: u8) -> u32 {
        if copy == 0 { 0 } else { Self::STRIDE as u32 }
    }
}

fn stored(copy: u8, sequence: u32, copies: &[Found; 2]) -> SettingsSource {
    let [first, second] = copies;
    let other = if copy == 0 { second } else { first };
    SettingsSource::Stored {
        copy,
        sequence,
        other_damaged: matches!(other, Found::Damaged),
    }
}

/// The newer of the whole ones.
fn newest(copies: &[Found; 2]) -> Option<(u8, &Record)> {
    match copies {
        [Found::Whole(first), Found::Whole(second)] => {
            // Sequence numbers go round.
            if second.sequence.wrapping_sub(first.sequence).cast_signed() > 0 {
                Some((1, second))
            } else {
                Some((0, first))
            }
        }
        [Found::Whole(first), _] => Some((0, first)),
        [_, Found::Whole(second)] => Some((1, second)),
        _ => None,
    }
}
