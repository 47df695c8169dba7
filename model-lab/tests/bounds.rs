//! Any log within the hard bounds of its quantities is compared or refused: no panic, no hang, and no memory beyond that required by its
//! length.

use model_lab::{CompareError, CompareOptions, Comparison, compare, find_conditions, free_run};
use plant_sim::PlantParameters;
use proptest::prelude::*;
use recording::{Bounds, Provenance, Recording, TimeBase, Unit};

const ROWS: usize = 120;

/// Signals of a log with their units.
const SIGNALS: [(&str, Unit); 4] = [
    ("p_ch", Unit::BarGauge),
    ("i_fill", Unit::Milliampere),
    ("i_vent", Unit::Milliampere),
    ("u_bat", Unit::Volt),
];
const USUAL: [f64; 4] = [1.5, 280.0, 0.0, 24.0];

fn log(duties: &[(f64, f64)], signals: [Vec<f64>; 4], times_s: Vec<f64>) -> Recording {
    let mut recording = Recording::new(Provenance::from_source("any values"));
    let base = recording.add_time_base(TimeBase::new(times_s).unwrap());
    let (fill, vent) = duties.iter().copied().unzip();
    recording
        .add_signal("duty_fill", Unit::Percent, base, fill)
        .unwrap();
    recording
        .add_signal("duty_vent", Unit::Percent, base, vent)
        .unwrap();
    for ((name, unit), values) in SIGNALS.into_iter().zip(signals) {
        recording.add_signal(name, unit, base, values).unwrap();
    }
    recording
}

fn compared(log: &Recording) -> Result<Comparison, CompareError> {
    let plant = PlantParameters::nominal();
    let whole = compare(&plant, log, &CompareOptions::default());
    let free = free_run(&plant, log, &find_conditions(&plant, log));
    assert_eq!(
        whole.is_ok(),
        free.is_ok(),
        "{:?} {:?}",
        whole.err(),
        free.err()
    );
    let whole = whole?;
    // Every value is a number: JSON has no NaN, and writes null.
    let json = serde_json::to_value(&whole).unwrap();
    for signal in json["signals"].as_array().unwrap() {
        for figure in ["rms", "worst", "bias"] {
            assert!(signal["free_run"][figure].is_f64(), "{figure} of {signal}");
        }
    }
    Ok(whole)
}

fn uniform() -> Vec<f64> {
    (0..ROWS).map(|row| row as f64 * 0.01).collect()
}

/// Returns duty cycles of 20 rows at rest, 40 filling, 20 at rest, 20 venting, the rest still.
fn usual_duties() -> Vec<(f64, f64)> {
    let duty = |row: usize| match row {
        20..60 => (60.0, 0.0),
        80..100 => (0.0, 70.0),
        _ => (0.0, 0.0),
    };
    (0..ROWS).map(duty).collect()
}

fn with_pressure(pressure: impl Fn(usize) -> f64) -> Recording {
    let mut signals = USUAL.map(|usual| vec![usual; ROWS]);
    signals[0] = (0..ROWS).map(pressure).collect();
    log(&usual_duties(), signals, uniform())
}

/// Defect seen: an unplugged sensor shows vacuum, which caused a panic.
#[test]
fn a_pressure_near_vacuum_is_compared() {
    for rows in [0..ROWS, 0..50, 30..80, 70..ROWS] {
        for vacuum in [-1.0, -1.012] {
            let log = with_pressure(|row| if rows.contains(&row) { vacuum } else { 0.0 });
            let found = compared(&log).unwrap();
            assert!(found.signals[0].free_run.rms > 0.1, "{rows:?}");
        }
    }
}

/// Defect seen: half a second unplugged, then half a second of rest. The line through both began below vacuum, which caused the panic.
#[test]
fn a_sensor_that_is_plugged_in_late_is_compared() {
    let rows = 250;
    let duties: Vec<(f64, f64)> = (0..rows)
        .map(|row| (f64::from(u8::from(row >= 150)) * 60.0, 0.0))
        .collect();
    let signals = |unplugged: f64| {
        let mut noise = 1_u32;
        let mut pressure = |row: usize| {
            noise = noise.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if row < 50 {
                unplugged
            } else {
                f64::from(noise >> 16) * 1e-7
            }
        };
        let pressure = (0..rows).map(&mut pressure).collect();
        [pressure, vec![0.0; rows], vec![0.0; rows], vec![24.0; rows]]
    };
    let times = || (0..rows).map(|row| row as f64 * 0.01).collect();
    for unplugged in [-1.0, -1.012] {
        let found = compared(&log(&duties, signals(unplugged), times())).unwrap();
        assert!(found.start.pressure_bar_gauge > -1.013, "{:?}", found.start);
    }
    // Gauge values that are below vacuum at the ambient pressure of the plant.
    let mut high = PlantParameters::nominal();
    high.set("gas.ambient_pressure_pa", 7e4, "test").unwrap();
    let found = compare(
        &high,
        &log(&duties, signals(-1.0), times()),
        &CompareOptions::default(),
    )
    .unwrap();
    assert_eq!(found.signals[0].missing, 50);
    assert!(
        found
            .defects
            .sentences
            .iter()
            .any(|sentence| sentence.starts_with("50 samples of p_ch are below vacuum")),
        "{:?}",
        found.defects
    );
}

