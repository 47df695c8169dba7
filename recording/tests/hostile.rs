//! Hostile files cause no panic and no excessive use of memory or time.
//!
//! `memory.rs` counts the heap. The tests here count the bytes read of a refused input, and on Linux the growth of the
//! process while a long input is streamed.

#[allow(dead_code, reason = "each test checks some of the properties")]
mod properties;

use std::io::{self, Read};
use std::time::{Duration, Instant};

use proptest::prelude::*;
use recording::csv::{CsvError, Limits, Options, Reader, read};

const MIB: u64 = 1 << 20;

/// Input that repeats a pattern after a beginning, up to a size, and counts the bytes read.
struct Generated<'a> {
    beginning: &'a [u8],
    pattern: &'a [u8],
    size: u64,
    taken: &'a mut u64,
}

impl Read for Generated<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let mut filled = 0;
        while filled < buffer.len() && *self.taken < self.size {
            let source = match self.beginning.get(*self.taken as usize..) {
                Some(rest) if !rest.is_empty() => rest,
                _ => {
                    let into = *self.taken - self.beginning.len() as u64;
                    &self.pattern[(into % self.pattern.len() as u64) as usize..]
                }
            };
            let left = (self.size - *self.taken).min((buffer.len() - filled) as u64) as usize;
            let count = source.len().min(left);
            buffer[filled..filled + count].copy_from_slice(&source[..count]);
            filled += count;
            *self.taken += count as u64;
        }
        Ok(filled)
    }
}

/// Returns the refusal of a generated input, and the number of bytes read.
fn refusal(beginning: &[u8], pattern: &[u8], size: u64) -> (CsvError, u64) {
    let mut taken = 0;
    let input = Generated {
        beginning,
        pattern,
        size,
        taken: &mut taken,
    };
    let started = Instant::now();
    let error = match read("hostile.csv", input, &Options::default()) {
        Err(error) => error,
        Ok(_) => panic!("the hostile file was accepted"),
    };
    assert!(
        started.elapsed() < Duration::from_secs(2),
        "took {:?}",
        started.elapsed()
    );
    (error, taken)
}

#[test]
fn an_unclosed_quote_of_300_megabytes_is_refused_after_the_record_limit() {
    let (error, taken) = refusal(
        b"time_s,p_ch_bar_gauge\n0.0,1.5\n0.1,\"",
        b"1.5\n0.2,",
        300 * MIB,
    );
    assert_eq!(
        (error.code(), error.place().line),
        ("E-CSV-LIMIT-FIELD", Some(3)),
        "{error}"
    );
    assert!(taken < 2 * MIB, "{taken}");
    let (error, taken) = refusal(b"\"", b"time_s,", 300 * MIB);
    assert_eq!(error.code(), "E-CSV-DELIMITER", "{error}");
    assert!(taken < 4 * MIB, "{taken}");
    // Short quoted fields: only the record is too long.
    let (error, taken) = refusal(b"time_s,a_V\n0.0,1.5\n", b"\"\n\",", 300 * MIB);
    assert_eq!(error.code(), "E-CSV-LIMIT-COLUMNS", "{error}");
    assert!(taken < 2 * MIB, "{taken}");
}

#[test]
fn a_line_of_a_hundred_million_commas_is_refused_after_the_column_limit() {
    for beginning in [&b"time_s"[..], b"time_s,p_ch_bar_gauge\n0.0,1.5\n", b""] {
        let (error, taken) = refusal(beginning, b",", 100 * MIB);
        assert_eq!(error.code(), "E-CSV-LIMIT-COLUMNS", "{error}");
        assert!(taken < 4 * MIB, "{taken}");
    }
}

#[test]
fn endless_blank_lines_comments_and_zeros_end_at_a_limit_or_at_once() {
    let (error, _) = refusal(b"", b"\n", 20 * MIB);
    assert_eq!(error.code(), "E-CSV-EMPTY", "{error}");
    let (error, _) = refusal(b"# ", b"no end ", 20 * MIB);
    assert_eq!(error.code(), "E-CSV-EMPTY", "{error}");
    let (error, taken) = refusal(b"", b"\0", 300 * MIB);
    assert_eq!(error.code(), "E-CSV-ENCODING", "{error}");
    assert!(taken < 4 * MIB, "{taken}");
    let (error, taken) = refusal(b"time_s,p_ch_bar_gauge\n0.0,", b"1", 300 * MIB);
    assert_eq!(error.code(), "E-CSV-LIMIT-FIELD", "{error}");
    assert!(taken < 4 * MIB, "{taken}");
}

