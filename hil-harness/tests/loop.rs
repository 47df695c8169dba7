//! Complete loop: repeatable bits, checks that detect violations, requirements met on many rigs.

use controller::fixed::types::I16F16;
use controller::{Distributor, Settings};
use ecu::EcuSettings;
use hil_harness::checks::{CheckId, StepResponse};
use hil_harness::link::{LastWords, LinkError};
use hil_harness::requirement::BothValves;
use hil_harness::scenario::{FIGURE_ORIFICE_M, with_orifices};
use hil_harness::wire::FULL_DUTY;
use hil_harness::{
    Actuators, Answer, DeviceUnderTest, DutError, InProcess, ReferenceProfile, Requirement,
    RunError, Scenario, Sensors, Telemetry, controller_file, judge, rigs, run, run_in_process,
    scattered,
};
use hil_protocol::STATE_WORDS;
use proptest::prelude::*;
use recording::csv;

const REQUIREMENT: Requirement = Requirement::THESIS;

/// Seed of rigs on which the recommended controller was not tuned; those came from seed 1.
const FRESH_SEED: u64 = 2026;

fn short_scenario() -> Scenario {
    Scenario::new(
        "short",
        ReferenceProfile::starting_at(0.0)
            .step_to(3.0)
            .hold_ms(1000)
            .step_to(2.0)
            .hold_ms(1000),
    )
}

#[test]
fn the_same_scenario_gives_the_same_bits_and_another_seed_does_not() {
    let first = run_in_process(&short_scenario()).unwrap();
    assert_eq!(first, run_in_process(&short_scenario()).unwrap());
    assert_ne!(
        first.exchanges,
        run_in_process(&short_scenario().seeded(2))
            .unwrap()
            .exchanges
    );
}

/// The first run is stopped while the boost is active; nothing of it may affect the second one.
#[test]
fn a_device_that_has_run_before_starts_from_power_on_again() {
    let scenario = Scenario::new("one bar", ReferenceProfile::starting_at(1.0).hold_ms(500));
    let mut used = InProcess::new();
    let cut_off = Scenario {
        duration_samples: 4,
        ..scenario.clone()
    };
    run(&cut_off, &mut used).unwrap();
    assert_eq!(
        run(&scenario, &mut used).unwrap(),
        run_in_process(&scenario).unwrap()
    );
}

#[test]
fn currents_and_positions_are_logged_under_their_valve() {
    for (duty_fill, duty_vent, expected) in [
        (FULL_DUTY, 0, [292.0, 0.0, 0.5, 0.0]),
        (0, FULL_DUTY, [0.0, 292.0, 0.0, 0.5]),
    ] {
        let mut open = Puppet(|_| Actuators {
            duty_fill,
            duty_vent,
        });
        let recording = run(&short_scenario(), &mut open).unwrap().recording;
        let names = ["i_fill", "i_vent", "x_fill", "x_vent"];
        let found = names.map(|name| {
            *recording
                .signal(name)
                .unwrap()
                .values_or_nan()
                .last()
                .unwrap()
        });
        for (found, expected) in found.iter().zip(expected) {
            assert!(
                (found - expected).abs() < 0.1,
                "{found} instead of {expected}"
            );
        }
    }
}

#[test]
fn a_run_logs_the_signals_of_a_bench_log_and_more_on_the_sample_grid() {
    let scenario = short_scenario();
    let recording = run_in_process(&scenario).unwrap().recording;
    let names: Vec<&str> = recording
        .signals()
        .iter()
        .map(|signal| signal.name())
        .collect();
    let expected = [
        "p_ref",
        "p_ch",
        "p_ch_measured",
        "duty_fill",
        "duty_vent",
        "u",
        "i_fill",
        "i_vent",
        "x_fill",
        "x_vent",
        "actuations_fill",
        "actuations_vent",
    ];
    assert_eq!(names, expected);
    assert!(
        recording
            .signals()
            .iter()
            .all(|signal| signal.len() == scenario.duration_samples as usize)
    );
    assert_eq!(recording.time_base_of("p_ch").unwrap().times_s()[100], 1.0);
    assert!(
        recording
            .provenance()
            .notes
            .iter()
            .any(|note| note.key == "seed" && note.value == "1")
    );
}

