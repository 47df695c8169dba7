use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use plant_sim::logger_clock::LoggerClock;
use plant_sim::replay::{CurrentSampling, Replay, ReplayInput, replay};
use plant_sim::{Command as DutyCycles, PlantParameters, Tolerance};
use recording::csv;

use crate::runner::{Bench, assert_contains, data, short_log};

/// A simulated recording is a measurement of the same plant: the comparison passes, and with another plant it fails.
#[test]
fn a_simulated_recording_is_within_tolerance_of_its_own_plant_only() {
    let bench = Bench::new();
    let log = data("synthetic/practice-00-check.csv");
    let ran = bench.run(&["simulate", "--log", &log, "--out", "model.csv"]);
    assert_contains(
        &ran.err,
        &[
            "times faster than real time",
            "integration steps per PWM period",
            "Written: model.csv",
        ],
    );
    assert_eq!(ran.ended_with(0), "");
    bench.run(&["compare", "--log", "model.csv"]).ended_with(0);
    bench
        .run(&[
            "compare",
            "--log",
            "model.csv",
            "--set",
            "chamber.volume_m3=76e-6",
        ])
        .ended_with(1);
}

/// Returns a log of the nominal plant, taken every 2 ms by a logger whose rows lie 3.3 ms after the samples of the ECU.
fn log_of_a_logger_with_its_own_clock() -> String {
    let plant = PlantParameters::nominal();
    let clock = LoggerClock {
        phase_s: 3.3e-3,
        drift_ppm: 80.0,
    };
    let mut model = Replay::new(
        &plant,
        CurrentSampling::MeanOfInterval,
        Tolerance::default(),
    );
    let mut log =
        "time_s,duty_fill_pct,duty_vent_pct,p_ch_bar_gauge,i_fill_mA,i_vent_mA\n".to_owned();
    for row in 0..6000_u64 {
        let time_ns = clock.ecu_time_ns(row * 2_000_000);
        let sample = time_ns / plant.ecu.sample_time_ns();
        let command = match sample {
            0..100 => DutyCycles::default(),
            _ => DutyCycles {
                duty_fill_pct: if sample % 60 < 7 { 80.0 } else { 0.0 },
                duty_vent_pct: if (30..41).contains(&(sample % 60)) {
                    70.0
                } else {
                    0.0
                },
            },
        };
        let [fill, vent, p_ch, i_fill, i_vent, ..] = model.row(ReplayInput {
            issued_ns: sample * plant.ecu.sample_time_ns(),
            command: Some(command),
            ..ReplayInput::at(time_ns)
        });
        let noise = ((row * 7919) % 1009) as f64 / 1009.0 - 0.5;
        log += &format!(
            "{:.3},{fill},{vent},{:.4},{:.2},{:.2}\n",
            row as f64 * 2e-3,
            p_ch + 8e-3 * noise,
            i_fill + 2.0 * noise,
            i_vent - 2.0 * noise
        );
    }
    log
}

/// Goal: modelled signals are those of the instants of the log, and the clock that was found is stated. Defect seen:
/// the error was up to the full current.
#[test]
fn a_log_of_a_logger_with_its_own_clock_is_simulated_and_compared_by_it() {
    let bench = Bench::new();
    bench.file("log.csv", &log_of_a_logger_with_its_own_clock());
    let ran = bench.run(&["simulate", "--log", "log.csv", "--out", "model.csv"]);
    let found = ran.err.split_whitespace().collect::<Vec<_>>().join(" ");
    assert_contains(
        &found,
        &[
            "clock of the logger",
            "ppm slow",
            "from the logged commands",
        ],
    );
    assert_eq!(ran.ended_with(0), "");
    let [model, log] = ["model.csv", "log.csv"]
        .map(|file| csv::read_file(bench.path(file), &csv::Options::default()).unwrap());
    let [model, log] = [&model, &log].map(|recording| recording.signal("i_fill").unwrap());
    let errors = model.values_or_nan().iter().zip(log.values_or_nan());
    let square: f64 = errors.map(|(a, b)| (a - b).powi(2)).sum();
    assert!((square / 6000.0).sqrt() < 1.5, "{square}");
    let text = bench.run(&["compare", "--log", "log.csv"]).ended_with(0);
    assert_contains(&text, &["clock of the logger", "pass"]);
    let json = bench
        .run(&["compare", "--log", "log.csv", "--json"])
        .ended_with(0);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["clock"]["source"], "commands");
}

/// Rows in chunks equal the rows of the whole: the values are those of the library's replay, as written.
#[test]
fn streaming_gives_the_rows_of_a_replay_in_memory() {
    let bench = Bench::new();
    let path = data("synthetic/practice-00-id.csv");
    let on_standard_output = bench.run(&["simulate", "--log", &path]).ended_with(0);
    let streamed = csv::read(
        "streamed",
        on_standard_output.as_bytes(),
        &csv::Options::default(),
    )
    .unwrap();
    let log = csv::read_file(&path, &csv::Options::default()).unwrap();
    let replayed = replay(
        &PlantParameters::nominal(),
        &log,
        Tolerance::default(),
        |_, _| {},
    )
    .unwrap();
    for (name, step) in [
        ("p_ch", 1e-6),
        ("i_fill", 1e-4),
        ("i_vent", 1e-4),
        ("x_fill", 1e-6),
    ] {
        let [streamed, replayed] =
            [&streamed, &replayed.recording].map(|recording| recording.signal(name).unwrap());
        assert_eq!(streamed.len(), 6000);
        let pairs = streamed
            .values_or_nan()
            .iter()
            .zip(replayed.values_or_nan());
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst <= 0.5001 * step, "{name}: {worst}");
    }
}

