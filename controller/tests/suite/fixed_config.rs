//! Mechanisms fixed at compile time: same bits as the configurable controller; other mechanisms are refused.

use controller::{
    AntiWindup, Distributor, Field, FixedConfig, IntegralAtReference, LowerLimit, Mechanisms,
    Output, Prediction, PredictionBasis, Settings, State, SwitchOff, step_traced,
};

use crate::support::{Bench, config, lit};

struct Thesis;

impl Mechanisms for Thesis {
    const SETTINGS: Settings = Settings::thesis();
}

struct Recommended;

impl Mechanisms for Recommended {
    const SETTINGS: Settings = Settings::recommended();
}

/// Goal: fixing the mechanisms at compile time changes no result. Method: both versions run through every regime.
fn assert_same_bits<M: Mechanisms>(settings: &Settings) {
    let any = config(settings);
    let fixed = FixedConfig::<M>::new(any).expect("these mechanisms");
    let (mut state, mut bench, mut output) = (State::at_rest(), Bench::new(11), Output::OFF);
    for sample in 0..20_000 {
        let input = bench.next(output.duty_fill.to_bits(), output.duty_vent.to_bits());
        let (mut fixed_state, mut traced_state) = (state, state);
        let traced = fixed.step_traced(&mut traced_state, input);
        output = fixed.step(&mut fixed_state, input);
        assert_eq!(
            step_traced(&any, &mut state, input),
            traced,
            "sample {sample}"
        );
        assert_eq!(output, traced.0, "sample {sample}");
        assert_eq!((fixed_state, traced_state), (state, state));
    }
}

#[test]
fn fixed_mechanisms_give_the_bits_of_the_configuration() {
    assert_same_bits::<Thesis>(&Settings::thesis());
    assert_same_bits::<Recommended>(&Settings::recommended());
}

#[test]
fn numbers_stay_tunable_where_mechanisms_are_fixed() {
    assert_same_bits::<Thesis>(&Settings {
        gain_pct_per_bar: lit("12"),
        tolerance_bar: lit("0.3"),
        boost: None,
        duty_max_fill_pct: lit("90"),
        ..Settings::thesis()
    });
}

#[test]
fn a_configuration_of_other_mechanisms_is_refused_by_the_name_of_the_first() {
    let thesis = Settings::thesis();
    let check = |settings: Settings, expected: Field, name: &str| {
        let refused = FixedConfig::<Thesis>::new(config(&settings)).expect_err("refused");
        assert_eq!(refused.mechanism, expected);
        assert_eq!(
            refused.to_string(),
            format!(
                "{name} is another one than was compiled in: choose that one, or run this configuration with `step`"
            )
        );
    };
    check(
        Settings {
            prediction: Prediction::OneStep,
            ..thesis
        },
        Field::Prediction,
        "prediction",
    );
    check(
        Settings {
            prediction_basis: PredictionBasis::Pressure,
            ..thesis
        },
        Field::PredictionBasis,
        "prediction_basis",
    );
    check(
        Settings {
            switch_off: SwitchOff::InsideOrBeyond,
            ..thesis
        },
        Field::SwitchOff,
        "switch_off",
    );
    check(
        Settings {
            integral_at_reference: IntegralAtReference::Clear,
            ..thesis
        },
        Field::IntegralAtReference,
        "integral_at_reference",
    );
    check(
        Settings {
            anti_windup: AntiWindup::Off,
            ..thesis
        },
        Field::AntiWindup,
        "anti_windup",
    );
    check(
        Settings {
            distributor: Distributor::Scheme2 {
                middle_fill_pct: lit("50"),
                middle_vent_pct: lit("50"),
            },
            ..thesis
        },
        Field::Distributor,
        "distributor",
    );
    check(
        Settings {
            duty_min: Settings::recommended().duty_min,
            ..thesis
        },
        Field::DutyMin,
        "duty_min",
    );
    check(Settings::recommended(), Field::Prediction, "prediction");
}

/// The traditional distributor is Scheme 1 from 0 to 100 %, for all lower limits.
#[test]
fn what_differs_in_numbers_alone_is_the_same_mechanism() {
    for settings in [
        Settings {
            distributor: Distributor::Traditional,
            ..Settings::thesis()
        },
        Settings {
            distributor: Distributor::Traditional,
            duty_min: Settings::recommended().duty_min,
            ..Settings::thesis()
        },
        Settings {
            duty_min: LowerLimit::Constant {
                fill_pct: lit("10"),
                vent_pct: lit("20"),
            },
            integral_time_ms: None,
            boost: None,
            ..Settings::thesis()
        },
    ] {
        assert!(FixedConfig::<Thesis>::new(config(&settings)).is_ok());
    }
}

#[test]
fn a_fixed_configuration_is_a_value_like_the_one_it_was_made_of() {
    let fixed = |settings: &Settings| -> FixedConfig<Thesis> {
        FixedConfig::new(config(settings)).expect("these mechanisms")
    };
    let thesis = fixed(&Settings::thesis());
    let other = fixed(&Settings {
        gain_pct_per_bar: lit("41"),
        ..Settings::thesis()
    });
    #[allow(clippy::clone_on_copy, reason = "both are asked here")]
    let clone = thesis.clone();
    assert!(clone == thesis && other != thesis);
    assert_eq!(*thesis.config(), config(&Settings::thesis()));
    assert_eq!(
        format!("{thesis:?}"),
        format!("FixedConfig({:?})", thesis.config())
    );
}
