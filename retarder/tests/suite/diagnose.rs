use std::io::Read as _;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use model_lab::Comparison;
use model_lab::diagnosis::result::Verdict;
use model_lab::diagnosis::{Diagnosis, Estimation, Refinement};
use serde_json::Value;

use recording::{Provenance, Recording, TimeBase, Unit, csv, mf4};

use crate::next_experiment::experiment_proposed_by;
use crate::runner::{Bench, assert_contains, beginning_of};
use crate::schemas::keep_example;

/// Log of the rig with a leak, and the time used from it (s).
const LEAKING: (&str, f64) = ("synthetic/practice-01-id.csv", 10.0);

/// Goal: the main use case. Method: name the hidden effect of the log, add it, check that the error falls, and find
/// nothing more; each step uses the file that the step before wrote.
///
/// `BLESS=1` stores both results as the examples of their schemas, without the values that depend on the machine.
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
    let last = diagnosis.error_steps.last().unwrap();
    let form = last.variant.as_ref().unwrap();
    let proposed =
        format!("retarder refine --log bench.csv --add chamber_leak:{form} --out refined.toml");
    assert_contains(
        &out,
        &[
            "Missing: chamber leak",
            "the plain model",
            "plant as given",
            "ordinary parameters refitted",
            &format!("+ chamber leak ({form})"),
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
    let last = refinement.error_steps.last().unwrap();
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
        &["Nothing detectable is missing", "detection limit"],
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

/// Goal: from a first plant file to a fitted one. Method: a rig without missing effects, and a plant file whose
/// discharge and delay are far off; `diagnose` accepts the fitted file.
///
/// `BLESS=1` stores the result as the example of its schema.
#[test]
fn a_plant_file_that_is_far_off_is_estimated_and_then_nothing_is_missing() {
    let bench = Bench::new();
    bench.file(
        "bench.csv",
        &beginning_of("synthetic/practice-00-id.csv", 20.0),
    );
    let arguments = [
        "refine",
        "--log",
        "bench.csv",
        "--set",
        "flow.discharge_fill=0.7",
        "--set",
        "ecu.command_delay_s=0.019",
        "--fix",
        "chamber.volume_m3",
        "--out",
        "fitted.toml",
        "--json",
        "e.json",
    ];
    let out = bench.run(&arguments).ended_with(0);
    assert_contains(
        &out,
        &[
            "plant as given",
            "ordinary parameters refitted",
            "flow.discharge_fill",
            "determined",
            "Written: fitted.toml",
            "retarder diagnose --plant fitted.toml --log bench.csv    # is anything missing?",
        ],
    );
    let estimation: Estimation = serde_json::from_str(&bench.read("e.json")).unwrap();
    assert!(estimation.is_adequate, "{}", estimation.sentence);
    let names = estimation
        .parameters
        .iter()
        .map(|parameter| &*parameter.name);
    assert!(!names.clone().any(|name| name == "chamber.volume_m3"));
    let fitted = bench.read("fitted.toml");
    assert_contains(
        &fitted,
        &[
            "discharge_fill = { value = ",
            "was 0.7; 95 %:",
            "volume_m3 = { value = 7.5e-5, exact = true }",
        ],
    );
    keep_example("estimation", &timeless(&bench.read("e.json")));
    let diagnose = ["diagnose", "--plant", "fitted.toml", "--log", "bench.csv"];
    assert_contains(
        &bench.run(&diagnose).ended_with(0),
        &["Nothing detectable is missing"],
    );
}

/// With a free volume, the pressure determines ratios of flows and volume alone.
#[test]
fn parameters_that_stay_open_get_an_experiment() {
    let bench = Bench::new();
    bench.file(
        "bench.csv",
        &beginning_of("synthetic/practice-00-id.csv", 20.0),
    );
    let refine = ["refine", "--log", "bench.csv", "--out", "fitted.toml"];
    let out = bench.run(&refine).ended_with(0);
    assert_contains(&out, &["only with others"]);
    experiment_proposed_by(&bench, &out);
}

/// A wrong value has its own exit status: no effect is missing, and yet the model is outside its tolerance.
#[test]
fn a_wrong_value_of_the_plant_file_is_reported_with_its_own_status() {
    let bench = Bench::new();
    bench.file(
        "bench.csv",
        &beginning_of("synthetic/practice-00-id.csv", 6.0),
    );
    let wrong = ["--set", "armature.preload_fill_n=4.6"];
    let arguments = [&["diagnose", "--log", "bench.csv"][..], &wrong].concat();
    let out = bench.run(&arguments).ended_with(3);
    assert_contains(
        &out,
        &[
            "The plant file is wrong here: `armature.preload_fill_n` is",
            "--free armature.preload_fill_n",
        ],
    );
}

#[test]
fn what_cannot_be_freed_is_refused_before_any_work() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, 1.0));
    for (free, says) in [
        ("chamber.volume", "`chamber.volume_m3`"),
        ("chamber.volume_m3=2..1", "the lower end comes first"),
        ("chamber.volume_m3=5", "LOW..HIGH"),
    ] {
        let arguments = [
            "refine",
            "--log",
            "bench.csv",
            "--free",
            free,
            "--out",
            "r.toml",
        ];
        let run = bench.run(&arguments);
        assert_eq!(run.status, 2, "{free}");
        assert_contains(&run.err, &[says]);
    }
}

