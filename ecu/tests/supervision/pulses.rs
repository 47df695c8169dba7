//! Model-based pulses under the supervisor.

use controller::Settings;
use ecu::{EcuConfig, EcuConfigError, EcuSettings, Mode, VentValve};

use crate::bench::Bench;

fn settings() -> EcuSettings {
    EcuSettings {
        controller: Settings::pulses(),
        ..EcuSettings::bench()
    }
}

/// Returns a bench in `Running` at its pressure, with this supply voltage.
fn running(supply_mv: u16) -> Bench {
    let mut bench = Bench::with(&settings());
    for _ in 0..20 {
        bench.step_with(|inputs| inputs.battery_mv = Some(supply_mv));
    }
    assert_eq!(bench.ecu.mode(), Mode::Running);
    bench
}

#[test]
fn a_pulse_gets_longer_at_a_low_voltage_and_shorter_at_a_high_one() {
    let first = |supply_mv: u16| {
        let mut bench = running(supply_mv);
        bench.reference_bar = 0.15;
        bench.step_with(|inputs| inputs.battery_mv = Some(supply_mv));
        bench.duties()[0]
    };
    let [low, nominal, high] = [20_000, 24_000, 32_000].map(first);
    assert!(
        high > 0.0 && nominal > high + 5.0 && low > nominal + 5.0,
        "{low} {nominal} {high}"
    );
}

#[test]
fn the_control_signal_of_the_telemetry_is_the_pulse() {
    let mut bench = running(24_000);
    bench.reference_bar = 5.0;
    bench.step_with(|_| {});
    assert_eq!(bench.duties(), [100.0, 0.0]);
    assert_eq!(bench.ecu.telemetry().control_signal, 100 << 12);
}

#[test]
fn a_run_whose_pulses_reach_the_coils_goes_on() {
    let mut bench = running(24_000);
    bench.reference_bar = 5.0;
    for sample in 0..5 {
        bench.step_with(|_| {});
        assert_eq!(bench.duties(), [100.0, 0.0], "sample {sample}");
    }
}

/// A sample without a plausible pressure shuts both valves. The run that was under way gets no further pulse, and the loop
/// goes on after it.
#[test]
fn a_run_that_is_cut_by_a_doubtful_pressure_is_ended_and_a_new_one_begins_later() {
    let mut bench = running(24_000);
    bench.reference_bar = 5.0;
    bench.step_with(|_| {});
    bench.step_with(|inputs| inputs.pressure = None);
    assert_eq!(bench.duties(), [0.0, 0.0]);
    bench.step_with(|_| {});
    assert_eq!(
        bench.duties(),
        [0.0, 0.0],
        "the cut run gives no more pulses"
    );
    let again = (0..20).any(|_| {
        bench.step_with(|_| {});
        bench.duties()[0] > 0.0
    });
    assert!(again);
}

/// Tables of a valve that opens under current are wrong for one that it shuts.
#[test]
fn pulses_on_a_normally_open_vent_valve_are_refused() {
    let settings = EcuSettings {
        vent_valve: VentValve::NormallyOpen,
        ..settings()
    };
    let error = EcuConfig::new(&settings).unwrap_err();
    assert_eq!(error, EcuConfigError::PulsesOnNormallyOpen);
    let text = error.to_string();
    assert!(
        text.contains("[pulses]") && text.contains("normally closed"),
        "{text}"
    );
}
