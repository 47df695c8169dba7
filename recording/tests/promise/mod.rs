//! What the readers promise for any input. Stated once: the fuzz targets and the tests of this crate both hold them to it.

use recording::Recording;
use recording::csv::{Decimals, Mapping, Options, read, write};

/// Any bytes are a recording or a typed error; a recording survives being written and read again.
pub(crate) fn csv_reader(bytes: &[u8]) {
    match read("any.csv", bytes, &Options::default()) {
        Ok(recording) => survives_a_round_trip(&recording),
        Err(error) => is_one_line(&error.to_string(), "E-CSV-"),
    }
}

/// Any text is a mapping or a typed error; any mapping reads a good file or refuses it with a typed error.
pub(crate) fn mapping_toml(text: &str) {
    let log = "skipped\nZeit;Druck;p_ch_bar_gauge;remark\n0;1,5;1,25;2\n1.000;---;1,5;2\n";
    match Mapping::parse("any.toml", text) {
        Err(error) => is_one_line(&error.to_string(), "E-MAP-"),
        Ok(mapping) => {
            let options = Options {
                mapping,
                ..Options::default()
            };
            if let Err(error) = read("any.csv", log.as_bytes(), &options) {
                is_one_line(&error.to_string(), "E-CSV-");
            }
        }
    }
}

fn is_one_line(text: &str, code: &str) {
    assert!(text.starts_with(code), "{text}");
    assert!(!text.contains(char::is_control), "{text:?}");
}

fn survives_a_round_trip(recording: &Recording) {
    let (base, time_base) = recording
        .time_bases()
        .next()
        .expect("a CSV file has one time base");
    let written = write(Vec::new(), recording, base, &Decimals::shortest())
        .expect("what was read can be written");
    let again = read("again.csv", written.as_slice(), &Options::default())
        .expect("what was written can be read");
    assert_eq!(
        again.time_bases().next().map(|(_, again)| again),
        Some(time_base)
    );
    assert_eq!(recording.signals().len(), again.signals().len());
    for (signal, again) in recording.signals().iter().zip(again.signals()) {
        assert_eq!((signal.name(), signal.unit()), (again.name(), again.unit()));
        let bits = |sample: Option<f64>| sample.map(f64::to_bits);
        assert!(
            signal.iter().map(bits).eq(again.iter().map(bits)),
            "{} changed",
            signal.name()
        );
    }
}
