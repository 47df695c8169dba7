//! One line of text, built without the core library's formatter. The formatter calls through pointers and can panic;
//! with it the stack of the image could not be bounded, and panics could not be excluded.

/// Line of at most [`Line::LENGTH_MAX`] bytes; longer text is cut off.
pub(crate) struct Line {
    bytes: [u8; Self::LENGTH_MAX],
    length: usize,
}

impl Line {
    const LENGTH_MAX: usize = 128;

    /// Creates an empty line.
    pub(crate) const fn new() -> Self {
        Self {
            bytes: [0; Self::LENGTH_MAX],
            length: 0,
        }
    }

    /// Appends this text, up to its first character that is not ASCII.
    pub(crate) fn text(mut self, text: &str) -> Self {
        for byte in text.bytes().take_while(u8::is_ascii) {
            self.push(byte);
        }
        self
    }

    /// Appends this number, without leading zeros.
    pub(crate) fn decimal(mut self, number: u32) -> Self {
        let mut divisor = 1_000_000_000;
        while divisor > 1 && number < divisor {
            divisor /= 10;
        }
        while divisor > 0 {
            self.push(b'0' + (number / divisor % 10) as u8);
            divisor /= 10;
        }
        self
    }

    /// Appends this number, as 16 hexadecimal digits.
    pub(crate) fn hex(mut self, number: u64) -> Self {
        for place in (0..16).rev() {
            let digit = (number >> (4 * place)) as u8 & 0xf;
            self.push(if digit < 10 {
                b'0' + digit
            } else {
                b'a' - 10 + digit
            });
        }
        self
    }

    /// Returns the whole line.
    pub(crate) fn as_str(&self) -> &str {
        let bytes = self.bytes.get(..self.length).unwrap_or_default();
        // Only ASCII was appended.
        core::str::from_utf8(bytes).unwrap_or_default()
    }

    fn push(&mut self, byte: u8) {
        if let Some(place) = self.bytes.get_mut(self.length) {
            *place = byte;
            self.length = self.length.saturating_add(1);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_the_standard_formatter_writes_them() {
        for number in [0, 1, 9, 10, 65_536, 999_999_999, 1_000_000_000, u32::MAX] {
            assert_eq!(Line::new().decimal(number).as_str(), format!("{number}"));
        }
        for number in [0, 1, 0x0123_4567_89ab_cdef, u64::MAX] {
            assert_eq!(Line::new().hex(number).as_str(), format!("{number:016x}"));
        }
    }

    #[test]
    fn a_line_ends_where_it_is_full_and_text_where_it_is_not_ascii() {
        let full = Line::new().text(&"x".repeat(200)).decimal(7);
        assert_eq!(full.as_str(), "x".repeat(128));
        assert_eq!(Line::new().text("5 µs").text("!").as_str(), "5 !");
    }
}
