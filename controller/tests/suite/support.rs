//! Shared parts of the tests: generators of settings and inputs, and random numbers.

use controller::fixed::types::I16F16;
use controller::{
    AntiWindup, Boost, Coefficient, Config, ConfigError, ControlSignal, Distributor, Input,
    IntegralAtReference, LowerLimit, OpeningDuty, Output, Prediction, PredictionBasis, Pressure,
    Settings, State, SwitchOff, Trace, step_traced,
};
use proptest::prelude::*;

pub(crate) fn lit(text: &str) -> I16F16 {
    text.parse().expect("a decimal number in a test")
}

pub(crate) fn bar(text: &str) -> Pressure {
    Pressure::from_bar(lit(text))
}

pub(crate) fn input(reference: &str, pressure: &str) -> Input {
    Input {
        reference: bar(reference),
        pressure: bar(pressure),
    }
}

pub(crate) fn config(settings: &Settings) -> Config {
    Config::new(settings).expect("valid settings in a test")
}

/// Runs the inputs, beginning from the state of the first, and returns the output, trace and state of every sample.
pub(crate) fn run(settings: &Settings, inputs: &[(&str, &str)]) -> Vec<(Output, Trace, State)> {
    let config = config(settings);
    let mut state = State::new(input(inputs[0].0, inputs[0].1));
    inputs
        .iter()
        .map(|(reference, pressure)| {
            let (output, trace) = step_traced(&config, &mut state, input(reference, pressure));
            (output, trace, state)
        })
        .collect()
}

pub(crate) fn percent(signal: ControlSignal) -> f64 {
    signal.percent().to_num()
}

/// Asserts that two control signals are equal to their last of 12 bits, plus the tenth of a unit by which a decimal
/// setting may be off.
pub(crate) fn assert_close(actual: ControlSignal, expected: f64) {
    let deviation = (percent(actual) - expected).abs();
    assert!(deviation < 0.000_3, "{actual} is not {expected} %");
}

pub(crate) fn duties(output: &Output) -> (I16F16, I16F16) {
    (output.duty_fill.percent(), output.duty_vent.percent())
}

/// Asserts two duty cycles (%), up to the rounding error of u.
#[track_caller]
pub(crate) fn assert_duties(output: &Output, expected: (&str, &str)) {
    let (fill, vent) = duties(output);
    let is = |actual: I16F16, expected| (actual - lit(expected)).abs().to_num::<f64>() < 0.000_3;
    assert!(
        is(fill, expected.0) && is(vent, expected.1),
        "{output:?} is not {expected:?} %"
    );
}

/// Returns a P controller without other mechanisms: K = 40 %/bar, Scheme 1. Each test switches on the mechanism under
/// test.
pub(crate) fn bare() -> Settings {
    Settings {
        integral_time_ms: None,
        derivative_time_ms: None,
        anti_windup: AntiWindup::Off,
        tolerance_bar: I16F16::ZERO,
        prediction: Prediction::Off,
        boost: None,
        ..Settings::thesis()
    }
}

/// Returns name and settings of every configuration that has its own evidence.
pub(crate) fn configurations() -> Vec<(&'static str, Settings)> {
    let thesis = Settings::thesis();
    let recommended = Settings::recommended();
    let tracking_time_ms = lit("100");
    let scheme_2 = Distributor::Scheme2 {
        middle_fill_pct: lit("58"),
        middle_vent_pct: lit("55"),
    };
    vec![
        ("thesis", thesis),
        ("recommended", recommended),
        (
            "traditional",
            Settings {
                distributor: Distributor::Traditional,
                ..thesis
            },
        ),
        (
            "scheme_2",
            Settings {
                distributor: scheme_2,
                prediction: Prediction::OneStep,
                ..thesis
            },
        ),
        (
            "scheme_2_by_pressure",
            Settings {
                distributor: scheme_2,
                ..recommended
            },
        ),
        (
            "back_calculation",
            Settings {
                anti_windup: AntiWindup::BackCalculation { tracking_time_ms },
                ..thesis
            },
        ),
        (
            "windup",
            Settings {
                anti_windup: AntiWindup::Off,
                integral_max_pct: lit("1000"),
                ..thesis
            },
        ),
        (
            "linear_limits",
            Settings {
                duty_min: LowerLimit::PressureDependent {
                    fill: OpeningDuty::linear(lit("54.5"), lit("28.5")),
                    vent: OpeningDuty::linear(lit("51.5"), lit("25.5")),
                },
                ..thesis
            },
        ),
        ("bare", bare()),
    ]
}

