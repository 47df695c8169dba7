use core::ops::ControlFlow;

use plant_sim::parameters::{Knowledge, OnOffValveParameters, ParameterSpec};
use plant_sim::valve::ValveFunction;
use recording::csv;

use super::distance::made;
use super::*;
use crate::bench::{Bench as Rig, with_signals};
use crate::diagnosis::verdict::DISTINGUISHABLE;

const RIVALS: [&str; 2] = ["series_restriction", "supply_line_droop"];
const LIMITS: Limits = Limits {
    duration_s: 8.0,
    max_bar: 6.0,
    max_duty_pct: 100.0,
};

fn go_on(_: crate::diagnosis::Progress) -> ControlFlow<()> {
    ControlFlow::Continue(())
}

fn rig(hidden: &str) -> PlantParameters {
    {
        let nominal = PlantParameters::nominal();
        let setting = settings(&nominal, hidden).unwrap().swap_remove(0);
        nominal.with_effect(setting)
    }
}

/// Returns a log of one fill at full duty: it is too slow, for an unknown reason.
fn poor_log(plant: PlantParameters) -> Recording {
    let phases = vec![(1.0, 0.0, 0.0), (0.2, 100.0, 0.0), (0.4, 0.0, 0.0)];
    Rig {
        plant,
        phases,
        ..Rig::default()
    }
    .measure()
}

fn asked(question: Question, limits: Limits) -> Result<NextExperiment, DiagnoseError> {
    next_experiment(
        &PlantParameters::nominal(),
        &[poor_log(rig(RIVALS[0]))],
        question,
        limits,
        &go_on,
    )
}

#[test]
fn the_best_test_signal_shows_what_the_log_could_not() {
    let next = asked(Question::Between(&RIVALS), LIMITS).unwrap();
    assert!(next.distance_now < DISTINGUISHABLE, "{}", next.distance_now);
    assert!(next.distinguishes(), "{next:?}");
    assert!(next.ranking.is_sorted_by(|a, b| a.distance >= b.distance));

    // The rig runs it, and both rivals are fitted to both logs.
    let plant = PlantParameters::nominal();
    let log = poor_log(rig(RIVALS[0]));
    let noises = Noises::of(&gather(&plant, core::slice::from_ref(&log)).unwrap());
    let sequence = Sequence {
        name: "next",
        about: "",
        duties: expanded(&next),
        interval_s: next.sample_time_s,
        highest_bar: 0.0,
    };
    let second = made(&rig(RIVALS[0]), &sequence, &noises).unwrap();
    let fitting = gather(&plant, &[log, second]).unwrap();
    let bench = Bench {
        library: &[],
        plant: &plant,
        fitting: &fitting,
        checking: &fitting,
    };
    let plain = bench.plain().unwrap();
    let rivals = fitted(&bench, &plain, &RIVALS, &go_on).unwrap();
    let seen = distance::on_the_logs(&rivals[0], &rivals[1]);
    assert!(rivals[0].cost < rivals[1].cost);
    assert!(
        seen > DISTINGUISHABLE,
        "{seen}, predicted {}",
        next.ranking[0].distance
    );
}

/// Returns the rows of the CSV as a reader parses them.
fn expanded(next: &NextExperiment) -> Vec<[f64; 2]> {
    let log = csv::read("next.csv", next.csv().as_bytes(), &csv::Options::default()).unwrap();
    let [fill, vent] =
        crate::commands::DUTIES.map(|name| log.signal(name).unwrap().values_or_nan().to_vec());
    fill.into_iter()
        .zip(vent)
        .map(|(fill, vent)| [fill, vent])
        .collect()
}

#[test]
fn every_test_signal_keeps_the_limits() {
    let limits = Limits {
        duration_s: 5.0,
        max_bar: 3.0,
        max_duty_pct: 60.0,
    };
    let next = asked(Question::For("gas_temperature"), limits).unwrap();
    assert!(next.ranking.len() >= 4);
    for test_signal in &next.ranking {
        assert!(
            test_signal.duration_s <= 5.0 && test_signal.highest_bar <= 3.0,
            "{test_signal:?}"
        );
    }
    let duties = expanded(&next);
    assert_eq!(
        duties.len() as f64 * next.sample_time_s,
        next.ranking[0].duration_s
    );
    assert!(
        duties
            .iter()
            .flatten()
            .all(|duty| (0.0..=60.0).contains(duty))
    );
}

