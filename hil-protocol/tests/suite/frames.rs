//! Frames: decoding returns the encoded message, in the documented format.

use hil_protocol::frame::{
    Damage, Decoder, Direction, Header, PAYLOAD_MAX, encode, header, message,
};
use hil_protocol::{FRAME_MAX, Reply, Request, crc32};
use proptest::prelude::*;

use crate::messages;

/// Returns the payload of a frame, or the reason why it has none.
pub(crate) fn decode(frame: &[u8]) -> Option<Result<Vec<u8>, Damage>> {
    let mut decoder = Decoder::new();
    let mut last = None;
    for &byte in frame {
        if let Some(result) = decoder.push(byte) {
            last = Some(result.map(<[u8]>::to_vec));
        }
    }
    last
}

#[test]
fn every_message_comes_back_as_it_was() {
    let head = Header {
        direction: Direction::ToHost,
        session: u32::MAX,
        sequence: u32::MAX,
    };
    let mut buffer = [0; FRAME_MAX];
    for request in messages::requests() {
        let payload = decode(encode(head, &request, &mut buffer).unwrap())
            .unwrap()
            .unwrap();
        let (found, bytes) = header(&payload).unwrap();
        assert_eq!((found, message::<Request>(bytes)), (head, Some(request)));
    }
    for reply in messages::replies() {
        let payload = decode(encode(head, &reply, &mut buffer).unwrap())
            .unwrap()
            .unwrap();
        let (found, bytes) = header(&payload).unwrap();
        assert_eq!((found, message::<Reply>(bytes)), (head, Some(reply)));
    }
}

/// The longest message of each kind is tested, and all of them were encoded; the buffer need not be longer.
#[test]
fn the_longest_messages_fit_and_a_byte_less_is_refused() {
    for frame in messages::frames() {
        assert!(frame.len() <= FRAME_MAX);
    }
    let head = Header {
        direction: Direction::ToHost,
        session: 1,
        sequence: 1,
    };
    for reply in messages::replies() {
        let mut buffer = [0; FRAME_MAX];
        let length = encode(head, &reply, &mut buffer).unwrap().len();
        for room in 0..length {
            let error = encode(head, &reply, &mut buffer[..room]).unwrap_err();
            assert_eq!(error.room, room);
        }
        assert!(encode(head, &reply, &mut buffer[..length]).is_ok());
    }
}

#[test]
fn a_message_with_bytes_to_spare_is_unknown() {
    let mut bytes = [0; 8];
    let length = postcard::to_slice(&Request::Discard, &mut bytes)
        .unwrap()
        .len();
    assert_eq!(message(&bytes[..length]), Some(Request::Discard));
    assert_eq!(message::<Request>(&bytes[..=length]), None);
    assert_eq!(message::<Request>(&[]), None);
}

#[test]
fn delimiters_may_fill_a_pause() {
    let mut decoder = Decoder::new();
    for _ in 0..10 {
        assert_eq!(decoder.push(0), None);
    }
    let frame = &messages::frames()[1];
    let (delimiter, bytes) = frame.split_last().unwrap();
    for &byte in bytes {
        assert_eq!(decoder.push(byte), None);
    }
    assert!(decoder.push(*delimiter).unwrap().is_ok());
    assert_eq!(decoder.push(0), None);
}

#[test]
fn endless_bytes_without_delimiter_are_one_damaged_frame() {
    let mut decoder = Decoder::new();
    for _ in 0..10 * FRAME_MAX {
        assert_eq!(decoder.push(1), None);
    }
    assert_eq!(decoder.push(0), Some(Err(Damage::TooLong)));
    for &byte in &messages::frames()[0] {
        if let Some(result) = decoder.push(byte) {
            assert!(
                result.is_ok(),
                "the next frame is read as if nothing had been"
            );
        }
    }
}

/// Encodes the payload bytes as a header and a list of numbers; returns the length.
fn frame_of(payload: &[u8], buffer: &mut [u8]) -> Option<usize> {
    // Three bytes of header; a tuple of bytes is encoded without change.
    let (head, rest) = payload.split_first_chunk::<3>()?;
    let head = Header {
        direction: if head[0] & 1 == 0 {
            Direction::ToDevice
        } else {
            Direction::ToHost
        },
        session: u32::from(head[1] & 0x7F),
        sequence: u32::from(head[2] & 0x7F),
    };
    struct Raw<'a>(&'a [u8]);
    impl serde::Serialize for Raw<'_> {
        fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            use serde::ser::SerializeTuple;
            let mut tuple = serializer.serialize_tuple(self.0.len())?;
            for byte in self.0 {
                tuple.serialize_element(byte)?;
            }
            tuple.end()
        }
    }
    encode(head, &Raw(rest), buffer).ok().map(<[u8]>::len)
}

proptest! {
    /// The reference of the stuffing is another implementation. Runs of equal bytes fill up blocks.
    #[test]
    fn the_stuffing_is_cobs(runs in prop::collection::vec((any::<u8>(), 1_usize..300), 1..6)) {
        let mut payload: Vec<u8> = vec![1, 5, 9];
        for (byte, length) in runs {
            payload.extend(std::iter::repeat_n(byte, length));
        }
        payload.truncate(PAYLOAD_MAX);
        let mut buffer = [0; FRAME_MAX];
        let length = frame_of(&payload, &mut buffer).unwrap();
        let mut checked = payload.clone();
        checked.extend(crc32::digest(&payload).to_le_bytes());
        let mut expected = cobs::encode_vec(&checked);
        expected.push(0);
        prop_assert_eq!(&buffer[..length], expected.as_slice());
        prop_assert_eq!(decode(&buffer[..length]), Some(Ok(payload)));
    }
}
