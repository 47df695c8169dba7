//! Behaviour of each mechanism of chapter 6, in a small scenario each.

use controller::fixed::types::I16F16;
use controller::{
    Activity, AntiWindup, Boost, ControlSignal, Input, IntegralAtReference, Output, Prediction,
    PredictionBasis, Pressure, Saturation, Settings, State, SwitchOff, step, step_traced,
};

use crate::support::{assert_close, bar, bare, config, input, lit, percent, run};

// ---- equation 6.2 ----

#[test]
fn the_pid_is_equation_6_2() {
    let settings = Settings {
        gain_pct_per_bar: lit("10"),
        derivative_time_ms: Some(lit("20")),
        integral_time_ms: Some(lit("500")),
        ..bare()
    };
    let samples = run(
        &settings,
        &[("3", "2"), ("3", "2.5"), ("3", "2.25"), ("3", "3.5")],
    );
    // e = 1, 0.5, 0.75, -0.5; K (e + 2 Δe + Σe/50)
    for ((_, trace, _), expected) in samples.iter().zip([
        10.0 * (1.0 + 0.0 + 1.0 / 50.0),
        10.0 * (0.5 - 1.0 + 1.5 / 50.0),
        10.0 * (0.75 + 0.5 + 2.25 / 50.0),
        10.0 * (-0.5 - 2.5 + 1.75 / 50.0),
    ]) {
        assert_close(trace.u, expected);
    }
}

#[test]
fn without_its_times_the_pid_is_p_pi_or_pd() {
    let inputs = [("3", "2"), ("3", "2.5")];
    let last = |settings: &Settings| run(settings, &inputs)[1].1.u;
    assert_close(last(&bare()), 20.0);
    assert_close(
        last(&Settings {
            integral_time_ms: Some(lit("400")),
            ..bare()
        }),
        40.0 * (0.5 + 1.5 / 40.0),
    );
    assert_close(
        last(&Settings {
            derivative_time_ms: Some(lit("5")),
            ..bare()
        }),
        40.0 * (0.5 - 0.25),
    );
}

#[test]
fn a_sample_time_twice_as_long_halves_the_derivative_and_doubles_the_integral() {
    let settings = Settings {
        derivative_time_ms: Some(lit("10")),
        integral_time_ms: Some(lit("1000")),
        ..bare()
    };
    let slow = Settings {
        sample_time_ms: lit("20"),
        ..settings
    };
    let inputs = [("3", "2"), ("3", "2.5")];
    let (fast, slow) = (run(&settings, &inputs)[1].1, run(&slow, &inputs)[1].1);
    assert_close(slow.derivative, percent(fast.derivative) / 2.0);
    assert_close(slow.integral, percent(fast.integral) * 2.0);
}

// ---- deadband, 6.3.1 ----

#[test]
fn the_tolerance_is_strict() {
    let settings = Settings {
        tolerance_bar: lit("0.125"),
        ..bare()
    };
    let config = config(&settings);
    let activity = |error: Pressure| {
        let sample = Input {
            reference: error,
            pressure: Pressure::ZERO,
        };
        step_traced(&config, &mut State::new(sample), sample)
            .1
            .activity
    };
    let unit = Pressure::from_bits(1);
    assert_eq!(activity(bar("0.125")), Activity::Controlling);
    assert_eq!(
        activity(bar("0.125").saturating_sub(unit)),
        Activity::InsideTolerance
    );
    assert_eq!(activity(bar("-0.125")), Activity::Controlling);
    assert_eq!(
        activity(bar("-0.125").saturating_add(unit)),
        Activity::InsideTolerance
    );
}

#[test]
fn leaving_the_tolerance_gives_no_derivative_kick() {
    let settings = Settings {
        tolerance_bar: lit("0.125"),
        derivative_time_ms: Some(lit("10")),
        ..bare()
    };
    let samples = run(&settings, &[("3", "2"), ("3", "2.9375"), ("3", "2.75")]);
    assert_eq!(samples[1].1.activity, Activity::InsideTolerance);
    // From 0.0625 to 0.25 bar, not from 1 to 0.25.
    assert_close(samples[2].1.derivative, 7.5);
}

