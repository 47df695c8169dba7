//! Evaluation of the processor's converter: means over a PWM period, and scaling.

use controller::Pressure;

/// Highest code of the processor's converter, 12 bits.
pub const CODE_MAX: u16 = 4095;

/// Mean of all codes since the last call of [`Mean::take`].
///
/// A coil's current rises and falls within a PWM period; its mean distinguishes a broken coil from a healthy one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mean {
    sum: u32,
    count: u32,
}

impl Mean {
    /// Creates a mean without codes.
    pub const fn new() -> Self {
        Self { sum: 0, count: 0 }
    }

    /// Adds a code. After a million codes, which is minutes without being taken, further ones are ignored.
    pub fn add(&mut self, code: u16) {
        if self.count < 1 << 20 {
            self.sum = self.sum.saturating_add(u32::from(code.min(CODE_MAX)));
            self.count = self.count.saturating_add(1);
        }
    }

    /// Returns the mean, rounded to nearest, and starts again; `None` without codes.
    pub fn take(&mut self) -> Option<u16> {
        let Self { sum, count } = core::mem::take(self);
        let mean = sum.saturating_add(count >> 1).checked_div(count)?;
        u16::try_from(mean).ok()
    }
}

/// Returns the value of a code whose highest value corresponds to `full_scale`, rounded to nearest.
pub fn scaled(code: u16, full_scale: u16) -> u16 {
    let product = u32::from(code.min(CODE_MAX)).saturating_mul(u32::from(full_scale));
    (product.saturating_add(u32::from(CODE_MAX / 2)) / u32::from(CODE_MAX)) as u16
}

/// Returns the reference set by the lever, a potentiometer between two resistors: one end is 10 % of the supply, the
/// other 90 %. 10 to 90 % give 0 to 6 bar gauge, the operating range of the thesis' retarder (0.71 of 8.4 bar, section
/// 6.4.2). Up to 5 % beyond an end gives that end. Further out a wire is broken or shorted, and the result is `None`.
pub fn lever_reference(code: u16) -> Option<Pressure> {
    const TENTH: i32 = 410;
    const NINE_TENTHS: i32 = 3686;
    const MARGIN: i32 = 205;
    /// Full travel (2⁻¹⁶ bar gauge).
    const FULL: i32 = 6 << 16;
    let code = i32::from(code);
    if !(TENTH - MARGIN..=NINE_TENTHS + MARGIN).contains(&code) {
        return None;
    }
    let travel = (code - TENTH).clamp(0, NINE_TENTHS - TENTH);
    // At most 3276 · 120. The slope is rounded once, so that full travel gives 1.5 mbar less than 6 bar.
    Some(Pressure::from_bits(travel * (FULL / (NINE_TENTHS - TENTH))))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mean_is_the_nearest_and_begins_anew() {
        let mut mean = Mean::new();
        for code in [10, 11, 11] {
            mean.add(code);
        }
        assert_eq!(mean.take(), Some(11));
        assert_eq!(mean.take(), None);
        mean.add(CODE_MAX);
        assert_eq!(mean.take(), Some(CODE_MAX));
    }

    #[test]
    fn a_mean_that_nobody_takes_stays_a_mean() {
        let mut mean = Mean::new();
        for _ in 0..2_000_000 {
            mean.add(CODE_MAX);
        }
        assert_eq!(mean.take(), Some(CODE_MAX));
    }

    #[test]
    fn a_scale_is_exact_at_both_ends_and_nearest_between() {
        for full_scale in [0, 1, 1000, 36_300, u16::MAX] {
            assert_eq!(scaled(0, full_scale), 0);
            assert_eq!(scaled(CODE_MAX, full_scale), full_scale);
            assert_eq!(scaled(u16::MAX, full_scale), full_scale);
            for code in 0..=CODE_MAX {
                let exact = f64::from(code) * f64::from(full_scale) / 4095.0;
                assert!((f64::from(scaled(code, full_scale)) - exact).abs() <= 0.5);
            }
        }
    }

    #[test]
    fn the_lever_asks_for_nothing_at_one_end_and_for_6_bar_at_the_other() {
        let bar = |code| lever_reference(code).map(|p| f64::from(p.to_bits()) / 65_536.0);
        assert_eq!(bar(410), Some(0.0));
        assert_eq!(bar(205), Some(0.0));
        assert!((bar(3686).unwrap() - 6.0).abs() < 0.003);
        assert_eq!(bar(3891), bar(3686));
        assert!((bar(2048).unwrap() - 3.0).abs() < 0.003);
    }

    #[test]
    fn a_lever_with_a_broken_or_shorted_wire_asks_for_nothing_valid() {
        for code in [0, 204, 3892, 4095, u16::MAX] {
            assert_eq!(lever_reference(code), None, "{code}");
        }
    }
}
