//! Programs of the blind benchmark, end to end on one short rig.

#![cfg(unix)]

use std::fs;

use retarder_tests::blind::draw::{Counts, Draw, DrawError};
use retarder_tests::blind::format::{Answer, Class, Folders, Hidden};
use retarder_tests::blind::pairs;
use retarder_tests::blind::run::{Released, run};
use retarder_tests::blind::score::score;
use retarder_tests::reference_plant::catalogue::Kinship;
use retarder_tests::stand_in::stand_in;

/// Only poor logs of the first kind, 10 to 20 s long.
const SHORT: Counts = Counts {
    plain: 0,
    matched: 0,
    variant: 0,
    two: 0,
    beyond: 0,
    poor: 1,
};

fn finding(effects: &str) -> String {
    let figures = r#"{"p_ch": 0.004, "i_fill": 0.7, "i_vent": 0.7}"#;
    format!(
        r#"{{"verdict": "adequate", "effects": {effects}, "error_steps":
            [{{"fit_rms": {figures}, "check_rms": {figures}, "noise_floor": {figures}}}]}}"#
    )
}

#[test]
fn a_rig_is_the_same_from_the_same_seed_and_another_from_another() {
    let of = |seed| Draw::new(seed, SHORT).rig(0);
    let (rig, again, other) = (of(1), of(1), of(2));
    assert_eq!(rig.answer, again.answer);
    assert_eq!(rig.logs, again.logs);
    assert_ne!(rig.logs, other.logs);
}

#[test]
fn a_rig_drawn_alone_is_that_of_the_whole_draw() {
    let whole = Draw::new(1, Counts { poor: 2, ..SHORT });
    let alone = whole.clone().only(&[2]).unwrap();
    assert_eq!(alone.count(), 1);
    let (of_all, alone) = (whole.rig(1), alone.rig(0));
    assert_eq!(of_all.answer, alone.answer);
    assert_eq!(of_all.logs, alone.logs);
    for missing in [0, whole.count() + 1] {
        let refused = whole.clone().only(&[1, missing]).unwrap_err().to_string();
        let range = format!(
            "no rig {missing}: this draw has rigs 1 to {}",
            whole.count()
        );
        assert!(refused.contains(&range), "{refused}");
    }
}

#[test]
fn what_the_diagnosis_says_of_a_drawn_rig_is_scored() {
    let folder = tempfile::tempdir().unwrap();
    for (effects, false_names) in [("[]", 0), (r#"["chamber_leak"]"#, 1)] {
        let folders = Folders::new(folder.path().join(format!("draw-{false_names}")));
        let draw = Draw::new(1, SHORT);
        draw.write(&folders, 1, |_| ()).unwrap();
        let again = draw.write(&folders, 1, |_| ());
        assert!(matches!(again, Err(DrawError::Occupied(_))));

        let command = Released {
            retarder: stand_in(folder.path(), &finding(effects)),
            plant: "plant.toml".into(),
        };
        fs::write(folder.path().join("calls"), "").unwrap();
        for _ in 0..2 {
            assert_eq!(run(&folders, &command, 1, |_| ()).unwrap(), 0);
        }
        let calls = fs::read_to_string(folder.path().join("calls")).unwrap();
        assert_eq!(calls.lines().count(), 1, "the second run has nothing left");
        assert!(!calls.contains("sealed"), "{calls}");

        let report = score(&folders).unwrap();
        assert_eq!((report.rigs.count, report.rigs.of), (1, 1));
        let gate = &report.gates[0];
        assert_eq!((gate.share.count, gate.share.of), (false_names, 1));
        assert_eq!(gate.holds, false_names == 0);
    }
}

/// A diagnosis without a finding gives no name, and the score as a whole fails.
#[test]
fn a_diagnosis_that_fails_leaves_what_it_said() {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders::new(folder.path().join("draw"));
    Draw::new(1, SHORT).write(&folders, 1, |_| ()).unwrap();
    let command = Released {
        retarder: "/bin/echo".into(),
        plant: "plant.toml".into(),
    };
    assert_eq!(run(&folders, &command, 1, |_| ()).unwrap(), 1);
    let said = fs::read_to_string(folders.found().failed("rig-001")).unwrap();
    assert!(said.contains("diagnose --plant plant.toml"), "{said}");
    let report = score(&folders).unwrap();
    assert_eq!((report.rigs.count, report.rigs.of), (0, 1));
    assert!(!report.holds());
    assert_eq!(report.misses.len(), 1);
}

/// A detectable pair: without either effect, the error is more than half the noise.
#[test]
fn a_pair_is_fitted_with_each_of_its_effects_alone() {
    let folder = tempfile::tempdir().unwrap();
    let folders = Folders::new(folder.path().join("draw"));
    Draw::new(1, SHORT).write(&folders, 1, |_| ()).unwrap();
    let sealed = folders.sealed().join("rig-001.json");
    let mut answer: Answer = serde_json::from_slice(&fs::read(&sealed).unwrap()).unwrap();
    let hidden = |effect: &str| Hidden {
        effect: effect.to_owned(),
        law: String::new(),
        kinship: Kinship::Matched,
        same: vec![],
        size: 1.0,
        unit: String::new(),
        size_over_typical: 1.0,
        shape: 0.5,
        parameter: None,
    };
    answer.class = Class::Two;
    answer.hidden = ["chamber_leak", "sensor_lag"].map(hidden).to_vec();
    fs::write(&sealed, serde_json::to_string(&answer).unwrap()).unwrap();

    let unlooked = score(&folders).unwrap();
    assert_eq!(unlooked.quality.both_of_separable.of, 0);
    let left = r#"{"error_steps": [{"fit_rms": {}, "check_rms": {"p_ch": 2.0}, "noise_floor": {"p_ch": 1.0}}]}"#;
    let command = Released {
        retarder: stand_in(folder.path(), left),
        plant: "plant.toml".into(),
    };
    fs::write(folder.path().join("calls"), "").unwrap();
    for _ in 0..2 {
        pairs::run(&folders, &command, |_, _| ()).unwrap();
    }
    let calls = fs::read_to_string(folder.path().join("calls")).unwrap();
    let calls: Vec<&str> = calls.lines().collect();
    assert_eq!(calls.len(), 2, "the second run has nothing left: {calls:?}");
    for (call, effect) in calls.iter().zip(["chamber_leak", "sensor_lag"]) {
        assert!(call.contains(&format!("--add {effect} ")), "{call}");
    }
    let report = score(&folders).unwrap();
    assert_eq!(report.quality.both_of_separable.of, 1);
    let separable = report.gates.last().unwrap();
    assert_eq!(
        (separable.share.count, separable.share.of),
        (0, 1),
        "{report}"
    );
    assert!(!separable.holds, "{report}");
}
