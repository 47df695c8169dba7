//! Digests of a million samples of each configuration, one number each.
//!
//! A change here means that every target computes a different result than before. If that is the intention, bless it:
//! `BLESS=1 cargo nextest run -p retarder-controller golden`, and say in the commit what moved and why.

use std::fmt::Write as _;
use std::{env, fs};

use controller::{State, step};

use crate::support::{Bench, config, configurations};

const SAMPLES: usize = 1_000_000;
const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/suite/golden.txt");

/// FNV-1a over the words, little endian: simple and identical on every machine.
struct Digest(u64);

impl Digest {
    fn word(&mut self, word: i32) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }
}

#[test]
fn golden_digests_of_a_million_samples_are_as_blessed() {
    let mut report = String::from(
        "# Digest of duty cycles and state over 1 000 000 samples; bless on purpose (golden.rs).\n",
    );
    for (name, settings) in configurations() {
        let config = config(&settings);
        let (mut state, mut bench, mut digest) = (
            State::at_rest(),
            Bench::new(6),
            Digest(0xCBF2_9CE4_8422_2325),
        );
        let (mut fill, mut vent) = (0, 0);
        for _ in 0..SAMPLES {
            let output = step(&config, &mut state, bench.next(fill, vent));
            (fill, vent) = (output.duty_fill.to_bits(), output.duty_vent.to_bits());
            for word in [fill, vent].into_iter().chain(state.to_words()) {
                digest.word(word);
            }
        }
        writeln!(report, "{name} {:#018x}", digest.0).expect("a string takes all");
    }
    if env::var_os("BLESS").is_some() {
        fs::write(FILE, &report).expect("golden.txt is writable");
    }
    let blessed = fs::read_to_string(FILE).expect("golden.txt is in the repository");
    assert_eq!(
        report, blessed,
        "the bits changed; see the head of golden.rs"
    );
}
