//! Tables of many rigs: `control --rigs-out` and `merge-rigs`.

use std::fs;
use std::process::Stdio;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::runner::{Bench, Ran, assert_contains};

/// Number of rigs of the tests: two chunks of the unfinished part, and two rigs.
const RIGS: &str = "130";
const BATCH: [&str; 5] = ["control", "--rigs", RIGS, "--scenario", "fill-requirement"];

fn batch<'a>(options: &[&'a str]) -> Vec<&'a str> {
    [&BATCH, options].concat()
}

/// Waits until the unfinished part of `rigs.parquet` has a chunk.
fn wait_for_a_chunk(bench: &Bench) {
    let deadline = Instant::now() + Duration::from_secs(60);
    let size = || fs::metadata(bench.path("rigs.parquet.part")).map_or(0, |part| part.len());
    let settings = loop {
        match size() {
            0 => assert!(Instant::now() < deadline, "no part"),
            size => break size,
        }
    };
    while size() < settings + 4096 {
        assert!(Instant::now() < deadline, "no chunk");
    }
}

/// Runs one batch whole, killed and continued on another number of threads, and in shards.
#[cfg(unix)]
#[test]
fn a_table_has_the_same_bytes_on_any_number_of_threads_after_a_kill_and_merged_from_shards() {
    let bench = Bench::new();
    let out = bench.run(&batch(&["--rigs-out", "whole.parquet", "--jobs", "1"]));
    let whole = fs::read(bench.path("whole.parquet")).unwrap();
    let answer = "130 rigs meet every binding requirement.";
    assert_contains(
        &out.out,
        &[
            "rig-seconds per second",
            "on 1 thread",
            answer,
            "Written: whole",
        ],
    );

    let two = batch(&["--rigs-out", "rigs.parquet", "--jobs", "2"]);
    let slow = batch(&["--rigs-out", "rigs.parquet", "--jobs", "1"]);
    let mut child = bench.command(&slow).stdout(Stdio::null()).spawn().unwrap();
    wait_for_a_chunk(&bench);
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(!bench.path("rigs.parquet").exists());
    let continued = bench.run(&two);
    assert_contains(&continued.out, &[" rigs of 12.6 s in "]);
    // Those of the first chunk were kept.
    assert!(!continued.out.contains("130 rigs of 12.6 s"));
    assert_eq!(continued.status, out.status);
    assert!(fs::read(bench.path("rigs.parquet")).unwrap() == whole);
    assert!(!bench.path("rigs.parquet.part").exists());
    let again = bench.run(&two);
    assert_contains(&again.out, &["No rig was run", answer]);

    let shards = ["1/3", "2/3", "3/3"].map(|shard| {
        let name = format!("{}.parquet", shard.replace('/', "of"));
        bench.run(&batch(&["--rigs-out", &name, "--shard", shard]));
        name
    });
    let [one, two, three] = shards.each_ref().map(String::as_str);
    let merged = bench.run(&["merge-rigs", three, one, two, "--out", "merged.parquet"]);
    assert_contains(
        &merged.out,
        &["130 rigs, merged", answer, "Written: merged.parquet"],
    );
    assert_eq!(merged.status, out.status);
    assert!(fs::read(bench.path("merged.parquet")).unwrap() == whole);

    let refused = |files: &[&str], parts: &[&str]| {
        let arguments = [&["merge-rigs", "--out", "bad.parquet"], files].concat();
        let ran = bench.run(&arguments);
        assert_contains(&ran.err, parts);
        ran.ended_with(2);
        assert!(!bench.path("bad.parquet").exists());
    };
    let empty = [
        "control",
        "--rigs",
        "2",
        "--rigs-out",
        "empty.parquet",
        "--shard",
        "1/3",
    ];
    let empty = bench.run(&empty).ended_with(0);
    assert_contains(&empty, &["No rigs: the batch has fewer rigs than shards."]);

    refused(
        &[one, three],
        &["error: rig 43 to 85 of 130 are in no file"],
    );
    refused(
        &[one, two, two, three],
        &["2of3.parquet and 2of3.parquet: both have rig 43 to 85"],
    );
    let other = ["control", "--rigs", "1", "--rigs-out", "other.parquet"];
    bench.run(&[&other[..], &BATCH[3..]].concat());
    refused(
        &[one, "other.parquet"],
        &["1of3.parquet and other.parquet: shards of different runs: number of rigs `130` and `1`"],
    );
}

