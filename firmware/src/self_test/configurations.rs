//! Compared controllers: that of the thesis, the recommended one, and each other choice at least once.

use controller::fixed::types::I16F16;
use controller::{
    AntiWindup, Boost, Distributor, IntegralAtReference, LowerLimit, OpeningDuty, Prediction,
    PredictionBasis, Settings, SwitchOff,
};

const THESIS: Settings = Settings::thesis();
const RECOMMENDED: Settings = Settings::recommended();

/// Name and settings, in the order in which they run.
pub(crate) const CONFIGURATIONS: [(&str, Settings); 19] = [
    ("thesis", THESIS),
    ("recommended", RECOMMENDED),
    (
        "p",
        Settings {
            integral_time_ms: None,
            derivative_time_ms: None,
            ..THESIS
        },
    ),
    (
        "pi",
        Settings {
            derivative_time_ms: None,
            ..THESIS
        },
    ),
    (
        "pd",
        Settings {
            integral_time_ms: None,
            ..THESIS
        },
    ),
    (
        "anti_windup_off",
        Settings {
            anti_windup: AntiWindup::Off,
            ..THESIS
        },
    ),
    (
        "back_calculation",
        Settings {
            anti_windup: BACK_CALCULATION,
            ..THESIS
        },
    ),
    (
        "integral_cleared_at_reference",
        Settings {
            integral_at_reference: IntegralAtReference::Clear,
            ..THESIS
        },
    ),
    (
        "no_tolerance",
        Settings {
            tolerance_bar: I16F16::ZERO,
            ..THESIS
        },
    ),
    (
        "no_prediction",
        Settings {
            prediction: Prediction::Off,
            ..THESIS
        },
    ),
    (
        "one_step_prediction",
        Settings {
            prediction: Prediction::OneStep,
            ..THESIS
        },
    ),
    (
        "prediction_of_pressure",
        Settings {
            prediction_basis: PredictionBasis::Pressure,
            ..THESIS
        },
    ),
    (
        "switch_off_beyond",
        Settings {
            switch_off: SwitchOff::InsideOrBeyond,
            ..THESIS
        },
    ),
    (
        "no_boost",
        Settings {
            boost: None,
            ..THESIS
        },
    ),
    (
        "traditional",
        Settings {
            distributor: Distributor::Traditional,
            ..THESIS
        },
    ),
    (
        "scheme_2",
        Settings {
            distributor: SCHEME_2,
            ..THESIS
        },
    ),
    (
        "linear_lower_limit",
        Settings {
            duty_min: LINEAR_LOWER_LIMIT,
            ..THESIS
        },
    ),
    ("small_gains", SMALL),
    ("large_gains", LARGE),
];

const BACK_CALCULATION: AntiWindup = AntiWindup::BackCalculation {
    tracking_time_ms: I16F16::lit("100"),
};

const SCHEME_2: Distributor = Distributor::Scheme2 {
    middle_fill_pct: I16F16::lit("54.5"),
    middle_vent_pct: I16F16::lit("51.5"),
};

const LINEAR_LOWER_LIMIT: LowerLimit = LowerLimit::PressureDependent {
    fill: OpeningDuty::linear(I16F16::lit("54.5"), I16F16::lit("28.5")),
    vent: OpeningDuty::linear(I16F16::lit("51.5"), I16F16::lit("25.5")),
};

/// Settings near the lower bounds, where a different rounding would have the largest effect.
const SMALL: Settings = Settings {
    gain_pct_per_bar: I16F16::lit("0.5"),
    integral_time_ms: Some(I16F16::lit("4500")),
    derivative_time_ms: Some(I16F16::lit("0.1")),
    ..RECOMMENDED
};

/// Settings near the upper bounds, where a different saturation would be visible.
const LARGE: Settings = Settings {
    gain_pct_per_bar: I16F16::lit("900"),
    integral_time_ms: Some(I16F16::lit("1200")),
    derivative_time_ms: Some(I16F16::lit("11")),
    integral_max_pct: I16F16::lit("1000"),
    boost: Some(Boost {
        rate_pct_per_bar_s: I16F16::lit("30000"),
        max_pct: I16F16::lit("1000"),
        response_bar: I16F16::lit("0.001"),
    }),
    ..RECOMMENDED
};
