//! State: saving, comparison, restoring, and a start at any pressure without a derivative kick.

use controller::{ControlSignal, Pressure, State, StateError, step, step_traced};
use proptest::prelude::*;

use crate::support::{any_inputs, any_settings, bare, config, input, lit};
use controller::Settings;
use controller::fixed::types::I20F12;

proptest! {
    #[test]
    fn a_restored_state_continues_bit_for_bit((_, config) in any_settings(), inputs in any_inputs(), cut in any::<prop::sample::Index>()) {
        let (first, second) = inputs.split_at(cut.index(inputs.len()));
        let mut state = State::at_rest();
        for &input in first {
            step(&config, &mut state, input);
        }
        let mut restored = State::from_words(state.to_words()).expect("words of a state");
        prop_assert_eq!(restored, state);
        for &input in second {
            prop_assert_eq!(step(&config, &mut restored, input), step(&config, &mut state, input));
        }
        prop_assert_eq!(restored.to_words(), state.to_words());
    }

    #[test]
    fn any_words_are_a_state_or_refused_and_no_state_panics((_, config) in any_settings(), words in any::<[i32; 6]>(), inputs in any_inputs()) {
        if let Ok(mut state) = State::from_words(words) {
            prop_assert_eq!(state.to_words(), words);
            for input in inputs {
                step_traced(&config, &mut state, input);
            }
        }
    }

    #[test]
    fn extreme_states_neither_overflow_nor_panic((_, config) in any_settings(), corner in 0..16_u32, inputs in any_inputs()) {
        let pick = |bit: u32, low: i32, high: i32| if corner >> bit & 1 == 0 { low } else { high };
        let integral = pick(2, -10 << 27, 10 << 27);
        let boost = pick(3, 0, 10 << 20);
        let words = [pick(0, -(1 << 20), (1 << 20) - 1), pick(1, -((1 << 21) - 1), (1 << 21) - 1), 0, integral, 0, boost];
        let mut state = State::from_words(words).expect("the corners of what a state may be");
        for input in inputs {
            step_traced(&config, &mut state, input);
        }
    }
}

#[test]
fn words_beyond_each_bound_are_refused_and_the_bound_itself_is_not() {
    let check = |words: [i32; 6], expected: Option<StateError>| {
        assert_eq!(State::from_words(words).err(), expected, "{words:?}");
    };
    check([(1 << 20) - 1, 0, 0, 0, 0, 0], None);
    check(
        [1 << 20, 0, 0, 0, 0, 0],
        Some(StateError::Pressure { bits: 1 << 20 }),
    );
    check([-(1 << 20), 0, 0, 0, 0, 0], None);
    check(
        [-(1 << 20) - 1, 0, 0, 0, 0, 0],
        Some(StateError::Pressure {
            bits: -(1 << 20) - 1,
        }),
    );
    check([0, (1 << 21) - 1, 0, 0, 0, 0], None);
    check(
        [0, 1 << 21, 0, 0, 0, 0],
        Some(StateError::Error { bits: 1 << 21 }),
    );
    check([0, 1 - (1 << 21), 0, 0, 0, 0], None);
    check(
        [0, -(1 << 21), 0, 0, 0, 0],
        Some(StateError::Error { bits: -(1 << 21) }),
    );
    // 1000 %: 10 in 2⁻⁵⁹ and in 2⁻⁵² of 100 %, lower word first.
    let (integral, boost) = (10_i64 << 59, 10_i64 << 52);
    check([0, 0, 0, 10 << 27, 0, 10 << 20], None);
    check([0, 0, 0, -10 << 27, 0, 0], None);
    // Defect seen: a bound clamps the upper word alone, and a state at its bound was refused.
    check([0, 0, -1, 10 << 27, -1, 10 << 20], None);
    let beyond = 1 << 32;
    check(
        [0, 0, 0, (10 << 27) + 1, 0, 0],
        Some(StateError::Integral {
            bits: integral + beyond,
        }),
    );
    check(
        [0, 0, -1, (-10 << 27) - 1, 0, 0],
        Some(StateError::Integral {
            bits: -integral - 1,
        }),
    );
    check(
        [0, 0, 0, 0, 0, (10 << 20) + 1],
        Some(StateError::Boost {
            bits: boost + beyond,
        }),
    );
    check([0, 0, 0, 0, -1, -1], Some(StateError::Boost { bits: -1 }));
}

