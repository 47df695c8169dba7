//! Damage on the wire: it never turns one frame into another.

use std::collections::HashSet;

use hil_protocol::crc32;
use hil_protocol::frame::{Damage, Decoder};

use crate::frames::decode;
use crate::messages;

/// Maximum length of a frame for which every pair of flipped bits is tried.
const EXHAUSTIVE_MAX: usize = 48;

/// Returns the payload that a decoder accepts from these bytes and a final delimiter, if it differs from `payload`.
/// Flips can create delimiters, so the bytes may even be several frames.
fn taken_for_another(bytes: &[u8], payload: &[u8]) -> Option<Vec<u8>> {
    let mut decoder = Decoder::new();
    for &byte in bytes.iter().chain(&[0]) {
        if let Some(Ok(found)) = decoder.push(byte)
            && found != payload
        {
            return Some(found.to_vec());
        }
    }
    None
}

fn flip(frame: &mut [u8], bit: usize) {
    frame[bit / 8] ^= 1 << (bit % 8);
}

#[test]
fn no_flipped_bit_makes_another_frame() {
    for mut frame in messages::frames() {
        let payload = decode(&frame).unwrap().unwrap();
        for bit in 0..8 * frame.len() {
            flip(&mut frame, bit);
            let other = taken_for_another(&frame, &payload);
            assert_eq!(other, None, "bit {bit} of {frame:02x?}");
            flip(&mut frame, bit);
        }
    }
}

#[test]
fn no_two_flipped_bits_make_another_frame() {
    for mut frame in messages::frames() {
        let payload = decode(&frame).unwrap().unwrap();
        let bits = 8 * frame.len();
        let codes = codes(&frame);
        for first in 0..bits {
            for second in 0..first {
                // In a long frame only flips that change its blocks are tried. Any two others change two checksummed
                // bits, and the next test covers all of those.
                if frame.len() > EXHAUSTIVE_MAX && !changes_blocks(&frame, &codes, first, second) {
                    continue;
                }
                flip(&mut frame, first);
                flip(&mut frame, second);
                let other = taken_for_another(&frame, &payload);
                assert_eq!(other, None, "bits {first} and {second} of {frame:02x?}");
                flip(&mut frame, first);
                flip(&mut frame, second);
            }
        }
    }
}

/// Returns for each byte of a frame whether it defines the end of a block: a code, or the delimiter.
fn codes(frame: &[u8]) -> Vec<bool> {
    let mut codes = vec![false; frame.len()];
    let mut at = 0;
    while frame[at] != 0 {
        codes[at] = true;
        at += usize::from(frame[at]);
    }
    codes[at] = true;
    codes
}

fn changes_blocks(frame: &[u8], codes: &[bool], first: usize, second: usize) -> bool {
    let mask = |bit: usize, byte: usize| {
        if bit / 8 == byte {
            1 << (bit % 8)
        } else {
            0_u8
        }
    };
    [first / 8, second / 8]
        .into_iter()
        .any(|byte| codes[byte] || frame[byte] == mask(first, byte) | mask(second, byte))
}

/// The checksum is linear: two flips are undetected only if both change it equally, or if none changes it. Neither
/// occurs within the length of a frame, so any two flips are detected.
#[test]
fn no_two_bits_of_a_longest_frame_change_the_checksum_alike() {
    let mut bytes = [0; hil_protocol::FRAME_MAX];
    let none = crc32::digest(&bytes);
    let mut seen = HashSet::from([0]);
    for bit in 0..8 * bytes.len() {
        flip(&mut bytes, bit);
        assert!(seen.insert(crc32::digest(&bytes) ^ none), "bit {bit}");
        flip(&mut bytes, bit);
    }
    // Flips in the checksum itself change one of its bits.
    for bit in 0..32 {
        assert!(seen.insert(1 << bit), "bit {bit} of the checksum");
    }
}

#[test]
fn no_part_of_a_frame_is_taken_for_one() {
    for frame in messages::frames() {
        for length in 0..frame.len() - 1 {
            let beginning = &frame[..length];
            assert_eq!(taken_for_another(beginning, &[]), None, "{beginning:02x?}");
        }
        for start in 1..frame.len() {
            let end = &frame[start..];
            assert_eq!(taken_for_another(end, &[]), None, "{end:02x?}");
        }
    }
}

/// Found by the pairs above: the checksum of no bytes is 0, and four zeros are four short blocks.
#[test]
fn nothing_and_its_checksum_are_no_frame() {
    assert_eq!(decode(&[1, 1, 1, 1, 1, 0]), Some(Err(Damage::Truncated)));
}
