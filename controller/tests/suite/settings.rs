//! Bounds of the settings at N-1, N and N+1, and the texts of the errors.

use controller::fixed::types::I16F16;
use controller::{
    AntiWindup, Boost, Coefficient, Compensation, Config, ConfigError, Distributor, Duty, Field,
    LowerLimit, OpeningDuty, Settings,
};

use crate::support::{bare, configurations, lit};

const BOOST: Boost = Boost {
    rate_pct_per_bar_s: I16F16::lit("100"),
    max_pct: I16F16::lit("50"),
    response_bar: I16F16::lit("0.02"),
};

const OPENING: OpeningDuty = OpeningDuty {
    without_pressure_pct: I16F16::lit("60"),
    at_half_pct: I16F16::lit("40"),
    with_supply_pressure_pct: I16F16::lit("20"),
};

/// Checks that `bound` and one unit inside are allowed, and that one unit beyond it (`outward` is 1 or -1) is refused
/// as this field with this value.
fn check(field: Field, bound: &str, outward: i32, with: impl Fn(I16F16) -> Settings) {
    let bound = lit(bound);
    let at = |units: i32| I16F16::from_bits(bound.to_bits() + units * outward);
    for value in [at(-1), at(0)] {
        assert_eq!(Config::new(&with(value)).err(), None, "{field:?} = {value}");
    }
    match Config::new(&with(at(1))) {
        Err(
            ConfigError::OutOfRange {
                field: culprit,
                value,
                ..
            }
            | ConfigError::BelowOther {
                field: culprit,
                value,
                ..
            }
            | ConfigError::AboveOther {
                field: culprit,
                value,
                ..
            },
        ) => assert_eq!((culprit, value), (field, at(1))),
        other => panic!("{field:?} = {} gave {other:?}", at(1)),
    }
}

fn by_pressure(fill: OpeningDuty) -> Settings {
    Settings {
        duty_min: LowerLimit::PressureDependent {
            fill,
            vent: OPENING,
        },
        ..bare()
    }
}

#[test]
fn each_bound_of_the_pid_is_the_last_allowed_value() {
    check(Field::SampleTime, "0.1", -1, |sample_time_ms| Settings {
        sample_time_ms,
        ..bare()
    });
    check(Field::SampleTime, "1000", 1, |sample_time_ms| Settings {
        sample_time_ms,
        ..bare()
    });
    check(Field::Gain, "0.01", -1, |gain_pct_per_bar| Settings {
        gain_pct_per_bar,
        ..bare()
    });
    check(Field::Gain, "1000", 1, |gain_pct_per_bar| Settings {
        gain_pct_per_bar,
        ..bare()
    });
    let integral = |gain, time| Settings {
        gain_pct_per_bar: lit(gain),
        integral_time_ms: Some(time),
        ..bare()
    };
    check(Field::IntegralTime, "1", -1, |time| integral("0.5", time));
    check(Field::IntegralTime, "30000", 1, |time| integral("40", time));
    let derivative = |time| Settings {
        derivative_time_ms: Some(time),
        sample_time_ms: lit("1000"),
        ..bare()
    };
    check(Field::DerivativeTime, "0", -1, |time| Settings {
        gain_pct_per_bar: lit("1"),
        ..derivative(time)
    });
    check(Field::DerivativeTime, "30000", 1, |time| Settings {
        gain_pct_per_bar: lit("1"),
        ..derivative(time)
    });
    check(Field::IntegralMax, "0", -1, |integral_max_pct| Settings {
        integral_max_pct,
        ..bare()
    });
    check(Field::IntegralMax, "1000", 1, |integral_max_pct| Settings {
        integral_max_pct,
        ..bare()
    });
    let tracking = |tracking_time_ms| Settings {
        anti_windup: AntiWindup::BackCalculation { tracking_time_ms },
        ..bare()
    };
    check(Field::TrackingTime, "10", -1, tracking);
    check(Field::TrackingTime, "30000", 1, tracking);
}

