//! Encoding of the log's frames: rzCOBS, as defined by the logging framework.
//!
//! The framework has an encoder as well, but it can panic where overflow is checked, and nothing in the image may
//! panic.

/// Encoder of successive frames: no byte of a frame is zero, except one after its end.
///
/// ```text
/// 0xxx_xxxx  ends up to seven bytes: a one stands for a zero byte, a zero for one of the bytes before, lowest bit first
/// 1nnn_nnnn  ends n + 7 bytes without a zero among them, and stands for the zero after them
/// 1111_1111  ends 134 bytes without a zero among or after them
/// ```
/// The encoding is read backwards from the end of a frame ("r"), so that the encoder needs no memory of the bytes.
pub struct Rzcobs {
    /// Number of bytes since the last code.
    run: u8,
    /// Zero bytes among the first seven of them, lowest bit first.
    zeros: u8,
}

/// Largest number of bytes of a code of the first kind.
const SHORT: u8 = 7;
/// Number of bytes after which a code of the third kind comes.
const LONG: u8 = 134;

impl Rzcobs {
    /// Creates an encoder before a frame.
    #[expect(
        clippy::new_without_default,
        reason = "meant for a static, which needs a constant"
    )]
    pub const fn new() -> Self {
        Self { run: 0, zeros: 0 }
    }

    /// Encodes the next byte of the frame.
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

    /// Ends the frame.
    pub fn end(&mut self, mut put: impl FnMut(u8)) {
        match self.run {
            0 => {}
            // Bytes missing to seven read as zeros, which the reader drops.
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

    /// Generates frames with mostly zeros, few zeros, and none, so that each kind of code occurs.
    fn frames() -> impl Strategy<Value = Vec<u8>> {
        (0_u8..=20).prop_flat_map(|weight| {
            let byte = prop_oneof![1 => Just(0), u32::from(weight) => 1..=u8::MAX];
            proptest::collection::vec(byte, 0..600)
        })
    }

    proptest! {
        /// Comparison with the decoder of another author, which the host's tools use.
        #[test]
        fn a_decoder_finds_the_frame_and_no_byte_before_the_end_is_zero(frame in frames()) {
            let encoded = encoded(&frame);
            let (end, code) = encoded.split_last().unwrap();
            prop_assert_eq!(*end, 0);
            prop_assert!(!code.contains(&0));
            let mut decoded = rzcobs::decode(code).unwrap();
            // The filling of the last code reads as zeros; the framework allows for them.
            let filled = decoded.split_off(frame.len().min(decoded.len()));
            prop_assert!(filled.len() < 7 && filled.iter().all(|byte| *byte == 0));
            prop_assert_eq!(decoded, frame);
        }
    }
}
