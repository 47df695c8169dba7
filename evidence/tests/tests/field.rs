//! Programs of the field benchmark, end to end on one rig.

#![cfg(unix)]

use std::fs;
use std::io::Write;

use retarder_tests::blind::field::draw::{Effects, FieldDraw, FieldRig};
use retarder_tests::blind::field::format::FieldAnswer;
use retarder_tests::blind::field::names;
use retarder_tests::blind::field::run::{Retarder, diagnose, fit, refine};
use retarder_tests::blind::field::score::{FieldReport, score};
use retarder_tests::blind::field::truth;
use retarder_tests::blind::format::Folders;
use retarder_tests::stand_in::stand_in;

const SAMPLE_S: f64 = 0.01;
/// Resolution of a time stamp (s).
const STAMP_S: f64 = 1e-6;
/// Range of the pressure's converter (bar).
const RANGE_BAR: f64 = 12.0;

fn draw(seed: u64, rigs: usize) -> FieldDraw {
    FieldDraw::new(seed, rigs, Effects::default())
}

/// Returns the rows of a log without its header.
fn rows(log: &str) -> Vec<Vec<f64>> {
    let cells = |line: &str| line.split(',').map(|cell| cell.parse().unwrap()).collect();
    log.lines().skip(1).map(cells).collect()
}

/// Returns a rig whose id log begins warm and has a gap; its logger has 1218 Hz and a clock error of 85 ppm.
fn rig_with_gaps() -> FieldRig {
    draw(1, 12).only(&[12]).unwrap().rig(0)
}

#[test]
fn a_field_rig_is_the_same_from_the_same_seed_and_another_from_another() {
    let (rig, again, other) = (draw(1, 2).rig(1), draw(1, 2).rig(1), draw(2, 2).rig(1));
    assert_eq!(rig.answer, again.answer);
    assert_eq!(rig.logs, again.logs);
    assert_ne!(rig.logs, other.logs);
    let alone = draw(1, 2).only(&[2]).unwrap();
    assert_eq!(alone.count(), 1);
    assert_eq!(alone.rig(0).logs, rig.logs);
    assert!(draw(1, 2).only(&[3]).is_err());
}

#[test]
fn hidden_effects_change_the_logs_and_nothing_else_of_a_rig() {
    let hiding = FieldDraw::new(1, 2, "2".parse().unwrap()).rig(1);
    let plain = draw(1, 2).rig(1);
    assert_eq!(hiding.answer.hidden.len(), 2);
    assert_eq!(hiding.answer.parameters, plain.answer.parameters);
    assert_eq!(hiding.answer.logger, plain.answer.logger);
    assert_eq!(hiding.plant, plain.plant);
    assert_ne!(hiding.logs, plain.logs);
}

/// A command changes at a sample of the ECU: by the clock of the answers, one lies between the previous row and the row
/// that shows the change.
#[test]
fn the_clock_of_a_log_is_that_of_its_answer() {
    let FieldRig { answer, logs, .. } = rig_with_gaps();
    let mut changes = 0;
    for (log, text) in answer.logs.iter().zip(&logs) {
        let rate = 1.0 + 1e-6 * answer.logger.clock_error_ppm;
        let sample_of = |logged_s: f64| ((log.phase_s + logged_s * rate) / SAMPLE_S).floor();
        let rows = rows(text);
        for pair in rows.windows(2) {
            if pair[0][1..3] != pair[1][1..3] {
                changes += 1;
                assert!(
                    sample_of(pair[1][0] + STAMP_S) > sample_of(pair[0][0] - STAMP_S),
                    "no sample before {} s",
                    pair[1][0]
                );
            }
        }
    }
    assert!(changes > 50, "{changes}");
    assert!(answer.logger.clock_error_ppm.abs() > 50.0);
}

