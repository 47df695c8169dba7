//! Tables of the same run: from one thread and several, after a kill, from shards. Most rows are made up, since only their
//! way into the file is tested.

use core::num::NonZero;
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicU32, Ordering};
use std::fs::{self, File};
use std::path::PathBuf;

use tempfile::TempDir;

use super::*;
use crate::operating_conditions::ConditionScatter;
use crate::requirement::Requirement;
use crate::rigs::RigError;
use crate::scenario::Scenario;

/// Number of rigs: more than two chunks, and no multiple of their size.
const RIGS: u32 = 150;

/// Returns a row whose every field differs from that of another rig.
fn row(rig: u32) -> RigRow {
    let figure = |scale: f64| Some(scale * f64::from(rig).sqrt());
    RigRow {
        rig,
        // Beyond the range of signed numbers.
        seed: u64::MAX - u64::from(rig),
        supply_voltage_v: figure(0.1),
        coil_temperature_c: figure(-0.2),
        holds: !rig.is_multiple_of(7),
        failed_checks: ["settling_time,steady_error", ""][usize::from(!rig.is_multiple_of(7))]
            .to_owned(),
        confirmed_faults: ["SensorStuck", ""][usize::from(rig != 9)].to_owned(),
        steps: 3 + rig,
        late_steps: rig % 5,
        never_settled_steps: rig % 3,
        settling_mean_samples: figure(1.1),
        settling_p90_samples: figure(1.2),
        settling_worst_samples: (rig != 11).then_some(f64::from(rig % 40)),
        steady_error_bar: figure(1.3),
        overshoot_bar: figure(1.4),
        fill_time_samples: figure(1.5),
        vent_time_samples: None,
        both_valves_samples: figure(1.6),
        duty_limits_samples: figure(1.7),
        rest_actuations: figure(1.8),
        lifts_per_s: figure(1.9),
    }
}

fn settings(seed: u32) -> RunSettings {
    let settings = [
        ("number of rigs", RIGS.to_string()),
        ("seed", seed.to_string()),
        ("plant", "[coil]\nresistance_ohm = 82\n".to_owned()),
    ];
    RunSettings::new(settings.map(|(name, text)| (name.to_owned(), text)))
}

fn jobs(count: usize) -> NonZero<usize> {
    NonZero::new(count).unwrap()
}

fn shard(text: &str) -> Shard {
    text.parse().unwrap()
}

/// Folder of a run.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn journal(&self, shard: Shard) -> Result<Journal, MonteCarloError> {
        Journal::open(self.path("rigs.part"), &settings(1), shard.rigs(RIGS))
    }

    /// Computes the rows that are missing, and returns the file.
    fn table(&self, shard: Shard, threads: usize) -> Vec<u8> {
        let mut journal = self.journal(shard).unwrap();
        let ok = |rig| Ok(row(rig));
        complete(&mut journal, jobs(threads), &ok, &mut |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
        let (bytes, _) = journal.write(Vec::new()).unwrap();
        journal.remove().unwrap();
        bytes
    }

    /// Writes the file of a shard.
    fn shard(&self, text: &str) -> PathBuf {
        let path = self.path(&text.replace('/', "of"));
        fs::write(&path, self.table(shard(text), 1)).unwrap();
        path
    }

    /// Computes rows until `stop_after` rigs are done, and leaves the journal.
    fn interrupted(&self, threads: usize, stop_after: u32) -> MonteCarloError {
        let mut journal = self.journal(Shard::WHOLE).unwrap();
        let ok = |rig| Ok(row(rig));
        complete(
            &mut journal,
            jobs(threads),
            &ok,
            &mut |done| match done < stop_after {
                true => ControlFlow::Continue(()),
                false => ControlFlow::Break(()),
            },
        )
        .unwrap_err()
    }
}

fn whole() -> Vec<u8> {
    Bench::new().table(Shard::WHOLE, 1)
}

fn merged(paths: &[PathBuf]) -> Result<Vec<u8>, String> {
    let merged = merge(paths, Vec::new());
    merged
        .map(|(bytes, _)| bytes)
        .map_err(|error| error.to_string())
}

#[track_caller]
fn assert_parts(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "`{part}` is not in: {text}");
    }
}

#[test]
fn a_table_returns_every_field_of_every_row_and_the_settings() {
    let bench = Bench::new();
    let path = bench.path("rigs.parquet");
    fs::write(&path, bench.table(Shard::WHOLE, 1)).unwrap();
    let table = RowReader::open(File::open(path).unwrap()).unwrap();
    assert_eq!(table.settings(), &settings(1));
    assert_eq!(table.row_count(), u64::from(RIGS));
    let rows: Vec<RigRow> = table.collect::<Result<_, _>>().unwrap();
    let expected: Vec<RigRow> = (0..RIGS).map(row).collect();
    assert_eq!(rows, expected);
}