/// The pressure is 5 bar and is vented towards 0 bar; then the reference becomes 3 bar. Equation 6.2 would open the
/// fill valve.
#[test]
fn a_reference_that_jumps_towards_the_pressure_makes_the_derivative_part_fill_only_where_it_sees_the_jump()
 {
    let derivative = |prediction_basis, inputs: &[(&str, &str)]| {
        let settings = Settings {
            derivative_time_ms: Some(lit("10")),
            prediction_basis,
            ..bare()
        };
        run(&settings, inputs)[1].1.derivative
    };
    let (error, pressure) = (PredictionBasis::Error, PredictionBasis::Pressure);
    let towards = [("0", "5"), ("3", "5")];
    assert_close(derivative(error, &towards), 120.0);
    assert_close(derivative(pressure, &towards), 0.0);
    // A change of the pressure itself still counts.
    let falling = [("0", "5"), ("3", "4.5")];
    assert_close(derivative(error, &falling), 140.0);
    assert_close(derivative(pressure, &falling), 20.0);
    // A jump of the reference away from the pressure still counts, in both directions.
    for (inputs, expected) in [
        ([("3", "5"), ("1", "5")], -80.0),
        ([("3", "2"), ("5", "2")], 80.0),
    ] {
        assert_close(derivative(error, &inputs), expected);
        assert_close(derivative(pressure, &inputs), expected);
    }
}

#[test]
fn the_integral_part_is_held_or_cleared_at_the_reference_as_chosen() {
    let hold = Settings {
        tolerance_bar: lit("0.125"),
        integral_time_ms: Some(lit("400")),
        ..bare()
    };
    let clear = Settings {
        integral_at_reference: IntegralAtReference::Clear,
        ..hold
    };
    let inputs = [("3", "2"), ("3", "2.95"), ("3", "2.5"), ("3", "3.5")];
    let integrals = |settings| {
        run(settings, &inputs)
            .iter()
            .map(|sample| percent(sample.2.integral()))
            .collect::<Vec<_>>()
    };
    // K T_s/T_i = 1 % per bar and sample: 1, frozen inside, 1 + 0.5, 1.5 - 0.5
    assert_eq!(integrals(&hold), [1.0, 1.0, 1.5, 1.0]);
    // 1, cleared inside, 0.5, cleared by the change of sign and then -0.5
    assert_eq!(integrals(&clear), [1.0, 0.0, 0.5, -0.5]);
}

// ---- prediction, 6.5.2 ----

const PREDICTING: Settings = Settings {
    tolerance_bar: I16F16::lit("0.1"),
    prediction: Prediction::TwoStep,
    integral_time_ms: None,
    derivative_time_ms: None,
    boost: None,
    ..Settings::thesis()
};

/// Figure 6.8: for an error that rises from -0.5 bar by 0.13 bar per sample the valves are switched off before the
/// error is inside the deadband, one sample earlier for each step of prediction.
#[test]
fn the_valves_are_switched_off_one_sample_earlier_per_predicted_step() {
    let inputs = [
        ("3", "3.5"),
        ("3", "3.37"),
        ("3", "3.24"),
        ("3", "3.11"),
        ("3", "2.98"),
    ];
    let off_from = |prediction| {
        run(
            &Settings {
                prediction,
                ..PREDICTING
            },
            &inputs,
        )
        .iter()
        .position(|sample| sample.0 == Output::OFF)
    };
    assert_eq!(off_from(Prediction::Off), Some(4));
    assert_eq!(off_from(Prediction::OneStep), Some(3));
    assert_eq!(off_from(Prediction::TwoStep), Some(2));
}

#[test]
fn the_pid_acts_on_the_actual_error_until_the_prediction_switches_off() {
    let samples = run(&PREDICTING, &[("3", "4"), ("3", "3.9")]);
    assert_eq!(samples[1].1.activity, Activity::Controlling);
    assert_close(samples[1].1.u, -40.0 * 0.9);
}

