use std::io::Read as _;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use model_lab::Comparison;
use model_lab::diagnosis::result::Verdict;
use model_lab::diagnosis::{Diagnosis, Refinement};
use serde_json::Value;

use crate::runner::{Bench, assert_contains, beginning_of};
use crate::schemas::keep_example;

/// A log of the rig with a leak; seconds of it.
const LEAKING: (&str, f64) = ("synthetic/practice-01-id.csv", 10.0);

/// Goal: what a person comes for. Method: name what the log hides, add it, watch the error fall, find nothing more; each
/// step with the file that the one before wrote.
///
/// `BLESS=1` keeps both results as the examples of their schemas, without what depends on the machine.
#[test]
fn a_leak_is_named_and_added_and_then_nothing_is_missing() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, LEAKING.1));
    let diagnose = [
        "diagnose",
        "--log",
        "bench.csv",
        "--json",
        "d.json",
        "--html",
        "d.html",
    ];
    let out = bench.run(&diagnose).ended_with(1);
    let diagnosis: Diagnosis = serde_json::from_str(&bench.read("d.json")).unwrap();
    let form = diagnosis.ladder[1].variant.as_ref().unwrap();
    let proposed =
        format!("retarder refine --log bench.csv --add chamber_leak:{form} --out refined.toml");
    assert_contains(
        &out,
        &[
            "Missing: chamber leak",
            "the plain model",
            &format!("+ chamber_leak ({form})"),
            "_m2 = ",
            &proposed,
        ],
    );
    assert_eq!(
        (diagnosis.verdict, &*diagnosis.effects),
        (Verdict::Found, &["chamber_leak".to_owned()][..])
    );
    assert_contains(
        &bench.read("d.html"),
        &[
            "Missing: chamber leak",
            &proposed,
            "refined model",
            "noise floor",
        ],
    );

    let refine: Vec<&str> = proposed
        .split(' ')
        .skip(1)
        .chain(["--json", "r.json"])
        .collect();
    let out = bench.run(&refine).ended_with(0);
    assert_contains(
        &out,
        &[
            "With chamber leak",
            &format!("chamber_leak, {form}"),
            "Written: refined.toml",
        ],
    );
    let plant = bench.read("refined.toml");
    assert_contains(
        &plant,
        &[
            "[effects.chamber_leak]",
            "# fitted by retarder refine to bench.csv; was 0.95",
        ],
    );
    let refinement: Refinement = serde_json::from_str(&bench.read("r.json")).unwrap();
    let last = refinement.ladder.last().unwrap();
    assert!(last.check_rms["p_ch"] < 1.2 * last.noise_floor["p_ch"]);
    keep_example("diagnosis", &timeless(&bench.read("d.json")));
    keep_example("refinement", &timeless(&bench.read("r.json")));

    let error = |more: &[&str]| {
        let arguments = [&["compare", "--log", "bench.csv", "--json"], more].concat();
        let comparison: Comparison = serde_json::from_str(&bench.run(&arguments).out).unwrap();
        comparison.signals[0].free_run.rms
    };
    assert!(error(&["--plant", "refined.toml"]) < 0.1 * error(&[]));
    let again = bench.run(&["diagnose", "--plant", "refined.toml", "--log", "bench.csv"]);
    assert_contains(
        &again.ended_with(0),
        &["Nothing detectable is missing", "would have shown"],
    );
    for command in [
        &[
            "simulate",
            "--plant",
            "refined.toml",
            "--log",
            "bench.csv",
            "--out",
            "m.csv",
        ][..],
        &[
            "control",
            "--plant",
            "refined.toml",
            "--scenario",
            "fill-requirement",
        ],
    ] {
        assert!(bench.run(command).status < 2, "{command:?}");
    }
}

/// Times are 0.
fn timeless(json: &str) -> Value {
    let mut value: Value = serde_json::from_str(json).unwrap();
    for key in ["elapsed_s", "per_simulation_ms"] {
        value["cost"][key] = 0.0.into();
    }
    value
}

/// Whether a handler for SIGINT, the second signal, is installed.
#[cfg(target_os = "linux")]
fn catches_interrupts(pid: &str) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    u64::from_str_radix(caught.unwrap().trim(), 16).unwrap() & 0b10 != 0
}

#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_ends_a_diagnosis_and_leaves_no_file() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, LEAKING.1));
    let mut child = bench
        .command(&[
            "diagnose",
            "--log",
            "bench.csv",
            "--json",
            "d.json",
            "--html",
            "d.html",
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let pid = child.id().to_string();
    let deadline = Instant::now() + Duration::from_secs(20);
    while !catches_interrupts(&pid) {
        assert!(Instant::now() < deadline, "Ctrl-C is not watched for");
        std::thread::yield_now();
    }
    assert!(
        Command::new("kill")
            .args(["-INT", &pid])
            .status()
            .unwrap()
            .success()
    );
    let [mut out, mut err] = [String::new(), String::new()];
    child
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut out)
        .unwrap();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut err)
        .unwrap();
    assert_eq!(
        (child.wait().unwrap().code(), out.as_str()),
        (Some(2), ""),
        "{err}"
    );
    assert_contains(&err, &["error: stopped; nothing was written"]);
    assert_eq!(bench.files(), ["bench.csv"]);
}
