//! Damage for files of any kind, and for the links and numbers of MF4.

use super::values::{FLOATS, INTEGERS, TEXTS};
use crate::chance::Chance;

/// Kind of damage: its name, and the function that makes it.
pub type Mutation = (&'static str, fn(&mut Vec<u8>, &mut Chance));

/// Kinds of damage for files of any format.
pub const ANY: [Mutation; 14] = [
    ("bits flipped", |bytes, chance| flip_bits(bytes, chance)),
    ("byte set", |bytes, chance| set_byte(bytes, chance)),
    ("run overwritten", |bytes, chance| {
        overwrite_run(bytes, chance)
    }),
    ("run removed", remove_run),
    ("run inserted", insert_run),
    ("run copied", copy_run),
    ("runs swapped", swap_runs),
    ("truncated", truncate),
    ("emptied", |bytes, _| bytes.clear()),
    ("text inserted", insert_text),
    ("one character repeated", repeat_character),
    ("garbage appended", append_garbage),
    ("byte-order mark", byte_order_mark),
    ("UTF-16", utf_16),
];

/// Kinds of damage for MF4, whose links and counts are integers of 64 bits at multiples of 8.
pub const MF4: [Mutation; 6] = [
    ("integer set to a bound", |bytes, chance| {
        let value = chance.one_of(&INTEGERS);
        put(bytes, chance, 8, &value.to_le_bytes());
    }),
    ("integer set near the end of the file", |bytes, chance| {
        let end = bytes.len() as u64;
        let value = (end + 64).saturating_sub(8 * chance.whole(0, 24) as u64);
        put(bytes, chance, 8, &value.to_le_bytes());
    }),
    ("float set to a bound", |bytes, chance| {
        let value = chance.one_of(&FLOATS);
        put(bytes, chance, 8, &value.to_le_bytes());
    }),
    ("short integer set to a bound", |bytes, chance| {
        let value = chance.one_of(&INTEGERS).to_le_bytes();
        let width = chance.one_of(&[1, 2, 4]);
        put(bytes, chance, width, &value[..width]);
    }),
    ("link taken from elsewhere", |bytes, chance| {
        let words = bytes.len() / 8;
        if words > 0 {
            let from = 8 * chance.whole(0, words - 1);
            let word: [u8; 8] = bytes[from..from + 8].try_into().expect("eight bytes");
            put(bytes, chance, 8, &word);
        }
    }),
    ("block called another", |bytes, chance| {
        let kinds = [
            "##HD", "##DG", "##CG", "##CN", "##CC", "##SI", "##TX", "##MD", "##DT", "##DZ", "##DL",
            "##HL", "##LD", "##SD", "##FH", "##CA", "##XX",
        ];
        let blocks: Vec<usize> = bytes
            .windows(2)
            .enumerate()
            .filter_map(|(at, pair)| (pair == b"##").then_some(at))
            .filter(|at| at + 4 <= bytes.len())
            .collect();
        if !blocks.is_empty() {
            let (at, kind) = (chance.one_of(&blocks), chance.one_of(&kinds));
            bytes[at..at + 4].copy_from_slice(kind.as_bytes());
        }
    }),
];

/// Returns a position between 0 and the end, both included.
pub(super) fn place(bytes: &[u8], chance: &mut Chance) -> usize {
    chance.whole(0, bytes.len())
}

/// Returns the range of up to `most` bytes.
fn run(bytes: &[u8], chance: &mut Chance, most: usize) -> std::ops::Range<usize> {
    let begin = place(bytes, chance);
    let length = 1 << chance.whole(0, most.ilog2() as usize);
    begin..(begin + chance.whole(1, length)).min(bytes.len())
}

fn flip_bits(bytes: &mut [u8], chance: &mut Chance) {
    if bytes.is_empty() {
        return;
    }
    for _ in 0..chance.whole(1, 8) {
        let at = chance.whole(0, bytes.len() - 1);
        bytes[at] ^= 1 << chance.whole(0, 7);
    }
}

fn set_byte(bytes: &mut [u8], chance: &mut Chance) {
    if !bytes.is_empty() {
        let at = chance.whole(0, bytes.len() - 1);
        bytes[at] = any_byte(chance);
    }
}

fn any_byte(chance: &mut Chance) -> u8 {
    let special = *b"\0\xff\x7f\x80 \n\r\t,;.-+\"'#[]{}=:0919eE_%";
    if chance.happens(0.7) {
        chance.one_of(&special)
    } else {
        chance.whole(0, 255) as u8
    }
}

fn overwrite_run(bytes: &mut [u8], chance: &mut Chance) {
    let run = run(bytes, chance, 256);
    let one = chance.happens(0.5).then(|| any_byte(chance));
    for byte in &mut bytes[run] {
        *byte = one.unwrap_or_else(|| any_byte(chance));
    }
}

fn remove_run(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let run = run(bytes, chance, 1024);
    bytes.drain(run);
}

fn insert_run(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let at = place(bytes, chance);
    let run: Vec<u8> = (0..chance.whole(1, 64)).map(|_| any_byte(chance)).collect();
    bytes.splice(at..at, run);
}

fn copy_run(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let copy = bytes[run(bytes, chance, 1024)].to_vec();
    let at = place(bytes, chance);
    let end = if chance.happens(0.5) {
        at
    } else {
        (at + copy.len()).min(bytes.len())
    };
    bytes.splice(at..end, copy);
}

fn swap_runs(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let first = run(bytes, chance, 256);
    let second = run(bytes, chance, 256);
    if first.end <= second.start {
        let (a, b) = (
            bytes[first.clone()].to_vec(),
            bytes[second.clone()].to_vec(),
        );
        bytes.splice(second, a);
        bytes.splice(first, b);
    }
}

fn truncate(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let at = if chance.happens(0.3) {
        chance.whole(0, 200.min(bytes.len()))
    } else {
        place(bytes, chance)
    };
    bytes.truncate(at);
}

fn insert_text(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let at = place(bytes, chance);
    let text = chance.one_of(&TEXTS).as_bytes();
    bytes.splice(at..at, text.iter().copied());
}

fn repeat_character(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let at = place(bytes, chance);
    let character = chance.one_of(b"0919 ,;\"'[{(=#aA\n\t-.\0");
    let count = chance.one_of(&[10, 100, 1000, 10_000, 70_000, 300_000]);
    bytes.splice(at..at, std::iter::repeat_n(character, count));
}

fn append_garbage(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let garbage = (0..chance.whole(1, 300)).map(|_| chance.whole(0, 255) as u8);
    let garbage: Vec<u8> = garbage.collect();
    bytes.extend(garbage);
}

fn byte_order_mark(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let marks: [&[u8]; 4] = [b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff", b"\0\0\xfe\xff"];
    bytes.splice(0..0, chance.one_of(&marks).iter().copied());
}

fn utf_16(bytes: &mut Vec<u8>, chance: &mut Chance) {
    let text = String::from_utf8_lossy(bytes).into_owned();
    let is_little = chance.happens(0.5);
    *bytes = text
        .encode_utf16()
        .flat_map(|unit| match is_little {
            true => unit.to_le_bytes(),
            false => unit.to_be_bytes(),
        })
        .collect();
}

/// Overwrites `width` bytes at a multiple of `width`.
fn put(bytes: &mut [u8], chance: &mut Chance, width: usize, value: &[u8]) {
    let places = bytes.len() / width;
    if places > 0 {
        let at = width * chance.whole(0, places - 1);
        bytes[at..at + width].copy_from_slice(value);
    }
}
