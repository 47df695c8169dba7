//! Effects of the library act in the closed loop as in the simulator.

use ecu::EcuSettings;
use hil_harness::checks::CheckId;
use hil_harness::wire::FULL_DUTY;
use hil_harness::{
    Actuators, Answer, DeviceUnderTest, DutError, Exchange, ReferenceProfile, Requirement, Run,
    Scenario, Sensors, Verdict, run, run_in_process,
};
use plant_sim::PlantParameters;
use plant_sim::effects::{EffectSetting, LIBRARY, by_id};
use plant_sim::replay::ACTUATOR_POSITION;

/// Returns fillings, rests and ventings, with small steps at both ends of the pressure range.
fn scenario() -> Scenario {
    let profile = [3.0, 5.5, 5.8, 5.5, 2.0, 1.7]
        .into_iter()
        .fold(ReferenceProfile::starting_at(0.0), |profile, bar| {
            profile.step_to(bar).hold_ms(1000)
        });
    Scenario::new("effects", profile)
}

fn run_with(effect: Option<EffectSetting>) -> Run {
    let plant = match effect {
        Some(setting) => PlantParameters::nominal().with_effect(setting),
        None => PlantParameters::nominal(),
    };
    // The settings of the ECU stay those of the kind of rig.
    run_in_process(&scenario().on_rig(plant)).unwrap()
}

fn verdict(run: &Run) -> Verdict {
    run.verdict(&Requirement::THESIS).unwrap()
}

/// Device that repeats the answers of an earlier run, whatever it reads, and then keeps both valves fully energised,
/// which warms the coils.
struct Repeated {
    repeated: std::vec::IntoIter<Exchange>,
    last: Answer,
}

impl DeviceUnderTest for Repeated {
    fn identity(&self) -> String {
        "repeated".to_owned()
    }

    fn start(&mut self, _: &EcuSettings) -> Result<(), DutError> {
        Ok(())
    }

    fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError> {
        let repeated = self.repeated.next().map(|exchange| exchange.answer);
        self.last = repeated.unwrap_or(Answer {
            sample: sensors.sample,
            actuators: Actuators {
                duty_fill: FULL_DUTY,
                duty_vent: FULL_DUTY,
            },
            ..self.last
        });
        Ok(self.last)
    }
}

/// Returns the inputs of the ECU in the run `plain`, but on `plant`: the duty cycles are those of `plain`, so that a
/// difference comes from the plant alone and does not grow from a single code by the loop.
fn inputs(plain: &Run, plant: PlantParameters) -> Vec<Sensors> {
    let mut scenario = scenario().on_rig(plant);
    scenario.sensor_noise_mbar_rms = 0.0;
    scenario.duration_samples += ENERGISED_SAMPLES;
    let mut device = Repeated {
        repeated: plain.exchanges.clone().into_iter(),
        last: plain.exchanges[0].answer,
    };
    let exchanges = run(&scenario, &mut device).unwrap().exchanges;
    exchanges.iter().map(|exchange| exchange.sensors).collect()
}

/// Time for which both valves are energised in the end (samples): coils warm slowly.
const ENERGISED_SAMPLES: u32 = 6000;

/// Largest difference of an input that the accuracy of the simulator explains: one code of the pressure, 1 mA.
const NUMERICAL: u16 = 1;

/// Defect seen: `control` ignored a lag, a hysteresis and an offset of the sensor.
#[test]
fn every_effect_of_the_library_changes_what_the_ecu_reads() {
    let run = run_with(None);
    let nominal = PlantParameters::nominal();
    let plain = inputs(&run, nominal.clone());
    // An effect of on/off valves does not act on this plant, and an actuator rests in the loop.
    let settings = LIBRARY.iter().flat_map(|effect| nominal.forms_of(*effect));
    let settings = settings.filter(|setting| setting.driven_by() != Some(ACTUATOR_POSITION));
    for setting in settings {
        let with = inputs(&run, nominal.with_effect(setting.clone()));
        let is_different = |(plain, with): (&Sensors, &Sensors)| {
            let values = |sensors: &Sensors| {
                [
                    sensors.pressure,
                    sensors.current_fill_ma,
                    sensors.current_vent_ma,
                ]
            };
            let mut pairs = values(plain).into_iter().zip(values(with));
            pairs.any(|(plain, with)| plain.unwrap().abs_diff(with.unwrap()) > NUMERICAL)
        };
        let different = plain
            .iter()
            .zip(&with)
            .filter(|&pair| is_different(pair))
            .count();
        assert!(
            different >= 10,
            "{}, {}: {different} of {} samples differ",
            setting.id(),
            setting.variant().name,
            plain.len()
        );
    }
}

/// Returns a typical effect of the library with another value.
fn effect(id: &str, key: &str, value: f64) -> EffectSetting {
    EffectSetting::typical(by_id(id).unwrap()).with(key, value)
}

/// The loop brings the measured pressure to the reference. Defect seen: with an offset of 0.5 bar the loop passed.
#[test]
fn an_offset_of_the_sensor_fails_by_the_true_pressure_and_is_shown_apart() {
    let plain = verdict(&run_with(None));
    assert!(
        plain.holds && plain.sensor_error.unwrap().mean_bar.abs() < 1e-3,
        "{plain}"
    );
    let shifted = verdict(&run_with(Some(effect("sensor_offset", "offset_bar", 0.5))));
    let error = shifted.sensor_error.unwrap();
    assert!(
        (error.mean_bar - 0.5).abs() < 2e-3 && (error.rms_bar - 0.5).abs() < 2e-3,
        "{error:?}"
    );
    let steady = shifted
        .check(CheckId::SteadyError)
        .unwrap()
        .reached
        .unwrap();
    assert!(!shifted.holds && (steady - 0.5).abs() < 0.12, "{shifted}");
}

/// A slow sensor shows the chamber too late, so the true pressure overshoots.
#[test]
fn a_lag_of_the_sensor_makes_the_true_pressure_overshoot() {
    let overshoot = |run: &Run| {
        verdict(run)
            .check(CheckId::Overshoot)
            .unwrap()
            .reached
            .unwrap()
    };
    let plain = overshoot(&run_with(None));
    let slow = overshoot(&run_with(Some(effect(
        "sensor_lag",
        "time_constant_s",
        0.02,
    ))));
    assert!(
        slow > plain + 0.1,
        "{plain} bar without the lag, {slow} bar with it"
    );
}

/// The mean of the sensor's error is zero, its largest value is half of the width and a little noise.
#[test]
fn a_hysteresis_of_the_sensor_is_in_its_error() {
    let error = verdict(&run_with(Some(effect(
        "sensor_hysteresis",
        "hysteresis_bar",
        0.2,
    ))))
    .sensor_error
    .unwrap();
    assert!(
        error.largest_bar > 0.1 && error.largest_bar < 0.13,
        "{error:?}"
    );
}
