//! Time to read and to write an hour of 1 kHz data in four channels as MF4, 144 MB in memory.

use std::io::{self, Cursor};

use divan::Bencher;
use divan::counter::BytesCount;
use recording::mf4::{Options, read, write};
use recording::{Provenance, Recording, TimeBase, Unit};

fn main() {
    divan::main();
}

const SAMPLES: usize = 3_600_000;

fn hour() -> Recording {
    let mut recording = Recording::new(Provenance::from_source("bench"));
    let base = TimeBase::uniform(0.0, 0.001, SAMPLES).expect("increasing");
    let base = recording.add_time_base(base);
    for (name, unit) in [
        ("p_ch", Unit::BarGauge),
        ("i_fill", Unit::Milliampere),
        ("i_vent", Unit::Milliampere),
        ("duty_fill", Unit::Percent),
    ] {
        let samples = (0..SAMPLES).map(|index| (index % 1000) as f64 * 0.008);
        recording
            .add_signal(name, unit, base, samples.collect())
            .expect("a signal");
    }
    recording
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn read_an_hour(bencher: Bencher<'_, '_>) {
    let bytes = write(Vec::new(), &hour()).expect("memory takes all");
    bencher
        .counter(BytesCount::new(bytes.len()))
        .bench(|| read("bench", Cursor::new(&bytes), &Options::default()).expect("a log"));
}

#[divan::bench(sample_count = 5, sample_size = 1)]
fn write_an_hour(bencher: Bencher<'_, '_>) {
    let recording = hour();
    bencher
        .counter(BytesCount::new(SAMPLES * 8 * 5))
        .bench(|| write(io::sink(), &recording).expect("a sink takes all"));
}
