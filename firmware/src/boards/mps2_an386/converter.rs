//! Simulated converter of the pressure sensor: it answers on SPI as the real part does, bit by bit.

use core::convert::Infallible;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use firmware::drivers::frame_of;

use super::pins;

/// MCP3201 behind its chip select, which converts the simulated pin values.
pub(super) struct Converter;

/// Bytes read from a line that only a pull-up drives.
const SILENCE: [u8; 4] = [0xff; 4];

impl ErrorType for Converter {
    type Error = Infallible;
}

impl SpiDevice for Converter {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        let frame = pins::pressure().map_or(SILENCE, frame_of);
        // The part has no data input and continues its answer for every kind of transfer; after the answer it clocks
        // out zeros.
        let mut answer = frame.into_iter().chain(core::iter::repeat(0));
        for operation in operations {
            match operation {
                Operation::Read(words) | Operation::TransferInPlace(words) => {
                    words
                        .iter_mut()
                        .zip(&mut answer)
                        .for_each(|(word, byte)| *word = byte);
                }
                Operation::Transfer(words, _) => {
                    words
                        .iter_mut()
                        .zip(&mut answer)
                        .for_each(|(word, byte)| *word = byte);
                }
                Operation::Write(words) => answer.by_ref().take(words.len()).for_each(drop),
                Operation::DelayNs(_) => {}
            }
        }
        Ok(())
    }
}