/// The thesis predicts the error including the reference: a jump by a third of the error looks like a pressure close to
/// the reference.
#[test]
fn a_reference_jump_can_switch_off_wrongly_for_one_sample_where_the_error_is_predicted() {
    let inputs = [("5", "2"), ("4", "2"), ("4", "2")];
    let activities = |prediction, prediction_basis, inputs: &[(&str, &str)]| {
        let settings = Settings {
            prediction,
            prediction_basis,
            ..PREDICTING
        };
        run(&settings, inputs)
            .iter()
            .map(|sample| sample.1.activity)
            .collect::<Vec<_>>()
    };
    let (on, off) = (Activity::Controlling, Activity::SwitchedOffAhead);
    assert_eq!(
        activities(Prediction::TwoStep, PredictionBasis::Error, &inputs),
        [on, off, on]
    );
    assert_eq!(
        activities(Prediction::TwoStep, PredictionBasis::Pressure, &inputs),
        [on, on, on]
    );
    // One step: by half of the error.
    let inputs = [("5", "2"), ("3.5", "2"), ("3.5", "2")];
    assert_eq!(
        activities(Prediction::OneStep, PredictionBasis::Error, &inputs),
        [on, off, on]
    );
    assert_eq!(
        activities(Prediction::OneStep, PredictionBasis::Pressure, &inputs),
        [on, on, on]
    );
}

#[test]
fn the_account_shows_the_error_and_where_it_is_predicted() {
    let samples = run(&PREDICTING, &[("3", "5"), ("3", "4.75")]);
    assert_eq!(samples[1].1.error, bar("-1.75"));
    assert_eq!(samples[1].1.predicted_error, bar("-1.25"));
    let off = run(&PREDICTING, &[("3", "2.9375")]);
    assert_eq!(off[0].1.activity, Activity::InsideTolerance);
    assert_eq!(off[0].1.error, bar("0.0625"));
}

/// A predicted error beyond the reference, exactly at the far edge of the deadband, is not inside.
#[test]
fn the_tolerance_is_strict_on_the_far_side_of_the_prediction_too() {
    let settings = Settings {
        tolerance_bar: lit("0.125"),
        prediction: Prediction::OneStep,
        switch_off: SwitchOff::InsideTolerance,
        ..PREDICTING
    };
    let activity = |to: &str| run(&settings, &[("3", "2.375"), ("3", to)])[1].1.activity;
    // 0.25 bar, after a change by 0.375 bar: -0.125 bar.
    assert_eq!(activity("2.75"), Activity::Controlling);
    assert_eq!(activity("2.749"), Activity::SwitchedOffAhead);
}

#[test]
fn a_control_signal_of_exactly_100_percent_is_not_cut() {
    let settings = Settings {
        gain_pct_per_bar: lit("6.5"),
        ..bare()
    };
    let config = config(&settings);
    let trace = |reference: Pressure, pressure: Pressure| {
        let sample = Input {
            reference,
            pressure,
        };
        step_traced(&config, &mut State::new(sample), sample).1
    };
    let far = |units| bar("15.3845").saturating_add(Pressure::from_bits(units));
    for (end, beyond) in [
        (ControlSignal::MAX, Saturation::High),
        (ControlSignal::MIN, Saturation::Low),
    ] {
        let at = |units| match beyond {
            Saturation::High => trace(far(units), Pressure::ZERO),
            _ => trace(Pressure::ZERO, far(units)),
        };
        // 100 % lies within these errors, for which u changes by hardly more than its last bit.
        let exact = (0..64).map(at).find(|trace| trace.u_unsaturated == end);
        assert_eq!(exact.map(|trace| trace.saturation), Some(Saturation::None));
        assert_eq!(at(64).saturation, beyond);
    }
}

#[test]
fn a_reference_jump_from_rest_switches_nothing_off() {
    for jump in ["3.2", "2.8", "8", "0"] {
        let samples = run(&PREDICTING, &[("3", "3"), (jump, "3")]);
        assert_eq!(
            samples[1].1.activity,
            Activity::Controlling,
            "to {jump} bar"
        );
    }
}

/// 0.44 bar per sample, as an orifice of 1.9 mm fills 75 cm³: the predicted error jumps over the deadband.
#[test]
fn a_pressure_that_is_predicted_past_the_tolerance_is_switched_off_only_beyond() {
    let inputs = [("3", "2.1"), ("3", "2.54")];
    let activity = |switch_off| {
        run(
            &Settings {
                switch_off,
                ..PREDICTING
            },
            &inputs,
        )[1]
        .1
        .activity
    };
    assert_eq!(activity(SwitchOff::InsideTolerance), Activity::Controlling);
    assert_eq!(
        activity(SwitchOff::InsideOrBeyond),
        Activity::SwitchedOffAhead
    );
}

