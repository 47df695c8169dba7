//! Requirements on the readers for any input, used by the fuzz targets and by the tests of this crate.

use std::io::Cursor;

use recording::csv::{Decimals, Mapping, Options, read, write};
use recording::{LogFormat, Recording, mf4, table};

/// Checks that any bytes give a recording or a typed error, and that a recording is unchanged after writing and
/// reading.
pub(crate) fn csv_reader(bytes: &[u8]) {
    match read("any.csv", bytes, &Options::default()) {
        Ok(recording) => survives_a_round_trip(&recording),
        Err(error) => is_one_line(&error.to_string(), "E-CSV-"),
    }
}

/// Checks that any text gives a mapping or a typed error, and that any mapping reads a good file or refuses it with a
/// typed error.
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

/// Checks that any bytes give a recording or a typed error, and so does their listing; a recording is unchanged after
/// writing and reading.
pub(crate) fn mf4_reader(bytes: &[u8]) {
    // A small file may claim many samples: this limits them.
    let limits = mf4::Limits {
        values: 1 << 20,
        unpacked_bytes: 1 << 20,
        ..mf4::Limits::default()
    };
    let options = mf4::Options {
        limits,
        ..mf4::Options::default()
    };
    if let Err(error) = mf4::list("any.mf4", Cursor::new(bytes), limits) {
        is_one_line(&error.to_string(), "E-MF4-");
    }
    match mf4::read("any.mf4", Cursor::new(bytes), &options) {
        Ok(recording) => {
            let written = mf4::write(Vec::new(), &recording).expect("what was read can be written");
            let again = mf4::read("again.mf4", Cursor::new(written), &options)
                .expect("what was written can be read");
            has_the_same_samples(&recording, &again);
        }
        Err(error) => is_one_line(&error.to_string(), "E-MF4-"),
    }
}

/// Checks that any bytes give a recording or a typed error, and that a recording has the same samples after writing and
/// reading, in each format of whole columns.
pub(crate) fn table_reader(bytes: &[u8]) {
    let format = LogFormat::of_beginning(&bytes[..bytes.len().min(128)]);
    let format = match format {
        LogFormat::Csv | LogFormat::Mf4 => LogFormat::Matlab,
        format => format,
    };
    // A small file may claim many values: this limits them.
    let limits = table::Limits {
        values: 1 << 20,
        unpacked_bytes: 1 << 20,
        ..table::Limits::default()
    };
    let options = table::Options {
        limits,
        ..table::Options::default()
    };
    match table::read("any", bytes, format, &options) {
        Ok(recording) => {
            let (base, _) = recording.time_bases().next().expect("it has a time");
            let written = [
                (
                    LogFormat::Parquet,
                    table::write_parquet(Vec::new(), &recording, base),
                ),
                (
                    LogFormat::Matlab,
                    table::write_matlab(Vec::new(), &recording, base),
                ),
                (
                    LogFormat::MatlabHdf5,
                    table::write_matlab_hdf5(Vec::new(), &recording, base),
                ),
            ];
            for (format, written) in written {
                let written = written.expect("what was read can be written");
                match table::read("again", &written[..], format, &options) {
                    Ok(again) => assert_eq!(again.time_bases().count(), 1),
                    // A variable of MATLAB cannot have every name that a signal has.
                    Err(error) => {
                        assert_eq!(error.code(), "E-TAB-NO-SIGNAL");
                        assert_ne!(format, LogFormat::Parquet);
                    }
                }
            }
        }
        Err(error) => is_one_line(&error.to_string(), "E-TAB-"),
    }
}

fn is_one_line(text: &str, code: &str) {
    assert!(text.starts_with(code), "{text}");
    assert!(!text.contains(char::is_control), "{text:?}");
}

fn survives_a_round_trip(recording: &Recording) {
    let (base, _) = recording
        .time_bases()
        .next()
        .expect("a CSV file has one time base");
    let written = write(Vec::new(), recording, base, &Decimals::shortest())
        .expect("what was read can be written");
    let again = read("again.csv", written.as_slice(), &Options::default())
        .expect("what was written can be read");
    has_the_same_samples(recording, &again);
}

fn has_the_same_samples(recording: &Recording, again: &Recording) {
    assert_eq!(recording.signals().len(), again.signals().len());
    for signal in recording.signals() {
        let name = signal.name();
        let same = again.signal(name).expect("the name survives");
        assert_eq!(same.unit(), signal.unit(), "{name}");
        assert_eq!(again.time_base_of(name), recording.time_base_of(name));
        let bits = |sample: Option<f64>| sample.map(f64::to_bits);
        assert!(signal.iter().map(bits).eq(same.iter().map(bits)), "{name}");
    }
}
