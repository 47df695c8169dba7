//! Closed loops on rigs of other kinds: valves without coils, a hose, a second chamber.

use controller::{LowerLimit, Settings};
use hil_harness::duty_limits::with_duty_limits;
use hil_harness::rigs;
use hil_harness::scenario::ScenarioError;
use hil_harness::{
    ReferenceProfile, Requirement, Run, RunError, Scenario, ScenarioWarning, controller_file,
    run_in_process,
};
use plant_sim::PlantParameters;

/// Data sheet of a pair of on/off valves that are commanded once in 20 ms.
const ON_OFF: &str = "
supply_pressure_bar_gauge = 7.2      # gauge, ±0.3
ambient_pressure_bar_abs = 1.013
command_frequency_hz = 50            # exact
chamber_volume_cm3 = 420             # ±15 %
fill_C_dm3_per_s_bar = 0.65          # ±15 %
fill_b = 0.25                        # ±0.1
fill_opening_delay_ms = 8.8          # ±25 %
fill_closing_delay_ms = 8            # ±25 %
fill_opening_ramp_ms = 2.4           # ±1
fill_closing_ramp_ms = 3.2           # ±1
vent_C_dm3_per_s_bar = 1             # ±15 %
vent_b = 0.38                        # ±0.1
vent_opening_delay_ms = 9.7          # ±25 %
vent_closing_delay_ms = 8.3          # ±25 %
vent_opening_ramp_ms = 2.3           # ±1
vent_closing_ramp_ms = 4.1           # ±1
";

/// Data sheet of a pair of proportional valves.
const PROPORTIONAL: &str = "
supply_pressure_bar_gauge = 7.1
ambient_pressure_bar_abs = 1.013
command_frequency_hz = 100
command_delay_ms = 12
chamber_volume_cm3 = 150
fill_valve = \"proportional\"
vent_valve = \"proportional\"
fill_C_dm3_per_s_bar = 0.4
fill_b = 0.3
vent_C_dm3_per_s_bar = 0.4
vent_b = 0.3
fill_time_constant_ms = 8
vent_time_constant_ms = 8
";

/// Lines of a hose that doubles its volume, and of a second chamber behind a line that passes less than the valves.
const HOSE: &str = "hose_growth_cm3_per_bar = 60\n";
const SECOND_CHAMBER: &str =
    "second_volume_cm3 = 460\nline_C_dm3_per_s_bar = 0.25\nline_b = 0.15\n";

fn plant(datasheet: &str, more: &str) -> PlantParameters {
    PlantParameters::from_datasheet(&(datasheet.to_owned() + more), "plate.toml").unwrap()
}

/// Returns a loop with the recommended controller: steps up and down between 1.5 and 5 bar, 2.4 s each.
fn scenario(plant: PlantParameters) -> Scenario {
    let levels = [2.0, 4.0, 3.0, 5.0, 1.5, 4.5];
    let at_rest = ReferenceProfile::starting_at(0.0).hold_ms(1000);
    let profile = levels.into_iter().fold(at_rest, |profile, level| {
        profile.step_to(level).hold_ms(2400)
    });
    Scenario::new("levels", profile).on(plant)
}

fn run(plant: PlantParameters) -> Run {
    run_in_process(&scenario(plant)).unwrap()
}

#[test]
fn on_off_valves_hold_every_level_with_the_recommended_controller() {
    let run = run(plant(ON_OFF, ""));
    let verdict = run.verdict(&Requirement::THESIS).unwrap();
    assert!(verdict.holds, "{verdict}");
    assert_eq!(run.confirmed_faults(), []);
    let unmeasured = |exchange: &hil_harness::wire::Exchange| {
        let sensors = exchange.sensors;
        [
            sensors.current_fill_ma,
            sensors.current_vent_ma,
            sensors.battery_mv,
        ] == [None; 3]
    };
    assert!(
        run.exchanges.iter().all(unmeasured),
        "a valve without a coil has no current"
    );
}

