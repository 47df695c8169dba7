//! Displayed text of quantities and coefficients, as shown in logs and errors.

use controller::fixed::types::I20F12;
use controller::{Coefficient, ControlSignal, Duty};

use crate::support::{bar, lit};

#[test]
fn a_quantity_is_shown_with_its_unit() {
    assert_eq!(bar("-0.5").to_string(), "-0.5 bar");
    let duty = Duty::from_percent(lit("25.5")).expect("in range");
    assert_eq!(duty.to_string(), "25.5 %");
    let signal = ControlSignal::saturating_from_percent(I20F12::lit("-12.5"));
    assert_eq!(signal.to_string(), "-12.5 %");
}

#[test]
fn a_control_signal_is_held_at_100_percent_and_keeps_its_sign() {
    let signal = |percent: &str| {
        ControlSignal::saturating_from_percent(percent.parse::<I20F12>().expect("a number"))
    };
    assert_eq!(signal("100"), ControlSignal::MAX);
    assert_eq!(signal("100.001"), ControlSignal::MAX);
    assert_eq!(signal("-100.001"), ControlSignal::MIN);
    assert_eq!(signal("0"), ControlSignal::ZERO);
    assert!(signal("99.999") < ControlSignal::MAX);
    // Rounding to the nearest 2⁻²⁰ of 100 % and back to the nearest 2⁻¹² % gives the same value.
    for bits in [1, 12, 13, 4096, 123_456, 409_599] {
        let there_and_back =
            |bits: i32| ControlSignal::saturating_from_percent(I20F12::from_bits(bits)).to_bits();
        assert_eq!(there_and_back(bits), bits);
        assert_eq!(there_and_back(-bits), -bits);
    }
}

#[test]
fn a_coefficient_is_shown_as_the_product_that_it_is() {
    for (coefficient, product) in [
        (Coefficient::Integral, "gain * sample_time / integral_time"),
        (
            Coefficient::Derivative,
            "gain * derivative_time / sample_time",
        ),
        (Coefficient::Boost, "boost_rate * sample_time"),
    ] {
        assert_eq!(coefficient.to_string(), product);
    }
}
