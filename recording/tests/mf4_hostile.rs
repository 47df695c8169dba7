//! Damaged, cut and hostile MF4 files: each gives a recording or a typed error, in bounded memory and time.

#[allow(dead_code, reason = "each test checks some of the properties")]
mod properties;

use std::fs;
use std::io::Cursor;
use std::time::{Duration, Instant};

use proptest::prelude::*;
use recording::mf4::{Limits, Mf4Error, Options, read};

const FIXTURES: [&str; 12] = [
    "conversions",
    "invalid",
    "lists",
    "numbers",
    "rates",
    "rates-411",
    "rates-packed",
    "rates-transposed",
    "started",
    "started-local",
    "unfinished",
    "unsorted",
];

fn fixture(name: &str) -> Vec<u8> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/mf4");
    fs::read(format!("{folder}/{name}.mf4")).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// Returns the position of the block `id` that comes after `skip` others.
fn block_at(bytes: &[u8], id: &[u8; 4], skip: usize) -> usize {
    let places = (0..bytes.len() / 8).map(|place| 8 * place);
    let mut found = places.filter(|&at| bytes[at..].starts_with(id));
    found.nth(skip).expect("the fixture has the block")
}

fn set_u64(bytes: &mut [u8], at: usize, value: u64) {
    bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
}

fn refusal(bytes: &[u8], limits: Limits) -> Mf4Error {
    let options = Options {
        limits,
        ..Options::default()
    };
    let started = Instant::now();
    let result = read("hostile.mf4", Cursor::new(bytes), &options);
    let elapsed = started.elapsed();
    assert!(elapsed < Duration::from_secs(2), "took {elapsed:?}");
    result.expect_err("the hostile file was accepted")
}

#[test]
fn a_file_that_is_cut_anywhere_is_refused_or_read() {
    for name in FIXTURES {
        let bytes = fixture(name);
        for length in (0..bytes.len()).step_by(7) {
            properties::mf4_reader(&bytes[..length]);
        }
    }
}

