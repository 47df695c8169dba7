//! Settings that the search changes.

use controller::fixed::types::I16F16;
use controller::{Boost, Prediction, Settings};

/// One setting and its range in the search.
#[derive(Debug)]
pub struct Gain {
    /// Key in a controller file, with its unit at the end.
    pub key: &'static str,
    /// Lowest and highest value in the search, which is logarithmic.
    pub range: [f64; 2],
    /// Returns the value; `None` if the controller has no such part.
    pub value: fn(&Settings) -> Option<f64>,
    set: fn(&mut Settings, I16F16),
}

/// All of them.
pub const GAINS: [Gain; 5] = [
    Gain {
        key: "gain_pct_per_bar",
        range: [2.0, 500.0],
        value: |settings| Some(settings.gain_pct_per_bar.to_num()),
        set: |settings, value| settings.gain_pct_per_bar = value,
    },
    Gain {
        key: "integral_time_ms",
        range: [30.0, 10_000.0],
        value: |settings| settings.integral_time_ms.map(I16F16::to_num),
        set: |settings, value| settings.integral_time_ms = Some(value),
    },
    Gain {
        key: "derivative_time_ms",
        range: [1.0, 200.0],
        value: |settings| settings.derivative_time_ms.map(I16F16::to_num),
        set: |settings, value| settings.derivative_time_ms = Some(value),
    },
    Gain {
        key: "rate_pct_per_bar_s",
        range: [10.0, 5000.0],
        value: |settings| {
            let boost = settings.boost?;
            Some(boost.rate_pct_per_bar_s.to_num())
        },
        set: |settings, rate_pct_per_bar_s| {
            settings.boost = settings.boost.map(|boost| Boost {
                rate_pct_per_bar_s,
                ..boost
            });
        },
    },
    Gain {
        key: "response_bar",
        range: [0.01, 1.0],
        value: |settings| {
            let boost = settings.boost?;
            Some(boost.response_bar.to_num())
        },
        set: |settings, response_bar| {
            settings.boost = settings.boost.map(|boost| Boost {
                response_bar,
                ..boost
            });
        },
    },
];

/// Prediction horizons of the search.
pub(super) const HORIZONS: [Prediction; 3] =
    [Prediction::Off, Prediction::OneStep, Prediction::TwoStep];

impl Gain {
    /// Sets the value within its range in the search; does nothing if the controller has no such part.
    pub fn set(&self, settings: &mut Settings, value: f64) {
        if (self.value)(settings).is_some() {
            let [low, high] = self.range;
            let value = rounded(value.clamp(low, high));
            (self.set)(settings, I16F16::saturating_from_num(value));
        }
    }
}

/// Rounds to three digits, which a person can read and type.
fn rounded(value: f64) -> f64 {
    let digits = 2 - value.abs().log10().floor() as i32;
    let scale = 10_f64.powi(digits);
    (value * scale).round() / scale
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_gain_is_set_within_its_range_and_a_part_that_is_off_stays_off() {
        for gain in &GAINS {
            let mut settings = Settings::recommended();
            for (wanted, expected) in [
                (0.0, gain.range[0]),
                (1e9, gain.range[1]),
                (
                    gain.range[0] * 1.2345678,
                    rounded(gain.range[0] * 1.2345678),
                ),
            ] {
                gain.set(&mut settings, wanted);
                let value = (gain.value)(&settings).unwrap();
                assert!((value - expected).abs() < 1e-4, "{}: {value}", gain.key);
            }
        }
        let mut settings = Settings {
            boost: None,
            integral_time_ms: None,
            ..Settings::recommended()
        };
        let before = settings;
        for gain in &GAINS[1..] {
            if (gain.value)(&settings).is_none() {
                gain.set(&mut settings, 100.0);
            }
        }
        assert_eq!(settings, before);
    }

    #[test]
    fn a_value_has_three_digits() {
        assert_eq!(rounded(123.456), 123.0);
        assert_eq!(rounded(0.0123456), 0.0123);
        assert_eq!(rounded(9.999), 10.0);
    }
}