#[test]
fn each_bound_of_tolerance_and_boost_is_the_last_allowed_value() {
    check(Field::Tolerance, "0", -1, |tolerance_bar| Settings {
        tolerance_bar,
        ..bare()
    });
    check(Field::Tolerance, "10", 1, |tolerance_bar| Settings {
        tolerance_bar,
        ..bare()
    });
    let rate = |sample_time, rate_pct_per_bar_s| Settings {
        sample_time_ms: lit(sample_time),
        boost: Some(Boost {
            rate_pct_per_bar_s,
            ..BOOST
        }),
        ..bare()
    };
    check(Field::BoostRate, "0.1", -1, |value| rate("1000", value));
    check(Field::BoostRate, "30000", 1, |value| rate("10", value));
    check(Field::BoostMax, "0", -1, |max_pct| Settings {
        boost: Some(Boost { max_pct, ..BOOST }),
        ..bare()
    });
    check(Field::BoostMax, "1000", 1, |max_pct| Settings {
        boost: Some(Boost { max_pct, ..BOOST }),
        ..bare()
    });
    check(Field::BoostResponse, "0", -1, |response_bar| Settings {
        boost: Some(Boost {
            response_bar,
            ..BOOST
        }),
        ..bare()
    });
    check(Field::BoostResponse, "10", 1, |response_bar| Settings {
        boost: Some(Boost {
            response_bar,
            ..BOOST
        }),
        ..bare()
    });
}

#[test]
fn each_bound_of_the_compensation_is_the_last_allowed_value() {
    let with = |nominal_voltage_v, nominal_resistance_ohm, release_shift_pct| Settings {
        compensation: Some(Compensation {
            nominal_voltage_v,
            nominal_resistance_ohm,
            release_shift_pct,
        }),
        ..bare()
    };
    let voltage = |value| with(value, lit("82.2"), lit("0"));
    check(Field::NominalVoltage, "9", -1, voltage);
    check(Field::NominalVoltage, "36", 1, voltage);
    let resistance = |value| with(lit("24"), value, lit("0"));
    check(Field::NominalResistance, "1", -1, resistance);
    check(Field::NominalResistance, "1000", 1, resistance);
    let shift = |value| with(lit("24"), lit("82.2"), value);
    check(Field::ReleaseShift, "0", -1, shift);
    check(Field::ReleaseShift, "100", 1, shift);
}

#[test]
fn each_bound_of_the_duty_cycles_is_the_last_allowed_value() {
    let constant = |fill, vent| Settings {
        duty_min: LowerLimit::Constant {
            fill_pct: fill,
            vent_pct: vent,
        },
        duty_max_fill_pct: lit("100"),
        duty_max_vent_pct: lit("100"),
        ..bare()
    };
    check(Field::DutyMinFill, "0", -1, |value| {
        constant(value, lit("20"))
    });
    check(Field::DutyMinFill, "100", 1, |value| {
        constant(value, lit("20"))
    });
    check(Field::DutyMinVent, "0", -1, |value| {
        constant(lit("20"), value)
    });
    check(Field::DutyMinVent, "100", 1, |value| {
        constant(lit("20"), value)
    });
    check(Field::DutyMaxFill, "25.5", -1, |duty_max_fill_pct| {
        Settings {
            duty_max_fill_pct,
            ..bare()
        }
    });
    check(Field::DutyMaxFill, "100", 1, |duty_max_fill_pct| Settings {
        duty_max_fill_pct,
        ..bare()
    });
    check(Field::DutyMaxVent, "25.5", -1, |duty_max_vent_pct| {
        Settings {
            duty_max_vent_pct,
            ..bare()
        }
    });
    check(Field::DutyMaxVent, "100", 1, |duty_max_vent_pct| Settings {
        duty_max_vent_pct,
        ..bare()
    });
    let scheme_2 = |fill, vent| Settings {
        distributor: Distributor::Scheme2 {
            middle_fill_pct: fill,
            middle_vent_pct: vent,
        },
        ..bare()
    };
    check(Field::DutyMiddleFill, "25.5", -1, |value| {
        scheme_2(value, lit("50"))
    });
    check(Field::DutyMiddleFill, "82", 1, |value| {
        scheme_2(value, lit("50"))
    });
    check(Field::DutyMiddleVent, "25.5", -1, |value| {
        scheme_2(lit("50"), value)
    });
    check(Field::DutyMiddleVent, "80", 1, |value| {
        scheme_2(lit("50"), value)
    });
}

