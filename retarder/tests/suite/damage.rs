//! Damaged files of every kind, and kills: a small part of the cases of `cargo xtask damage` and `cargo xtask kills`.

use std::sync::Mutex;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use retarder_tests::damage::campaign::Campaign;
use retarder_tests::damage::commands::Effort;
use retarder_tests::damage::limits::Limits;
use retarder_tests::kills;

const RETARDER: &str = env!("CARGO_BIN_EXE_retarder");

/// Goal: the program ends with an answer or a reason for any content of a file. Method: 300 damaged inputs of the cheap
/// commands. Takes half a minute of computing.
#[test]
fn no_damaged_file_ends_a_command_without_an_answer_or_a_reason() {
    let failures = tempfile::tempdir().unwrap();
    let campaign = Campaign {
        retarder: RETARDER.into(),
        seed: 1,
        cases: 0..300,
        jobs: 2,
        limits: Limits {
            // The build may be slow and the machine busy: only a command that never ends is a finding.
            processor_time: Duration::MAX,
            time: Duration::from_secs(300),
            ..Limits::default()
        },
        effort: Effort::Cheap,
        failures: failures.path().to_owned(),
        keeps_all: false,
    };
    let found = Mutex::new(String::new());
    let counted = campaign.run(&AtomicBool::new(false), |_, failure| {
        if let Some(failure) = failure {
            let (finding, case) = (failure.finding, &failure.case);
            let (story, line) = (case.story(), case.line());
            *found.lock().unwrap() +=
                &format!("\n{finding}: case {}\n{story}$ {line}\n", case.number);
        }
    });
    let counted = counted.unwrap();
    assert_eq!(*found.lock().unwrap(), "", "{counted}");
    // Enough damaged files must remain readable; otherwise the test covers the readers alone.
    let answered = counted.ended_with(0) + counted.ended_with(1);
    assert_eq!(counted.cases(), 300);
    assert!(answered >= 40 && counted.ended_with(2) >= 40, "{counted}");
}

#[test]
fn a_diagnosis_that_is_killed_loses_nothing() {
    let counted =
        kills::diagnose::kill(RETARDER.as_ref(), 1, 3).unwrap_or_else(|loss| panic!("{loss}"));
    assert!(counted.at_work + counted.too_late >= 3, "{counted:?}");
}

#[test]
fn a_server_that_is_killed_loses_nothing() {
    let counted =
        kills::serve::kill(RETARDER.as_ref(), 1, 3).unwrap_or_else(|loss| panic!("{loss}"));
    assert!(counted.at_work + counted.too_late >= 3, "{counted:?}");
}