#[test]
fn each_budget_holds_at_its_bound_and_refuses_one_beyond() {
    let file = |field: &str, rows: usize| {
        let mut text = "time_s,a_V,b_V\n".to_owned();
        (0..rows).for_each(|row| text.push_str(&format!("{row},{field},0.5\n")));
        text
    };
    let check = |text: &str, limits: Limits, code: Option<&str>| {
        let options = Options {
            limits,
            ..Options::default()
        };
        let result = read("limits.csv", text.as_bytes(), &options);
        match (&result, code) {
            (Ok(_), None) => {}
            (Err(error), Some(code)) => {
                assert!(error.code() == code && error.is_limit(), "{error}")
            }
            _ => panic!("expected {code:?}, got {result:?}"),
        }
    };
    let base = Limits::default();
    let text = file("1.25", 3);
    let size = text.len() as u64;
    check(
        &text,
        Limits {
            file_bytes: size,
            ..base
        },
        None,
    );
    check(
        &text,
        Limits {
            file_bytes: size - 1,
            ..base
        },
        Some("E-CSV-LIMIT-FILE"),
    );
    check(&text, Limits { samples: 3, ..base }, None);
    check(
        &text,
        Limits { samples: 2, ..base },
        Some("E-CSV-LIMIT-SAMPLES"),
    );
    check(&text, Limits { columns: 3, ..base }, None);
    check(
        &text,
        Limits { columns: 2, ..base },
        Some("E-CSV-LIMIT-COLUMNS"),
    );
    check(
        &file("1.2345", 3),
        Limits {
            field_bytes: 6,
            ..base
        },
        None,
    );
    check(
        &file("1.23456", 3),
        Limits {
            field_bytes: 6,
            ..base
        },
        Some("E-CSV-LIMIT-FIELD"),
    );
    let longest = "0,1.2345678901,0.5\n".len();
    check(
        &file("1.2345678901", 3),
        Limits {
            record_bytes: longest,
            ..base
        },
        None,
    );
    check(
        &file("1.2345678901", 3),
        Limits {
            record_bytes: longest - 1,
            ..base
        },
        Some("E-CSV-LIMIT-RECORD"),
    );
}

/// Endless rows in the format of this crate, generated while they are read.
struct Rows {
    next: u64,
    count: u64,
    pending: Vec<u8>,
    given: usize,
}

impl Read for Rows {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.given == self.pending.len() && self.next < self.count {
            self.pending.clear();
            self.given = 0;
            for _ in 0..1000 {
                let (s, cs) = (self.next / 100, self.next % 100);
                let row = format!(
                    "{s}.{cs:02},28.5,0.0,{}.{:04},1.5,1.0,23.975\n",
                    self.next % 8,
                    self.next % 10_000
                );
                self.pending.extend_from_slice(row.as_bytes());
                self.next += 1;
            }
        }
        let rest = &self.pending[self.given..];
        let count = rest.len().min(buffer.len());
        buffer[..count].copy_from_slice(&rest[..count]);
        self.given += count;
        Ok(count)
    }
}

/// Returns the resident memory of this process, from the kernel.
#[cfg(target_os = "linux")]
fn resident_bytes() -> u64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = status
        .lines()
        .find(|line| line.starts_with("VmRSS:"))
        .unwrap();
    line.split_whitespace()
        .nth(1)
        .unwrap()
        .parse::<u64>()
        .unwrap()
        * 1024
}

/// 200 MB through the streaming reader: every row arrives, and memory does not grow.
#[test]
fn a_log_of_200_megabytes_is_streamed_without_growing() {
    let header = b"time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge,i_fill_mA,i_vent_mA,u_bat_V\n";
    let rows = Rows {
        next: 0,
        count: 5_200_000,
        pending: header.to_vec(),
        given: 0,
    };
    let mut reader = Reader::new("long.csv", rows, &Options::default()).unwrap();
    #[cfg(target_os = "linux")]
    let before = resident_bytes();
    let (mut count, mut sum) = (0, 0.0);
    while let Some(row) = reader.next_row().unwrap_or_else(|error| panic!("{error}")) {
        count += 1;
        sum += row.values[0];
    }
    #[cfg(target_os = "linux")]
    assert!(
        resident_bytes() < before + 4 * MIB,
        "grew from {before} to {}",
        resident_bytes()
    );
    assert_eq!((count, sum), (5_200_000, 5_200_000.0 * 28.5));
    let size = reader.provenance().input.unwrap().size_bytes;
    assert!(size > 200_000_000, "{size}");
}