#[test]
fn a_need_that_cannot_be_meant_is_refused_before_any_work() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, 1.0));
    for (need, says) in [
        ("p_ch=0", "an error is positive"),
        ("p_chamber=0.02", "they have duty_fill, duty_vent, p_ch"),
    ] {
        let run = bench.run(&["diagnose", "--log", "bench.csv", "--need", need]);
        assert_eq!(run.status, 2, "{need}");
        assert_contains(&run.err, &[says]);
    }
}

/// With `--need` of one bar, an error of one bar counts as noise.
#[test]
fn what_is_below_the_need_is_not_missing() {
    let bench = Bench::new();
    bench.file("bench.csv", &beginning_of(LEAKING.0, 10.0));
    let needs = [
        "--need",
        "p_ch=1",
        "--need",
        "i_fill=50",
        "--need",
        "i_vent=50",
    ];
    let arguments = [&["diagnose", "--log", "bench.csv"][..], &needs].concat();
    let said = bench.run(&arguments).ended_with(0);
    assert_contains(&said, &["Nothing detectable is missing"]);
}

/// Writes a log with duty cycles and currents at 100 Hz, the pressure at 50 Hz, and a channel without a known unit.
fn two_rates(bench: &Bench) {
    let text = beginning_of(LEAKING.0, LEAKING.1);
    let log = csv::read("bench.csv", text.as_bytes(), &csv::Options::default()).unwrap();
    let (_, all) = log.time_bases().next().unwrap();
    let mut rates = Recording::new(Provenance::from_source("bench"));
    let id = rates.add_time_base(all.clone());
    let every_second = |values: &[f64]| values.iter().copied().step_by(2).collect();
    let slow = TimeBase::new(every_second(all.times_s())).unwrap();
    let slow_id = rates.add_time_base(slow);
    for signal in log.signals() {
        let values = signal.values_or_nan();
        let (base, values) = match signal.name() {
            "p_ch" => (slow_id, every_second(values)),
            _ => (id, values.to_vec()),
        };
        rates
            .add_signal(signal.name(), signal.unit(), base, values)
            .unwrap();
    }
    let lamp = vec![0.0; all.len()];
    rates.add_signal("lamp", Unit::Percent, id, lamp).unwrap();
    let path = bench.path("rates.mf4");
    mf4::write(std::fs::File::create(&path).unwrap(), &rates).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let unit = bytes.windows(2).rposition(|text| text == b"%\0").unwrap();
    bytes[unit] = b'?';
    std::fs::write(path, bytes).unwrap();
}

