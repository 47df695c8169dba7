//! Conversion of the control signal into two duty cycles (section 6.3), with the lower limits of section 7.2.

use controller::{ControlSignal, Distributor, LowerLimit, Output, Settings};

use crate::support::{assert_duties, bare, duties, lit, run};

#[test]
fn the_traditional_distributor_is_equations_6_3_to_6_5() {
    let settings = Settings {
        distributor: Distributor::Traditional,
        ..bare()
    };
    let check = |reference, pressure, expected: (&str, &str)| {
        let (output, _, _) = run(&settings, &[(reference, pressure)])[0];
        assert_duties(&output, expected);
    };
    check("3", "2", ("40", "0"));
    check("2", "3.25", ("0", "50"));
    check("2", "2", ("0", "0"));
    check("8", "2", ("100", "0"));
    check("2", "8", ("0", "100"));
}

#[test]
fn scheme_1_maps_u_onto_the_range_in_which_the_valve_moves() {
    let check = |reference, pressure, expected: (&str, &str)| {
        let (output, _, _) = run(&bare(), &[(reference, pressure)])[0];
        assert_duties(&output, expected);
    };
    // u = 50 %: halfway from 25.5 % to 82 % and to 80 %.
    check("3.25", "2", ("53.75", "0"));
    check("2", "3.25", ("0", "52.75"));
    check("8", "2", ("82", "0"));
    check("2", "8", ("0", "80"));
    check("2", "2", ("0", "0"));
}

#[test]
fn scheme_2_drives_both_valves_around_their_middles() {
    let settings = Settings {
        distributor: Distributor::Scheme2 {
            middle_fill_pct: lit("40"),
            middle_vent_pct: lit("38"),
        },
        ..bare()
    };
    let check = |reference, pressure, expected: (&str, &str)| {
        let (output, _, _) = run(&settings, &[(reference, pressure)])[0];
        assert_duties(&output, expected);
    };
    check("3.25", "2", ("61", "31.75"));
    check("2", "3.25", ("32.75", "59"));
    check("8", "2", ("82", "25.5"));
    check("2", "8", ("25.5", "80"));
}

#[test]
fn scheme_2_gives_both_middles_where_the_control_signal_is_zero_and_none_inside_the_tolerance() {
    let settings = Settings {
        gain_pct_per_bar: lit("10"),
        // K e + K T_d/T_s Δe = 10 (0.5 - 0.5): u is exactly 0, the error is not.
        derivative_time_ms: Some(lit("10")),
        tolerance_bar: lit("0.125"),
        distributor: Distributor::Scheme2 {
            middle_fill_pct: lit("40"),
            middle_vent_pct: lit("38"),
        },
        ..bare()
    };
    let samples = run(&settings, &[("3", "2"), ("3", "2.5"), ("3", "2.9")]);
    assert_eq!(samples[1].1.u, ControlSignal::ZERO);
    assert_eq!(duties(&samples[1].0), (lit("40"), lit("38")));
    assert_eq!(samples[2].0, Output::OFF);
}

/// Tables 4.1 and 4.2 at their ends: at full chamber pressure no pressure difference helps the fill valve, and the
/// reverse.
#[test]
fn the_pressure_dependent_limits_meet_the_measured_opening_duties() {
    let settings = Settings {
        duty_min: Settings::recommended().duty_min,
        gain_pct_per_bar: lit("0.01"),
        ..bare()
    };
    let limit = |reference, pressure| {
        let (output, _, _) = run(&settings, &[(reference, pressure)])[0];
        let (fill, vent) = duties(&output);
        // u is at most 0.08 %, which lifts the duty cycle by at most 0.05 % above its limit.
        (fill.max(vent).to_num::<f64>() - 0.025).abs()
    };
    let assert_limit = |actual: f64, expected: f64| {
        assert!(
            (actual - expected).abs() < 0.026,
            "{actual} is not {expected} %"
        )
    };
    assert_limit(limit("1", "0"), 28.5);
    assert_limit(limit("9", "8.4"), 54.5);
    assert_limit(limit("4.3", "4.2"), 43.488_5);
    assert_limit(limit("7", "8.4"), 25.5);
    assert_limit(limit("-0.5", "0"), 51.5);
    assert_limit(limit("4.1", "4.2"), 40.635_6);
    // The limit does not change beyond the ends.
    assert_limit(limit("9", "8.9"), 54.5);
    assert_limit(limit("3", "9.5"), 25.5);
}