#[test]
fn the_same_bytes_in_pieces_of_any_size_give_the_same_recording() {
    struct Pieces<'a>(&'a [u8], usize);
    impl Read for Pieces<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let count = self.1.min(self.0.len()).min(buffer.len());
            let (piece, rest) = self.0.split_at(count);
            buffer[..count].copy_from_slice(piece);
            self.0 = rest;
            Ok(count)
        }
    }
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../data/synthetic/practice-00-id.csv"
    );
    let crlf = String::from_utf8(std::fs::read(path).unwrap())
        .unwrap()
        .replace('\n', "\r\n");
    let whole = read("a.csv", crlf.as_bytes(), &Options::default()).unwrap();
    for size in [1, 2, 7, 4096, 65_537] {
        let pieces = read("a.csv", Pieces(crlf.as_bytes(), size), &Options::default()).unwrap();
        assert!(pieces == whole, "pieces of {size}");
    }
}

#[test]
fn after_an_error_the_reader_gives_no_more_rows() {
    let text = "time_s,a_V\n0,1\n1,x\n2,1\n";
    let mut reader = Reader::new("a.csv", text.as_bytes(), &Options::default()).unwrap();
    assert!(reader.next_row().unwrap().is_some());
    assert_eq!(reader.next_row().unwrap_err().code(), "E-CSV-NUMBER");
    assert_eq!(reader.next_row().unwrap_err().code(), "E-CSV-AFTER-ERROR");
}

#[test]
fn a_failing_disk_is_an_error_and_not_the_end_of_the_file() {
    struct Failing(u32);
    impl Read for Failing {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            self.0 += 1;
            match self.0 {
                1 => {
                    let text = b"time_s,a_V\n0.0,1.5\n";
                    buffer[..text.len()].copy_from_slice(text);
                    Ok(text.len())
                }
                2 => Err(io::Error::from(io::ErrorKind::Interrupted)),
                _ => Err(io::Error::other("the stick was pulled")),
            }
        }
    }
    let error = read("a.csv", Failing(0), &Options::default()).unwrap_err();
    assert_eq!(error.code(), "E-CSV-IO");
    assert!(
        error.to_string().contains("the stick was pulled"),
        "{error}"
    );
}

fn good_file() -> Vec<u8> {
    let mut text = "# rig: 3\ntime_s;duty_fill_pct;p_ch_bar_gauge;i_fill_mA\n".to_owned();
    for row in 0..20 {
        text.push_str(&format!(
            "0,{row:02};28,5;\"{},25\";{}\n",
            row % 8,
            row * 10
        ));
    }
    text.into_bytes()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn random_bytes_give_a_recording_or_a_typed_error(bytes in prop::collection::vec(any::<u8>(), 0..300)) {
        properties::csv_reader(&bytes);
    }

    #[test]
    fn random_csv_like_text_gives_a_recording_or_a_typed_error(text in "(time_s|p_V|[0-9.,;\"\t\r\n#e+\\- ]){0,60}") {
        properties::csv_reader(text.as_bytes());
    }

    #[test]
    fn a_damaged_good_file_gives_a_recording_or_a_typed_error(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3u8), 1..5),
    ) {
        let mut bytes = good_file();
        for (index, byte, edit) in edits {
            let at = index.index(bytes.len());
            match edit {
                0 => bytes[at] = byte,
                1 => bytes.insert(at, byte),
                _ => bytes.truncate(at.max(1)),
            }
        }
        properties::csv_reader(&bytes);
    }

    #[test]
    fn random_mappings_give_a_mapping_or_a_typed_error(
        text in "(schema = 1\n|\\[time\\]\n|column = [0-9]\n|unit = \"(s|bar|V)\"\n|scale = [0-9]\n|\\[signal.a\\]\n|[ -~]){0,12}",
    ) {
        properties::mapping_toml(&text);
    }
}

/// A prefix of a good file never counts as complete, unless it ends with a whole row.
#[test]
fn no_cut_of_a_log_is_taken_for_the_whole_unless_it_ends_between_rows() {
    let bytes = b"time_s,p_ch_bar_gauge,i_fill_mA\n0.00,1.5,2\n0.01,1.25,30\n0.02,1.75,400\n";
    for end in 1..bytes.len() {
        let result = read("cut.csv", &bytes[..end], &Options::default());
        let ends_between_rows = bytes[end - 1] == b'\n' && end > 32;
        assert_eq!(
            result.is_ok(),
            ends_between_rows,
            "cut at {end}: {result:?}"
        );
    }
}
