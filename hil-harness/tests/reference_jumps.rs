//! Reference that is lowered and then raised while the pressure is still above it.

use hil_harness::scenario::{FIGURE_ORIFICE_M, with_orifices};
use hil_harness::wire::{bar, measured_bar};
use hil_harness::{ReferenceProfile, Scenario, run_in_process};

/// Returns the rise of the pressure (bar) while it is above the reference and its deadband. The reference goes from
/// `from_bar` to zero for `samples`, then up to `to_bar`, which the falling pressure has not reached yet.
fn rise_bar(scenario: &Scenario, from_bar: f64, samples: u32, to_bar: f64) -> f64 {
    let settled = ReferenceProfile::starting_at(0.0)
        .step_to(from_bar)
        .hold_ms(1500);
    let raised = settled.step_to(0.0).hold_ms(10 * samples).step_to(to_bar);
    let jump = Scenario {
        reference: raised.hold_ms(300),
        duration_samples: 180 + samples,
        ..scenario.clone()
    };
    let run = run_in_process(&jump).expect("a scenario within bounds");
    let traces = run.exchanges[run.exchanges.len() - 30..]
        .iter()
        .map(|exchange| {
            let pressure_bar = exchange.sensors.pressure.map_or(f64::NAN, measured_bar);
            let reference_bar = exchange.sensors.reference.map_or(f64::NAN, bar);
            (pressure_bar, reference_bar)
        });
    let mut lowest_bar = f64::INFINITY;
    traces
        .take_while(|(pressure_bar, reference_bar)| pressure_bar - reference_bar > 0.1)
        .map(|(pressure_bar, _)| {
            lowest_bar = lowest_bar.min(pressure_bar);
            pressure_bar - lowest_bar
        })
        .fold(0.0, f64::max)
}

/// Returns the largest rise over many such jumps (bar).
fn worst_bar(scenario: &Scenario) -> f64 {
    let mut worst_bar = 0.0_f64;
    for from in 2..=8 {
        for samples in [1, 3, 5, 8, 12] {
            for to in 1..2 * from {
                let (from_bar, to_bar) = (f64::from(from), f64::from(to) / 2.0);
                worst_bar = worst_bar.max(rise_bar(scenario, from_bar, samples, to_bar));
            }
        }
    }
    worst_bar
}

#[test]
fn a_pressure_above_a_raised_reference_goes_on_falling() {
    let wide = Scenario::new("jump", ReferenceProfile::starting_at(0.0));
    let narrow = with_orifices(wide.plant.clone(), FIGURE_ORIFICE_M);
    let narrow = wide.clone().on(narrow);
    for (orifices, scenario) in [("1.9 mm", wide), ("1.3 mm", narrow)] {
        let worst_bar = worst_bar(&scenario);
        println!("{orifices}: {worst_bar:.3} bar");
        assert!(worst_bar < 0.1, "{orifices}: {worst_bar} bar");
    }
}