#[test]
fn each_bound_of_a_pressure_dependent_limit_is_the_last_allowed_value() {
    check(Field::SupplyPressure, "1", -1, |supply_pressure_bar| {
        Settings {
            supply_pressure_bar,
            ..bare()
        }
    });
    check(Field::SupplyPressure, "15", 1, |supply_pressure_bar| {
        Settings {
            supply_pressure_bar,
            ..bare()
        }
    });
    // A quarter of the drop of 40 % above the lower end, and below the upper end.
    check(Field::DutyHalfFill, "30", -1, |at_half_pct| {
        by_pressure(OpeningDuty {
            at_half_pct,
            ..OPENING
        })
    });
    check(Field::DutyHalfFill, "50", 1, |at_half_pct| {
        by_pressure(OpeningDuty {
            at_half_pct,
            ..OPENING
        })
    });
    check(Field::DutyMinFillWithSupplyPressure, "0", -1, |value| {
        by_pressure(OpeningDuty::linear(lit("60"), value))
    });
    check(Field::DutyMinFillWithSupplyPressure, "60", 1, |value| {
        by_pressure(OpeningDuty::linear(lit("60"), value))
    });
    check(Field::DutyMinFill, "0", -1, |value| {
        by_pressure(OpeningDuty::linear(value, value.min(I16F16::ZERO)))
    });
    check(Field::DutyMinFill, "100", 1, |value| Settings {
        duty_max_fill_pct: lit("100"),
        ..by_pressure(OpeningDuty::linear(value, lit("20")))
    });
    check(Field::DutyMaxFill, "60", -1, |duty_max_fill_pct| Settings {
        duty_max_fill_pct,
        ..by_pressure(OPENING)
    });
}

/// Goal: coefficients that do not fit into their words are refused at the last unit. Method: settings whose product
/// moves in single units.
#[test]
fn each_bound_of_the_coefficients_is_the_last_allowed_value() {
    let check = |coefficient: Coefficient, allowed: Settings, refused: Settings| {
        assert_eq!(Config::new(&allowed).err(), None, "{coefficient}");
        match Config::new(&refused) {
            Err(ConfigError::CoefficientOutOfRange {
                coefficient: culprit,
                ..
            }) => assert_eq!(culprit, coefficient),
            other => panic!("{coefficient} gave {other:?}"),
        }
    };
    let next = |value: I16F16| I16F16::from_bits(value.to_bits() + 1);
    let previous = |value: I16F16| I16F16::from_bits(value.to_bits() - 1);
    let integral = |gain, sample_time, time| Settings {
        gain_pct_per_bar: gain,
        sample_time_ms: sample_time,
        integral_time_ms: Some(time),
        ..bare()
    };
    let ten = lit("10");
    // T_s = T_i: the coefficient is K itself, and 7.9 lies between two of its units.
    check(
        Coefficient::Integral,
        integral(lit("7.9"), ten, ten),
        integral(next(lit("7.9")), ten, ten),
    );
    let thousand = lit("1000");
    check(
        Coefficient::Integral,
        integral(lit("1"), lit("1"), thousand),
        integral(previous(lit("1")), lit("1"), thousand),
    );
    let derivative = |gain, time| Settings {
        gain_pct_per_bar: gain,
        derivative_time_ms: Some(time),
        ..bare()
    };
    check(
        Coefficient::Derivative,
        derivative(lit("100"), lit("100")),
        derivative(lit("100"), next(lit("100"))),
    );
    let boost = |rate, sample_time_ms| Settings {
        sample_time_ms,
        boost: Some(Boost {
            rate_pct_per_bar_s: rate,
            ..BOOST
        }),
        ..bare()
    };
    check(
        Coefficient::Boost,
        boost(thousand, thousand),
        boost(next(thousand), thousand),
    );
    check(
        Coefficient::Boost,
        boost(ten, ten),
        boost(previous(ten), ten),
    );
}

#[test]
fn an_error_names_the_field_its_value_and_the_bound() {
    let check = |settings: Settings, expected: &str| {
        assert_eq!(
            Config::new(&settings)
                .expect_err("out of bounds")
                .to_string(),
            expected
        );
    };
    let duty_min = LowerLimit::Constant {
        fill_pct: lit("28.5"),
        vent_pct: lit("25.5"),
    };
    check(
        Settings {
            duty_min,
            duty_max_fill_pct: lit("20"),
            ..bare()
        },
        "duty_max_fill_pct = 20 % is below duty_min_fill_pct = 28.5 %: must be 28.5 ..= 100 %",
    );
    check(
        Settings {
            tolerance_bar: lit("-0.1"),
            ..bare()
        },
        "tolerance_bar = -0.1 bar is out of range: must be 0 ..= 10 bar",
    );
    check(
        Settings {
            distributor: Distributor::Scheme2 {
                middle_fill_pct: lit("90"),
                middle_vent_pct: lit("50"),
            },
            ..bare()
        },
        "middle_fill_pct = 90 % is above duty_max_fill_pct = 82 %: must be 25.5 ..= 82 %",
    );
    check(
        Settings {
            gain_pct_per_bar: lit("1000"),
            integral_time_ms: Some(lit("1")),
            ..bare()
        },
        "gain * sample_time / integral_time = 10000 %/bar per sample is out of range: must be 0.001 ..= 7.9 %/bar per sample",
    );
    check(
        Settings {
            gain_pct_per_bar: lit("1000"),
            derivative_time_ms: Some(lit("20")),
            ..bare()
        },
        "gain * derivative_time / sample_time = 2000 % per bar of change in a sample is out of range: must be 0 ..= 1000 % per bar of change in a sample",
    );
}

