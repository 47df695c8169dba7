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

/// Returns a bench in `Running`, the chamber at ambient pressure.
fn running() -> Bench {
    let mut bench = Bench::with(&settings());
    for _ in 0..20 {
        bench.step();
    }
    assert_eq!(bench.ecu.mode(), Mode::Running);
    bench
}

/// Returns a bench at 5 bar. The run to there has measured the fill coil.
fn measured() -> Bench {
    Bench::with(&settings()).settled_at(5.0)
}

/// Runs a sample at this supply voltage, which the currents follow.
fn step_at(bench: &mut Bench, supply_mv: u16) {
    let current = |nominal_ma: Option<u16>| {
        nominal_ma.map(|ma| (u32::from(ma) * u32::from(supply_mv) / 24_000) as u16)
    };
    bench.step_with(|inputs| {
        inputs.battery_mv = Some(supply_mv);
        inputs.current_fill_ma = current(inputs.current_fill_ma);
        inputs.current_vent_ma = current(inputs.current_vent_ma);
    });
}

/// Runs samples at this supply voltage with the reference at the pressure.
fn rest_at(bench: &mut Bench, supply_mv: u16) {
    for _ in 0..20 {
        bench.reference_bar = bench.rig.pressure_bar;
        step_at(bench, supply_mv);
    }
}

#[test]
fn a_pulse_gets_longer_at_a_low_voltage_and_shorter_at_a_high_one() {
    let first = |supply_mv: u16| {
        let mut bench = measured();
        rest_at(&mut bench, supply_mv);
        bench.reference_bar += 0.15;
        step_at(&mut bench, supply_mv);
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
    let mut bench = running();
    bench.reference_bar = 5.0;
    bench.step_with(|_| {});
    assert_eq!(bench.duties(), [100.0, 0.0]);
    assert_eq!(bench.ecu.telemetry().control_signal, 100 << 12);
}

#[test]
fn a_run_whose_pulses_reach_the_coils_goes_on() {
    let mut bench = running();
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
    let mut bench = running();
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

/// The bounds of the factor are 1.43 and 1.48: 16.8 and 16.2 V at the nominal resistance.
#[test]
fn below_the_current_of_the_pulses_the_pid_controller_drives_the_valves() {
    let mut bench = measured();
    for (supply_mv, is_pid) in [
        (16_500, false),
        (16_100, true),
        (16_500, true),
        (17_300, false),
        (16_100, true),
    ] {
        rest_at(&mut bench, supply_mv);
        bench.reference_bar += 0.5;
        let before = bench.ecu.telemetry().controller_state;
        step_at(&mut bench, supply_mv);
        let after = bench.ecu.telemetry().controller_state;
        assert_eq!(before != after, is_pid, "{supply_mv} mV");
        assert!(bench.duties()[0] > 0.0, "{supply_mv} mV");
    }
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
