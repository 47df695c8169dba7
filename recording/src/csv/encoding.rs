//! Encoding of a text file: UTF-8, or one of those that spreadsheets and older loggers write.

use std::borrow::Cow;
use std::fmt;
use std::io::{self, Read};

use encoding_rs::{CoderResult, Decoder, UTF_16BE, UTF_16LE, WINDOWS_1252};

/// Size of a piece that is decoded at once (bytes).
const PIECE_BYTES: usize = 16 << 10;

/// Encoding of a text file, found from its head.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Encoding {
    /// UTF-8, with or without byte order mark.
    #[default]
    Utf8,
    /// UTF-16, low byte first: "Unicode text" of spreadsheets.
    Utf16LittleEndian,
    /// UTF-16, high byte first.
    Utf16BigEndian,
    /// Windows-1252, which contains Latin-1.
    Windows1252,
}

impl Encoding {
    /// Returns the encoding of a text that begins with `head`.
    pub fn of_head(head: &[u8]) -> Self {
        match head {
            [0xff, 0xfe, ..] | [_, 0, _, 0, ..] => return Self::Utf16LittleEndian,
            [0xfe, 0xff, ..] | [0, _, 0, _, ..] => return Self::Utf16BigEndian,
            _ => {}
        }
        match std::str::from_utf8(head) {
            Ok(_) => Self::Utf8,
            // The head may end within a character.
            Err(error) if error.error_len().is_none() => Self::Utf8,
            Err(_) if is_windows_1252(head) => Self::Windows1252,
            Err(_) => Self::Utf8,
        }
    }

    fn decoder(self) -> Option<Decoder> {
        let encoding = match self {
            Self::Utf8 => return None,
            Self::Utf16LittleEndian => UTF_16LE,
            Self::Utf16BigEndian => UTF_16BE,
            Self::Windows1252 => WINDOWS_1252,
        };
        Some(encoding.new_decoder_with_bom_removal())
    }

    /// Returns the head as UTF-8; a character that is cut at its end is left out.
    pub fn decoded(self, mut head: &[u8]) -> Cow<'_, [u8]> {
        if self == Self::Utf8 {
            return Cow::Borrowed(head);
        }
        let mut decoding = Decoding::new(self);
        let (mut text, mut piece) = (Vec::new(), vec![0; PIECE_BYTES]);
        // The head of a file may be cut, which is no damage.
        while let Ok(count @ 1..) = decoding.read(&mut head, &mut piece, &mut |_| ()) {
            text.extend_from_slice(&piece[..count]);
        }
        Cow::Owned(text)
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Utf8 => "UTF-8",
            Self::Utf16LittleEndian | Self::Utf16BigEndian => "UTF-16",
            Self::Windows1252 => "Windows-1252",
        })
    }
}

/// Returns whether bytes that are not UTF-8 look like a text in Windows-1252: mostly ASCII, without control characters
/// and without bytes that this encoding leaves free.
fn is_windows_1252(head: &[u8]) -> bool {
    let is_control = |byte: u8| byte < 0x20 && !matches!(byte, b'\t' | b'\n' | b'\r');
    let is_free = |byte: u8| matches!(byte, 0x7f | 0x81 | 0x8d | 0x8f | 0x90 | 0x9d);
    let high = head.iter().filter(|byte| !byte.is_ascii()).count();
    4 * high <= head.len() && !head.iter().any(|&byte| is_control(byte) || is_free(byte))
}

/// Conversion of an input into UTF-8, piece by piece.
pub(super) struct Decoding {
    decoder: Option<Decoder>,
    /// Whether carriage returns become line feeds.
    pub(super) carriage_returns: bool,
    raw: Vec<u8>,
    position: usize,
    filled: usize,
    at_end: bool,
    is_done: bool,
}

impl Decoding {
    pub(super) fn new(encoding: Encoding) -> Self {
        let decoder = encoding.decoder();
        let size = if decoder.is_some() { PIECE_BYTES } else { 0 };
        Self {
            decoder,
            carriage_returns: false,
            raw: vec![0; size],
            position: 0,
            filled: 0,
            at_end: false,
            is_done: false,
        }
    }

