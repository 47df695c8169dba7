//! Settings in two pages at the end of flash bank 2 (RM0440, section 3.3). The image runs from bank 1, so that the
//! processor does not stop while a page is erased (22 ms, data sheet DS12288) or written.

use core::ptr;

use embedded_storage::nor_flash::{
    ErrorType, NorFlash, NorFlashErrorKind, ReadNorFlash, check_erase, check_read, check_write,
};
use stm32g4xx_hal::stm32::FLASH;

use super::watchdog;

/// Address of the pages (`board.x`).
const START: usize = 0x0807_f000;
const PAGE: usize = 2048;
const PAGES: usize = 2;
/// Number of the first page in bank 2, which begins at 0x0804_0000.
const FIRST_PAGE: u32 = ((START - 0x0804_0000) / PAGE) as u32;
/// Number of bytes that are written at once.
const DOUBLE_WORD: usize = 8;

/// Unlock keys of section 3.3.5.
const KEYS: [u32; 2] = [0x4567_0123, 0xcdef_89ab];

/// Largest number of polls of the status register before a page or a double word counts as failed. An erase takes at
/// most 24.5 ms (DS12288, table 54), and each poll takes a tenth of a microsecond or more.
const LOOKS_MAX: u32 = 2_000_000;

/// Settings pages in flash.
pub(super) struct Flash {
    registers: FLASH,
}

impl Flash {
    pub(super) fn new(registers: FLASH) -> Self {
        Self { registers }
    }

    /// Runs `work` with the registers unlocked, and locks them again.
    fn unlocked(
        &mut self,
        work: impl FnOnce(&mut Self) -> Result<(), NorFlashErrorKind>,
    ) -> Result<(), NorFlashErrorKind> {
        self.settled()?;
        for key in KEYS {
            self.registers.keyr().write(|w| {
                // SAFETY: one of the two keys, in their order; code that is interrupted between them does not write to
                // flash.
                unsafe { w.keyr().bits(key) }
            });
        }
        let done = work(self);
        self.registers.cr().write(|w| w.lock().set_bit());
        done
    }

    /// Waits until the flash is idle, for at most [`LOOKS_MAX`] polls. An error flag is returned as an error and
    /// cleared.
    fn settled(&mut self) -> Result<(), NorFlashErrorKind> {
        for _ in 0..LOOKS_MAX {
            let status = self.registers.sr().read();
            if status.bsy().bit_is_set() {
                // An erase takes as long as three samples; this wait has its own limit.
                watchdog::feed_again();
                continue;
            }
            // The flags, including end of operation, are cleared by writing ones; EOP is no error.
            self.registers.sr().write(|w| {
                // SAFETY: flags that were set, and read-only bits.
                unsafe { w.bits(status.bits()) }
            });
            let errors = status.bits() & !1;
            return if errors == 0 {
                Ok(())
            } else {
                Err(NorFlashErrorKind::Other)
            };
        }
        Err(NorFlashErrorKind::Other)
    }

    fn erase_page(&mut self, page: u32) -> Result<(), NorFlashErrorKind> {
        let number = FIRST_PAGE.wrapping_add(page) as u8;
        self.registers.cr().write(|w| {
            w.per().set_bit().bker().set_bit();
            // SAFETY: `check_erase` keeps the page within the two of the settings.
            unsafe { w.pnb().bits(number) }
        });
        self.registers.cr().modify(|_, w| w.strt().set_bit());
        self.settled()
    }

    fn write_double_word(
        &mut self,
        offset: usize,
        bytes: [u8; DOUBLE_WORD],
    ) -> Result<(), NorFlashErrorKind> {
        let [low, high] = halves(bytes);
        let place = ptr::without_provenance_mut::<u32>(START.wrapping_add(offset));
        self.registers.cr().write(|w| w.pg().set_bit());
        // SAFETY: `check_write` keeps the offset within the two pages, which contain no Rust object; the flash takes
        // the two words as one double word, in this order (section 3.3.7).
        unsafe {
            ptr::write_volatile(place, low);
            cortex_m::asm::isb();
            ptr::write_volatile(place.wrapping_add(1), high);
        }
        self.settled()
    }
}

/// Returns whether an uncorrectable word was found in the settings' bank, and clears the flag.
pub(super) fn forgive_torn_settings() -> bool {
    // SAFETY: no other code uses these flags.
    let flags = unsafe { &*FLASH::ptr() }.eccr();
    let found = flags.read();
    let in_settings = found.eccd().bit_is_set() && found.bk_ecc().bit_is_set();
    if in_settings {
        flags.modify(|_, w| w.eccd().set_bit());
    }
    in_settings
}

fn halves(bytes: [u8; DOUBLE_WORD]) -> [u32; 2] {
    let word = u64::from_le_bytes(bytes);
    [word as u32, (word >> 32) as u32]
}

impl ErrorType for Flash {
    type Error = NorFlashErrorKind;
}

impl ReadNorFlash for Flash {
    const READ_SIZE: usize = 1;

    fn read(&mut self, offset: u32, bytes: &mut [u8]) -> Result<(), Self::Error> {
        check_read(self, offset, bytes.len())?;
        let place = ptr::without_provenance::<u8>(START.wrapping_add(offset as usize));
        for (index, byte) in bytes.iter_mut().enumerate() {
            // SAFETY: `check_read` keeps the address within the two pages, which always exist and change only here.
            *byte = unsafe { ptr::read_volatile(place.wrapping_add(index)) };
        }
        Ok(())
    }

    fn capacity(&self) -> usize {
        PAGE * PAGES
    }
}

impl NorFlash for Flash {
    const WRITE_SIZE: usize = DOUBLE_WORD;
    const ERASE_SIZE: usize = PAGE;

    fn erase(&mut self, from: u32, to: u32) -> Result<(), Self::Error> {
        check_erase(self, from, to)?;
        let pages = from / PAGE as u32..to / PAGE as u32;
        self.unlocked(|flash| {
            pages
                .into_iter()
                .try_for_each(|page| flash.erase_page(page))
        })
    }

    fn write(&mut self, offset: u32, bytes: &[u8]) -> Result<(), Self::Error> {
        check_write(self, offset, bytes.len())?;
        let (words, _) = bytes.as_chunks::<DOUBLE_WORD>();
        self.unlocked(|flash| {
            let mut place = offset as usize;
            for &word in words {
                flash.write_double_word(place, word)?;
                place = place.wrapping_add(DOUBLE_WORD);
            }
            Ok(())
        })
    }
}