#[test]
fn the_file_does_not_depend_on_the_number_of_threads() {
    let one = whole();
    for threads in [2, 5] {
        assert!(
            Bench::new().table(Shard::WHOLE, threads) == one,
            "{threads} threads"
        );
    }
}

#[test]
fn an_interrupted_run_continues_with_the_rigs_that_are_missing() {
    for threads in [1, 2] {
        let bench = Bench::new();
        let error = bench.interrupted(threads, 140).to_string();
        assert_parts(
            &error,
            &["of 150 rigs are in ", "the same command continues there"],
        );
        let mut journal = bench.journal(Shard::WHOLE).unwrap();
        let kept = journal.done();
        assert!(kept >= 64, "{kept}");
        let computed = AtomicU32::new(0);
        let counted = |rig| {
            computed.fetch_add(1, Ordering::Relaxed);
            Ok(row(rig))
        };
        complete(&mut journal, jobs(threads), &counted, &mut |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
        // One row is computed again, to see that the program is the same.
        assert_eq!(computed.into_inner(), RIGS - kept + 1);
        assert!(journal.write(Vec::new()).unwrap().0 == whole());
    }
}

/// A kill at any byte costs the chunk that was being written, and nothing else.
#[test]
fn a_journal_that_was_cut_off_anywhere_gives_the_same_file() {
    let bench = Bench::new();
    bench.interrupted(1, 140);
    let journal = fs::read(bench.path("rigs.part")).unwrap();
    let expected = whole();
    for length in (0..journal.len()).step_by(397).chain([journal.len() - 1]) {
        fs::write(bench.path("rigs.part"), &journal[..length]).unwrap();
        assert!(bench.table(Shard::WHOLE, 1) == expected, "{length} bytes");
    }
}

/// A chunk whose bytes changed is computed again, and so are those behind it.
#[test]
fn a_chunk_that_is_damaged_on_the_disk_is_computed_again() {
    let bench = Bench::new();
    bench.interrupted(1, 140);
    let path = bench.path("rigs.part");
    let mut journal = fs::read(&path).unwrap();
    let last = journal.len() - 100;
    journal[last] ^= 1;
    fs::write(&path, journal).unwrap();
    assert_eq!(bench.journal(Shard::WHOLE).unwrap().done(), 64);
    assert!(bench.table(Shard::WHOLE, 1) == whole());
}

#[test]
fn a_journal_of_other_settings_is_refused_with_the_difference() {
    let bench = Bench::new();
    bench.interrupted(1, 70);
    let open = |settings: &RunSettings, shard: Shard| {
        let opened = Journal::open(bench.path("rigs.part"), settings, shard.rigs(RIGS));
        opened.unwrap_err().to_string()
    };
    let other_seed = open(&settings(2), Shard::WHOLE);
    assert_parts(
        &other_seed,
        &[
            "rigs.part: ",
            "seed `1` there and `2` now",
            "remove the part",
        ],
    );
    let other_plant = RunSettings::new(settings(1).iter().map(|(name, text)| {
        let text = text.replace("82", "83");
        (name.to_owned(), text)
    }));
    let other_plant = open(&other_plant, Shard::WHOLE);
    let expected = "plant `resistance_ohm = 82` there and `resistance_ohm = 83` now";
    assert_parts(&other_plant, &[expected]);
    let other_shard = open(&settings(1), shard("1/2"));
    assert_parts(
        &other_shard,
        &["shard `rigs 0 to 149` there and `rigs 0 to 74` now"],
    );
    assert_eq!(bench.journal(Shard::WHOLE).unwrap().done(), 64);
}

#[test]
fn a_finished_table_is_not_computed_again() {
    let bench = Bench::new();
    let whole = bench.path("whole");
    fs::write(&whole, bench.table(Shard::WHOLE, 1)).unwrap();
    let is_finished = |path: &PathBuf, settings: &RunSettings, rigs, overshoot_bar| {
        let row = |rig| {
            Ok(RigRow {
                overshoot_bar,
                ..row(rig)
            })
        };
        let summary = finished(path, settings, rigs, &row).unwrap();
        summary.is_some_and(|summary| summary.rigs == RIGS)
    };
    let first_bar = row(0).overshoot_bar;
    assert!(is_finished(&whole, &settings(1), 0..RIGS, first_bar));
    assert!(!is_finished(&whole, &settings(2), 0..RIGS, first_bar));
    assert!(!is_finished(&whole, &settings(1), 0..RIGS + 1, first_bar));
    assert!(!is_finished(&whole, &settings(1), 0..RIGS - 1, first_bar));
    assert!(
        !is_finished(&whole, &settings(1), 0..RIGS, Some(0.123)),
        "another build"
    );
    assert!(!is_finished(
        &bench.path("missing"),
        &settings(1),
        0..RIGS,
        first_bar
    ));
}

#[test]
fn a_journal_of_another_build_is_refused() {
    let bench = Bench::new();
    bench.interrupted(1, 70);
    let mut journal = bench.journal(Shard::WHOLE).unwrap();
    let other = |rig| {
        Ok(RigRow {
            overshoot_bar: Some(0.123),
            ..row(rig)
        })
    };
    let ended = complete(&mut journal, jobs(1), &other, &mut |_| {
        ControlFlow::Continue(())
    });
    assert_parts(
        &ended.unwrap_err().to_string(),
        &["rigs.part: rig 0 has other figures"],
    );
}

#[test]
fn two_processes_do_not_share_a_journal_and_a_foreign_file_is_kept() {
    let bench = Bench::new();
    let first = bench.journal(Shard::WHOLE).unwrap();
    let second = bench.journal(Shard::WHOLE).unwrap_err().to_string();
    assert_parts(&second, &["rigs.part: another run is writing it"]);
    drop(first);
    fs::write(bench.path("rigs.part"), "my notes").unwrap();
    let foreign = bench.journal(Shard::WHOLE).unwrap_err().to_string();
    assert_parts(
        &foreign,
        &["rigs.part: not the unfinished part", "move it away"],
    );
    assert_eq!(fs::read(bench.path("rigs.part")).unwrap(), b"my notes");
}

#[test]
fn a_rig_that_cannot_be_run_ends_the_run_and_the_finished_ones_stay() {
    let bench = Bench::new();
    let mut journal = bench.journal(Shard::WHOLE).unwrap();
    let failing = |rig| match rig {
        100 => Err(RigError::Judge(
            crate::judge(&recording_without_signals(), &Requirement::THESIS).unwrap_err(),
        )),
        _ => Ok(row(rig)),
    };
    let ended = complete(&mut journal, jobs(1), &failing, &mut |_| {
        ControlFlow::Continue(())
    });
    assert!(matches!(ended, Err(MonteCarloError::Rig(_))), "{ended:?}");
    assert_eq!(journal.done(), 64);
}

fn recording_without_signals() -> recording::Recording {
    recording::Recording::new(recording::Provenance::from_source("nothing"))
}

#[test]
fn merged_shards_are_the_file_of_a_run_without_shards() {
    let bench = Bench::new();
    for count in [1, 3, 7] {
        let mut paths: Vec<PathBuf> = (1..=count)
            .map(|number| bench.shard(&format!("{number}/{count}")))
            .collect();
        paths.reverse();
        assert!(merged(&paths).unwrap() == whole(), "{count} shards");
    }
}

#[test]
fn a_shard_without_rigs_merges_as_well() {
    let bench = Bench::new();
    let mut paths = vec![bench.shard("1/1")];
    let empty = bench.path("empty");
    let table = RowWriter::new(Vec::new(), &settings(1)).unwrap();
    fs::write(&empty, table.finish().unwrap()).unwrap();
    paths.insert(0, empty);
    assert!(merged(&paths).unwrap() == whole());
}

#[test]
fn a_merge_refuses_gaps_duplicates_and_other_runs() {
    let bench = Bench::new();
    let [one, two, three] = ["1/3", "2/3", "3/3"].map(|text| bench.shard(text));
    let check = |paths: &[&PathBuf], parts: &[&str]| {
        let paths: Vec<PathBuf> = paths.iter().map(|path| (*path).clone()).collect();
        assert_parts(&merged(&paths).unwrap_err(), parts);
    };
    check(
        &[&one, &three],
        &["rig 50 to 99 of 150 are in no file", "run the shards"],
    );
    check(&[&two, &three], &["rig 0 to 49 of 150"]);
    check(&[&one, &two], &["rig 100 to 149 of 150"]);
    check(
        &[&one, &two, &three, &two],
        &["2of3", "both have rig 50 to 99", "name each shard once"],
    );
    let half = bench.shard("2/2");
    check(
        &[&one, &two, &half],
        &["2of3", "2of2", "both have rig 75 to 99"],
    );
    check(&[], &["no file to merge"]);

    let mut other = Journal::open(bench.path("other.part"), &settings(2), 100..RIGS).unwrap();
    let ok = |rig| Ok(row(rig));
    complete(&mut other, jobs(1), &ok, &mut |_| ControlFlow::Continue(())).unwrap();
    let path = bench.path("other");
    fs::write(&path, other.write(Vec::new()).unwrap().0).unwrap();
    let parts = [
        "1of3 and ",
        "other: shards of different runs: seed `1` and `2`",
    ];
    check(&[&one, &two, &path], &parts);
}

#[test]
fn a_file_that_is_no_table_is_refused_with_its_name() {
    let bench = Bench::new();
    let whole = whole();
    let check = |bytes: &[u8], parts: &[&str]| {
        let path = bench.path("wrong.parquet");
        fs::write(&path, bytes).unwrap();
        let error = merged(&[path]).unwrap_err();
        assert_parts(&error, &["wrong.parquet: "]);
        assert_parts(&error, parts);
    };
    check(b"rig,seed\n0,1\n", &["damaged or no Parquet file"]);
    check(&whole[..whole.len() / 2], &["damaged or no Parquet file"]);
    check(
        &log_as_parquet(),
        &["not a table of rigs (retarder.rig-table/1)"],
    );
    let missing = merged(&[bench.path("missing.parquet")]).unwrap_err();
    assert_parts(&missing, &["missing.parquet: cannot be read"]);
}

fn log_as_parquet() -> Vec<u8> {
    let mut log = recording_without_signals();
    let base = recording::TimeBase::uniform(0.0, 0.01, 2).unwrap();
    let base = log.add_time_base(base);
    log.add_signal("p_ch", recording::Unit::BarGauge, base, vec![1.0, 2.0])
        .unwrap();
    recording::table::write_parquet(Vec::new(), &log, base).unwrap()
}

#[test]
fn a_summary_counts_and_names_the_worst_rig() {
    let mut summary = Summary::default();
    (0..RIGS).map(row).for_each(|row| summary.add(&row));
    let failing = RIGS.div_ceil(7);
    assert_eq!(summary.rigs, RIGS);
    assert_eq!(summary.rigs_that_hold, RIGS - failing);
    assert!(!summary.holds());
    let counts: Vec<_> = summary.failed_checks.iter().collect();
    assert_eq!(
        counts,
        [
            (&"settling_time".to_owned(), &failing),
            (&"steady_error".to_owned(), &failing)
        ]
    );
    assert_eq!(summary.confirmed_faults["SensorStuck"], 1);
    // Multiples of 7 fail; among those with four late steps, rig 119 has the slowest step.
    assert_eq!(summary.worst.as_ref().map(|row| row.rig), Some(119));
    assert_eq!(summary.figures["overshoot_bar"].worst_rig, RIGS - 1);
    let mean = (0..RIGS)
        .map(|rig| 1.4 * f64::from(rig).sqrt())
        .sum::<f64>()
        / f64::from(RIGS);
    assert!((summary.figures["overshoot_bar"].mean - mean).abs() < 1e-12);
    assert_eq!(summary.figures["settling_worst_samples"].rigs, RIGS - 1);
    assert!(!summary.figures.contains_key("vent_time_samples"));
    assert_eq!(summary.settling_quantile(0.5), Some(18));
    assert_eq!(summary.settling_quantile(1.0), None);
}

/// The figures of a row are those of the verdict, and another process finds the same.
#[test]
fn a_row_has_the_figures_of_its_verdict() {
    let scenario = Scenario::built_in("fill-requirement").unwrap();
    let conditions = ConditionScatter::vehicle(&scenario.plant);
    let batch = Batch {
        scenario,
        requirement: Requirement::THESIS,
        conditions,
        rigs: 4,
    };
    let verdict =
        crate::rigs::rig_verdict(&batch.scenario, &batch.requirement, 3, conditions).unwrap();
    let row = batch.row(3).unwrap();
    assert_eq!(row, batch.row(3).unwrap());
    assert_eq!(
        (row.rig, row.seed, row.holds),
        (3, verdict.seed, verdict.verdict.holds)
    );
    let check = |id| verdict.verdict.check(id).and_then(|check| check.reached);
    use crate::checks::CheckId;
    assert!(row.settling_worst_samples.is_some());
    assert_eq!(row.settling_worst_samples, check(CheckId::SettlingTime));
    assert_eq!(row.fill_time_samples, check(CheckId::FillTime));
    assert_eq!(row.overshoot_bar, check(CheckId::Overshoot));
    assert_eq!(row.vent_time_samples, None);
    assert_eq!(row.steps, 5);
}

/// The README of the crate lists the columns.
#[test]
fn every_column_is_listed_in_the_readme() {
    let readme = include_str!("../../README.md");
    for Column {
        name, unit, about, ..
    } in &COLUMNS
    {
        let line = format!("| `{name}` | {unit} | {about} |").replace("|  |", "| |");
        assert!(readme.contains(&line), "missing: {line}");
    }
}