    /// Reads the next piece of text into `text` and returns its length, 0 at the end. `see` gets the bytes of the input
    /// as they are.
    ///
    /// # Errors
    /// Returns the error of the input, or `InvalidData` for bytes that the encoding does not allow.
    pub(super) fn read(
        &mut self,
        input: &mut impl Read,
        text: &mut [u8],
        see: &mut dyn FnMut(&[u8]),
    ) -> io::Result<usize> {
        // A decoder that has ended must not be used again.
        if self.is_done {
            return Ok(0);
        }
        let Some(decoder) = &mut self.decoder else {
            let count = retried(input, text)?;
            see(&text[..count]);
            if self.carriage_returns {
                to_line_feeds(&mut text[..count]);
            }
            return Ok(count);
        };
        loop {
            if self.position == self.filled && !self.at_end {
                self.filled = retried(input, &mut self.raw)?;
                self.position = 0;
                self.at_end = self.filled == 0;
                see(&self.raw[..self.filled]);
            }
            let rest = &self.raw[self.position..self.filled];
            let (result, read, written, is_damaged) =
                decoder.decode_to_utf8(rest, text, self.at_end);
            self.position += read;
            if is_damaged {
                return Err(io::ErrorKind::InvalidData.into());
            }
            let is_done = self.at_end && result == CoderResult::InputEmpty;
            self.is_done = is_done;
            if written > 0 || is_done {
                if self.carriage_returns {
                    to_line_feeds(&mut text[..written]);
                }
                return Ok(written);
            }
        }
    }
}

/// Replaces carriage returns by line feeds.
pub(super) fn to_line_feeds(text: &mut [u8]) {
    for byte in text.iter_mut().filter(|byte| **byte == b'\r') {
        *byte = b'\n';
    }
}

fn retried(input: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    loop {
        match input.read(buffer) {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            result => return result,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn utf16(text: &str, swap: bool) -> Vec<u8> {
        let units = std::iter::once(0xfeff).chain(text.encode_utf16());
        let bytes = |unit: u16| {
            if swap {
                unit.to_be_bytes()
            } else {
                unit.to_le_bytes()
            }
        };
        units.flat_map(bytes).collect()
    }

    #[test]
    fn every_encoding_is_found_and_decoded() {
        let text = "Zeit;Überdruck [bar];°C\n0;1;€\n";
        let windows: Vec<u8> = text
            .chars()
            .map(|character| {
                if character == '€' {
                    0x80
                } else {
                    character as u8
                }
            })
            .collect();
        for (bytes, encoding) in [
            (text.as_bytes().to_vec(), Encoding::Utf8),
            (utf16(text, false), Encoding::Utf16LittleEndian),
            (utf16(text, true), Encoding::Utf16BigEndian),
            (windows, Encoding::Windows1252),
        ] {
            assert_eq!(Encoding::of_head(&bytes), encoding);
            let decoded = encoding.decoded(&bytes);
            assert_eq!(std::str::from_utf8(&decoded).unwrap(), text, "{encoding}");
        }
    }

    #[test]
    fn a_cut_character_is_no_other_encoding_and_binary_data_is_none() {
        assert_eq!(
            Encoding::of_head(&"Druck ü".as_bytes()[..7]),
            Encoding::Utf8
        );
        assert_eq!(
            Encoding::of_head(&[0xff, 0x01, 0x90, b'a', b'b', b'c', b'd']),
            Encoding::Utf8
        );
        let mut cut = utf16("Zeit", false);
        cut.pop();
        assert_eq!(&*Encoding::Utf16LittleEndian.decoded(&cut), b"Zei");
    }

    #[test]
    fn the_bytes_of_the_input_are_seen_as_they_are() {
        let bytes = utf16(&"Zeit;1,5\n".repeat(5000), false);
        let (mut input, mut seen, mut text) = (&bytes[..], Vec::new(), Vec::new());
        let mut decoding = Decoding::new(Encoding::Utf16LittleEndian);
        let mut piece = vec![0; 100];
        loop {
            let count = decoding.read(&mut input, &mut piece, &mut |raw| {
                seen.extend_from_slice(raw)
            });
            match count.unwrap() {
                0 => break,
                count => text.extend_from_slice(&piece[..count]),
            }
        }
        assert_eq!(seen, bytes);
        assert_eq!(text, "Zeit;1,5\n".repeat(5000).as_bytes());
    }
}
