//! Non-volatile settings: two copies, of which one is always whole.
//!
//! ```text
//! copy 0 │ magic │ version, length │ sequence │ digest of the table │ numbers ... │ CRC-32 │ 0xFF ... to the end of its pages
//! copy 1 │ the same                                                                        │
//! ```
//!
//! A save erases the older copy and writes it anew with the next sequence number, the checksum last. The newer copy is
//! not touched, so a loss of supply at any time leaves it whole. A start takes the newest copy that is whole, valid,
//! and of this image's table of settings. If there is none, it takes the built-in settings and reports this.

mod ram_flash;
mod record;

use embedded_storage::nor_flash::NorFlash;
use hil_protocol::SettingsSource;

use crate::calibration::{CheckedSettings, SettingValues};
pub use ram_flash::{RamFlash, RamFlashError};
use record::{Found, RECORD_BYTES, Record};

/// Store of the two copies, in a separate flash memory or in an assigned part of one.
#[derive(Clone, Debug)]
pub struct SettingsStore<F> {
    flash: F,
}

/// Reason why settings were not saved. The settings saved before are still stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum StoreError {
    /// The memory is too small for two copies.
    #[error("the settings' memory has {bytes} bytes, two copies need {needed}")]
    TooSmall {
        /// Size of the memory.
        bytes: usize,
        /// Required size.
        needed: usize,
    },
    /// The memory could not be erased or written.
    #[error("the settings' memory could not be erased or written")]
    Flash,
    /// The written copy reads differently: the memory is worn out or damaged.
    #[error(
        "copy {copy} of the settings reads otherwise than it was written: the memory is worn out or damaged"
    )]
    Verify {
        /// Number of the copy, 0 or 1.
        copy: u8,
    },
}

impl<F: NorFlash> SettingsStore<F> {
    /// Distance of the two copies (bytes): the whole pages that a record needs.
    const STRIDE: usize = RECORD_BYTES.next_multiple_of(F::ERASE_SIZE);

    /// Size of the two copies (bytes).
    pub const BYTES: usize = 2 * Self::STRIDE;

    /// Opens the copies in this memory, with any content.
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

    /// Returns the settings for the start and their source: the newest good copy, otherwise `defaults`. It writes
    /// nothing.
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

    /// Saves these settings for the next start, in place of the older copy.
    ///
    /// Erasing takes time, on many parts with the processor stopped. Call it only while nothing depends on the next
    /// sample.
    ///
    /// # Errors
    /// Returns an error if the memory failed; the newer copy was not touched.
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

    /// Returns the memory, for another use.
    pub fn into_flash(self) -> F {
        self.flash
    }

    fn read(&mut self, copy: u8) -> Found {
        let mut bytes = [0; RECORD_BYTES];
        match self.flash.read(Self::offset(copy), &mut bytes) {
            Ok(()) => match Found::in_bytes(&bytes) {
                // The copy is whole, but another version of this image wrote it, with other ranges.
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

/// Returns the newer one of the whole copies.
fn newest(copies: &[Found; 2]) -> Option<(u8, &Record)> {
    match copies {
        [Found::Whole(first), Found::Whole(second)] => {
            // Sequence numbers wrap.
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