#[test]
fn a_refused_state_says_which_words_and_why() {
    let message = |words| State::from_words(words).expect_err("refused").to_string();
    assert_eq!(
        message([1 << 20, 0, 0, 0, 0, 0]),
        "word 0: pressure of 1048576 units of 2^-16 bar is outside the control range of -16 ..< 16 bar"
    );
    assert_eq!(
        message([0, 1 << 21, 0, 0, 0, 0]),
        "word 1: error of 2097152 units of 2^-16 bar is outside -32 ..= 32 bar"
    );
    assert_eq!(
        message([0, 0, 0, (10 << 27) + 1, 0, 0]),
        "words 2 and 3: integral part of 5764607527329202176 units of 2^-59 is outside -10 ..= 10, which is 1000 %"
    );
    assert_eq!(
        message([0, 0, 0, 0, 0, (10 << 20) + 1]),
        "words 4 and 5: boost of 45036000568672256 units of 2^-52 is outside 0 ..= 10, which is 1000 %"
    );
}

/// Goal: no derivative kick at a start under pressure. Method: the same first sample from rest and from `State::new`.
#[test]
fn a_start_under_pressure_gives_no_derivative_kick() {
    let config = config(&Settings {
        derivative_time_ms: Some(lit("20")),
        ..bare()
    });
    let first = input("4", "3");
    let (_, kicked) = step_traced(&config, &mut State::at_rest(), first);
    let (_, smooth) = step_traced(&config, &mut State::new(first), first);
    assert_eq!(
        kicked.derivative.percent(),
        lit("80"),
        "K T_d/T_s times 1 bar"
    );
    assert_eq!(smooth.derivative, ControlSignal::ZERO);
    assert_eq!(smooth.u.percent(), lit("40"));
}

#[test]
fn a_takeover_continues_from_the_control_signal_that_was_applied() {
    let config = config(&Settings {
        integral_time_ms: Some(lit("1000")),
        ..bare()
    });
    for (percent, expected) in [("12.5", "12.5"), ("-30", "-30"), ("100", "100")] {
        let u =
            ControlSignal::saturating_from_percent(percent.parse::<I20F12>().expect("a number"));
        let first = input("4", "3.5");
        let mut state = State::taking_over(&config, first, u);
        let (_, trace) = step_traced(&config, &mut state, first);
        let deviation = trace.u.percent() - expected.parse::<I20F12>().expect("a number");
        assert!(
            deviation.abs() <= I20F12::DELTA,
            "asked for {percent} %, got {}",
            trace.u
        );
    }
}

#[test]
fn a_takeover_of_more_than_the_integral_may_hold_stops_at_its_bound() {
    let settings = Settings {
        integral_time_ms: Some(lit("1000")),
        integral_max_pct: lit("10"),
        ..bare()
    };
    let state = State::taking_over(&config(&settings), input("3", "4"), ControlSignal::MAX);
    assert_eq!(state.integral().percent(), lit("10"));
    let without_integral =
        State::taking_over(&config(&bare()), input("3", "4"), ControlSignal::MAX);
    assert_eq!(without_integral.integral(), ControlSignal::ZERO);
}

#[test]
fn pressures_beyond_the_control_range_are_taken_as_its_ends() {
    let config = config(&Settings::thesis());
    let run = |reference, pressure| {
        let mut state = State::at_rest();
        (
            step(
                &config,
                &mut state,
                controller::Input {
                    reference,
                    pressure,
                },
            ),
            state,
        )
    };
    let (highest, lowest) = (Pressure::from_bits(i32::MAX), Pressure::from_bits(i32::MIN));
    assert_eq!(
        run(highest, lowest),
        run(Pressure::MAX_CONTROL, Pressure::MIN_CONTROL)
    );
    assert_eq!(
        run(lowest, highest),
        run(Pressure::MIN_CONTROL, Pressure::MAX_CONTROL)
    );
}

/// Words 2 to 5 are counted along the error of word 1.
#[test]
fn the_sums_of_a_saved_state_are_along_its_error_and_an_error_of_0_counts_as_up() {
    let parts = |error| {
        let state = State::from_words([0, error, 0, 1 << 27, 0, 1 << 20]).expect("a state");
        (state.integral(), state.boost())
    };
    assert_eq!(parts(1), (ControlSignal::MAX, ControlSignal::MAX));
    assert_eq!(parts(0), (ControlSignal::MAX, ControlSignal::MAX));
    assert_eq!(parts(-1), (ControlSignal::MIN, ControlSignal::MIN));
}

#[test]
fn the_words_of_a_state_are_those_it_was_restored_from() {
    for words in [
        [0; 6],
        [1, -2, 3, 4, 5, 6],
        [-(3 << 16), 5 << 16, -1, -7, -9, 11],
    ] {
        let state = State::from_words(words).expect("a state");
        assert_eq!(state.to_words(), words);
    }
}
