//! The encoding of the log's frames: rzCOBS, as the logging framework defines it.
//!
//! The framework brings an encoder as well, but it can panic where overflow is checked, and nothing in the image may.

/// Encodes one frame after the other so that no byte of it is zero, but for one after its end.
///
/// ```text
/// 0xxx_xxxx  ends up to seven bytes: a one stands for a zero byte, a zero for one of the bytes before, lowest bit first
/// 1nnn_nnnn  ends n + 7 bytes without a zero among them, and stands for the zero after them
/// 1111_1111  ends 134 bytes without a zero among or after them
/// ```
/// Read backwards from the end of a frame ("r"), so that the encoder needs no memory of the bytes.
pub struct Rzcobs {
    /// Bytes since the last code.
    run: u8,
    /// Which of the first seven of them are zero, lowest bit first.
    zeros: u8,
}

/// Bytes that a code of the first kind has room for.
const SHORT: u8 = 7;
/// Bytes after which a code of the third kind comes.
const LONG: u8 = 134;

impl Rzcobs {
    /// Before a frame.
    #[expect(
        clippy::new_without_default,
        reason = "meant for a static, which needs a constant"
    )]
    pub const fn new() -> Self {
        Self { run: 0, zeros: 0 }
    }

    /// The next byte of the frame.
    pub fn write(&mut self, byte: u8, mut put: impl FnMut(u8)) {
        if byte != 0 {
            put(byte);
        } else if self.run < SHORT {
            self.zeros |= 1 << self.run;
        } else {
            put(self.long_code());
            *self = Self::new();
            return;
        }
        self.run = self.run.saturating_add(1);
        let code = match self.run {
            SHORT if self.zeros != 0 => self.zeros,
            LONG => 0xff,
            _ => return,
        };
        put(code);
        *self = Self::new();
    }

    /// The end of the frame.
    pub fn end(&mut self, mut put: impl FnMut(u8)) {
        match self.run {
            0 => {}
            // What is missing of seven reads as zeros, which the reader drops.
            run @ 1..SHORT => put((self.zeros | 0xff << run) & 0x7f),
            _ => put(self.long_code()),
        }
        put(0);
        *self = Self::new();
    }

    fn long_code(&self) -> u8 {
        0x80 | self.run.saturating_sub(SHORT)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn encoded(frame: &[u8]) -> Vec<u8> {
        let mut encoder = Rzcobs::new();
        let mut bytes = Vec::new();
        for &byte in frame {
            encoder.write(byte, |byte| bytes.push(byte));
        }
        encoder.end(|byte| bytes.push(byte));
        bytes
    }

    #[test]
    fn frames_are_encoded_as_the_framework_gives_examples_of() {
        for (frame, expected) in [
            (&[][..], &[0x00][..]),
            (&[0x00], &[0x7f, 0x00]),
            (&[0x00; 8], &[0x7f, 0x7f, 0x00]),
            (&[0x01, 0x02], &[0x01, 0x02, 0x7c, 0x00]),
            (
                &[0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77],
                &[0x11, 0x22, 0x33, 0x44, 0x55, 0x66, 0x77, 0x80, 0x00],
            ),
            (&[0x00, 0x00, 0x44, 0x00], &[0x44, 0x7b, 0x00]),
        ] {
            assert_eq!(encoded(frame), expected, "{frame:x?}");
        }
    }

    /// Mostly zeros, few zeros, none: each kind of code is met.
    fn frames() -> impl Strategy<Value = Vec<u8>> {
        (0_u8..=20).prop_flat_map(|weight| {
            let byte = prop_oneof![1 => Just(0), u32::from(weight) => 1..=u8::MAX];
            proptest::collection::vec(byte, 0..600)
        })
    }

    proptest! {
        /// Against the decoder of another author, which the host's tools use.
        #[test]
        fn a_decoder_finds_the_frame_and_no_byte_before_the_end_is_zero(frame in frames()) {
            let encoded = encoded(&frame);
            let (end, code) = encoded.split_last().unwrap();
            prop_assert_eq!(*end, 0);
            prop_assert!(!code.contains(&0));
            let mut decoded = rzcobs::decode(code).unwrap();
            // What fills the last code up reads as zeros; the framework allows for them.
            let filled = decoded.split_off(frame.len().min(decoded.len()));
            prop_assert!(filled.len() < 7 && filled.iter().all(|byte| *byte == 0));
            prop_assert_eq!(decoded, frame);
        }
    }
}
