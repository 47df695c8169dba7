//! Converter of the pressure sensor: Microchip MCP3201, 12 bits, SPI (data sheet DS21290F).

use ecu::SensorCode;
use embedded_hal::spi::SpiDevice;

/// Microchip MCP3201: one channel, 12 bits, 100 000 conversions per second, 2.7 V to 5.5 V.
///
/// A conversion begins with chip select and is shifted out by the clock that reads it, on falling edges, for SPI mode
/// (0, 0) or (1, 1), at up to 1.6 MHz with a supply of 5 V (section 1.0). In 32 clocks the part sends the result twice
/// (sections 5.0 and 6.1):
///
/// ```text
/// clock  1  2 | 3    | 4 ... 15          | 16 ... 26          | 27 ... 32
///        ?  ? | 0    | B11 B10 ... B1 B0 | B1 B2 ... B10 B11  | 0 ... 0
///      sample | null | most significant  | least significant  | nothing left
///             |      | bit first         | bit first          |
/// ```
/// Two clocks sample the input, with the output open. If the transfer of a conversion was disturbed, it differs from
/// its mirror image. A line that is stuck high has no null bit. Both are errors and give no pressure. A line that is
/// stuck low reads as code 0, which the sensor never gives (its lowest is 48): the supervisor detects it.
#[derive(Debug)]
pub struct Mcp3201<S> {
    spi: S,
}

/// Reason why there is no code.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReadError<E> {
    /// The SPI bus failed.
    #[error("the SPI bus failed")]
    Bus(E),
    /// No null bit, or set bits after the end: no part drives the line.
    #[error("the converter did not answer: {word:#010x}")]
    NoAnswer {
        /// The 32 bits, first clock first.
        word: u32,
    },
    /// The conversion and its mirror image differ.
    #[error(
        "the answer was disturbed: {code:#05x}, but bits 11 to 1 came again as {mirrored:#05x}"
    )]
    Disturbed {
        /// Bits 11 to 0, as sent first.
        code: u16,
        /// Bits 11 to 1, as sent second.
        mirrored: u16,
    },
}

/// Null bit: clock 3, counted from the most significant of 32 bits.
const NULL_BIT: u32 = 1 << 29;
/// Bits after the end: clocks 27 to 32.
const END_BITS: u32 = 0x3f;

impl<S: SpiDevice> Mcp3201<S> {
    /// Creates the driver from an SPI device in mode (0, 0) or (1, 1), at no more than 1.6 MHz.
    pub const fn new(spi: S) -> Self {
        Self { spi }
    }

    /// Converts once and reads the result: 32 clocks, 20 µs at 1.6 MHz.
    ///
    /// # Errors
    /// Returns [`ReadError`] if there is no code; the next call may succeed.
    pub fn read(&mut self) -> Result<SensorCode, ReadError<S::Error>> {
        let mut frame = [0; 4];
        self.spi.read(&mut frame).map_err(ReadError::Bus)?;
        let word = u32::from_be_bytes(frame);
        if word & (NULL_BIT | END_BITS) != 0 {
            return Err(ReadError::NoAnswer { word });
        }
        let code = (word >> 17) as u16 & SensorCode::MAX.bits();
        // Eleven bits, B1 first; reversed they are B11 to B1.
        let mirrored = ((word >> 6) as u16 & 0x7ff).reverse_bits() >> 5;
        match SensorCode::from_bits(code) {
            Some(read) if code >> 1 == mirrored => Ok(read),
            _ => Err(ReadError::Disturbed { code, mirrored }),
        }
    }
}

/// Returns the 32 bits with which the part answers for a code, for a simulation of the part.
///
/// The two bits before the null bit are not driven; they are high, as a pull-up would make them.
pub const fn frame_of(code: SensorCode) -> [u8; 4] {
    let code = code.bits() as u32;
    let mirror = (code >> 1).reverse_bits() >> 21;
    (0b11 << 30 | code << 17 | mirror << 6).to_be_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;
    use embedded_hal::spi::{ErrorKind, ErrorType, Operation};
    use embedded_hal_mock::eh1::spi::{Mock, Transaction};

    /// Returns the driver's result for one answer of the part.
    fn read(frame: [u8; 4]) -> Result<SensorCode, ReadError<ErrorKind>> {
        let mut spi = Mock::new(&[
            Transaction::transaction_start(),
            Transaction::read_vec(frame.to_vec()),
            Transaction::transaction_end(),
        ]);
        let read = Mcp3201::new(spi.clone()).read();
        spi.done();
        read
    }

    /// The data sheet's order of bits, written out for one code: 0b1010_0110_0101.
    #[test]
    fn a_conversion_is_read_as_the_data_sheet_draws_it() {
        // Undriven and null bit, B11 to B0, B1 to B11, zeros.
        let drawn = "110 101001100101 01001100101 000000";
        let frame = u32::from_str_radix(&drawn.replace(' ', ""), 2).unwrap();
        let code = SensorCode::from_bits(0b1010_0110_0101).unwrap();
        assert_eq!(read(frame.to_be_bytes()), Ok(code));
        assert_eq!(frame_of(code), frame.to_be_bytes());
    }

    #[test]
    fn every_code_is_read_whatever_floats_before_the_null_bit() {
        for bits in 0..=4095 {
            let code = SensorCode::from_bits(bits).unwrap();
            let mut frame = frame_of(code);
            assert_eq!(read(frame), Ok(code));
            frame[0] &= 0x3f;
            assert_eq!(read(frame), Ok(code));
        }
    }

    /// The last bit is sent only once, because the order reverses there.
    #[test]
    fn any_single_disturbed_bit_is_an_error_except_the_undriven_ones_and_the_last_one() {
        const UNDRIVEN: [u32; 2] = [31, 30];
        const LAST_OF_CODE: u32 = 17;
        for bits in [0, 1, 48, 1000, 0x555, 0xaaa, 4048, 4095] {
            let frame = u32::from_be_bytes(frame_of(SensorCode::from_bits(bits).unwrap()));
            for bit in 0..32 {
                let disturbed = read((frame ^ 1 << bit).to_be_bytes()).map(SensorCode::bits);
                if UNDRIVEN.contains(&bit) {
                    assert_eq!(disturbed, Ok(bits), "bit {bit}");
                } else if bit == LAST_OF_CODE {
                    assert_eq!(disturbed, Ok(bits ^ 1));
                } else {
                    assert!(disturbed.is_err(), "code {bits}, bit {bit}: {disturbed:?}");
                }
            }
        }
    }

    #[test]
    fn a_line_that_hangs_high_is_no_answer_and_one_that_hangs_low_is_code_0() {
        let word = u32::MAX;
        assert_eq!(read([0xff; 4]), Err(ReadError::NoAnswer { word }));
        assert_eq!(read([0; 4]), Ok(SensorCode::MIN));
    }

    /// SPI device that always fails; the mock of the bus cannot fail.
    struct Broken;

    impl ErrorType for Broken {
        type Error = ErrorKind;
    }

    impl SpiDevice for Broken {
        fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
            Err(ErrorKind::ModeFault)
        }
    }

    #[test]
    fn a_bus_that_fails_is_reported() {
        let read = Mcp3201::new(Broken).read();
        assert_eq!(read, Err(ReadError::Bus(ErrorKind::ModeFault)));
    }
}