/// Defect seen: an ECU that takes commands every 20 ms got commands every 10 ms, which showed nothing.
#[test]
fn commands_follow_the_sample_time_and_the_pwm_period_of_the_plant() {
    let mut plant = PlantParameters::nominal();
    plant.ecu.sample_time_s = 0.02;
    plant.ecu.pwm_frequency_hz = 25.0;
    let sequences = test_signal::sequences(&[&plant], &LIMITS).unwrap();
    assert!(sequences.len() >= 4);
    for sequence in &sequences {
        let base = sequence.recording();
        let (_, base) = base.time_bases().next().unwrap();
        let step_s = base.sampling().median_step_s.unwrap();
        assert!((step_s - 0.02).abs() < 1e-9, "{step_s}");
        assert!(base.end_s() <= LIMITS.duration_s);
    }
    let staircase = sequences
        .iter()
        .find(|one| one.name == "pulse-width staircase");
    let duties = &staircase.unwrap().duties;
    let begin = duties.iter().position(|[fill, _]| *fill > 0.0).unwrap();
    let pulse = duties[begin..].iter().take_while(|[fill, _]| *fill > 0.0);
    // Two periods of 40 ms.
    assert_eq!(pulse.count(), 4);
}

/// Defect seen: a normally open vent valve got no current while a plan filled and held, so that the chamber stayed empty.
#[test]
fn a_normally_open_vent_valve_is_driven_wherever_the_air_is_to_stay() {
    let mut plant = PlantParameters::nominal();
    plant.functions[VENT] = ValveFunction::NormallyOpen;
    let sequences = test_signal::sequences(&[&plant], &LIMITS).unwrap();
    let closed = test_signal::sequences(&[&PlantParameters::nominal()], &LIMITS).unwrap();
    assert_eq!(sequences.len(), closed.len());
    for (sequence, closed) in sequences.iter().zip(&closed) {
        let filling = sequence.duties.iter().filter(|duties| duties[FILL] > 0.0);
        assert!(filling.count() > 0, "{}", sequence.name);
        let is_shut = |duties: &&[f64; 2]| duties[FILL] == 0.0 || duties[VENT] == 100.0;
        assert!(sequence.duties.iter().all(|duties| is_shut(&duties)));
        let [open, closed] = [sequence.highest_bar, closed.highest_bar];
        // While its coil warms, this valve keeps the air in, and a normally closed one vents.
        assert!(open > closed - 0.3, "{}: {open} {closed}", sequence.name);
    }
    let hold = sequences
        .iter()
        .find(|one| one.name == "hold at two pressures");
    let duties = &hold.unwrap().duties;
    let is_held = |duties: &[f64; 2]| *duties == [0.0, 100.0];
    assert!(is_held(&duties[0]));
    let filled = duties.iter().position(|duties| duties[FILL] > 0.0).unwrap();
    let held = duties[filled..].iter().filter(|duties| is_held(duties));
    assert!(held.count() >= 400);
}

/// Defect seen: a plant with on/off valves was refused. Such a rig may command its valves open and shut alone.
#[test]
fn an_on_off_valve_is_commanded_open_or_shut_for_whole_samples() {
    let mut plant = PlantParameters::nominal();
    plant.functions = [ValveFunction::OnOff; 2];
    for valve in [&mut plant.on_off_fill, &mut plant.on_off_vent] {
        *valve = OnOffValveParameters {
            conductance_dm3_per_s_bar: 0.3,
            critical_ratio: 0.4,
            opening_delay_s: 0.015,
            closing_delay_s: 0.025,
            opening_ramp_s: 0.004,
            closing_ramp_s: 0.002,
        };
    }
    let sequences = test_signal::sequences(&[&plant], &LIMITS).unwrap();
    assert!(sequences.len() >= 6);
    for sequence in &sequences {
        let mut duties = sequence.duties.iter().flatten();
        assert!(duties.all(|duty| [0.0, 100.0].contains(duty)));
    }
    let staircase = sequences
        .iter()
        .find(|one| one.name == "pulse-width staircase");
    let fills: Vec<bool> = staircase
        .unwrap()
        .duties
        .iter()
        .map(|duties| duties[FILL] > 0.0)
        .collect();
    let pulses = fills.chunk_by(|a, b| a == b).filter(|rows| rows[0]);
    let rows: Vec<usize> = pulses.map(<[bool]>::len).collect();
    assert!(rows.len() > 4 && rows.last() > rows.first(), "{rows:?}");
    let log = poor_log(plant.clone());
    let next = next_experiment(
        &plant,
        &[log],
        Question::For("chamber_leak"),
        LIMITS,
        &go_on,
    );
    assert_eq!(next.unwrap().ranking[0].name, "hold at two pressures");
}

#[test]
fn an_effect_that_was_not_excited_gets_a_test_signal() {
    let next = asked(Question::For("chamber_leak"), LIMITS).unwrap();
    assert_eq!(next.rivals[0].effect, None);
    assert_eq!(next.rivals[1].effect.as_deref(), Some("chamber_leak"));
    assert_eq!(
        next.ranking[0].name, "hold at two pressures",
        "{:?}",
        next.ranking
    );
}