#[test]
fn gaps_and_steps_of_a_log_are_those_of_its_answer() {
    let FieldRig { answer, logs, .. } = rig_with_gaps();
    let interval_s = 1.0 / answer.logger.rate_hz;
    let step = RANGE_BAR / f64::from(1_u32 << answer.logger.bits);
    for (log, text) in answer.logs.iter().zip(&logs) {
        let rows = rows(text);
        let found: Vec<f64> = rows
            .windows(2)
            .map(|pair| pair[1][0] - pair[0][0])
            .filter(|apart_s| *apart_s > 0.1)
            .collect();
        let gaps = log.gaps.iter().map(|gap| gap[1] - gap[0]);
        assert_eq!(found.len(), log.gaps.len());
        for (found_s, gap_s) in found.iter().zip(gaps) {
            assert!(
                (found_s - gap_s).abs() < 2.0 * interval_s,
                "{found_s} {gap_s}"
            );
        }
        for row in &rows {
            let steps = row[3] / step;
            assert!((steps - steps.round()).abs() < 0.1, "{}", row[3]);
        }
        // The values differ only by the sensor's noise and the ECU's first samples.
        let first = log.first_pressure_bar_gauge;
        assert!((rows[0][3] - first).abs() < 0.1, "{} {first}", rows[0][3]);
        assert_eq!(log.relaxation_s > 0.0, log.first_surplus_k > 1.0);
    }
    assert!(answer.logs.iter().any(|log| !log.gaps.is_empty()));
}

/// Returns a result of `retarder refine --json`: a check error (noise floors), a free-run error, and the interval of
/// one parameter.
fn finding(check: f64, free_run: f64, name: &str, [low, after, high]: [f64; 3]) -> String {
    format!(
        r#"{{"steps": [{{"check_rms": {{"p_ch": {check}}}, "noise_floor": {{"p_ch": 1.0}},
            "free_run_check_rms": {{"p_ch": {free_run}}}}}],
            "parameters": [{{"name": "{name}", "after": {after}, "low": {low}, "high": {high},
                "determination": "determined"}}]}}"#
    )
}

fn scored(folders: &Folders, says: &str) -> FieldReport {
    let rig = "rig-001";
    fs::write(folders.found().finding(rig), says).unwrap();
    score(folders).unwrap()
}

#[test]
fn a_refined_rig_is_scored_and_each_broken_finding_fails_its_gate() {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders::new(folder.path().join("draw"));
    let draw = draw(1, 1);
    draw.write(&folders, 1, |_| ()).unwrap();
    assert!(
        draw.write(&folders, 1, |_| ()).is_err(),
        "it is there already"
    );
    let answer = fs::read(folders.answer("rig-001")).unwrap();
    let answer: FieldAnswer = serde_json::from_slice(&answer).unwrap();
    let name = "chamber.volume_m3";
    let volume = answer.parameters[name];
    let around = |value: f64| [0.99 * value, value, 1.01 * value];
    let good = finding(1.0, 2.0, name, around(volume));

    let retarder = Retarder {
        retarder: stand_in(folder.path(), &good),
    };
    for _ in 0..2 {
        assert_eq!(refine(&folders, &retarder, 1, |_| ()).unwrap(), 0);
    }
    let calls = fs::read_to_string(folder.path().join("calls")).unwrap();
    assert_eq!(calls.lines().count(), 1, "the second run has nothing left");
    assert!(!calls.contains("sealed"), "{calls}");
    assert!(calls.contains("logs/rig-001.toml"), "{calls}");
    truth::run(&folders, &retarder, 1, |_, _| ()).unwrap();
    let calls = fs::read_to_string(folder.path().join("calls")).unwrap();
    assert!(
        calls.lines().last().unwrap().contains("--fix all"),
        "{calls}"
    );

    let report = score(&folders).unwrap();
    assert!(report.holds(), "{report}");
    let broken = [
        finding(1.11, 2.0, name, around(volume)),
        finding(1.0, 2.41, name, around(volume)),
        finding(1.0, 2.0, name, around(1.015 * volume)),
        finding(1.0, 2.0, name, around(0.9 * volume)),
    ];
    for (gate, says) in broken.iter().enumerate() {
        let report = scored(&folders, says);
        assert!(!report.gates[gate].holds, "{report}");
        assert!(!report.holds() && !report.misses.is_empty(), "{report}");
    }
    let times = fs::read_to_string(folders.found().times()).unwrap();
    fs::write(folders.found().times(), times + "rig-001,91.0,0\n").unwrap();
    assert!(!scored(&folders, &good).gates[0].holds, "too slow");
    fs::remove_file(folders.found().finding("rig-001")).unwrap();
    let report = score(&folders).unwrap();
    assert!(!report.holds(), "no answer");
    assert_eq!(report.misses.len(), 1);
}

