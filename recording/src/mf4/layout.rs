//! Place and format of a channel's number in a record.

use super::structure::Channel;

/// Place and format of a channel's number in each record of its group.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Layout {
    /// Number of the record, from 0; it is not stored in the record.
    RecordNumber,
    /// Bytes of the record.
    Bytes {
        /// Index of the first byte.
        at: usize,
        form: Form,
        is_big_endian: bool,
    },
}

/// Shape of the records of a group (bytes).
#[derive(Clone, Copy)]
pub(super) struct RecordShape {
    /// Size of a record.
    pub(super) stride: usize,
    /// Size of the record's number before its data.
    pub(super) skip: usize,
}

/// Format of a number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Form {
    Float32,
    Float64,
    Integer {
        /// Number of bytes with its bits, 1 to 9.
        bytes: usize,
        /// Number of bits below its lowest one, 0 to 7.
        shift: u32,
        /// Number of bits, 1 to 64.
        bits: u32,
        is_signed: bool,
    },
}

impl Form {
    fn bytes(self) -> usize {
        match self {
            Self::Float32 => 4,
            Self::Float64 => 8,
            Self::Integer { bytes, .. } => bytes,
        }
    }
}

impl Layout {
    /// Returns the layout of `channel`, or the reason why it contains no number.
    pub(super) fn of(channel: &Channel) -> Result<Self, &'static str> {
        match channel.kind {
            0 | 2 => {}
            3 | 6 => return Ok(Self::RecordNumber),
            1 | 5 => return Err("its values differ in length, as texts do"),
            4 => return Err("it points into another stream, such as a video"),
            _ => return Err("it is a kind of channel that MDF 4 does not have"),
        }
        if channel.is_composed {
            return Err("it is an array or a structure; log its elements as channels");
        }
        let (bits, shift) = (channel.bits, u32::from(channel.bit_offset));
        let form = match (channel.data_type, bits) {
            (0..=3, 1..=64) if shift < 8 => Form::Integer {
                bytes: (shift + bits).div_ceil(8) as usize,
                shift,
                bits,
                is_signed: channel.data_type >= 2,
            },
            (0..=3, _) => return Err("it is an integer of more than 64 bits, or of none"),
            (4 | 5, 32) if shift == 0 => Form::Float32,
            (4 | 5, 64) if shift == 0 => Form::Float64,
            (4 | 5, _) => return Err("it is a float of neither 32 nor 64 bits"),
            (6..=9 | 17, _) => return Err("it is a text"),
            (15 | 16, _) => return Err("it is a complex number"),
            _ => return Err("it is no number but a row of bytes"),
        };
        Ok(Self::Bytes {
            at: channel.byte_offset as usize,
            form,
            is_big_endian: matches!(channel.data_type, 1 | 3 | 5),
        })
    }

    /// Returns the number of bytes that a record must have for it.
    pub(super) fn end(&self) -> usize {
        match self {
            Self::RecordNumber => 0,
            Self::Bytes { at, form, .. } => at.saturating_add(form.bytes()),
        }
    }

    /// Returns whether it contains an integer.
    pub(super) fn is_integer(&self) -> bool {
        match self {
            Self::RecordNumber => true,
            Self::Bytes { form, .. } => matches!(form, Form::Integer { .. }),
        }
    }

    /// Appends the numbers of whole `records`, of this shape; the first one has the number `first`. Each record has [`Layout::end`] bytes of data, which the caller has checked.
    pub(super) fn decode(
        &self,
        records: &[u8],
        shape: RecordShape,
        first: u64,
        numbers: &mut Vec<f64>,
    ) {
        let records = records.chunks_exact(shape.stride);
        let (at, form, is_big_endian) = match *self {
            Self::RecordNumber => {
                let numbered = records.zip(first..).map(|(_, number)| number as f64);
                return numbers.extend(numbered);
            }
            Self::Bytes {
                at,
                form,
                is_big_endian,
            } => (shape.skip + at, form, is_big_endian),
        };
        match (form, is_big_endian) {
            (Form::Float64, false) => {
                numbers.extend(records.map(|record| f64::from_le_bytes(array(record, at))))
            }
            (Form::Float64, true) => {
                numbers.extend(records.map(|record| f64::from_be_bytes(array(record, at))))
            }
            (Form::Float32, false) => numbers
                .extend(records.map(|record| f64::from(f32::from_le_bytes(array(record, at))))),
            (Form::Float32, true) => numbers
                .extend(records.map(|record| f64::from(f32::from_be_bytes(array(record, at))))),
            (
                Form::Integer {
                    bytes,
                    shift,
                    bits,
                    is_signed,
                },
                _,
            ) => {
                numbers.extend(records.map(|record| {
                    let word = word(&record[at..at + bytes], is_big_endian);
                    integer((word >> shift) as u64, bits, is_signed)
                }));
            }
        }
    }
}

