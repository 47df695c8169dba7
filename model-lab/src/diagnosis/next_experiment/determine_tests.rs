use core::ops::ControlFlow;

use plant_sim::parameters::Knowledge;

use super::determine::determining_experiment;
use super::distance::{Noises, made};
use super::test_signal::sequences;
use super::*;
use crate::bench::Bench as Rig;
use crate::diagnosis::estimation::{Determination, estimate};
use crate::diagnosis::knowledge::fix;

const LIMITS: Limits = Limits {
    duration_s: 10.0,
    max_bar: 7.0,
    max_duty_pct: 100.0,
};
const FLOWS: [&str; 2] = ["flow.discharge_fill", "flow.discharge_vent"];

fn go_on(_: crate::diagnosis::Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

/// Returns a log of one fill at full duty.
fn poor_log() -> Recording {
    let phases = vec![(1.0, 0.0, 0.0), (0.2, 100.0, 0.0), (0.4, 0.0, 0.0)];
    Rig {
        phases,
        ..Rig::default()
    }
    .measure()
}

fn asked(plant: &PlantParameters, what: &[&str]) -> Result<DeterminingExperiment, DiagnoseError> {
    determining_experiment(plant, &[poor_log()], what, LIMITS, &go_on)
}

fn with_known_volume() -> PlantParameters {
    let mut plant = PlantParameters::nominal();
    fix(&mut plant, "chamber.volume_m3").unwrap();
    plant
}

/// A pressure shows the ratio of flow and volume, so only the plant file can separate the flows from the volume.
#[test]
fn what_the_plant_file_knows_decides_what_a_test_signal_determines() {
    let open = asked(&PlantParameters::nominal(), &FLOWS).unwrap();
    assert!(!open.determines_all(), "{:?}", open.parameters);
    for parameter in &open.parameters {
        let determined_by = parameter.determined_by.as_ref().unwrap();
        assert!(determined_by.contains("fix the volume"), "{determined_by}");
        assert!(open.sentence.contains(&parameter.name), "{}", open.sentence);
    }
    let known = asked(&with_known_volume(), &FLOWS).unwrap();
    assert!(known.is_adequate);
    assert!(known.determines_all(), "{:?}", known.parameters);
    assert_eq!(known.ranking[0].determines, FLOWS);
    assert_eq!(known.parameters[0].now, [0.57, 1.33]);
    assert!(known.csv().lines().count() as f64 * known.sample_time_s <= LIMITS.duration_s + 0.02);
}

/// Goal: the predicted interval is the one that is reached. Method: the rig runs the best excitation, and its log is fitted.
#[test]
fn a_fit_to_the_best_test_signal_has_the_interval_that_was_foreseen() {
    let plant = with_known_volume();
    let what = [FLOWS[0], FLOWS[1], "armature.preload_fill_n"];
    let next = asked(&plant, &what).unwrap();
    let best = &next.ranking[0].name;
    let mut sequences = sequences(&[&plant], &LIMITS).unwrap().into_iter();
    let sequence = sequences.find(|sequence| sequence.name == best).unwrap();
    let evidence = gather(&plant, &[poor_log()]).unwrap();
    let log = made(&plant, &sequence, &Noises::of(&evidence)).unwrap();
    let found = estimate(&plant, &[log], &[], &go_on).unwrap();
    for foreseen in &next.parameters {
        let mut reached = found.estimation.parameters.iter();
        let reached = reached.find(|one| one.name == foreseen.name).unwrap();
        let [low, high] = foreseen.after;
        let ratio = (reached.high - reached.low) / (high - low);
        assert!(
            (0.6..1.7).contains(&ratio),
            "{ratio}: {foreseen:?} {reached:?}"
        );
        let is_determined = reached.determination == Determination::Determined;
        assert_eq!(is_determined, foreseen.is_determined_after, "{reached:?}");
    }
}

#[test]
fn what_is_known_well_is_not_asked_for_and_what_is_exact_is_refused() {
    let mut plant = with_known_volume();
    let stated = Knowledge::TolerancePct(1.0);
    plant.knowledge.insert(FLOWS[0].to_owned(), stated);
    let next = asked(&plant, &["flow"]).unwrap();
    let known: Vec<bool> = next
        .parameters
        .iter()
        .map(|one| one.is_determined_now)
        .collect();
    assert_eq!(known, [true, false]);
    assert_eq!(next.ranking[0].determines, FLOWS[1..]);
    // A parameter requested by its name counts nevertheless, and no excitation halves 1 %.
    let named = asked(&plant, &FLOWS[..1]).unwrap();
    assert!(!named.determines_all() && !named.parameters[0].is_determined_now);
    assert!(named.sentence.contains(FLOWS[0]), "{}", named.sentence);

    let refused = |what| asked(&plant, &[what]).unwrap_err().to_string();
    let exact = refused("chamber.volume_m3");
    assert!(exact.contains("`chamber.volume_m3` = 0.000075 m3 counts as exact"));
    assert!(exact.contains("--free chamber.volume_m3"), "{exact}");
    assert!(refused("armature.stroke_m").contains("counts as exact"));
    assert!(refused("chamber.volume").contains("no parameter or table `chamber.volume`"));
}
