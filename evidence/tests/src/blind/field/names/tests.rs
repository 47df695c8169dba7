//! Tests of the score with constructed names.

use super::super::super::format::Profile;
use super::super::format::{FIELD_SCHEMA, LogAnswer, LoggerAnswer};
use super::*;
use crate::blind::score::share::Share;

/// Effects of a rig with their kinship and removal cost (noise floors).
type Effects<'a> = &'a [(&'a str, Kinship, f64)];

const LEAK: (&str, Kinship, f64) = ("chamber_leak", Kinship::Matched, 3.0);
const SLIGHT_LAG: (&str, Kinship, f64) = ("sensor_lag", Kinship::Matched, 0.99);
const CLAMP_OF_OTHER_LAW: (&str, Kinship, f64) = ("flyback_clamp", Kinship::Variant, 1.0);
const PULSATION: (&str, Kinship, f64) = ("supply_pulsation", Kinship::Beyond, 20.0);

fn answer(effects: Effects) -> FieldAnswer {
    let log = LogAnswer {
        profile: Profile::Bench,
        command_grid: 1,
        phase_s: 0.0,
        gaps: vec![],
        first_pressure_bar_gauge: 0.0,
        first_surplus_k: 0.0,
        relaxation_s: 0.0,
    };
    let hidden = |&(effect, kinship, _): &(&str, Kinship, f64)| Hidden {
        effect: effect.to_owned(),
        law: "its law".to_owned(),
        kinship,
        same: vec![],
        size: 1.0,
        unit: String::new(),
        size_over_typical: 1.0,
        shape: 0.5,
        parameter: Some(("size".to_owned(), 1.0)),
    };
    let cost = |&(effect, _, cost): &(&str, Kinship, f64)| {
        let costs = [("p_ch".to_owned(), cost), ("i_fill".to_owned(), 0.1)];
        (effect.to_owned(), costs.into())
    };
    FieldAnswer {
        schema: FIELD_SCHEMA.to_owned(),
        rig: "rig-001".to_owned(),
        hidden: effects.iter().map(hidden).collect(),
        cost_if_left_out: effects.iter().map(cost).collect(),
        is_vent_normally_open: false,
        parameters: [].into(),
        logger: LoggerAnswer {
            rate_hz: 50.0,
            clock_error_ppm: 0.0,
            unevenness: 0.0,
            bits: 12,
            noise_bar: 4e-3,
            sensor_share: 1.0,
            currents: true,
            supply_pressure: false,
        },
        logs: [log.clone(), log],
    }
}

/// Returns a step with an error of one noise floor one step ahead, and this error in free run.
fn step(free_run: f64) -> serde_json::Value {
    let signal = |value: f64| serde_json::json!({ "p_ch": value });
    serde_json::json!({
        "fit_rms": signal(1.0), "check_rms": signal(1.0), "noise_floor": signal(1.0),
        "free_run_check_rms": signal(free_run),
    })
}

fn read<T: serde::de::DeserializeOwned>(json: serde_json::Value) -> T {
    serde_json::from_value(json).unwrap()
}

/// Returns a diagnosis with these names, each with an interval that ends at `high`.
fn finding(names: &[&str], high: f64) -> Finding {
    let interval = serde_json::json!([{ "key": "size", "value": 0.9, "low": 0.8, "high": high }]);
    let candidate = |name: &&str| {
        serde_json::json!({
            "effect": name, "fit_rms": {}, "check_rms": {}, "parameters": interval,
        })
    };
    let candidates: Vec<_> = names.iter().map(candidate).collect();
    read(serde_json::json!({
        "verdict": "found", "effects": names, "error_steps": [step(1.0)], "candidates": candidates,
    }))
}

/// Returns a rig that was diagnosed within 30 s, with a free-run error of 1.5 noise floors after the first refinement
/// and 1.4 with the named effects.
fn rig(effects: Effects, names: &[&str]) -> NamedRig {
    NamedRig::new(
        answer(effects),
        read(serde_json::json!({ "steps": [step(1.5)], "parameters": [] })),
        Some(finding(names, 1.1)),
        read(serde_json::json!({ "error_steps": [step(9.0), step(1.4)] })),
        Some(30.0),
    )
}

/// Returns one rig for each gate; all gates pass.
fn right() -> Vec<NamedRig> {
    vec![rig(&[], &[]), rig(&[LEAK], &["chamber_leak"])]
}

/// Returns the names of the gates that fail with this rig beside the right ones.
fn failed(rig: NamedRig) -> Vec<&'static str> {
    let mut rigs = right();
    rigs.push(rig);
    let gates = NamesReport::new(&rigs).gates.into_iter();
    gates
        .filter(|gate| !gate.holds)
        .map(|gate| gate.requirement)
        .collect()
}

#[test]
fn right_names_pass_every_gate() {
    let report = NamesReport::new(&right());
    assert!(report.holds() && report.misses.is_empty(), "{report}");
}

#[test]
fn each_fault_fails_its_gate_alone() {
    let false_name = rig(&[], &["sensor_lag"]);
    assert_eq!(failed(false_name), ["a rig without effect gets a name"]);
    let not_named = rig(&[LEAK], &[]);
    assert_eq!(
        failed(not_named),
        ["an effect that costs a noise floor is named"]
    );
    let too_many = rig(&[LEAK], &["chamber_leak", "sensor_lag"]);
    assert_eq!(failed(too_many), ["a rig with effects gets a wrong name"]);
    let missed = NamedRig {
        finding: Some(finding(&["chamber_leak"], 0.99)),
        ..rig(&[LEAK], &["chamber_leak"])
    };
    assert_eq!(failed(missed), ["95 % intervals contain the true value"]);
    let runs_away = NamedRig {
        fitted: read(serde_json::json!({ "error_steps": [step(1.0), step(1.51)] })),
        ..rig(&[LEAK], &["chamber_leak"])
    };
    assert_eq!(failed(runs_away), ["free run at most 1.5 noise floors"]);
}

#[test]
fn a_fault_is_one_line_with_all_that_is_known_of_the_rig() {
    let rig = rig(&[SLIGHT_LAG, LEAK], &["sensor_offset"]);
    let report = NamesReport::new(&[rig]);
    let [miss] = &report.misses[..] else {
        panic!("{report}")
    };
    for part in [
        "rig-001 (normally closed, 50 Hz",
        "hides [chamber_leak (its law): i_fill 0.1 p_ch 3.0, sensor_lag (its law): i_fill 0.1 p_ch 1.0]",
        "named [sensor_offset], verdict found, check error 1.00 floors, 30 s",
        "chamber_leak not named; 1 name wrong",
    ] {
        assert!(miss.contains(part), "{part}: {miss}");
    }
}

#[test]
fn an_effect_of_the_library_is_asked_for_where_it_costs_a_noise_floor() {
    let all = [LEAK, SLIGHT_LAG, CLAMP_OF_OTHER_LAW, PULSATION];
    let report = NamesReport::new(&[rig(&all, &["sensor_lag", "chamber_leak"])]);
    assert_eq!(report.gates[1].share, Share { count: 1, of: 2 });
    let by_cost = report
        .costs
        .iter()
        .map(|(_, share)| (share.count, share.of));
    assert_eq!(
        by_cost.collect::<Vec<_>>(),
        [(0, 1), (1, 1), (0, 0), (0, 0)]
    );
    let (lag, clamp) = (
        report.effects["sensor_lag"],
        report.effects["flyback_clamp"],
    );
    assert_eq!((lag.named.of, lag.not_required), (0, 1));
    assert_eq!(
        (clamp.named, clamp.not_required),
        (Share { count: 0, of: 1 }, 0)
    );
    assert_eq!(report.effects["supply_pulsation"].named.of, 0);
}

/// The equivalents of a name include both effects: it stands for the one with the larger cost.
#[test]
fn a_name_for_either_of_two_effects_stands_for_the_one_that_costs_more() {
    let mut of_either = finding(&["dead_volume"], 1.1);
    let said = ["sensor_lag", "chamber_leak"].map(str::to_owned);
    of_either
        .equivalents
        .insert("dead_volume".to_owned(), said.to_vec());
    let answer = answer(&[SLIGHT_LAG, LEAK]);
    let rig = NamedRig::new(answer, None, Some(of_either), None, None);
    let share = NamesReport::new(&[rig]).gates[1].share;
    assert_eq!(share, Share { count: 1, of: 1 });
}

#[test]
fn intervals_count_where_law_and_name_are_those_of_the_library() {
    let intervals = |effects: Effects, names: &[&str]| rig(effects, names).intervals().len();
    assert_eq!(intervals(&[LEAK], &["chamber_leak"]), 1);
    assert_eq!(intervals(&[LEAK], &[]), 0);
    assert_eq!(intervals(&[CLAMP_OF_OTHER_LAW], &["flyback_clamp"]), 0);
}

/// A free-run error of a rig with an effect outside the library does not count.
#[test]
fn free_runs_count_where_the_library_has_everything() {
    let away = |effects: Effects| NamedRig {
        refined: read(serde_json::json!({ "steps": [step(1.51)], "parameters": [] })),
        ..rig(effects, &[])
    };
    let free_run = |rig: NamedRig| NamesReport::new(&[rig]).gates[4].share;
    assert_eq!(free_run(away(&[])), Share { count: 0, of: 1 });
    assert_eq!(free_run(away(&[PULSATION])), Share::default());
    assert_eq!(free_run(rig(&[], &[])), Share { count: 1, of: 1 });
}

#[test]
fn a_diagnosis_that_did_not_end_fails_the_score() {
    let mut rigs = right();
    rigs.push(NamedRig::new(answer(&[]), None, None, None, None));
    let report = NamesReport::new(&rigs);
    assert!(!report.holds());
    assert!(report.misses[0].ends_with("no answer"), "{report}");
}

#[test]
fn a_diagnosis_may_take_longer_where_more_is_hidden() {
    let slow = |effects: Effects| NamedRig {
        seconds: Some(31.0),
        ..rig(effects, &[])
    };
    let many = [LEAK, SLIGHT_LAG, PULSATION];
    let report = NamesReport::new(&[slow(&many[..2]), slow(&many), rig(&[], &[])]);
    let [few, more] = report.in_time;
    assert_eq!(few, Share { count: 1, of: 2 });
    assert_eq!(more, Share { count: 1, of: 1 });
}

#[test]
fn rigs_are_counted_by_what_they_hide_and_how_they_are_logged() {
    let report = NamesReport::new(&right());
    let rigs = |label: &str| {
        let mut groups = report.groups.iter();
        groups.find(|group| group.label == label).unwrap().rigs
    };
    assert_eq!([rigs("0 hidden"), rigs("1 hidden")], [1, 1]);
    assert_eq!([rigs("20 to 50 Hz"), rigs("50 to 500 Hz")], [0, 2]);
    assert_eq!([rigs("currents logged"), rigs("no currents")], [2, 0]);
}

#[test]
fn a_name_that_a_better_sensor_loses_is_listed() {
    let drawn = [rig(&[LEAK], &["chamber_leak"]), rig(&[LEAK], &[])];
    let better = |names: &[&str]| {
        let mut rig = rig(&[LEAK], names);
        rig.answer.logger.sensor_share = 0.1;
        [rig]
    };
    let kept = Kept::of(&drawn, &better(&["chamber_leak"]));
    assert_eq!(
        (kept.names, kept.sensor_share),
        (Share { count: 1, of: 1 }, 0.1)
    );
    let lost = Kept::of(&drawn, &better(&[]));
    assert_eq!(lost.names, Share { count: 0, of: 1 });
    assert_eq!(lost.lost, ["rig-001: chamber_leak, now found []"]);
}