/// The same rig under the same commands, with a tenth of the noise in its log.
#[test]
fn better_sensors_read_the_same_run() {
    let draw = |share: f64| {
        let draw = FieldDraw::new(1, 2, Effects::default());
        draw.with_sensor_share(share).rig(1)
    };
    let pressures = |text: &str| -> Vec<f64> {
        let rows = text.lines().skip(1);
        let pressure = |row: &str| row.split(',').nth(3).unwrap().parse().unwrap();
        rows.map(pressure).collect()
    };
    let (drawn, better, ideal) = (draw(1.0), draw(0.1), draw(1e-3));
    assert_eq!(better.answer.parameters, drawn.answer.parameters);
    assert_eq!(better.answer.logger.sensor_share, 0.1);
    let ideal = pressures(&ideal.logs[0]);
    let noise = |rig: &FieldRig| {
        let read = pressures(&rig.logs[0]);
        assert_eq!(read.len(), ideal.len());
        let errors = read.iter().zip(&ideal).map(|(a, b)| (a - b).powi(2));
        (errors.sum::<f64>() / ideal.len() as f64).sqrt()
    };
    let ratio = noise(&drawn) / noise(&better);
    assert!((9.0..11.0).contains(&ratio), "{ratio}");
}

/// A diagnosis that names an effect ends with status 1, one that finds a wrong plant file with 3; both are answers.
#[test]
fn what_the_diagnosis_names_on_a_field_rig_is_fitted_and_scored() {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders::new(folder.path().join("draw"));
    FieldDraw::new(1, 1, "1".parse().unwrap())
        .write(&folders, 1, |_| ())
        .unwrap();
    let answer = fs::read(folders.answer("rig-001")).unwrap();
    let answer: FieldAnswer = serde_json::from_slice(&answer).unwrap();
    let hidden = &answer.hidden[0].effect;
    assert!(answer.removal_cost(hidden) > 0.0, "{answer:?}");

    let refined = finding(1.0, 1.0, "chamber.volume_m3", [0.9, 1.0, 1.1]);
    let says = format!(
        r#"{}, "verdict": "found", "effects": ["{hidden}"], "error_steps": [{{
            "added": "{hidden}", "variant": "of_its_form", "fit_rms": {{"p_ch": 1.0}}, "check_rms": {{"p_ch": 1.0}},
            "noise_floor": {{"p_ch": 1.0}}, "free_run_check_rms": {{"p_ch": 1.2}}}}]}}"#,
        refined.strip_suffix('}').unwrap()
    );
    let retarder = Retarder {
        retarder: stand_in(folder.path(), &says),
    };
    let script = fs::OpenOptions::new().append(true).open(&retarder.retarder);
    script.unwrap().write_all(b"exit 3\n").unwrap();
    for _ in 0..2 {
        assert_eq!(refine(&folders, &retarder, 1, |_| ()).unwrap(), 0);
        assert_eq!(diagnose(&folders, &retarder, 1, |_| ()).unwrap(), 0);
        assert_eq!(fit(&folders, &retarder, 1, |_| ()).unwrap(), 0);
    }
    let calls = fs::read_to_string(folder.path().join("calls")).unwrap();
    assert!(!calls.contains("sealed"), "{calls}");
    let calls: Vec<&str> = calls.lines().collect();
    assert_eq!(calls.len(), 3, "the second run has nothing left: {calls:?}");
    for (call, parts) in calls.iter().zip([
        ["refine", "logs/rig-001.toml"],
        ["diagnose", "found/rig-001.toml"],
        ["refine", &format!("--add {hidden}:of_its_form ")],
    ]) {
        assert!(parts.iter().all(|part| call.contains(part)), "{call}");
    }
    assert!(calls[2].contains("found/rig-001.toml"), "{}", calls[2]);

    let report = names::score(&folders, &[]).unwrap();
    assert_eq!((report.rigs.count, report.rigs.of), (1, 1), "{report}");
    assert_eq!(report.effects[hidden].hidden, 1);

    fs::remove_file(folders.named().finding("rig-001")).unwrap();
    let nothing = says.replace(&format!(r#"["{hidden}"]"#), "[]");
    fs::write(folders.named().finding("rig-001"), nothing).unwrap();
    fs::remove_file(folders.fitted().finding("rig-001")).unwrap();
    assert_eq!(fit(&folders, &retarder, 1, |_| ()).unwrap(), 0);
    let calls = fs::read_to_string(folder.path().join("calls")).unwrap();
    assert_eq!(calls.lines().count(), 3, "nothing is named");
}
