//! Flash memory simulated in RAM, for a machine without flash memory and for a controller in process.

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashError, NorFlashErrorKind, ReadNorFlash,
};

/// RAM that behaves like flash memory: erased in pages to 0xFF, written in words.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RamFlash<const BYTES: usize> {
    bytes: [u8; BYTES],
}

/// Error: an address beyond the memory, or not aligned to its words.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("outside of the memory, or between its words")]
pub struct RamFlashError;

impl NorFlashError for RamFlashError {
    fn kind(&self) -> NorFlashErrorKind {
        NorFlashErrorKind::OutOfBounds
    }
}

impl<const BYTES: usize> RamFlash<BYTES> {
    /// Creates an erased memory, as a new part is.
    pub const fn new() -> Self {
        Self {
            bytes: [0xFF; BYTES],
        }
    }

    fn part(&mut self, offset: u32, length: usize) -> Result<&mut [u8], RamFlashError> {
        let start = usize::try_from(offset).map_err(|_| RamFlashError)?;
        let end = start.checked_add(length).ok_or(RamFlashError)?;
        self.bytes.get_mut(start..end).ok_or(RamFlashError)
    }
}

impl<const BYTES: usize> Default for RamFlash<BYTES> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const BYTES: usize> ErrorType for RamFlash<BYTES> {
    type Error = RamFlashError;
}

impl<const BYTES: usize> ReadNorFlash for RamFlash<BYTES> {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), RamFlashError> {
        let part = self.part(offset, bytes.len())?;
        for (byte, &stored) in bytes.iter_mut().zip(&*part) {
            *byte = stored;
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        BYTES
    }
}

impl<const BYTES: usize> NorFlash for RamFlash<BYTES> {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = 256;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), RamFlashError> {
        let length = to.checked_sub(from).ok_or(RamFlashError)? as usize;
        if !from.is_multiple_of(Self::ERASE_SIZE as u32) || !length.is_multiple_of(Self::ERASE_SIZE)
        {
            return Err(RamFlashError);
        }
        self.part(from, length)?.fill(0xFF);
        Ok(())
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), RamFlashError> {
        if !offset.is_multiple_of(Self::WRITE_SIZE as u32)
            || !bytes.len().is_multiple_of(Self::WRITE_SIZE)
        {
            return Err(RamFlashError);
        }
        let part = self.part(offset, bytes.len())?;
        for (stored, &byte) in part.iter_mut().zip(bytes) {
            // A write clears bits and sets none.
            *stored &= byte;
        }
        Ok(())
    }
}
