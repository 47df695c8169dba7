//! Register of a device.

use core::ptr;

/// Register of a device of this machine, 32 bits.
#[derive(Clone, Copy)]
pub(super) struct Register(*mut u32);

impl Register {
    /// Creates the register at an address that the machine's memory map assigns to a device.
    pub(super) const fn at(address: usize) -> Self {
        assert!(address >= 0x4000_0000 && address < 0x4003_0000 && address.is_multiple_of(4));
        Self(ptr::without_provenance_mut(address))
    }

    /// Reads the register.
    #[inline]
    pub(super) fn read(self) -> u32 {
        // SAFETY: `at` took an aligned address in the range of this machine's peripherals, which contains no memory of
        // the image.
        unsafe { ptr::read_volatile(self.0) }
    }

    /// Writes the register.
    #[inline]
    pub(super) fn write(self, value: u32) {
        // SAFETY: as in `read`.
        unsafe { ptr::write_volatile(self.0, value) }
    }
}