#[test]
fn the_controller_sees_the_chamber_within_noise_and_one_code() {
    let recording = run_in_process(&short_scenario()).unwrap().recording;
    let [truth, seen] =
        ["p_ch", "p_ch_measured"].map(|name| recording.signal(name).unwrap().values_or_nan());
    let errors: Vec<f64> = truth
        .iter()
        .zip(seen)
        .map(|(truth, seen)| seen - truth)
        .collect();
    let rms = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    // 4 mbar of noise and 5.1/√12 mbar of quantisation.
    assert!((rms - 4.26e-3).abs() < 0.6e-3, "{rms} bar rms");
}

#[test]
fn a_shut_valve_is_not_counted_and_an_opened_one_is() {
    let run = run_in_process(&short_scenario()).unwrap();
    let last = |name: &str| {
        *run.recording
            .signal(name)
            .unwrap()
            .values_or_nan()
            .last()
            .unwrap()
    };
    assert!(last("actuations_fill") >= 1.0 && last("actuations_vent") >= 1.0);
    let mut idle = Puppet(|_| Actuators::OFF);
    let still = hil_harness::run(&short_scenario(), &mut idle).unwrap();
    assert_eq!(
        still
            .verdict(&REQUIREMENT)
            .unwrap()
            .actuations
            .map(|a| (a.fill, a.vent)),
        Some((0, 0))
    );
    // A fully energised valve opens once and stays open; lifts before time 0 are not counted.
    let time_0 = short_scenario().lead_in().samples();
    let mut open = Puppet(|sensors: Sensors| Actuators {
        duty_fill: match sensors.sample {
            0..3 => FULL_DUTY,
            sample if sample >= time_0 => FULL_DUTY,
            _ => 0,
        },
        ..Actuators::OFF
    });
    let filled = hil_harness::run(&short_scenario(), &mut open).unwrap();
    assert_eq!(
        filled
            .verdict(&REQUIREMENT)
            .unwrap()
            .actuations
            .map(|a| (a.fill, a.vent)),
        Some((1, 0))
    );
}

/// A result is a recording: written to a file and read back it is judged equally, like a bench log.
#[test]
fn a_run_read_back_from_csv_has_the_same_verdict() {
    let recording = run_in_process(&short_scenario()).unwrap().recording;
    let (time_base, _) = recording.time_bases().next().unwrap();
    let bytes = csv::write(Vec::new(), &recording, time_base, &csv::Decimals::default()).unwrap();
    let source = recording.provenance().source.clone();
    let read_back = csv::read(&source, bytes.as_slice(), &csv::Options::default()).unwrap();
    assert_eq!(
        judge(&read_back, &REQUIREMENT),
        judge(&recording, &REQUIREMENT)
    );
}

#[test]
fn a_reference_from_csv_drives_the_loop() {
    let text = "time_s,p_ref_bar_gauge\n10,0\n10.1,3\n11.1,2\n12,2\n";
    let log = csv::read("R.csv", text.as_bytes(), &csv::Options::default()).unwrap();
    let scenario = Scenario::new(
        "from a file",
        ReferenceProfile::from_recording(&log).unwrap(),
    );
    let steps = run_in_process(&scenario)
        .unwrap()
        .verdict(&REQUIREMENT)
        .unwrap()
        .steps;
    let found: Vec<_> = steps.iter().map(|step| (step.index, step.to_bar)).collect();
    assert_eq!(found, [(10, 3.0), (110, 2.0)]);
}

/// Device with answers defined by the test.
struct Puppet<F>(F);

impl<F: FnMut(Sensors) -> Actuators> DeviceUnderTest for Puppet<F> {
    fn identity(&self) -> String {
        "puppet".to_owned()
    }

    fn start(&mut self, _: &EcuSettings) -> Result<(), DutError> {
        Ok(())
    }

    fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError> {
        Ok(Answer {
            sample: sensors.sample,
            actuators: (self.0)(*sensors),
            telemetry: Telemetry {
                control_signal: 0,
                controller_state: [0; STATE_WORDS],
                mode: 0,
                faults: 0,
                ecu_digest: 0,
            },
        })
    }
}