/// A line through the first samples leads below vacuum at the beginning.
#[test]
fn a_pressure_that_rises_from_vacuum_is_compared() {
    compared(&with_pressure(|row| (row as f64 * 0.2 - 1.01).min(8.0))).unwrap();
    compared(&with_pressure(|row| if row < 10 { -1.01 } else { 900.0 })).unwrap();
}

/// Returns a value within the bounds, often one of their ends.
fn value(unit: Unit) -> impl Strategy<Value = f64> {
    let range = Bounds::of(unit.quantity()).in_unit(unit);
    let (least, most) = (*range.start(), *range.end());
    prop_oneof![
        3 => (0.0..1.0_f64).prop_map(move |share| (least + share * (most - least)).clamp(least, most)),
        1 => Just(least),
        1 => Just(most),
        1 => Just(f64::NAN),
    ]
}

/// Returns a column: usual values except for some cells, a part, or all of it.
fn column(index: usize) -> impl Strategy<Value = Vec<f64>> {
    let (usual, unit) = (USUAL[index], SIGNALS[index].1);
    let cells = prop::collection::vec((0..ROWS, value(unit)), 0..6);
    let block = (0..ROWS, 0..=ROWS, value(unit), prop::bool::weighted(0.3));
    (cells, block).prop_map(move |(cells, (begin, length, value, has_block))| {
        let mut column = vec![usual; ROWS];
        if has_block {
            column[begin..(begin + length).min(ROWS)].fill(value);
        }
        for (row, value) in cells {
            column[row] = value;
        }
        column
    })
}

fn duties() -> impl Strategy<Value = Vec<(f64, f64)>> {
    let duty =
        || prop_oneof![2 => Just(0.0), 1 => 0.0..100.0_f64, 1 => Just(100.0), 1 => Just(f64::NAN)];
    prop::collection::vec((duty(), duty()), ROWS / 10)
        .prop_map(|phases| phases.iter().flat_map(|duty| [*duty; 10]).collect())
}

/// Rows that are hours apart, and supplies of any size: the steps depend on the rows, not on the values.
#[test]
fn steps_are_counted_by_rows_and_not_by_values() {
    const MOST_PER_ROW: u64 = 400 * 100;
    for (supply, step_s) in [
        (1000.0, 0.01),
        (-1000.0, 0.01),
        (24.0, 3600.0),
        (1000.0, 10.0),
    ] {
        let mut signals = USUAL.map(|usual| vec![usual; ROWS]);
        signals[3] = vec![supply; ROWS];
        let times_s = (0..ROWS).map(|row| row as f64 * step_s).collect();
        let log = log(&usual_duties(), signals, times_s);
        let plant = PlantParameters::nominal();
        let mut work = 0;
        let replayed = plant_sim::replay::replay(
            &plant,
            &log,
            plant_sim::Tolerance::default(),
            |_, simulator| {
                work = simulator.statistics().work();
            },
        );
        assert!(
            work < 100_000 + MOST_PER_ROW * ROWS as u64,
            "{supply} V, {step_s} s: {work}"
        );
        let is_aborted = matches!(
            replayed,
            Err(plant_sim::replay::ReplayError::Aborted { .. })
        );
        assert!(replayed.is_ok() || is_aborted, "{supply} V, {step_s} s");
        assert_eq!(
            compared(&log).is_ok(),
            replayed.is_ok(),
            "{supply} V, {step_s} s"
        );
        // Any allowed supply leaves a plant that can be simulated.
        assert!(
            is_aborted == (step_s == 3600.0),
            "{supply} V, {step_s} s: {work} steps"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_values_within_bounds_are_compared(
        duties in duties(),
        columns in (column(0), column(1), column(2), column(3)),
    ) {
        let (pressure, fill, vent, supply) = columns;
        // A log without a value of a signal is one without the signal.
        let _ = compared(&log(&duties, [pressure, fill, vent, supply], uniform()));
    }
}