#[test]
fn every_configuration_with_a_name_is_valid() {
    for (name, settings) in configurations() {
        assert_eq!(Config::new(&settings).err(), None, "{name}");
    }
}

#[test]
fn a_duty_cycle_is_from_0_to_100_percent() {
    let unit = I16F16::DELTA;
    assert_eq!(Duty::from_percent(lit("0")), Some(Duty::OFF));
    assert_eq!(Duty::from_percent(-unit), None);
    assert_eq!(Duty::from_percent(lit("100")), Some(Duty::FULL));
    assert_eq!(Duty::from_percent(lit("100") + unit), None);
    assert_eq!(Duty::saturating_from_bits(i32::MIN), Duty::OFF);
    assert_eq!(Duty::saturating_from_bits(i32::MAX), Duty::FULL);
}

#[test]
fn timer_counts_are_exact_at_both_ends_and_nearest_between() {
    for counts_max in [1, 2, 99, 100, 1000, 4095, 10_000, u16::MAX] {
        assert_eq!(Duty::OFF.to_counts(counts_max), 0);
        assert_eq!(Duty::FULL.to_counts(counts_max), counts_max);
    }
    let half = Duty::from_percent(lit("50")).expect("in range");
    assert_eq!(
        (half.to_counts(1000), half.to_counts(1), half.to_counts(3)),
        (500, 1, 2)
    );
    let limit = Duty::from_percent(lit("25.5")).expect("in range");
    assert_eq!(
        (
            limit.to_counts(1000),
            limit.to_counts(100),
            limit.to_counts(0)
        ),
        (255, 26, 0)
    );
}

#[test]
fn the_force_balance_lies_above_the_straight_line_and_meets_it_at_the_ends() {
    let (without, with) = (lit("54.5"), lit("28.5"));
    let line = OpeningDuty::linear(without, with);
    let balance = OpeningDuty::force_balance(without, with);
    assert_eq!(line.at_half_pct, lit("41.5"));
    // sqrt((54.5² + 28.5²)/2) = 43.4885
    assert_eq!(
        balance.at_half_pct.to_num::<f64>(),
        (43.488_504_228_f64 * 65536.0).floor() / 65536.0
    );
    assert_eq!(
        (
            balance.without_pressure_pct,
            balance.with_supply_pressure_pct
        ),
        (without, with)
    );
}

/// Settings may have any value until they are checked.
#[test]
fn the_force_balance_of_what_no_valve_has_stays_in_its_type() {
    let balance = OpeningDuty::force_balance(I16F16::MIN, I16F16::MIN);
    assert_eq!(balance.at_half_pct, I16F16::MAX);
    let balance = OpeningDuty::force_balance(I16F16::MAX, I16F16::MAX);
    assert_eq!(balance.at_half_pct, I16F16::MAX);
}

/// Checks the README's table: the differences between the recommended controller and the thesis'.
#[test]
fn the_recommended_controller_differs_from_the_thesis_in_what_its_table_says() {
    let (thesis, recommended) = (Settings::thesis(), Settings::recommended());
    assert_eq!(recommended.gain_pct_per_bar, lit("35"));
    assert_eq!(recommended.integral_time_ms, Some(lit("700")));
    assert_eq!(recommended.derivative_time_ms, Some(lit("16")));
    assert_eq!(recommended.tolerance_bar, lit("0.085"));
    assert_ne!(
        recommended.integral_at_reference,
        thesis.integral_at_reference
    );
    assert_ne!(recommended.prediction, thesis.prediction);
    assert_ne!(recommended.prediction_basis, thesis.prediction_basis);
    assert_ne!(recommended.switch_off, thesis.switch_off);
    assert_ne!(recommended.boost, thesis.boost);
    assert_ne!(recommended.duty_min, thesis.duty_min);
}
