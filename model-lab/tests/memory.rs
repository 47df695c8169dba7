//! Heap use of a comparison, counted by the allocator.

use std::sync::Arc;

use model_lab::{CompareOptions, Comparison, compare};
use peak_alloc::PeakAlloc;
use plant_sim::replay::replay;
use plant_sim::{PlantParameters, Tolerance};
use recording::{Provenance, Recording, TimeBase, Unit};

#[global_allocator]
static HEAP: PeakAlloc = PeakAlloc;

/// Returns a log at 1 kHz: both duty cycles, the pressure and the current of the fill coil.
fn log(rows: usize) -> Recording {
    let mut log = Recording::new(Provenance::from_source("bench"));
    let base = log.add_time_base(TimeBase::uniform(0.0, 1e-3, rows).unwrap());
    let duty = |from: usize, to: usize| {
        let on = (from..to, 60.0);
        let duty = (0..rows).map(|row| {
            if on.0.contains(&(row % 4000)) {
                on.1
            } else {
                0.0
            }
        });
        duty.collect()
    };
    for (name, values) in [("duty_fill", duty(0, 300)), ("duty_vent", duty(2000, 2300))] {
        log.add_signal(name, Unit::Percent, base, values).unwrap();
    }
    let plant = PlantParameters::nominal();
    let run = replay(&plant, &log, Tolerance::default(), |_, _| {}).unwrap();
    for name in ["p_ch", "i_fill"] {
        let signal = run.recording.signal(name).unwrap();
        let noise = |row: usize| ((row * 7919) % 1009) as f64 * 1e-5;
        let values = signal.iter().enumerate();
        let values = values.map(|(row, value)| value.unwrap() + noise(row));
        log.add_signal(name, signal.unit(), base, values.collect())
            .unwrap();
    }
    log
}

/// Returns the largest growth of the heap (bytes) while a log with this number of rows is compared, and that with the result.
fn taken(rows: usize) -> (usize, usize) {
    let log = log(rows);
    HEAP.reset_peak_usage();
    let before = HEAP.current_usage();
    let compared = compare(
        &PlantParameters::nominal(),
        &log,
        &CompareOptions::default(),
    )
    .unwrap();
    assert_eq!(compared.samples, rows);
    let taken = [HEAP.peak_usage(), HEAP.current_usage()].map(|usage| usage - before);
    shares_the_log(&log, &compared);
    (taken[0], taken[1])
}

/// Asserts that a signal of the log in the unit of the model is in the result without a copy.
fn shares_the_log(log: &Recording, compared: &Comparison) {
    let measured = &compared.traces.measured;
    for name in ["p_ch", "i_fill"] {
        let [ours, theirs] = [measured, log].map(|one| one.signal(name).unwrap().shared_values());
        assert!(Arc::ptr_eq(&ours, &theirs), "{name}");
    }
    let [ours, theirs] = [measured, log].map(|one| one.time_bases().next().unwrap().1);
    assert!(Arc::ptr_eq(
        &ours.shared_times_s(),
        &theirs.shared_times_s()
    ));
}

/// Goal: an hour at 1 kHz in four channels is compared within 400 MB. The log itself takes 144 MB of them, so that 71 bytes are left for
/// each row. Method: the difference in bytes between two lengths, so that nothing fixed counts. It was 400 bytes a row when every signal of
/// the model, both residuals and every command were stored as separate columns.
#[test]
fn a_comparison_takes_two_columns_for_each_signal_and_a_few_bytes() {
    // The conditions of a log are found in its first 40 000 rows, which takes as much memory as a comparison of some 120 000.
    let [short, long] = [200_000, 280_000].map(taken);
    let per_row = |long: usize, short: usize| (long - short) as f64 / 80_000.0;
    let (peak, kept) = (per_row(long.0, short.0), per_row(long.1, short.1));
    // Free-run simulation and one-step-ahead prediction of two signals are 32 bytes.
    assert!(
        peak < 60.0,
        "{peak} bytes for each row while it is compared"
    );
    assert!(kept < 40.0, "{kept} bytes for each row afterwards");
}