/// Defect seen: the pressure was excluded because of its rate, and the leak that it alone shows was not found.
#[test]
fn a_signal_at_another_rate_shows_the_missing_effect() {
    let bench = Bench::new();
    two_rates(&bench);
    let log = ["--log", "rates.mf4", "--json", "d.json"];
    let diagnosed = bench.run(&[&["diagnose"][..], &log].concat());
    assert_contains(&diagnosed.out, &["Missing: chamber leak"]);
    let note = "note: rates.mf4: channels that are no signals: 1, lamp";
    assert_contains(&diagnosed.err, &[note]);
    let diagnosis: Diagnosis = serde_json::from_str(&bench.read("d.json")).unwrap();
    assert!(
        diagnosis.not_compared.is_empty(),
        "{:?}",
        diagnosis.not_compared
    );
}

/// Defect seen: a signal that is excluded from the fit was not named beside the effects that only it shows.
#[test]
fn a_dead_sensor_is_named_beside_what_is_not_excited() {
    let bench = Bench::new();
    let text = beginning_of(LEAKING.0, 3.0);
    let log = csv::read("bench.csv", text.as_bytes(), &csv::Options::default()).unwrap();
    let (_, base) = log.time_bases().next().unwrap();
    let mut dead = Recording::new(Provenance::from_source("bench"));
    let id = dead.add_time_base(base.clone());
    for signal in log.signals() {
        let values = match signal.name() {
            "p_ch" => vec![0.0; base.len()],
            _ => signal.values_or_nan().to_vec(),
        };
        dead.add_signal(signal.name(), signal.unit(), id, values)
            .unwrap();
    }
    mf4::write(
        std::fs::File::create(bench.path("dead.mf4")).unwrap(),
        &dead,
    )
    .unwrap();
    let log = ["--log", "dead.mf4", "--json", "d.json"];
    let diagnosed = bench.run(&[&["diagnose"][..], &log].concat());
    let reason = "p_ch of dead.mf4 is excluded from the fit: ";
    let advice = diagnosed
        .out
        .split("may contain the following already")
        .nth(1);
    assert_contains(&diagnosed.out, &[reason]);
    assert_contains(
        advice.unwrap_or_default(),
        &["Not excited: chamber_leak. To see it: both valves shut"],
    );
    let diagnosis: Diagnosis = serde_json::from_str(&bench.read("d.json")).unwrap();
    assert_eq!(diagnosis.not_compared["dead.mf4"][0].name, "p_ch");

    let add = ["--add", "coil_heating", "--out", "p.toml"];
    let refined = bench.run(&[&["refine"][..], &log, &add].concat());
    assert_contains(&refined.out, &[reason]);
}

/// Sets times to 0.
fn timeless(json: &str) -> Value {
    let mut value: Value = serde_json::from_str(json).unwrap();
    for key in ["elapsed_s", "per_simulation_ms"] {
        value["cost"][key] = 0.0.into();
    }
    value
}

/// Returns whether a handler for SIGINT, the second signal, is installed.
#[cfg(target_os = "linux")]
fn catches_interrupts(pid: &str) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).unwrap();
    let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:"));
    u64::from_str_radix(caught.unwrap().trim(), 16).unwrap() & 0b10 != 0
}

/// Sends SIGINT once its handler is installed.
#[cfg(target_os = "linux")]
pub(crate) fn interrupt(child: &Child) {
    let pid = child.id().to_string();
    let deadline = Instant::now() + Duration::from_secs(20);
    while !catches_interrupts(&pid) {
        assert!(Instant::now() < deadline, "Ctrl-C is not watched for");
        std::thread::yield_now();
    }
    let sent = Command::new("kill").args(["-INT", &pid]).status();
    assert!(sent.unwrap().success());
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
    interrupt(&child);
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
    assert_contains(&err, &["error: interrupted; nothing was written"]);
    assert_eq!(bench.files(), ["bench.csv"]);
}
