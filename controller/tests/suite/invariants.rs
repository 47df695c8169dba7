//! Invariants for any input and any settings that make a configuration.

use controller::fixed::types::I16F16;
use controller::{
    Activity, AntiWindup, Config, Distributor, Duty, Input, LowerLimit, OpeningDuty, Output,
    Prediction, PredictionBasis, Pressure, Saturation, Settings, State, Trace, step, step_traced,
};
use proptest::prelude::*;

use crate::support::{any_inputs, any_settings, mirrored};

/// Sample of a run: input, state before and after, output.
struct Sample {
    input: Input,
    before: State,
    after: State,
    output: Output,
    trace: Trace,
}

/// Runs the inputs from rest and passes every sample to `check`.
fn check(
    config: &Config,
    inputs: &[Input],
    mut check: impl FnMut(&Sample) -> Result<(), TestCaseError>,
) -> Result<(), TestCaseError> {
    let mut state = State::at_rest();
    for &input in inputs {
        let before = state;
        let (output, trace) = step_traced(config, &mut state, input);
        check(&Sample {
            input,
            before,
            after: state,
            output,
            trace,
        })?;
    }
    Ok(())
}

/// Returns the smallest and largest duty cycle that may open each valve.
fn limits(settings: &Settings) -> [(Duty, Duty); 2] {
    let duty = |percent| Duty::from_percent(percent).expect("checked by Config::new");
    if settings.distributor == Distributor::Traditional {
        return [(Duty::OFF, Duty::FULL); 2];
    }
    let (fill, vent) = match settings.duty_min {
        LowerLimit::Constant { fill_pct, vent_pct } => (fill_pct, vent_pct),
        LowerLimit::PressureDependent { fill, vent } => {
            (fill.with_supply_pressure_pct, vent.with_supply_pressure_pct)
        }
    };
    [
        (duty(fill), duty(settings.duty_max_fill_pct)),
        (duty(vent), duty(settings.duty_max_vent_pct)),
    ]
}

/// Returns |bits| of a pressure, also of the lowest one.
fn magnitude(pressure: Pressure) -> u32 {
    pressure.to_bits().unsigned_abs()
}

/// Returns the integral part in 2⁻⁵⁹ of 100 % along the error, from the words.
fn integral_bits(state: &State) -> i64 {
    let words = state.to_words();
    (i64::from(words[3]) << 32) | i64::from(words[2] as u32)
}