// ---- anti-windup, 6.5.1 ----

const WINDING: Settings = Settings {
    gain_pct_per_bar: I16F16::lit("40"),
    integral_time_ms: Some(I16F16::lit("400")),
    derivative_time_ms: None,
    tolerance_bar: I16F16::lit("0"),
    prediction: Prediction::Off,
    boost: None,
    integral_max_pct: I16F16::lit("1000"),
    ..Settings::thesis()
};

/// Example of the thesis: fully open for a second without reaching the reference, then the reference falls below the
/// pressure.
#[test]
fn only_without_anti_windup_the_valve_stays_open_after_the_reference_fell() {
    let samples_until_venting = |anti_windup| {
        let config = config(&Settings {
            anti_windup,
            ..WINDING
        });
        let mut state = State::new(input("8", "2"));
        for _ in 0..100 {
            let (_, trace) = step_traced(&config, &mut state, input("8", "2"));
            assert_eq!(trace.saturation, Saturation::High);
        }
        (0..1000).find(|_| {
            !step(&config, &mut state, input("1", "2"))
                .duty_vent
                .is_off()
        })
    };
    assert_eq!(
        samples_until_venting(AntiWindup::ConditionalIntegration),
        Some(0)
    );
    assert_eq!(
        samples_until_venting(AntiWindup::BackCalculation {
            tracking_time_ms: lit("100")
        }),
        Some(0)
    );
    assert!(samples_until_venting(AntiWindup::Off).is_some_and(|samples| samples > 100));
}

#[test]
fn conditional_integration_freezes_while_saturated_and_resumes_when_the_error_turns() {
    let settings = Settings {
        anti_windup: AntiWindup::ConditionalIntegration,
        ..WINDING
    };
    // 1.5 bar: u = 60 %; 6 bar: saturated; 1.5 bar again.
    let samples = run(
        &settings,
        &[
            ("3.5", "2"),
            ("8", "2"),
            ("8", "2"),
            ("3.5", "2"),
            ("1", "2"),
        ],
    );
    let integrals: Vec<f64> = samples
        .iter()
        .map(|sample| percent(sample.2.integral()))
        .collect();
    assert_eq!(integrals, [1.5, 1.5, 1.5, 3.0, 2.0]);
    let integrating: Vec<bool> = samples.iter().map(|sample| sample.1.integrating).collect();
    assert_eq!(integrating, [true, false, false, true, true]);
}

#[test]
fn back_calculation_draws_the_integral_part_by_the_share_of_what_was_cut_off() {
    let settings = Settings {
        anti_windup: AntiWindup::BackCalculation {
            tracking_time_ms: lit("40"),
        },
        ..WINDING
    };
    let samples = run(&settings, &[("8", "2"), ("8", "2")]);
    // u₀ = 240 + 6; a quarter of the 146 % cut off: 6 - 36.5. Then u₀ = 240 - 30.5 + 6, and a quarter of 115.5.
    assert_close(samples[0].1.u_unsaturated, 246.0);
    assert_close(samples[0].2.integral(), -30.5);
    assert_close(samples[1].1.u_unsaturated, 215.5);
    assert_close(samples[1].2.integral(), -24.5 - 115.5 / 4.0);
}

/// A derivative part can drive u to the end opposite to the error.
#[test]
fn back_calculation_draws_at_both_ends_and_says_that_the_error_was_not_summed() {
    let settings = Settings {
        anti_windup: AntiWindup::BackCalculation {
            tracking_time_ms: lit("40"),
        },
        derivative_time_ms: Some(lit("10")),
        ..WINDING
    };
    let samples = run(&settings, &[("8", "2"), ("3", "2"), ("3", "2")]);
    // u₀ = 40 - 200 - 30.5 + 1, and a quarter of the -89.5 % cut off; then u₀ = 40 - 7.125 + 1.
    assert_close(samples[1].1.u_unsaturated, -189.5);
    assert_close(samples[1].2.integral(), -29.5 + 89.5 / 4.0);
    assert_close(samples[2].1.u_unsaturated, 33.875);
    let account = samples
        .iter()
        .map(|sample| (sample.1.saturation, sample.1.integrating));
    assert_eq!(
        account.collect::<Vec<_>>(),
        [
            (Saturation::High, false),
            (Saturation::Low, false),
            (Saturation::None, true)
        ]
    );
}