/// The message names the part; with other settings, the part is kept and refused.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_leaves_the_finished_rigs_to_the_same_command() {
    let bench = Bench::new();
    let endless = ["control", "--rigs", "1000000", "--rigs-out", "rigs.parquet"];
    let with = |options: &[&'static str]| [&endless, &BATCH[3..], options].concat();
    let child = bench
        .command(&with(&[]))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for_a_chunk(&bench);
    crate::diagnose::interrupt(&child);
    let ran = Ran::of(child.wait_with_output().unwrap());
    assert_contains(
        &ran.err,
        &[
            "error: interrupted; ",
            " of 1000000 rigs are in rigs.parquet.part, and the same command continues",
        ],
    );
    assert_eq!(ran.ended_with(2), "");
    assert_eq!(bench.files(), ["rigs.parquet.part"]);
    for (options, difference) in [
        (["--seed", "2"], "seed `1` there and `2` now"),
        (["--controller", "thesis"], "controller `"),
        (["--set", "chamber.volume_m3=80e-6"], "plant `volume_m3 = "),
        (
            ["--supply-voltage", "28"],
            "supply voltage `` there and `28 V` now",
        ),
        (
            ["--shard", "1/2"],
            "shard `rigs 0 to 999999` there and `rigs 0 to 499999` now",
        ),
    ] {
        let ran = bench.run(&with(&options));
        let parts = [
            "error: rigs.parquet.part: the unfinished part of a run with other settings",
            difference,
        ];
        assert_contains(&ran.err, &parts);
        ran.ended_with(2);
    }
    bench.file("requirements.toml", "[settling]\nt_req_samples = 40\n");
    let ran = bench.run(&with(&["--requirements", "requirements.toml"]));
    assert_contains(
        &ran.err,
        &["requirements `t_req_samples: 50,` there and `t_req_samples: 40,` now"],
    );
}

#[test]
fn a_wrong_table_is_refused_before_any_work() {
    let bench = Bench::new();
    let check = |line: &str, parts: &[&str]| {
        let ran = bench.run(&line.split(' ').collect::<Vec<_>>());
        assert_contains(&ran.err, parts);
        ran.ended_with(2);
    };
    let parquet = "written as Parquet; choose a name that ends in .parquet";
    check(
        "control --rigs 2 --rigs-out rigs.csv",
        &["rigs.csv: ", parquet],
    );
    check("control --rigs 2 --rigs-out -", &["-: ", parquet]);
    check(
        "merge-rigs a.parquet --out rigs.csv",
        &["rigs.csv: ", parquet],
    );
    check(
        "control --rigs 0 --rigs-out rigs.parquet",
        &["--rigs-out with 0 rigs"],
    );
    check(
        "control --rigs 100001",
        &["--rigs 100001: 100000 at most without --rigs-out"],
    );
    check(
        "control --rigs 2 --rigs-out rigs.parquet --shard 3/2",
        &["expected K/N with 1 <= K <= N"],
    );
    check("control --rigs-out rigs.parquet", &["--rigs <COUNT>"]);
    check("control --rigs 2 --shard 1/2", &["--rigs-out <FILE>"]);
    check(
        "merge-rigs missing.parquet --out rigs.parquet",
        &["missing.parquet: cannot be read"],
    );
    bench.file("a.parquet", "rig,seed\n");
    check(
        "merge-rigs a.parquet --out rigs.parquet",
        &["a.parquet: damaged or no Parquet file"],
    );
    check(
        "merge-rigs a.parquet --out a.parquet",
        &["--out names the file that FILE reads"],
    );
    bench.file("rigs.parquet.part", "notes");
    let foreign = "rigs.parquet.part: not the unfinished part of a run with --rigs-out";
    check("control --rigs 2 --rigs-out rigs.parquet", &[foreign]);
    assert_eq!(bench.read("rigs.parquet.part"), "notes");
    bench.file("old.parquet", "older");
    check(
        "--no-clobber control --rigs 2 --rigs-out old.parquet",
        &["old.parquet: exists"],
    );
}

/// `--rig` gives the verdict that the batch gave, and the command that the table prints is complete.
#[test]
fn a_rig_of_a_batch_is_run_alone_by_its_number() {
    let bench = Bench::new();
    let run = |line: &str| bench.run(&line.split(' ').collect::<Vec<_>>());
    let options = "--scenario hold --seed 7 --coil-temperature 60 --set chamber.volume_m3=80e-6";
    let json = |line: &str| -> Value { serde_json::from_str(&run(line).out).unwrap() };
    let rigs = json(&format!("control --rigs 3 {options} --json"));
    let alone = json(&format!("control --rig 2 {options} --json"));
    assert_eq!(alone, rigs["rigs"][2]["verdict"]);

    let text = run(&format!(
        "control --rigs 3 {options} --rigs-out rigs.parquet"
    ))
    .out;
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (_, command) = text.split_once("Repeat it: retarder ").unwrap();
    let number = command
        .split(' ')
        .skip_while(|&word| word != "--rig")
        .nth(1)
        .unwrap();
    let (command, _) = command.split_once(" --rig ").unwrap();
    let alone = json(&format!("{command} --rig {number} --json"));
    let index: usize = number.parse().unwrap();
    assert_eq!(alone, rigs["rigs"][index]["verdict"]);
}