/// Returns the boost in 2⁻⁵² of 100 % along the error, from the words.
fn boost_bits(state: &State) -> i64 {
    let words = state.to_words();
    (i64::from(words[5]) << 32) | i64::from(words[4] as u32)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn one_scheme_never_energises_both_valves((settings, _) in any_settings(), inputs in any_inputs()) {
        for distributor in [Distributor::Traditional, Distributor::Scheme1] {
            let config = Config::new(&Settings { distributor, ..settings }).expect("as valid as before");
            check(&config, &inputs, |sample| {
                prop_assert!(sample.output.duty_fill.is_off() || sample.output.duty_vent.is_off());
                Ok(())
            })?;
        }
    }

    #[test]
    fn a_duty_cycle_is_off_or_within_its_limits((settings, config) in any_settings(), inputs in any_inputs()) {
        let [fill, vent] = limits(&settings);
        check(&config, &inputs, |sample| {
            for (duty, (min, max)) in [(sample.output.duty_fill, fill), (sample.output.duty_vent, vent)] {
                prop_assert!(duty.is_off() || (min..=max).contains(&duty), "{duty} outside {min} ..= {max}");
            }
            Ok(())
        })?;
    }

    #[test]
    fn full_control_signal_gives_exactly_the_upper_limit((settings, config) in any_settings(), inputs in any_inputs()) {
        let [fill, vent] = limits(&settings);
        check(&config, &inputs, |sample| {
            match sample.trace.saturation {
                Saturation::High => prop_assert_eq!(sample.output.duty_fill, fill.1),
                Saturation::Low => prop_assert_eq!(sample.output.duty_vent, vent.1),
                Saturation::None => {}
            }
            Ok(())
        })?;
    }

    #[test]
    fn inside_the_tolerance_both_valves_are_off((settings, config) in any_settings(), inputs in any_inputs()) {
        check(&config, &inputs, |sample| {
            let inside = magnitude(sample.trace.error) < settings.tolerance_bar.to_bits().unsigned_abs()
                || sample.trace.error == Pressure::ZERO;
            prop_assert_eq!(sample.trace.activity == Activity::InsideTolerance, inside);
            if inside {
                prop_assert_eq!(sample.output, Output::OFF);
            }
            Ok(())
        })?;
    }

    #[test]
    fn the_predicted_error_is_equation_6_8_or_6_10_exactly((settings, config) in any_settings(), inputs in any_inputs()) {
        let mut previous = (0, 0);
        check(&config, &inputs, |sample| {
            let in_range = |pressure: Pressure| i64::from(pressure.saturated_to_control_range().to_bits());
            let pressure = in_range(sample.input.pressure);
            let error = in_range(sample.input.reference) - pressure;
            // With the basis Pressure the previous error is computed with the present reference.
            let error_before = match settings.prediction_basis {
                PredictionBasis::Error => previous.0,
                PredictionBasis::Pressure => error + pressure - previous.1,
            };
            let predicted = match settings.prediction {
                Prediction::Off => error,
                Prediction::OneStep => 2 * error - error_before,
                Prediction::TwoStep => 3 * error - 2 * error_before,
            };
            previous = (error, pressure);
            let seen = i64::from(sample.trace.predicted_error.to_bits());
            // Beyond 32 bar, which is outside of every deadband, only the sign counts.
            if predicted.abs() <= 32 << 16 {
                prop_assert_eq!(seen, predicted);
            } else {
                prop_assert!(seen.abs() > 32 << 16 && seen.signum() == predicted.signum());
            }
            let tolerance = i64::from(settings.tolerance_bar.to_bits()).max(1);
            if predicted.abs() < tolerance {
                prop_assert_eq!(sample.output, Output::OFF);
            }
            Ok(())
        })?;
    }

    #[test]
    fn the_integrators_stay_within_their_bounds((settings, config) in any_settings(), inputs in any_inputs()) {
        // The upper word is clamped to the bound, rounded down; the lower word is not clamped and is less than a unit.
        let bound = |percent: I16F16, bits: u32| (((i64::from(percent.to_bits()) << (bits - 16)) / 100 + 1) << 32) - 1;
        let integral_max = bound(settings.integral_max_pct, 27);
        let boost_max = settings.boost.map_or(0, |boost| bound(boost.max_pct, 20));
        check(&config, &inputs, |sample| {
            prop_assert!((-integral_max..=integral_max).contains(&integral_bits(&sample.after)));
            prop_assert!((0..=boost_max).contains(&boost_bits(&sample.after)));
            Ok(())
        })?;
    }

    #[test]
    fn nothing_is_summed_while_saturation_cuts_what_the_error_asks(
        (settings, config) in any_settings(),
        inputs in any_inputs(),
    ) {
        check(&config, &inputs, |sample| {
            let driven = match sample.trace.saturation {
                Saturation::High => sample.trace.error > Pressure::ZERO,
                Saturation::Low => sample.trace.error < Pressure::ZERO,
                Saturation::None => false,
            };
            if driven {
                // A boost that the error's change of sign cleared is smaller, never larger.
                prop_assert!(boost_bits(&sample.after).abs() <= boost_bits(&sample.before).abs());
                if settings.anti_windup == AntiWindup::ConditionalIntegration {
                    prop_assert!(integral_bits(&sample.after).abs() <= integral_bits(&sample.before).abs());
                }
            }
            Ok(())
        })?;
    }

    #[test]
    fn nothing_is_summed_while_the_valves_are_turned_off((_, config) in any_settings(), inputs in any_inputs()) {
        check(&config, &inputs, |sample| {
            if sample.trace.activity != Activity::Controlling {
                for (before, after) in [
                    (integral_bits(&sample.before), integral_bits(&sample.after)),
                    (boost_bits(&sample.before), boost_bits(&sample.after)),
                ] {
                    prop_assert!(after.abs() == before.abs() || after == 0);
                }
            }
            Ok(())
        })?;
    }

    #[test]
    fn the_parts_add_up_to_the_control_signal((_, config) in any_settings(), inputs in any_inputs()) {
        check(&config, &inputs, |sample| {
            let trace = &sample.trace;
            if trace.activity == Activity::Controlling {
                let sum = [trace.proportional, trace.derivative, trace.integral, trace.boost]
                    .iter()
                    .map(|part| i64::from(part.to_bits()))
                    .sum::<i64>();
                // Each of the four is rounded for display.
                prop_assert!((sum - i64::from(trace.u_unsaturated.to_bits())).abs() <= 4);
            }
            Ok(())
        })?;
    }

    #[test]
    fn an_error_of_the_other_sign_gives_mirrored_outputs(
        (settings, config) in any_settings(),
        errors in proptest::collection::vec((0..(7 << 16), 0..(1 << 16)), 1..40),
    ) {
        let other_config = Config::new(&mirrored(&settings)).expect("mirrored settings are as valid");
        // Mirrored about half the supply pressure, so that the pressure difference that helped one valve helps the
        // other.
        let supply = settings.supply_pressure_bar.to_bits();
        let within = |raw: i32| ((i64::from(raw) * i64::from(supply)) >> 19) as i32;
        let mirror = |bits: i32| Pressure::from_bits(supply - bits);
        let start = Input { reference: Pressure::ZERO, pressure: Pressure::ZERO };
        let other_start = Input { reference: mirror(0), pressure: mirror(0) };
        let (mut state, mut other_state) = (State::new(start), State::new(other_start));
        for (reference, pressure) in errors {
            let (reference, pressure) = (within(reference), within(reference.wrapping_add(pressure)));
            let input = Input { reference: Pressure::from_bits(reference), pressure: Pressure::from_bits(pressure) };
            let output = step(&config, &mut state, input);
            let other = step(&other_config, &mut other_state, Input { reference: mirror(reference), pressure: mirror(pressure) });
            // With u = 0 both signs are equal, and Scheme 2 treats u as positive: both valves get their middles in
            // either case.
            prop_assert_eq!((output.duty_fill, output.duty_vent), (other.duty_vent, other.duty_fill));
            prop_assert_eq!(state.boost().to_bits(), -other_state.boost().to_bits());
            // Along the error both are equal; an error of 0 has no other sign.
            let sign = if reference == pressure { -1 } else { 1 };
            prop_assert_eq!(integral_bits(&state), sign * integral_bits(&other_state));
            prop_assert_eq!(boost_bits(&state), boost_bits(&other_state));
        }
    }

    #[test]
    fn equal_state_and_input_give_equal_output_traced_or_not((_, config) in any_settings(), inputs in any_inputs()) {
        check(&config, &inputs, |sample| {
            let mut state = sample.before;
            prop_assert_eq!(step(&config, &mut state, sample.input), sample.output);
            prop_assert_eq!(state, sample.after);
            Ok(())
        })?;
    }

    #[test]
    fn a_pressure_dependent_limit_falls_with_the_pressure_that_helps(
        without in 0..=(100 << 16),
        drop in 0..=(1 << 16),
        pressures in proptest::collection::vec(-(2 << 16)..(12 << 16), 2..20),
    ) {
        let without_pct = I16F16::from_bits(without);
        let with_pct = I16F16::from_bits(((i64::from(without) * i64::from(drop)) >> 16) as i32);
        let opening = OpeningDuty::force_balance(without_pct, with_pct);
        let settings = Settings {
            duty_min: LowerLimit::PressureDependent { fill: opening, vent: opening },
            duty_max_fill_pct: I16F16::lit("100"),
            duty_max_vent_pct: I16F16::lit("100"),
            gain_pct_per_bar: I16F16::lit("0.01"),
            ..crate::support::bare()
        };
        let config = Config::new(&settings).expect("the force balance is in the middle half");
        let mut pressures = pressures;
        pressures.sort_unstable();
        // A tiny negative u: the vent valve gets its lower limit and 0.0003 of the rest.
        let limits: Vec<Duty> = pressures
            .iter()
            .map(|&pressure| {
                let pressure = Pressure::from_bits(pressure);
                let input = Input { reference: pressure.saturating_sub(Pressure::from_bits(2 << 16)), pressure };
                step(&config, &mut State::new(input), input).duty_vent
            })
            .collect();
        // Where the curve is level, rounding may be visible by two units.
        prop_assert!(limits.windows(2).all(|pair| pair[1].to_bits() <= pair[0].to_bits() + 2), "{limits:?}");
    }
}