/// Returns the same controller with the two valves exchanged.
pub(crate) fn mirrored(settings: &Settings) -> Settings {
    Settings {
        distributor: match settings.distributor {
            Distributor::Scheme2 {
                middle_fill_pct,
                middle_vent_pct,
            } => Distributor::Scheme2 {
                middle_fill_pct: middle_vent_pct,
                middle_vent_pct: middle_fill_pct,
            },
            other => other,
        },
        duty_min: match settings.duty_min {
            LowerLimit::Constant { fill_pct, vent_pct } => LowerLimit::Constant {
                fill_pct: vent_pct,
                vent_pct: fill_pct,
            },
            LowerLimit::PressureDependent { fill, vent } => LowerLimit::PressureDependent {
                fill: vent,
                vent: fill,
            },
        },
        duty_max_fill_pct: settings.duty_max_vent_pct,
        duty_max_vent_pct: settings.duty_max_fill_pct,
        ..*settings
    }
}

/// Generates any number of the range; the ends have a higher probability.
fn within(min: &str, max: &str) -> impl Strategy<Value = I16F16> {
    let (min, max) = (lit(min).to_bits(), lit(max).to_bits());
    prop_oneof![1 => Just(min), 1 => Just(max), 8 => min..=max].prop_map(I16F16::from_bits)
}

/// Returns the value at a share of the way from `low` to `high`; shares are in 1/65536, ends included.
fn between(low: I16F16, high: I16F16, share: i32) -> I16F16 {
    let span = i64::from(high.to_bits()) - i64::from(low.to_bits());
    I16F16::from_bits(low.to_bits() + ((span * i64::from(share)) >> 16) as i32)
}

fn share() -> impl Strategy<Value = i32> {
    prop_oneof![1 => Just(0), 1 => Just(1 << 16), 8 => 0..=(1 << 16)]
}

fn pid() -> impl Strategy<Value = Settings> {
    let time = || proptest::option::of(prop_oneof![within("1", "100"), within("1", "30000")]);
    let gain = prop_oneof![
        within("0.01", "10"),
        within("1", "100"),
        within("0.01", "1000")
    ];
    let anti_windup = prop_oneof![
        Just(AntiWindup::Off),
        Just(AntiWindup::ConditionalIntegration),
        within("1000", "30000")
            .prop_map(|tracking_time_ms| AntiWindup::BackCalculation { tracking_time_ms }),
        Just(AntiWindup::BackCalculation {
            tracking_time_ms: lit("100")
        }),
    ];
    let at_reference = prop_oneof![
        Just(IntegralAtReference::Hold),
        Just(IntegralAtReference::Clear)
    ];
    (
        within("0.1", "100"),
        gain,
        time(),
        time(),
        within("0", "1000"),
        at_reference,
        anti_windup,
    )
        .prop_map(
            |(
                sample_time_ms,
                gain,
                integral,
                derivative,
                integral_max_pct,
                integral_at_reference,
                anti_windup,
            )| Settings {
                sample_time_ms,
                gain_pct_per_bar: gain,
                integral_time_ms: integral,
                derivative_time_ms: derivative,
                integral_max_pct,
                integral_at_reference,
                anti_windup,
                ..Settings::thesis()
            },
        )
}