// ---- boost, 6.5.3 ----

const BOOSTING: Settings = Settings {
    tolerance_bar: I16F16::lit("0.125"),
    prediction: Prediction::Off,
    integral_time_ms: None,
    derivative_time_ms: None,
    boost: Some(Boost {
        // 10 % per bar and sample.
        rate_pct_per_bar_s: I16F16::lit("1000"),
        max_pct: I16F16::lit("20"),
        response_bar: I16F16::lit("0.0625"),
    }),
    ..Settings::thesis()
};

fn boosts(inputs: &[(&str, &str)]) -> Vec<f64> {
    run(&BOOSTING, inputs)
        .iter()
        .map(|sample| percent(sample.2.boost()))
        .collect()
}

#[test]
fn the_boost_runs_only_while_the_pressure_does_not_respond() {
    // Two samples without motion, then two that move by 0.0625 bar or more, one that moves by less, one that moves away.
    let inputs = [
        ("3", "2.5"),
        ("3", "2.5"),
        ("3", "2.5625"),
        ("3", "2.75"),
        ("3", "2.7625"),
        ("3", "2.5"),
    ];
    let boosts = boosts(&inputs);
    assert_eq!(boosts[..4], [5.0, 10.0, 10.0, 10.0]);
    assert!((boosts[4] - 12.375).abs() < 0.001);
    assert!((boosts[5] - 17.375).abs() < 0.001);
}

#[test]
fn the_boost_is_bounded_and_runs_to_either_side() {
    assert_eq!(
        boosts(&[("3", "2"), ("3", "2"), ("3", "2"), ("3", "2")]),
        [10.0, 20.0, 20.0, 20.0]
    );
    assert_eq!(
        boosts(&[("2", "3"), ("2", "3"), ("2", "3"), ("2", "3")]),
        [-10.0, -20.0, -20.0, -20.0]
    );
}

#[test]
fn the_boost_is_cleared_inside_the_tolerance_and_when_the_error_changes_its_sign() {
    assert_eq!(
        boosts(&[("3", "2.5"), ("3", "2.95"), ("3", "2.75"), ("3", "2.75")]),
        [5.0, 0.0, 2.5, 5.0]
    );
    // From 0.5 bar below to 0.5 bar above within a sample: cleared, and 0.5 bar to the other side.
    assert_eq!(boosts(&[("3", "2.5"), ("3", "3.5")]), [5.0, -5.0]);
}

#[test]
fn the_boost_does_not_run_while_the_control_signal_is_saturated() {
    assert_eq!(boosts(&[("8", "2"), ("8", "2")]), [0.0, 0.0]);
}

/// Purpose of the boost: after an early switch-off the pressure stops outside the deadband, and the duty cycle is too
/// small to open the valve.
#[test]
fn the_boost_lifts_the_duty_cycle_until_the_valve_opens() {
    let config = config(&BOOSTING);
    let mut state = State::new(input("7", "6.8"));
    let opened = (0..100).find(|_| {
        step(&config, &mut state, input("7", "6.8"))
            .duty_fill
            .percent()
            > lit("40")
    });
    // 25.5 + (8 + 2 n) 0.565 > 40
    assert_eq!(opened, Some(8));
}

#[test]
fn without_boost_a_pressure_that_does_not_respond_changes_nothing() {
    for (_, trace, state) in run(&bare(), &[("7", "6.8"), ("7", "6.8"), ("7", "6.7")]) {
        assert_eq!(
            (state.boost(), trace.boosting),
            (ControlSignal::ZERO, false)
        );
    }
}

/// 50 % of P and 50 % of boost give 100 %, which is not saturated.
#[test]
fn exactly_100_percent_is_not_saturated() {
    let settings = Settings {
        gain_pct_per_bar: lit("50"),
        boost: Some(Boost {
            rate_pct_per_bar_s: lit("5000"),
            max_pct: lit("60"),
            response_bar: lit("0.0625"),
        }),
        ..BOOSTING
    };
    let (_, trace, state) = run(&settings, &[("3", "2")])[0];
    assert_eq!(trace.u_unsaturated, ControlSignal::MAX);
    assert_eq!(trace.saturation, Saturation::None);
    assert!(trace.boosting);
    assert_close(state.boost(), 50.0);
}