/// Example of section 6.6: at 6.8 bar a fill valve with 25.5 % as lower limit does not open for an error of 0.2 bar.
#[test]
fn with_pressure_dependent_limits_a_small_error_opens_the_fill_valve_at_high_pressure() {
    let opens = |duty_min| {
        let (output, _, _) = run(&Settings { duty_min, ..bare() }, &[("7", "6.8")])[0];
        output.duty_fill.percent()
    };
    assert!(opens(Settings::thesis().duty_min) < lit("45"));
    assert!(opens(Settings::recommended().duty_min) > lit("50"));
}

#[test]
fn a_constant_limit_is_the_same_at_every_pressure() {
    let duty_min = LowerLimit::Constant {
        fill_pct: lit("30"),
        vent_pct: lit("20"),
    };
    let settings = Settings { duty_min, ..bare() };
    let fill = |reference, pressure| duties(&run(&settings, &[(reference, pressure)])[0].0).0;
    assert_eq!(fill("1.25", "0"), fill("8.25", "7"));
}

#[test]
fn scheme_1_turns_both_valves_off_where_the_control_signal_is_zero() {
    let settings = Settings {
        gain_pct_per_bar: lit("10"),
        // K e + K T_d/T_s Δe = 10 (0.5 - 0.5): u is exactly 0, the error is not.
        derivative_time_ms: Some(lit("10")),
        tolerance_bar: lit("0.125"),
        ..bare()
    };
    let samples = run(&settings, &[("3", "2"), ("3", "2.5")]);
    assert_eq!(samples[1].1.u, ControlSignal::ZERO);
    assert_eq!(samples[1].0, Output::OFF);
}

#[test]
fn full_control_signal_gives_the_upper_limit_at_any_pressure() {
    let duty_min = Settings::recommended().duty_min;
    let at = |distributor, reference, pressure| {
        let settings = Settings {
            distributor,
            duty_min,
            ..bare()
        };
        duties(&run(&settings, &[(reference, pressure)])[0].0)
    };
    let zero = lit("0");
    for (pressure, higher, lower) in [("0", "8", "-8"), ("4.2", "12", "0"), ("8.4", "14", "2")] {
        assert_eq!(
            at(Distributor::Scheme1, higher, pressure),
            (lit("82"), zero)
        );
        assert_eq!(at(Distributor::Scheme1, lower, pressure), (zero, lit("80")));
        let scheme_2 = Distributor::Scheme2 {
            middle_fill_pct: lit("60"),
            middle_vent_pct: lit("58"),
        };
        assert_eq!(at(scheme_2, higher, pressure).0, lit("82"));
        assert_eq!(at(scheme_2, lower, pressure).1, lit("80"));
    }
}

/// A control signal against the error drives the other valve, whose lower limit then applies.
#[test]
fn scheme_2_lowers_the_other_valve_to_what_just_opens_it_at_this_pressure() {
    let settings = Settings {
        distributor: Distributor::Scheme2 {
            middle_fill_pct: lit("60"),
            middle_vent_pct: lit("58"),
        },
        duty_min: Settings::recommended().duty_min,
        ..bare()
    };
    let at = |reference, pressure| duties(&run(&settings, &[(reference, pressure)])[0].0);
    assert_eq!(at("12", "0").1, lit("51.5"));
    assert_eq!(at("14", "8.4").1, lit("25.5"));
    assert_eq!(at("-8", "0").0, lit("28.5"));
    assert_eq!(at("2", "8.4").0, lit("54.5"));
}