#[test]
fn a_file_with_any_wrong_byte_is_refused_or_read() {
    for name in FIXTURES {
        let mut bytes = fixture(name);
        for at in 0..bytes.len() {
            let right = bytes[at];
            // The lowest bit flipped, the highest bit flipped, or zero, in turn.
            bytes[at] = [right ^ 1, right ^ 0x80, 0][at % 3];
            properties::mf4_reader(&bytes);
            bytes[at] = right;
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn numbers_of_the_format_may_be_any(
        name in prop::sample::select(&FIXTURES[..]),
        changes in prop::collection::vec((any::<prop::sample::Index>(), word()), 1..4),
    ) {
        let mut bytes = fixture(name);
        for (place, word) in changes {
            let at = 8 * place.index(bytes.len() / 8);
            set_u64(&mut bytes, at, word);
        }
        properties::mf4_reader(&bytes);
    }
}

/// Generates links, counts and lengths: inside of the file, at its ends, and very large.
fn word() -> impl Strategy<Value = u64> {
    prop_oneof![
        (0u64..1000).prop_map(|place| 8 * place),
        0u64..64,
        Just(u64::MAX),
        Just(u64::MAX - 7),
        Just(1 << 63),
        (0u32..64).prop_map(|bit| 1u64 << bit),
        any::<u64>(),
    ]
}

#[test]
fn what_leads_nowhere_is_refused_with_its_block_and_place() {
    let rates = fixture("rates");
    let file_bytes = rates.len() as u64;
    let group = block_at(&rates, b"##DG", 0);
    let check = |at: usize, value: u64, code: &str, said: &str| {
        let mut bytes = rates.clone();
        set_u64(&mut bytes, at, value);
        let error = refusal(&bytes, Limits::default());
        assert_eq!(error.code(), code, "{error}");
        assert!(error.to_string().contains(said), "{error}");
        assert!(error.place().offset.is_some(), "{error}");
    };
    // The link to the next group: to itself, beyond the end, and to an address where no block may begin.
    check(group + 24, group as u64, "E-MF4-LOOP", "##DG at byte");
    check(
        group + 24,
        file_bytes + 8,
        "E-MF4-LINK",
        &format!("the end of the file at {file_bytes}"),
    );
    check(
        group + 24,
        group as u64 + 4,
        "E-MF4-LINK",
        "a multiple of 8",
    );
    check(
        group + 24,
        64,
        "E-MF4-BLOCK",
        "found \"##HD\", expected \"##DG\"",
    );
    check(group + 8, 1 << 40, "E-MF4-LENGTH", "1099511627776");
    check(group + 16, u64::MAX, "E-MF4-LENGTH", "expected");
    let channel_group = block_at(&rates, b"##CG", 0);
    check(
        channel_group + 24 + 48 + 8,
        1 << 50,
        "E-MF4-DATA-SHORT",
        "expected 1125899906842624",
    );
    let data = block_at(&rates, b"##DT", 0);
    check(data + 8, 1 << 20, "E-MF4-LENGTH", "##DT at byte");
}

#[test]
fn packed_data_that_lie_about_their_size_are_refused() {
    let packed = fixture("rates-packed");
    let block = block_at(&packed, b"##DZ", 0);
    let check = |at: usize, value: u64, code: &str| {
        let mut bytes = packed.clone();
        set_u64(&mut bytes, block + at, value);
        let error = refusal(&bytes, Limits::default());
        assert_eq!(error.code(), code, "{error}");
    };
    check(32, 1 << 60, "E-MF4-LIMIT-UNPACKED");
    check(32, 16 << 20, "E-MF4-FIELD");
    check(32, 12, "E-MF4-PACKED");
    check(40, 1 << 30, "E-MF4-FIELD");
    check(40, 1, "E-MF4-FIELD");
    check(40, 100, "E-MF4-PACKED");
    let mut damaged = packed.clone();
    damaged[block + 60] ^= 0xff;
    assert_eq!(refusal(&damaged, Limits::default()).code(), "E-MF4-PACKED");
}

/// A block of zeros packs a thousand to one; a list with the same block repeated would multiply it again.
#[test]
fn a_block_is_data_once() {
    let mut bytes = fixture("lists");
    let list = block_at(&bytes, b"##DL", 0);
    let first: [u8; 8] = bytes[list + 32..list + 40].try_into().unwrap();
    bytes[list + 40..list + 48].copy_from_slice(&first);
    let error = refusal(&bytes, Limits::default());
    assert_eq!(error.code(), "E-MF4-LOOP", "{error}");
}

#[test]
fn each_budget_holds_at_its_bound_and_refuses_one_beyond() {
    let bytes = fixture("rates-packed");
    let base = Limits::default();
    let size = bytes.len() as u64;
    // Groups of 60 samples of 3 signals and 12 of 2, each with its time; 11 channels.
    let exact = Limits {
        file_bytes: size,
        channels: 10,
        samples: 60,
        values: 60 * 4 + 12 * 3,
        ..base
    };
    let options = Options {
        limits: exact,
        ..Options::default()
    };
    read("exact.mf4", Cursor::new(&bytes), &options).unwrap();
    let check = |limits: Limits, code: &str| {
        let error = refusal(&bytes, limits);
        assert!(error.code() == code && error.is_limit(), "{error}");
    };
    check(
        Limits {
            file_bytes: size - 1,
            ..exact
        },
        "E-MF4-LIMIT-FILE",
    );
    check(
        Limits {
            channels: 9,
            ..exact
        },
        "E-MF4-LIMIT-CHANNELS",
    );
    check(
        Limits {
            samples: 59,
            ..exact
        },
        "E-MF4-LIMIT-SAMPLES",
    );
    check(
        Limits {
            values: exact.values - 1,
            ..exact
        },
        "E-MF4-LIMIT-VALUES",
    );
    check(
        Limits {
            metadata_bytes: 2000,
            ..exact
        },
        "E-MF4-LIMIT-METADATA",
    );
    check(
        Limits {
            unpacked_bytes: 100,
            ..exact
        },
        "E-MF4-LIMIT-UNPACKED",
    );
}

#[test]
fn what_is_no_mdf_4_is_refused_by_its_first_bytes() {
    let code = |bytes: &[u8]| refusal(bytes, Limits::default()).code().to_owned();
    assert_eq!(code(b""), "E-MF4-ID");
    assert_eq!(code(b"time_s,p_ch_bar_gauge\n0,1\n"), "E-MF4-ID");
    assert_eq!(code(b"MDF     4.10    "), "E-MF4-ID");
    let mut older = fixture("rates");
    older[28..30].copy_from_slice(&330u16.to_le_bytes());
    assert_eq!(code(&older), "E-MF4-VERSION");
}

/// A record of variable length may claim 4 GiB.
#[test]
fn a_record_that_never_ends_is_passed_over() {
    let mut bytes = fixture("unsorted");
    let texts = bytes.windows(2).rposition(|pair| pair == b"ok").unwrap();
    bytes[texts - 4..texts].copy_from_slice(&u32::MAX.to_le_bytes());
    let recording = read("texts.mf4", Cursor::new(bytes), &Options::default()).unwrap();
    assert_eq!(recording.signal("u_bat").unwrap().len(), 7);
}
