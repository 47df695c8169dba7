//! Controller with plausibility check of its input.

use ecu::controller::{Input, Mechanisms, Output, Settings, State, step_traced};
use ecu::{
    CheckedLoop, CheckedLoopConfig, EcuConfig, EcuSettings, Fault, FaultSet, PressureSensor,
};

use crate::bench::{code, pressure};

struct Recommended;

impl Mechanisms for Recommended {
    const SETTINGS: Settings = Settings::recommended();
}

struct Thesis;

impl Mechanisms for Thesis {
    const SETTINGS: Settings = Settings::thesis();
}

fn bench() -> EcuConfig {
    EcuConfig::new(&EcuSettings::bench()).unwrap()
}

fn config() -> CheckedLoopConfig<Recommended> {
    CheckedLoopConfig::new(&bench()).unwrap()
}

#[test]
fn a_pressure_that_is_believed_gets_what_the_controller_says() {
    let controller = ecu::controller::Config::new(&Settings::recommended()).unwrap();
    let (mut checked, mut state) = (CheckedLoop::NEW, State::at_rest());
    for sample in 0..200 {
        let seen = code(0.02 * f64::from(sample));
        let (output, telemetry) = checked.sample(&config(), pressure(3.0), Some(seen));
        let input = Input {
            reference: pressure(3.0),
            pressure: PressureSensor::pressure(seen),
        };
        let (expected, trace) = step_traced(&controller, &mut state, input);
        assert_eq!(output, expected, "{sample}");
        assert_eq!(telemetry.control_signal, trace.u);
        assert_eq!(telemetry.controller_state, state);
        assert_eq!(telemetry.faults, FaultSet::NONE);
    }
}

#[test]
fn a_code_that_is_not_believed_shuts_both_valves_and_is_a_fault_after_five() {
    let mut checked = CheckedLoop::NEW;
    checked.sample(&config(), pressure(3.0), Some(code(1.0)));
    for sample in 1..=6 {
        let (output, telemetry) = checked.sample(&config(), pressure(3.0), None);
        assert_eq!(output, Output::OFF);
        assert_eq!(telemetry.control_signal.to_bits(), 0);
        let is_found = telemetry.faults.contains(Fault::SensorMissing);
        assert_eq!(is_found, sample >= 5, "{sample}");
    }
}

#[test]
fn a_code_that_is_stuck_while_a_valve_is_driven_is_a_fault_after_fifty() {
    let mut checked = CheckedLoop::NEW;
    let found = (0..100).find(|_| {
        let (_, telemetry) = checked.sample(&config(), pressure(3.0), Some(code(1.0)));
        telemetry.faults.contains(Fault::SensorStuck)
    });
    assert_eq!(found, Some(50));
}

#[test]
fn a_configuration_with_other_mechanisms_is_refused() {
    assert!(CheckedLoopConfig::<Thesis>::new(&bench()).is_err());
    let text = format!("{:?}", config());
    assert!(
        text.contains("controller") && text.contains("limits"),
        "{text}"
    );
}