fn array<const N: usize>(record: &[u8], at: usize) -> [u8; N] {
    let mut array = [0; N];
    array.copy_from_slice(&record[at..at + N]);
    array
}

/// Returns up to nine bytes as one number.
fn word(bytes: &[u8], is_big_endian: bool) -> u128 {
    let push = |word: u128, byte: &u8| word << 8 | u128::from(*byte);
    if is_big_endian {
        bytes.iter().fold(0, push)
    } else {
        bytes.iter().rev().fold(0, push)
    }
}

/// Returns the lowest `bits` of a word. Integers beyond 2⁵³ are rounded to the nearest float.
fn integer(word: u64, bits: u32, is_signed: bool) -> f64 {
    let unused = 64 - bits;
    if is_signed {
        ((word << unused) as i64 >> unused) as f64
    } else {
        (word << unused >> unused) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn channel(data_type: u8, byte_offset: u32, bit_offset: u8, bits: u32) -> Channel {
        Channel {
            offset: 0,
            name: String::new(),
            unit: String::new(),
            kind: 0,
            sync: 0,
            data_type,
            bit_offset,
            byte_offset,
            bits,
            flags: 0,
            invalidation_bit: 0,
            is_composed: false,
            conversion: 0,
        }
    }

    #[test]
    fn numbers_are_found_at_their_bits_in_either_order_of_bytes() {
        let check = |channel: &Channel, record: &[u8], expected: f64| {
            let layout = Layout::of(channel).unwrap();
            assert!(layout.end() <= record.len());
            let mut numbers = Vec::new();
            layout.decode(
                &[record, record].concat(),
                RecordShape {
                    stride: record.len(),
                    skip: 0,
                },
                0,
                &mut numbers,
            );
            assert_eq!(numbers, [expected, expected], "{channel:?}");
        };
        check(
            &channel(0, 1, 0, 16),
            &[9, 0x34, 0x12, 9],
            f64::from(0x1234),
        );
        check(
            &channel(1, 1, 0, 16),
            &[9, 0x12, 0x34, 9],
            f64::from(0x1234),
        );
        check(&channel(2, 0, 0, 8), &[0xff], -1.0);
        check(&channel(3, 0, 0, 16), &[0xff, 0xfe], -2.0);
        check(&channel(0, 0, 3, 4), &[0b0101_1000], 11.0);
        check(&channel(2, 0, 3, 4), &[0b0101_1000], -5.0);
        check(&channel(0, 0, 6, 12), &[0b1100_0000, 0xff, 0b11], 4095.0);
        check(&channel(1, 0, 4, 12), &[0x12, 0x34], f64::from(0x123));
        check(
            &channel(0, 0, 1, 64),
            &[0xfe, 255, 255, 255, 255, 255, 255, 255, 1],
            u64::MAX as f64,
        );
        check(&channel(4, 0, 0, 32), &1.5f32.to_le_bytes(), 1.5);
        check(&channel(5, 0, 0, 32), &1.5f32.to_be_bytes(), 1.5);
        check(
            &channel(4, 2, 0, 64),
            &[&[0, 0], &0.1f64.to_le_bytes()[..]].concat(),
            0.1,
        );
        check(&channel(5, 0, 0, 64), &0.1f64.to_be_bytes(), 0.1);
    }

    #[test]
    fn a_virtual_channel_counts_the_records() {
        let virtual_master = Channel {
            kind: 3,
            ..channel(0, 0, 0, 0)
        };
        let mut numbers = Vec::new();
        let layout = Layout::of(&virtual_master).unwrap();
        layout.decode(
            &[0; 6],
            RecordShape { stride: 2, skip: 1 },
            40,
            &mut numbers,
        );
        assert_eq!(numbers, [40.0, 41.0, 42.0]);
    }

    #[test]
    fn what_is_no_number_has_a_reason() {
        for (data_type, bits) in [
            (0, 0),
            (0, 65),
            (4, 16),
            (7, 80),
            (10, 64),
            (15, 64),
            (99, 8),
        ] {
            assert!(Layout::of(&channel(data_type, 0, 0, bits)).is_err());
        }
        for kind in [1, 4, 5, 7] {
            assert!(
                Layout::of(&Channel {
                    kind,
                    ..channel(4, 0, 0, 64)
                })
                .is_err()
            );
        }
    }
}
