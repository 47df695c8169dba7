//! Settings that the search changes.

use controller::fixed::types::I16F16;
use controller::{Field, Prediction, Settings};

/// One setting and its range in the search.
#[derive(Debug)]
pub struct Gain {
    /// Setting of the controller.
    pub field: Field,
    /// Lowest and highest value in the search, which is logarithmic.
    pub range: [f64; 2],
}

const fn gain(field: Field, low: f64, high: f64) -> Gain {
    Gain {
        field,
        range: [low, high],
    }
}

/// All of them.
pub const GAINS: [Gain; 5] = [
    gain(Field::Gain, 2.0, 500.0),
    gain(Field::IntegralTime, 30.0, 10_000.0),
    gain(Field::DerivativeTime, 1.0, 200.0),
    gain(Field::BoostRate, 10.0, 5000.0),
    gain(Field::BoostResponse, 0.01, 1.0),
];

/// Prediction horizons of the search.
pub(super) const HORIZONS: [Prediction; 3] =
    [Prediction::Off, Prediction::OneStep, Prediction::TwoStep];

impl Gain {
    /// Returns the value; `None` if the controller has no such part.
    pub fn value(&self, settings: &Settings) -> Option<f64> {
        self.field
            .get(settings)
            .map(|bits| I16F16::from_bits(bits).to_num())
    }

    /// Sets the value within its range in the search; does nothing if the controller has no such part.
    pub fn set(&self, settings: &mut Settings, value: f64) {
        let [low, high] = self.range;
        let value = I16F16::saturating_from_num(rounded(value.clamp(low, high)));
        self.field.set(settings, value.to_bits());
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
                let value = gain.value(&settings).unwrap();
                assert!((value - expected).abs() < 1e-4, "{gain:?}: {value}");
            }
        }
        let off = Settings {
            boost: None,
            integral_time_ms: None,
            derivative_time_ms: None,
            ..Settings::recommended()
        };
        let mut settings = off;
        for gain in &GAINS[1..] {
            gain.set(&mut settings, 100.0);
        }
        assert_eq!(settings, off);
    }

    #[test]
    fn a_value_has_three_digits() {
        assert_eq!(rounded(123.456), 123.0);
        assert_eq!(rounded(0.0123456), 0.0123);
        assert_eq!(rounded(9.999), 10.0);
    }
}
