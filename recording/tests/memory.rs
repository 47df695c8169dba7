//! Heap usage of the readers, counted by the allocator: never more than their budgets, for any file.

use std::fs;
use std::io::{Cursor, Read};
use std::sync::{Mutex, PoisonError};

use peak_alloc::PeakAlloc;
use recording::{LogFormat, csv, mf4, table};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// The peak belongs to the process, so only one test counts at a time.
static COUNTING: Mutex<()> = Mutex::new(());

const MIB: usize = 1 << 20;

/// Returns the maximum growth of the heap during `work` (bytes).
fn peak(work: impl FnOnce()) -> usize {
    HEAP.reset_peak_usage();
    let before = HEAP.current_usage();
    work();
    HEAP.peak_usage().saturating_sub(before)
}

fn set_u64(bytes: &mut [u8], at: usize, value: u64) {
    bytes[at..at + 8].copy_from_slice(&value.to_le_bytes());
}

/// Every word of every fixture is replaced by a length or a count beyond the file.
#[test]
fn an_mf4_file_takes_what_its_budgets_allow_and_no_more() {
    let _one = COUNTING.lock().unwrap_or_else(PoisonError::into_inner);
    let limits = mf4::Limits {
        metadata_bytes: MIB as u64,
        values: MIB as u64 / 8,
        unpacked_bytes: MIB as u64,
        ..mf4::Limits::default()
    };
    let options = mf4::Options {
        limits,
        ..mf4::Options::default()
    };
    // Blocks without data, one unpacked block, and samples.
    let bound = 3 * MIB;
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/mf4");
    let mut files = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "mf4") {
            continue;
        }
        files += 1;
        let mut bytes = fs::read(&path).unwrap();
        for at in (0..bytes.len() - 8).step_by(8) {
            let right: [u8; 8] = bytes[at..at + 8].try_into().unwrap();
            for value in [1 << 20, 1 << 28, 1 << 40, u64::MAX >> 1] {
                set_u64(&mut bytes, at, value);
                let taken = peak(|| {
                    let _ = mf4::list("hostile.mf4", Cursor::new(&bytes), limits);
                    let _ = mf4::read("hostile.mf4", Cursor::new(&bytes), &options);
                });
                assert!(
                    taken < bound,
                    "{}: {value} at byte {at} takes {taken} bytes",
                    path.display()
                );
            }
            bytes[at..at + 8].copy_from_slice(&right);
        }
    }
    assert!(files > 0, "no fixture in {folder}");
}

/// Words of every Parquet and MATLAB fixture are replaced by a length or a count beyond the file.
#[test]
fn a_file_of_whole_columns_takes_what_its_budgets_allow_and_no_more() {
    let _one = COUNTING.lock().unwrap_or_else(PoisonError::into_inner);
    let limits = table::Limits {
        values: MIB as u64 / 8,
        unpacked_bytes: MIB as u64,
        ..table::Limits::default()
    };
    let options = table::Options {
        limits,
        ..table::Options::default()
    };
    // The file, one unpacked variable or chunk, the values of a column as they are and as numbers, and those of all.
    let bound = 8 * MIB;
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/table");
    let mut files = 0;
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let mut bytes = fs::read(&path).unwrap();
        let format = LogFormat::of_beginning(&bytes[..128]);
        if format == LogFormat::Csv {
            continue;
        }
        files += 1;
        for at in (0..bytes.len() - 4).step_by(2) {
            let right: [u8; 4] = bytes[at..at + 4].try_into().unwrap();
            for value in [1_u32 << 20, 0x7fff_ffff, u32::MAX] {
                bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
                let taken = peak(|| {
                    let _ = table::read("hostile", &bytes[..], format, &options);
                });
                assert!(
                    taken < bound,
                    "{}: {value} at byte {at} takes {taken} bytes",
                    path.display()
                );
            }
            bytes[at..at + 4].copy_from_slice(&right);
        }
    }
    assert_eq!(files, 9);
}

/// A record without end, a field without end, and too many columns.
#[test]
fn a_csv_file_without_an_end_takes_what_a_record_may() {
    let _one = COUNTING.lock().unwrap_or_else(PoisonError::into_inner);
    let record = csv::Limits::default().record_bytes;
    for pattern in ["1", "\"", "1,", "\"1\"\"", "time_s,"] {
        let endless = pattern.as_bytes().repeat(64 * MIB / pattern.len());
        for beginning in ["", "time_s,p_ch_bar_gauge\n0.00,"] {
            let input = beginning.as_bytes().chain(&endless[..]);
            let mut refused = false;
            let taken = peak(|| {
                let options = csv::Options::default();
                refused = csv::read("hostile.csv", input, &options).is_err();
            });
            assert!(refused, "{beginning:?} {pattern:?}");
            assert!(
                taken < 8 * record,
                "{beginning:?} {pattern:?}: {taken} bytes"
            );
        }
    }
}