#[test]
fn proportional_valves_hold_every_level_on_scattered_rigs() {
    let scenario = scenario(plant(PROPORTIONAL, ""));
    for rig in rigs::verdicts(&scenario, &Requirement::THESIS, 4) {
        let rig = rig.unwrap();
        assert!(rig.verdict.holds, "{}", rig.verdict);
        assert_eq!((rig.supply_voltage_v, rig.coil_temperature_c), (None, None));
    }
}

/// Defects seen: the rate of the valves was that of a stiff chamber, or of the first chamber alone, and a healthy rig got NoRise or
/// NoFall; the verdict was on the pressure of the first chamber, where no sensor is.
#[test]
fn no_fault_is_confirmed_on_a_hose_or_on_two_chambers() {
    for more in [HOSE, SECOND_CHAMBER] {
        let scenario = scenario(plant(ON_OFF, more));
        for rig in 0..6 {
            let rig = rigs::rig_in_operation(&scenario, rig, Default::default()).unwrap();
            let run = run_in_process(&rig).unwrap();
            assert_eq!(run.confirmed_faults(), [], "{more}");
            let signal = |name: &str| run.recording.signal(name).unwrap().values_or_nan();
            let (judged, measured) = (signal("p_ch"), signal("p_ch_measured"));
            let far = judged.iter().zip(measured.iter());
            let far = far.filter(|(judged, measured)| (*judged - *measured).abs() > 0.05);
            assert_eq!(far.count(), 0, "{more}");
        }
    }
}

/// A command must stand for the opening delay, and a pause for the closing delay.
#[test]
fn duty_limits_of_an_on_off_valve_follow_from_its_delays() {
    let plant = plant(ON_OFF, "");
    let found = with_duty_limits(Settings::recommended(), &plant).unwrap();
    let LowerLimit::PressureDependent { fill, vent } = found.duty_min else {
        panic!("{:?}", found.duty_min)
    };
    for (limit, expected) in [
        (fill.without_pressure_pct, 100.0 * 8.8e-3 * 50.0),
        (fill.with_supply_pressure_pct, 100.0 * 8.8e-3 * 50.0),
        (vent.without_pressure_pct, 100.0 * 9.7e-3 * 50.0),
        (found.duty_max_fill_pct, 100.0 * (1.0 - 8e-3 * 50.0)),
        (found.duty_max_vent_pct, 100.0 * (1.0 - 8.3e-3 * 50.0)),
    ] {
        let limit: f64 = limit.to_num();
        assert!((limit - expected).abs() < 0.1, "{limit} {expected}");
    }
    assert_eq!(found.duty_min, scenario(plant).controller.duty_min);
}

#[test]
fn a_shipped_controller_takes_the_sample_time_of_the_plant_and_an_own_one_does_not() {
    let scenario = scenario(plant(ON_OFF, ""));
    assert_eq!(scenario.controller.sample_time_ms.to_num::<f64>(), 20.0);
    assert_eq!(scenario.controller.compensation, None);
    let own = Settings {
        gain_pct_per_bar: "30".parse().unwrap(),
        ..controller_file::recommended()
    };
    let refused = run_in_process(&scenario.clone().controlled_by(own));
    assert!(
        matches!(
            refused,
            Err(RunError::Scenario(ScenarioError::SampleTimes { .. }))
        ),
        "{:?}",
        refused.err()
    );
    let nominal = scenario.on(PlantParameters::nominal());
    assert_eq!(nominal.controller, controller_file::recommended());
}

#[test]
fn pulses_are_refused_on_valves_whose_opening_times_are_not_in_their_tables() {
    let plant = plant(PROPORTIONAL, "");
    let pulsed = scenario(plant).controlled_by(Settings::pulses());
    assert_eq!(pulsed.check(), Err(ScenarioError::PulsesWithoutCoil));
}

#[test]
fn a_reference_near_the_supply_pressure_is_warned_about() {
    let mut plant = plant(ON_OFF, "");
    assert_eq!(scenario(plant.clone()).warnings(), []);
    plant
        .set("gas.supply_pressure_bar_gauge", 5.1, "test")
        .unwrap();
    let warnings = scenario(plant).warnings();
    let [ScenarioWarning::HighReference { reference_bar, .. }] = warnings[..] else {
        panic!("{warnings:?}")
    };
    assert_eq!(reference_bar, 5.0);
}