#[test]
fn the_same_log_gives_the_same_bytes_from_a_file_and_from_the_standard_input() {
    let bench = Bench::new();
    bench.file("log.csv", &short_log());
    let from_file = bench.run(&["simulate", "--log", "log.csv"]).ended_with(0);
    let output = bench
        .command(&["simulate", "--log", "-"])
        .stdin(std::fs::File::open(bench.path("log.csv")).unwrap())
        .output()
        .unwrap();
    let from_input = String::from_utf8(output.stdout).unwrap();
    let rows = |text: &str| text.split_once("time_s").unwrap().1.to_owned();
    assert_eq!(rows(&from_input), rows(&from_file));
}

/// Defect seen: a pause and empty cells gave no message, while `compare` listed them.
#[test]
fn gaps_and_missing_cells_of_the_log_are_listed_as_compare_lists_them() {
    let bench = Bench::new();
    let row = |row: u32| {
        let duty = if row % 40 < 10 { "60" } else { "0" };
        let vent = if (100..103).contains(&row) { "" } else { "0" };
        format!("{:.2},{duty},{vent}\n", f64::from(row) * 0.01)
    };
    let rows: String = (0..300)
        .filter(|row| !(200..250).contains(row))
        .map(row)
        .collect();
    bench.file(
        "log.csv",
        &format!("time_s,duty_fill_pct,duty_vent_pct\n{rows}"),
    );
    let sentences = [
        "no rows from 1.990 to 2.500 s (0.510 s, about 50 samples)",
        "3 of 250 cells of duty_vent are missing, the first at 1.000 s",
    ];
    let simulate = ["simulate", "--log", "log.csv", "--out", "model.csv"];
    let ran = bench.run(&simulate);
    let text = ran.err.split_whitespace().collect::<Vec<_>>().join(" ");
    for sentence in sentences {
        assert!(text.contains(&format!("Log: {sentence}.")), "{text}");
    }
    let json = bench
        .run(&[&simulate[..], &["--json"]].concat())
        .ended_with(0);
    let found: serde_json::Value = serde_json::from_str(&json).unwrap();
    let defects = &found["defects"];
    assert_eq!(defects["sentences"], serde_json::json!(sentences));
    assert_eq!(defects["gaps"][0]["start_s"], 1.99);
    assert_eq!(defects["missing"][0]["cells"], 3);
}

#[test]
fn a_log_that_breaks_off_leaves_the_older_file_as_it_was() {
    let bench = Bench::new();
    bench.file("log.csv", &format!("{}1.00,sixty,0\n", short_log()));
    bench.file("model.csv", "older");
    let ran = bench.run(&["simulate", "--log", "log.csv", "--out", "model.csv"]);
    assert_contains(&ran.err, &["line 102", "\"sixty\""]);
    assert_eq!(ran.status, 2);
    assert_eq!(bench.read("model.csv"), "older");
    assert_eq!(bench.files(), ["log.csv", "model.csv"]);
}

#[test]
fn a_reader_who_has_seen_enough_is_no_failure() {
    let bench = Bench::new();
    let mut child = bench
        .command(&["simulate", "--log", &data("synthetic/practice-00-id.csv")])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::with_capacity(16, child.stdout.take().unwrap())
        .read_line(&mut line)
        .unwrap();
    assert_eq!(line, "# source: model of practice-00-id.csv\n");
    let mut err = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut err)
        .unwrap();
    assert_eq!((child.wait().unwrap().code(), err.as_str()), (Some(0), ""));
}

/// The log is a pipe that stays open, so that the process is at work when the signal comes.
#[cfg(unix)]
#[test]
fn a_signal_to_end_leaves_no_file_behind() {
    for signal in ["-INT", "-TERM"] {
        let bench = Bench::new();
        let mut child = bench
            .command(&["simulate", "--log", "-", "--out", "model.csv"])
            .stdin(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut input = child.stdin.take().unwrap();
        let header = "time_s,duty_fill_pct,duty_vent_pct\n";
        input.write_all(header.as_bytes()).unwrap();
        let mut next = 0;
        let mut rows = || {
            let first = next;
            next += 20_000;
            (first..next)
                .map(|row| format!("{:.2},0,0\n", f64::from(row) * 0.01))
                .collect::<String>()
        };
        input.write_all(rows().as_bytes()).unwrap();
        let deadline = Instant::now() + Duration::from_secs(20);
        while bench.files().is_empty() {
            assert!(Instant::now() < deadline, "no output file was begun");
            std::thread::yield_now();
        }
        let sent = Command::new("kill")
            .args([signal, &child.id().to_string()])
            .status()
            .unwrap();
        assert!(sent.success());
        // The process waits for rows. It may end before it has read all of these.
        while Instant::now() < deadline && input.write_all(rows().as_bytes()).is_ok() {}
        drop(input);
        let mut err = String::new();
        child
            .stderr
            .take()
            .unwrap()
            .read_to_string(&mut err)
            .unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(2));
        assert_contains(&err, &["error: interrupted"]);
        assert_eq!(bench.files(), Vec::<String>::new());
    }
}
