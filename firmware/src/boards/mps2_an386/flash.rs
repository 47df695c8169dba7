//! Simulated flash, two pages: RAM that a warm reset does not change, erased and written like flash.

use core::sync::atomic::{AtomicU8, Ordering};

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};

use super::memory::{SETTINGS, SETTINGS_BYTES};

/// Simulated pages like those of the STM32G4: erased in units of 2 KiB, written in units of eight bytes.
pub(super) struct Flash;

impl Flash {
    /// Takes over the pages. After a cold start their content is random, so they are erased.
    pub(super) fn start(cold: bool) -> Self {
        if cold {
            SETTINGS.iter().for_each(erase);
        }
        Self
    }
}

fn erase(byte: &AtomicU8) {
    byte.store(0xff, Ordering::Relaxed);
}

fn part(offset: u32, length: usize) -> impl Iterator<Item = &'static AtomicU8> {
    SETTINGS.iter().skip(offset as usize).take(length)
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        for (byte, stored) in bytes.iter_mut().zip(part(offset, usize::MAX)) {
            *byte = stored.load(Ordering::Relaxed);
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        SETTINGS_BYTES
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = 2048;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        part(from, to.saturating_sub(from) as usize).for_each(erase);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        for (&byte, stored) in bytes.iter().zip(part(offset, bytes.len())) {
            // A write clears bits and sets none.
            stored.fetch_and(byte, Ordering::Relaxed);
        }
        Ok(())
    }
}