/// Test of the checks: each cheating controller must fail its own check.
#[test]
fn a_controller_that_cheats_is_found_out() {
    let duty = |percent: u32| percent << 16;
    let scenario = short_scenario();
    let time_0 = scenario.lead_in().samples();
    let started = || {
        let mut device = InProcess::new();
        device.start(&scenario.ecu_settings()).unwrap();
        device
    };
    let (mut honest, mut with_both, mut weak) = (started(), started(), started());
    let answer = |device: &mut InProcess, sensors| device.exchange(&sensors).unwrap().actuators;
    type Cheat<'a> = Box<dyn FnMut(Sensors) -> Actuators + 'a>;
    let cheats: [(Cheat<'_>, Option<CheckId>); 5] = [
        (Box::new(|sensors| answer(&mut honest, sensors)), None),
        (
            Box::new(|_| Actuators {
                duty_fill: duty(60),
                duty_vent: duty(60),
            }),
            Some(CheckId::NeverBothValves),
        ),
        (
            Box::new(
                |sensors| match sensors.sample - time_0.min(sensors.sample) {
                    100 => Actuators {
                        duty_fill: duty(30),
                        duty_vent: duty(30),
                    },
                    _ => answer(&mut with_both, sensors),
                },
            ),
            Some(CheckId::NeverBothValves),
        ),
        (
            Box::new(
                |sensors| match sensors.sample - time_0.min(sensors.sample) {
                    150 => Actuators {
                        duty_vent: duty(5),
                        ..Actuators::OFF
                    },
                    _ => answer(&mut weak, sensors),
                },
            ),
            Some(CheckId::DutyLimits),
        ),
        (Box::new(|_| Actuators::OFF), Some(CheckId::SettlingTime)),
    ];
    for (cheat, expected) in cheats {
        let verdict = run(&scenario, &mut Puppet(cheat))
            .unwrap()
            .verdict(&REQUIREMENT)
            .unwrap();
        assert_eq!(verdict.holds, expected.is_none(), "{verdict}");
        if let Some(id) = expected {
            assert!(!verdict.check(id).unwrap().holds, "{verdict}");
        }
    }
}

#[test]
fn a_device_that_fails_ends_the_run_with_its_name() {
    struct Silent;
    impl DeviceUnderTest for Silent {
        fn identity(&self) -> String {
            "board on the bench".to_owned()
        }
        fn start(&mut self, _: &EcuSettings) -> Result<(), DutError> {
            Ok(())
        }
        fn exchange(&mut self, sensors: &Sensors) -> Result<Answer, DutError> {
            Err(DutError::Link(LinkError::Silent {
                request: format!("sample {}", sensors.sample),
                waited_ms: 100,
                tries: 2,
                said: LastWords(vec!["INFO serving".to_owned()]),
            }))
        }
    }
    let error = run(&short_scenario(), &mut Silent).unwrap_err();
    assert!(matches!(error, RunError::Device { .. }));
    let text = error.to_string();
    assert!(
        text.contains(
            "board on the bench: no reply to sample 0 within 100 ms, though sent 2 times"
        ),
        "{text}"
    );
    assert!(text.ends_with("last words:\n  | INFO serving"), "{text}");
}

fn late_steps(scenario: &Scenario, rigs_count: u32) -> (usize, usize, u32) {
    let steps: Vec<StepResponse> = rigs::verdicts(
        &scenario.clone().seeded(FRESH_SEED),
        &REQUIREMENT,
        rigs_count,
    )
    .flat_map(|rig| rig.unwrap().verdict.steps)
    .filter(|step| step.in_operating_range)
    .collect();
    let settled = |step: &StepResponse| step.settled_samples.unwrap_or(u32::MAX);
    let late = steps
        .iter()
        .filter(|step| settled(step) > REQUIREMENT.t_req_samples)
        .count();
    (late, steps.len(), steps.iter().map(settled).max().unwrap())
}

/// Requirement on the rigs of a series, with a margin of twenty samples on the required orifice.
#[test]
fn the_recommended_controller_reaches_every_operating_reference_in_time_on_200_rigs() {
    for name in ["operating-range", "hold"] {
        let (late, steps, slowest) = late_steps(&Scenario::built_in(name).unwrap(), 200);
        assert!(
            late == 0 && slowest <= 30,
            "{name}: {late} of {steps} steps late, slowest {slowest} samples"
        );
    }
}

#[test]
fn the_recommended_controller_also_keeps_time_on_the_rig_of_the_figures() {
    for name in ["operating-range", "figure-6.5", "figure-6.7"] {
        let scenario = Scenario::built_in(name).unwrap();
        let plant = with_orifices(scenario.plant.clone(), FIGURE_ORIFICE_M);
        let (late, steps, slowest) = late_steps(&scenario.on(plant), 50);
        assert!(
            late == 0 && slowest <= 42,
            "{name}: {late} of {steps} steps late, slowest {slowest} samples"
        );
    }
}

/// A limit cycle of one pulse per dead time would be some ten lifts per second. Before each lift was counted, every rig
/// seemed to be within the limit of 3.
#[test]
fn the_recommended_controller_has_no_limit_cycle_on_any_rig() {
    for name in ["operating-range", "hold"] {
        let scenario = Scenario::built_in(name).unwrap().seeded(FRESH_SEED);
        let mut beyond = 0;
        for rig in rigs::verdicts(&scenario, &REQUIREMENT, 50) {
            let rig = rig.unwrap();
            let check = rig.verdict.check(CheckId::RestActuations).unwrap();
            assert!(
                check.reached.unwrap() <= 4.0,
                "{name}, rig {} (seed {}): {check}",
                rig.rig,
                rig.seed
            );
            beyond += u32::from(!check.holds);
        }
        assert!(beyond <= 1, "{name}: {beyond} of 50 rigs beyond the limit");
    }
}

/// Section 1.4, counted as in table 4.3.
#[test]
fn the_recommended_controller_fills_in_time_on_nearly_every_rig() {
    let scenario = Scenario::built_in("fill-requirement")
        .unwrap()
        .seeded(FRESH_SEED);
    let fills = rigs::verdicts(&scenario, &REQUIREMENT, 200)
        .filter(|rig| {
            rig.as_ref()
                .unwrap()
                .verdict
                .check(CheckId::FillTime)
                .unwrap()
                .holds
        })
        .count();
    assert!(fills >= 190, "{fills} of 200 rigs");
}

/// The limit is 2.5 samples. Table 4.3 has 0.052 T_req for this rig with the valve fully open: 2.6 samples to the level.
#[test]
fn an_open_valve_vents_in_time_to_within_the_tolerance_and_too_late_to_the_level_itself() {
    let mut scenario = Scenario::new(
        "open vent",
        ReferenceProfile::starting_at(0.88 * 8.4)
            .hold_ms(100)
            .step_to(0.71 * 8.4)
            .hold_ms(1500),
    );
    scenario.start_pressure_bar = 0.88 * 8.4;
    let time_0 = scenario.lead_in().samples();
    let mut open = Puppet(|sensors: Sensors| Actuators {
        duty_vent: if sensors.sample < time_0 + 10 {
            0
        } else {
            FULL_DUTY
        },
        ..Actuators::OFF
    });
    let run = run(&scenario, &mut open).unwrap();
    let verdict = run.verdict(&REQUIREMENT).unwrap();
    for (id, expected_samples, holds) in [
        (CheckId::VentTime, 2.40, true),
        (CheckId::VentTimeToLevel, 2.59, false),
    ] {
        let check = verdict.check(id).unwrap();
        let samples = check.reached.unwrap();
        assert!(
            (samples - expected_samples).abs() < 0.02 && check.holds == holds,
            "{check}"
        );
    }
    let dead_time = |with: CheckId, without: CheckId| {
        let reached = |id| verdict.check(id).unwrap().reached.unwrap();
        reached(with) - reached(without)
    };
    let [tolerated, to_level] = [
        dead_time(CheckId::VentTimeWithDeadTime, CheckId::VentTime),
        dead_time(
            CheckId::VentTimeToLevelWithDeadTime,
            CheckId::VentTimeToLevel,
        ),
    ];
    assert!(
        tolerated > 0.5 && (tolerated - to_level).abs() < 0.05,
        "{tolerated} and {to_level} samples of dead time"
    );
}

/// Scheme 2 energises both valves on purpose (section 6.3.2), so Scheme 1's rule is not its rule.
#[test]
fn scheme_2_is_not_judged_by_the_rule_of_scheme_1() {
    let settings = |distributor| Settings {
        distributor,
        ..controller_file::thesis()
    };
    let middle_pct = I16F16::lit("53.5");
    let scheme_2 = Distributor::Scheme2 {
        middle_fill_pct: middle_pct,
        middle_vent_pct: middle_pct,
    };
    let scenario = short_scenario();
    let judged = |distributor, requirement: &Requirement| {
        let scenario = scenario.clone().controlled_by(settings(distributor));
        let run = run_in_process(&scenario).unwrap();
        let verdict = run.verdict(requirement).unwrap();
        let check = verdict.check(CheckId::NeverBothValves);
        (
            check.map(|check| check.holds),
            verdict.not_exercised.contains(&CheckId::NeverBothValves),
        )
    };
    let never = Requirement {
        both_valves: BothValves::Never,
        ..REQUIREMENT
    };
    assert_eq!(judged(scheme_2, &REQUIREMENT), (None, false));
    assert_eq!(judged(scheme_2, &never), (Some(false), false));
    assert_eq!(
        judged(Distributor::Scheme1, &REQUIREMENT),
        (Some(true), false)
    );
}

fn responses_without_noise(scenario: Scenario, controller: Settings) -> Vec<StepResponse> {
    let mut scenario = scenario.controlled_by(controller);
    scenario.sensor_noise_mbar_rms = 0.0;
    run_in_process(&scenario)
        .unwrap()
        .verdict(&REQUIREMENT)
        .unwrap()
        .steps
}

/// Section 6.4.1: 25.5 % in all conditions is slow close to a reference, because it opens the fill valve least at high
/// pressure. Section 7.2 expects the pressure-dependent limit to correct that. Only the limit differs here.
#[test]
fn the_thesis_lower_limit_makes_small_fills_at_high_pressure_slow() {
    let profile = [4.6, 4.9, 5.2, 5.5, 5.8].into_iter().fold(
        ReferenceProfile::starting_at(4.3).hold_ms(500),
        |profile, bar| profile.step_to(bar).hold_ms(2000),
    );
    let mut scenario = Scenario::new("small fills", profile);
    scenario.start_pressure_bar = 4.3;
    let mean_reached = |controller| {
        let steps = responses_without_noise(scenario.clone(), controller);
        let reached = steps
            .iter()
            .map(|step| f64::from(step.reached_samples.unwrap_or(step.held_samples)));
        reached.sum::<f64>() / steps.len() as f64
    };
    let thesis = controller_file::thesis();
    let mended = Settings {
        duty_min: controller_file::recommended().duty_min,
        ..thesis
    };
    let (slow, fast) = (mean_reached(thesis), mean_reached(mended));
    assert!(
        slow > 2.0 * fast,
        "25.5 % everywhere: {slow} samples, by pressure: {fast} samples"
    );
}

/// Section 6.4.1: "works fairly well, but with some overshoots".
#[test]
fn the_thesis_controller_overshoots_more_than_the_recommended_one() {
    let scenario = Scenario::built_in("operating-range").unwrap();
    let mean_overshoot = |controller| {
        let steps = responses_without_noise(scenario.clone(), controller);
        steps.iter().map(|step| step.overshoot_bar).sum::<f64>() / steps.len() as f64
    };
    let thesis = mean_overshoot(controller_file::thesis());
    let recommended = mean_overshoot(controller_file::recommended());
    assert!(
        thesis > 1.4 * recommended,
        "thesis {thesis} bar, recommended {recommended} bar"
    );
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn scheme_1_never_energises_both_valves_whatever_the_reference_and_the_rig(
        levels in prop::collection::vec((-1.0..12.0_f64, 0_u32..400, any::<bool>()), 1..12),
        seed in any::<u64>(),
        noise in 0.0..100.0_f64,
        is_thesis in any::<bool>(),
    ) {
        let profile = levels.iter().fold(ReferenceProfile::starting_at(0.0), |profile, &(bar, ms, is_ramp)| {
            if is_ramp { profile.ramp_to(bar, ms) } else { profile.step_to(bar).hold_ms(ms) }
        });
        let mut scenario = Scenario::new("random", profile).seeded(seed);
        scenario.sensor_noise_mbar_rms = noise;
        if is_thesis {
            scenario.controller = controller_file::thesis();
        }
        let plant = scattered(&scenario.plant, seed).unwrap();
        let run = run_in_process(&scenario.on_rig(plant)).unwrap();
        for exchange in &run.exchanges {
            let Actuators { duty_fill, duty_vent } = exchange.answer.actuators;
            prop_assert!(duty_fill == 0 || duty_vent == 0, "{:?}", exchange);
        }
        let recording = &run.recording;
        let pressures = recording.signal("p_ch").unwrap().values_or_nan();
        prop_assert!(pressures.iter().all(|p| (-1e-3..8.6).contains(p)), "the chamber stays between drain and supply");
    }
}
