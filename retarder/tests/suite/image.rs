//! Commands on the ELF image, which runs in the emulator; RETARDER_IMAGE names it.

use std::env;

use serde_json::Value;

use crate::runner::{Bench, Ran, assert_contains};

/// Returns the command with the image at its end.
fn on_image(command: &[&str]) -> Vec<String> {
    let image = env::var("RETARDER_IMAGE").expect("RETARDER_IMAGE names the image");
    let words = command.iter().map(|word| (*word).to_owned());
    words.chain(["--image".to_owned(), image]).collect()
}

fn run(bench: &Bench, command: &[&str]) -> Ran {
    let words = on_image(command);
    bench.run(&words.iter().map(String::as_str).collect::<Vec<_>>())
}

/// Returns the rows of a measurement: number of the sample since the first, and number of its values.
fn rows(csv: &str) -> Vec<(u32, usize)> {
    let row = |line: &str| {
        let (time, values) = line.split_once(',').unwrap();
        let time_s: f64 = time.parse().unwrap();
        ((100.0 * time_s).round() as u32, values.split(',').count())
    };
    assert!(csv.ends_with('\n'), "{csv}");
    csv.lines().skip(1).map(row).collect()
}

#[test]
fn the_loop_on_the_image_has_the_same_bits_its_log_and_a_verdict() {
    let bench = Bench::new();
    let out = run(&bench, &["control", "--dut", "qemu"]).ended_with(0);
    assert_contains(
        &out,
        &[
            "on mps2-an386",
            "mailbox",
            "same bits.",
            "at all 1641 samples",
            "Supervisor { sample: 9, mode: Running, faults: none }",
            "The loop meets every binding requirement.",
        ],
    );
}

#[test]
fn over_the_serial_line_the_result_is_the_same_but_for_the_wire() {
    let bench = Bench::new();
    let verdict = |wire: &str| {
        let json = run(&bench, &["control", "--dut", wire, "--json"]).ended_with(0);
        let json: Value = serde_json::from_str(&json).unwrap();
        assert_eq!(json["first_different_sample"], Value::Null);
        assert!(!json["log"].as_array().unwrap().is_empty());
        (json["device"].clone(), json["verdict"].clone())
    };
    let (by_uart, by_mailbox) = (verdict("qemu:uart"), verdict("qemu:mailbox"));
    assert_ne!(by_uart.0, by_mailbox.0);
    assert_eq!(by_uart.1, by_mailbox.1);
}

#[test]
fn settings_of_the_image_are_read_changed_together_and_refused_with_name_and_bound() {
    let bench = Bench::new();
    let all = run(&bench, &["calibrate", "read", "--dut", "qemu"]).ended_with(0);
    assert_contains(&all, &["none were ever saved"]);
    for setting in &ecu::calibration::SETTINGS {
        assert_contains(&all, &[setting.name]);
    }
    let write = |assignments: &[&str]| {
        let command = ["calibrate", "write", "--dut", "qemu"];
        run(&bench, &[&command, assignments].concat())
    };
    let changed = write(&["gain_pct_per_bar=30.5", "boost=off"]).ended_with(0);
    assert_contains(&changed, &["30.5", "off", "until the device starts again"]);
    assert_contains(
        &write(&["boost=on", "--save"]).ended_with(0),
        &["kept for the next start"],
    );
    let refused = write(&["boost=off", "gain_pct_per_bar=-3"]);
    assert_contains(
        &refused.err,
        &["gain_pct_per_bar = -3 %/bar is out of range"],
    );
    refused.ended_with(2);
}

#[test]
fn over_the_serial_line_every_sample_is_measured() {
    let bench = Bench::new();
    let measure = [
        "calibrate",
        "measure",
        "--dut",
        "qemu",
        "p_ref",
        "u",
        "mode",
    ];
    let options = ["--samples", "150", "--out", "run.csv"];
    let out = run(&bench, &[&measure[..], &options].concat()).ended_with(0);
    assert_contains(&out, &["150 samples.", "Written: run.csv"]);
    let csv = bench.read("run.csv");
    assert!(csv.starts_with("time_s,p_ref_bar_gauge,u_pct,mode\n"));
    let expected: Vec<(u32, usize)> = (0..150).map(|sample| (sample, 3)).collect();
    assert_eq!(rows(&csv), expected);
}

/// The mailbox keeps one frame: a frame that is not read before the next sample is lost.
#[test]
fn what_the_mailbox_loses_is_counted() {
    let bench = Bench::new();
    let measure = ["calibrate", "measure", "--dut", "qemu:mailbox", "u"];
    let options = ["--samples", "1000", "--out", "run.csv"];
    let ran = run(&bench, &[&measure[..], &options].concat());
    let rows = rows(&bench.read("run.csv"));
    assert_eq!(rows.len(), 1000);
    assert!(rows.windows(2).all(|pair| pair[0].0 < pair[1].0));
    let lost = rows[999].0 - 999;
    if lost > 0 {
        assert_contains(
            &ran.out,
            &[&format!("{lost} samples in between are missing")],
        );
    } else {
        assert!(!ran.out.contains("missing"), "{}", ran.out);
    }
    ran.ended_with(i32::from(lost > 0));
}

#[cfg(unix)]
#[test]
fn ctrl_c_leaves_a_whole_file_of_what_was_measured_until_then() {
    use std::io::{BufRead as _, BufReader, Read as _};
    use std::process::{Command, Stdio};

    let bench = Bench::new();
    let measure = ["calibrate", "measure", "--dut", "qemu", "p_ref", "u"];
    let options = ["--samples", "100000000", "--out", "run.csv"];
    let words = on_image(&[&measure[..], &options].concat());
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let mut command = bench.command(&words);
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    // The first sample triggers the message.
    let mut line = String::new();
    let mut err = BufReader::new(child.stderr.take().unwrap());
    err.read_line(&mut line).unwrap();
    assert_contains(&line, &["Ctrl-C"]);
    let pid = child.id().to_string();
    let sent = Command::new("kill").args(["-INT", &pid]).status().unwrap();
    assert!(sent.success());
    let mut out = String::new();
    child
        .stdout
        .take()
        .unwrap()
        .read_to_string(&mut out)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(2));
    assert_eq!(bench.files(), ["run.csv"]);
    let rows = rows(&bench.read("run.csv"));
    assert_eq!(rows[0], (0, 2));
    assert!(rows.iter().all(|(_, values)| *values == 2));
    let said = format!("{} samples of 100000000: it was ended before.", rows.len());
    assert_contains(&out, &[&said, "Written: run.csv"]);
}

/// The first fault comes within a few samples, since there are no sensors: the box may be read before or after it.
#[test]
fn the_black_box_of_a_fresh_image_is_read_in_every_form() {
    let bench = Bench::new();
    let read = ["blackbox", "--dut", "qemu"];
    let out = run(&bench, &read).ended_with(0);
    assert_contains(&out, &["Black box", "on mps2-an386", "UART"]);
    let json = run(&bench, &[&read[..], &["--json"]].concat()).ended_with(0);
    let json: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(json["schema"], "retarder.black-box/1");
    let is_recording = json["status"] == "recording";
    assert_eq!(json["first_fault_in"] == Value::Null, is_recording);
    let faults = json["first_faults"].as_array().unwrap();
    assert_eq!(faults.is_empty(), is_recording);
    let csv = ["--clear", "--out", "box.csv"];
    run(&bench, &[&read[..], &csv].concat()).ended_with(0);
    assert!(bench.read("box.csv").starts_with("record,p_ref_bar_gauge,"));
}