fn switching() -> impl Strategy<Value = Settings> {
    let boost = (
        within("0.1", "30000"),
        within("0", "1000"),
        within("0", "10"),
    )
        .prop_map(|(rate_pct_per_bar_s, max_pct, response_bar)| Boost {
            rate_pct_per_bar_s,
            max_pct,
            response_bar,
        });
    let prediction = prop_oneof![
        Just(Prediction::Off),
        Just(Prediction::OneStep),
        Just(Prediction::TwoStep)
    ];
    let basis = prop_oneof![
        Just(PredictionBasis::Error),
        Just(PredictionBasis::Pressure)
    ];
    let switch_off = prop_oneof![
        Just(SwitchOff::InsideTolerance),
        Just(SwitchOff::InsideOrBeyond)
    ];
    let tolerance = prop_oneof![within("0", "0.5"), within("0", "10")];
    (
        tolerance,
        prediction,
        basis,
        switch_off,
        proptest::option::of(boost),
    )
        .prop_map(
            |(tolerance_bar, prediction, prediction_basis, switch_off, boost)| Settings {
                tolerance_bar,
                prediction,
                prediction_basis,
                switch_off,
                boost,
                ..Settings::thesis()
            },
        )
}

/// Generates DC_min without pressure, an opening curve that begins there, DC_max, and a middle duty cycle of Scheme 2.
fn valve() -> impl Strategy<Value = (I16F16, OpeningDuty, I16F16, I16F16)> {
    (within("0", "100"), share(), share(), share(), share()).prop_map(
        |(min, drop, half, max, middle)| {
            let with_supply_pressure_pct = between(I16F16::ZERO, min, drop);
            let quarter = (min.to_bits() - with_supply_pressure_pct.to_bits()) / 4;
            let at_half_pct = between(
                I16F16::from_bits(with_supply_pressure_pct.to_bits() + quarter),
                I16F16::from_bits(min.to_bits() - quarter),
                half,
            );
            let opening = OpeningDuty {
                without_pressure_pct: min,
                at_half_pct,
                with_supply_pressure_pct,
            };
            let max = between(min, lit("100"), max);
            (min, opening, max, between(min, max, middle))
        },
    )
}

fn distribution() -> impl Strategy<Value = Settings> {
    (valve(), valve(), 0..3, any::<bool>(), within("1", "15")).prop_map(
        |(fill, vent, scheme, by_pressure, supply_pressure_bar)| Settings {
            distributor: match scheme {
                0 => Distributor::Traditional,
                1 => Distributor::Scheme1,
                _ => Distributor::Scheme2 {
                    middle_fill_pct: fill.3,
                    middle_vent_pct: vent.3,
                },
            },
            duty_min: if by_pressure {
                LowerLimit::PressureDependent {
                    fill: fill.1,
                    vent: vent.1,
                }
            } else {
                LowerLimit::Constant {
                    fill_pct: fill.0,
                    vent_pct: vent.0,
                }
            },
            duty_max_fill_pct: fill.2,
            duty_max_vent_pct: vent.2,
            supply_pressure_bar,
            ..Settings::thesis()
        },
    )
}

/// Generates any settings that make a configuration. If a coefficient is out of range, its mechanism is switched off.
pub(crate) fn any_settings() -> impl Strategy<Value = (Settings, Config)> {
    (pid(), switching(), distribution()).prop_map(|(pid, switching, distribution)| {
        let mut settings = Settings {
            tolerance_bar: switching.tolerance_bar,
            prediction: switching.prediction,
            prediction_basis: switching.prediction_basis,
            switch_off: switching.switch_off,
            boost: switching.boost,
            distributor: distribution.distributor,
            duty_min: distribution.duty_min,
            duty_max_fill_pct: distribution.duty_max_fill_pct,
            duty_max_vent_pct: distribution.duty_max_vent_pct,
            supply_pressure_bar: distribution.supply_pressure_bar,
            ..pid
        };
        loop {
            match Config::new(&settings) {
                Ok(config) => return (settings, config),
                Err(ConfigError::CoefficientOutOfRange { coefficient, .. }) => match coefficient {
                    Coefficient::Integral => settings.integral_time_ms = None,
                    Coefficient::Derivative => settings.derivative_time_ms = None,
                    Coefficient::Boost => settings.boost = None,
                },
                Err(error) => panic!("the strategy made settings that are out of range: {error}"),
            }
        }
    })
}

