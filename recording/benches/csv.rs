//! Throughput of the CSV reader and writer on a log in the format of this crate, the one-minute practice log.

use std::io;

use divan::Bencher;
use divan::counter::BytesCount;
use recording::Recording;
use recording::csv::{Decimals, Options, Reader, read, write};

fn main() {
    divan::main();
}

fn log() -> Vec<u8> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../data/synthetic/practice-00-id.csv"
    );
    std::fs::read(path).expect("the bundled log is there")
}

fn recording() -> Recording {
    read("bench", log().as_slice(), &Options::default()).expect("the bundled log is right")
}

#[divan::bench]
fn stream_rows(bencher: Bencher<'_, '_>) {
    let bytes = log();
    bencher.counter(BytesCount::new(bytes.len())).bench(|| {
        let mut reader =
            Reader::new("bench", bytes.as_slice(), &Options::default()).expect("a log");
        let mut sum = 0.0;
        while let Some(row) = reader.next_row().expect("rows") {
            sum += row.values[0];
        }
        sum
    });
}

#[divan::bench]
fn read_recording(bencher: Bencher<'_, '_>) {
    let bytes = log();
    bencher
        .counter(BytesCount::new(bytes.len()))
        .bench(|| read("bench", bytes.as_slice(), &Options::default()).expect("a log"));
}

#[divan::bench]
fn write_recording(bencher: Bencher<'_, '_>) {
    let recording = recording();
    let (base, _) = recording.time_bases().next().expect("one time base");
    bencher.counter(BytesCount::new(log().len())).bench(|| {
        write(io::sink(), &recording, base, &Decimals::shortest()).expect("a sink takes all");
    });
}