/// A cold coil is one of less resistance: a known resistance distinguishes them.
#[test]
fn what_the_plant_file_knows_is_not_refitted_by_a_rival() {
    let best = |knowledge| {
        let mut plant = PlantParameters::nominal();
        plant
            .knowledge
            .insert("coil.resistance_20c_ohm".to_owned(), knowledge);
        let log = poor_log(PlantParameters::nominal());
        let question = Question::For("coil_ambient_temperature");
        let next = next_experiment(&plant, &[log], question, LIMITS, &go_on).unwrap();
        next.ranking[0].distance
    };
    let [exact, open] = [Knowledge::Exact, Knowledge::TolerancePct(40.0)].map(best);
    assert!(exact > 3.0 * open, "{exact} {open}");
}

#[test]
fn limits_that_leave_nothing_and_unknown_effects_are_refused() {
    let nothing = Limits {
        duration_s: 1.0,
        max_bar: 3.0,
        max_duty_pct: 100.0,
    };
    let error = asked(Question::For("chamber_leak"), nothing).unwrap_err();
    assert!(
        matches!(error, DiagnoseError::NoTestSignal { .. }),
        "{error}"
    );
    let error = asked(Question::Between(&["chamber_leak", "chamber_leek"]), LIMITS).unwrap_err();
    assert!(error.to_string().contains("chamber_leek"), "{error}");
}

#[test]
fn where_no_test_signal_distinguishes_them_it_says_so() {
    // The rig has neither effect.
    let log = poor_log(PlantParameters::nominal());
    let question = Question::Between(&["dead_volume", "sensor_lag"]);
    let limits = Limits {
        duration_s: 3.0,
        ..LIMITS
    };
    let next = next_experiment(
        &PlantParameters::nominal(),
        &[log],
        question,
        limits,
        &go_on,
    )
    .unwrap();
    assert!(!next.distinguishes(), "{:?}", next.ranking);
    assert!(
        next.sentence.starts_with("no test signal"),
        "{}",
        next.sentence
    );
}

/// Defect seen: such a plant got duty cycles for valves that it does not have.
#[test]
fn a_plant_without_a_valve_or_without_a_chamber_is_refused() {
    let log = poor_log(PlantParameters::nominal());
    for (valve, volume_m3, said) in [
        (ValveFunction::NormallyClosed, 0.0, "has no chamber"),
        (
            ValveFunction::AlwaysOpen,
            75e-6,
            "has no vent valve that is commanded",
        ),
    ] {
        let mut plant = PlantParameters::nominal();
        plant.functions[VENT] = valve;
        plant.chamber.volume_m3 = volume_m3;
        let question = Question::For("coil_heating");
        let refused = next_experiment(
            &plant,
            core::slice::from_ref(&log),
            question,
            LIMITS,
            &go_on,
        );
        let error = refused.unwrap_err().to_string();
        assert!(error.contains(said), "{error}");
        assert!(
            error.contains("describe the part in the plant file"),
            "{error}"
        );
    }
}

/// Defect seen: an excitation that could not be simulated was ranked with a distance of 0.
#[test]
fn a_test_signal_without_a_distance_is_not_ranked() {
    let sequence = |name: &'static str| Sequence {
        name,
        about: "",
        duties: Vec::new(),
        interval_s: 0.01,
        highest_bar: 0.0,
    };
    let tried = |distance: fn(&Sequence) -> Result<f64, Unseen>| {
        let names = ["failed", "poor", "good"];
        ranked(names.map(sequence).into(), &go_on, distance, falling)
    };
    let found = tried(|sequence| match sequence.name {
        "failed" => Err(Unseen::NotSimulated),
        "poor" => Ok(0.0),
        _ => Ok(9.0),
    });
    let names: Vec<_> = found
        .unwrap()
        .iter()
        .map(|(sequence, _)| sequence.name)
        .collect();
    assert_eq!(names, ["good", "poor"]);
    let error = tried(|_| Err(Unseen::NotSimulated)).unwrap_err();
    assert_eq!(error, NoneRanked::NotSimulated { test_signals: 3 });
    let error = tried(|_| Err(Unseen::NotShown)).unwrap_err();
    assert_eq!(error, NoneRanked::NotShown);
}

/// A lag and an offset of the pressure sensor, and a log with a current alone. Defect seen: the message blamed the simulation.
#[test]
fn rivals_that_the_logged_signals_cannot_show_are_said_to_need_another_signal() {
    let rig = Rig {
        phases: vec![(0.3, 0.0, 0.0), (0.2, 100.0, 0.0), (0.3, 0.0, 0.0)],
        ..Rig::default()
    };
    let log = with_signals(&rig.measure(), |name| name != "p_ch");
    let error = next_experiment(
        &PlantParameters::nominal(),
        &[log],
        Question::Between(&["sensor_lag", "sensor_offset"]),
        LIMITS,
        &go_on,
    );
    let error = error.unwrap_err().to_string();
    for said in [
        "i_fill and i_vent alone",
        "sensor_lag and sensor_offset",
        "log p_ch",
    ] {
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn the_highest_pressure_is_that_of_the_highest_supply() {
    let supply = ParameterSpec::by_name("gas.supply_pressure_bar_gauge").unwrap();
    assert_eq!(Limits::HIGHEST_BAR, supply.range.1);
}