/// Generates any 32 bits as a pressure: far beyond the control range, at its ends, and in a truck's range.
pub(crate) fn any_pressure() -> impl Strategy<Value = Pressure> {
    prop_oneof![
        1 => any::<i32>(),
        1 => prop_oneof![Just(i32::MIN), Just(i32::MAX), Just(0), Just(-(1 << 20)), Just(1 << 20), Just((1 << 20) - 1)],
        4 => 0..=(9 << 16),
    ]
    .prop_map(Pressure::from_bits)
}

/// Generates sequences of any inputs, and of inputs close to each other, for which deadband and prediction matter.
pub(crate) fn any_inputs() -> impl Strategy<Value = Vec<Input>> {
    let wild =
        proptest::collection::vec((any_pressure(), any_pressure()), 1..40).prop_map(|pairs| {
            pairs
                .into_iter()
                .map(|(reference, pressure)| Input {
                    reference,
                    pressure,
                })
                .collect()
        });
    let close = (
        any_pressure(),
        proptest::collection::vec((-40_000..40_000, -8_000..8_000), 1..60),
    )
        .prop_map(|(reference, steps): (Pressure, Vec<(i32, i32)>)| {
            let mut error = 0;
            steps
                .into_iter()
                .map(|(jump, drift)| {
                    error = if jump % 7 == 0 { jump } else { error + drift };
                    Input {
                        reference,
                        pressure: reference.saturating_sub(Pressure::from_bits(error)),
                    }
                })
                .collect()
        });
    prop_oneof![wild, close]
}

/// SplitMix64 (Steele, Lea, Flood 2014). It is implemented here because the random numbers of a library may change.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Returns a number from `-bound` to `bound`.
    pub(crate) fn symmetric(&mut self, bound: i32) -> i32 {
        let width = 2 * bound as u64 + 1;
        (self.next() % width) as i32 - bound
    }
}

/// Bench whose reference jumps and sometimes ramps, and whose pressure follows the valves roughly, with noise and the
/// quantisation of a sensor. It reaches every regime of the controller. It uses integers only, so it is identical on
/// every machine.
pub(crate) struct Bench {
    random: Random,
    reference: i32,
    ramp: i32,
    pressure: i32,
}

impl Bench {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            random: Random(seed),
            reference: 3 << 16,
            ramp: 0,
            pressure: 0,
        }
    }

    /// Returns the next input, after the valves had these duty cycles (2⁻¹⁶ %).
    pub(crate) fn next(&mut self, duty_fill: i32, duty_vent: i32) -> Input {
        match self.random.next() % 400 {
            0 => (self.reference, self.ramp) = ((self.random.next() % (8 << 16)) as i32, 0),
            1 => self.ramp = self.random.symmetric(400),
            // Rarely, any value, far outside of a sensor's range.
            2 => self.pressure = self.random.next() as i32 >> 8,
            _ => {}
        }
        self.reference = (self.reference + self.ramp).clamp(0, 8 << 16);
        let flow = |duty: i32, drop: i32| {
            ((i64::from((duty - (35 << 16)).max(0)) * i64::from(drop.max(0))) >> 28) as i32
        };
        self.pressure = self.pressure.clamp(-(2 << 16), 10 << 16);
        self.pressure +=
            flow(duty_fill, (550 << 10) - self.pressure) - flow(duty_vent, self.pressure);
        let measured = self.pressure + self.random.symmetric(500);
        Input {
            reference: Pressure::from_bits(self.reference),
            pressure: Pressure::from_bits(measured & !0xFF),
        }
    }
}
