//! SPI bus of the pressure sensor's converter, with its chip select.

use embedded_hal::spi::{ErrorType, Operation, SpiBus, SpiDevice};
use stm32g4xx_hal::gpio::{AF5, Output, PB12, PB13, PB14, PB15};
use stm32g4xx_hal::spi::{Error, Spi};
use stm32g4xx_hal::stm32::SPI2;

type Lines = (PB13<AF5>, PB14<AF5>, PB15<AF5>);

/// SPI bus with a single device.
pub(super) struct Bus {
    bus: Spi<SPI2, Lines>,
    select: PB12<Output>,
}

impl Bus {
    pub(super) fn new(bus: Spi<SPI2, Lines>, mut select: PB12<Output>) -> Self {
        select.set_high();
        Self { bus, select }
    }
}

impl ErrorType for Bus {
    type Error = Error;
}

impl SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Error> {
        self.select.set_low();
        let mut done = Ok(());
        for operation in operations {
            done = done.and_then(|()| match operation {
                Operation::Read(words) => self.bus.read(words),
                Operation::Write(words) => self.bus.write(words),
                Operation::Transfer(read, write) => self.bus.transfer(read, write),
                Operation::TransferInPlace(words) => self.bus.transfer_in_place(words),
                // The part needs no delays.
                Operation::DelayNs(_) => Ok(()),
            });
        }
        let flushed = SpiBus::<u8>::flush(&mut self.bus);
        self.select.set_high();
        done.and(flushed)
    }
}
