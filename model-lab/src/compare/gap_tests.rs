//! Logs with gaps: simulation, errors and report.

use recording::{Recording, Unit};

use super::*;
use crate::bench::{Bench, changed, without_rows};
use crate::{CompareOptions, compare, free_run};

fn compared(log: &Recording) -> Comparison {
    let plant = PlantParameters::nominal();
    let found = compare(&plant, log, &CompareOptions::default()).unwrap();
    let free = free_run(&plant, log, &LogConditions::default()).unwrap();
    assert_eq!(free.errors[0].rms, Some(found.signals[0].free_run.rms));
    found
}

fn venting_row(log: &Recording) -> usize {
    let duty = log.signal("duty_vent").unwrap().values_or_nan();
    (150..duty.len()).find(|&row| duty[row] > 0.0).unwrap()
}

/// The logger pauses for 0.7 s while a valve is open. The pause caused the largest error of the log, and nothing reported it.
#[test]
fn a_gap_is_in_no_error_and_is_listed() {
    let whole = Bench::default().measure();
    let of_whole = compared(&whole);
    assert!(of_whole.defects.is_empty(), "{:?}", of_whole.defects);
    let begin = venting_row(&whole) + 1;
    let found = compared(&without_rows(&whole, begin..begin + 70));
    for (signal, of_whole) in found.signals.iter().zip(&of_whole.signals) {
        let (rms, expected) = (signal.free_run.rms, of_whole.free_run.rms);
        assert!(rms < 1.5 * expected, "{}: {rms} {expected}", signal.name);
        assert_eq!(
            (signal.missing, of_whole.missing),
            (8, 0),
            "{}",
            signal.name
        );
    }
    assert!(found.verdict.holds, "{:?}", found.verdict);
    let [gap] = &found.defects.gaps[..] else {
        panic!("{:?}", found.defects)
    };
    assert_eq!(gap.samples, 8);
    assert!((gap.end_s - gap.start_s - 0.71).abs() < 1e-9);
    let restart = gap.restart_bar_gauge.unwrap();
    let shown = whole.signal("p_ch").unwrap().get(begin + 77).unwrap();
    assert!((restart - shown).abs() < 0.03, "{restart} {shown}");
    let [text] = &found.defects.sentences[..] else {
        panic!("one sentence for a gap: {:?}", found.defects.sentences)
    };
    assert!(
        text.contains("no rows from") && text.contains("begins again at the measured"),
        "{text}"
    );
}

/// Ten samples are jitter: the last command stays in force, and the pause is listed all the same.
#[test]
fn a_short_pause_is_listed_and_simulated() {
    let whole = Bench::default().measure();
    let found = compared(&without_rows(&whole, 120..128));
    assert!(found.defects.gaps.is_empty());
    assert_eq!(found.defects.sentences.len(), 1, "{:?}", found.defects);
    assert_eq!(found.signals[0].missing, 0);
}

#[test]
fn a_gap_of_an_hour_costs_what_a_second_costs() {
    let whole = Bench::default().measure();
    let begin = venting_row(&whole) + 1;
    let (_, base) = whole.time_bases().next().unwrap();
    let times = base.times_s().iter().enumerate();
    let later = times.map(|(row, time_s)| time_s + if row < begin { 0.0 } else { 3500.0 });
    let mut log = Recording::new(whole.provenance().clone());
    let id = log.add_time_base(TimeBase::new(later.collect()).unwrap());
    for signal in whole.signals() {
        let values = signal.values_or_nan().to_vec();
        log.add_signal(signal.name(), signal.unit(), id, values)
            .unwrap();
    }
    let found = compared(&log);
    assert!(found.signals[0].free_run.rms_in_noise.unwrap() < 10.0);
    assert_eq!(found.defects.gaps.len(), 1);
}

#[test]
fn rows_without_commands_are_a_gap_and_missing_cells_are_listed() {
    let whole = Bench::default().measure();
    let begin = venting_row(&whole) + 1;
    let log = changed(&whole, |_, unit, mut samples| {
        if unit == Unit::Percent {
            samples[begin..begin + 30].fill(f64::NAN);
        }
        Some((unit, samples))
    });
    let found = compared(&log);
    assert_eq!(found.defects.gaps[0].samples, 38);
    assert_eq!(found.signals[0].missing, 38);
    assert!(
        found.signals[0].free_run.rms_in_noise.unwrap() < 2.0,
        "{:?}",
        found.signals[0].free_run
    );
    let missing: Vec<_> = found
        .defects
        .missing
        .iter()
        .map(|one| (&one.signal[..], one.cells))
        .collect();
    assert_eq!(missing, [("duty_fill", 30), ("duty_vent", 30)]);
    let json = serde_json::to_string(&found).unwrap();
    assert_eq!(
        serde_json::from_str::<Comparison>(&json).unwrap().defects,
        found.defects
    );
}
