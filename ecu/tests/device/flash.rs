//! Flash memory whose supply fails.

use embedded_storage::nor_flash::{ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash};

/// Content of the byte that was being written when the supply fails.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Cut {
    Old,
    New,
    Erased,
    Other(u8),
}

#[derive(Clone, Debug)]
pub(crate) struct Flash {
    pub(crate) bytes: Vec<u8>,
    /// Number of bytes that are written or erased until the supply fails.
    pub(crate) until_cut: Option<(usize, Cut)>,
    dead: bool,
    /// Byte that can no longer be written.
    pub(crate) worn: Option<usize>,
}

impl Flash {
    pub(crate) const PAGE: usize = 256;

    pub(crate) fn new(pages: usize) -> Self {
        Self {
            bytes: vec![0xFF; pages * Self::PAGE],
            until_cut: None,
            dead: false,
            worn: None,
        }
    }

    /// Restores the supply.
    pub(crate) fn revived(mut self) -> Self {
        self.dead = false;
        self.until_cut = None;
        self
    }

    fn put(&mut self, at: usize, byte: u8) -> Result<(), NorFlashErrorKind> {
        if self.dead {
            return Err(NorFlashErrorKind::Other);
        }
        if let Some((left, cut)) = &mut self.until_cut {
            if *left == 0 {
                self.dead = true;
                match *cut {
                    Cut::Old => {}
                    Cut::New => self.bytes[at] = byte,
                    Cut::Erased => self.bytes[at] = 0xFF,
                    Cut::Other(other) => self.bytes[at] = other,
                }
                return Err(NorFlashErrorKind::Other);
            }
            *left -= 1;
        }
        if self.worn != Some(at) {
            self.bytes[at] = byte;
        }
        Ok(())
    }
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 4;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), NorFlashErrorKind> {
        let start = offset as usize;
        assert!(
            start.is_multiple_of(Self::READ_SIZE) && bytes.len().is_multiple_of(Self::READ_SIZE)
        );
        let part = self.bytes.get(start..start + bytes.len());
        bytes.copy_from_slice(part.ok_or(NorFlashErrorKind::OutOfBounds)?);
        Ok(())
    }

    fn capacity(&self) -> usize {
        self.bytes.len()
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = 8;
    const ERASE_SIZE: usize = Self::PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), NorFlashErrorKind> {
        assert!(from.is_multiple_of(Self::PAGE as u32) && to.is_multiple_of(Self::PAGE as u32));
        (from as usize..to as usize).try_for_each(|at| self.put(at, 0xFF))
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), NorFlashErrorKind> {
        let start = offset as usize;
        assert!(
            start.is_multiple_of(Self::WRITE_SIZE) && bytes.len().is_multiple_of(Self::WRITE_SIZE)
        );
        for (at, &byte) in (start..).zip(bytes) {
            assert_eq!(self.bytes[at], 0xFF, "byte {at} is written twice");
            self.put(at, byte)?;
        }
        Ok(())
    }
}
