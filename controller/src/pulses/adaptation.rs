//! Adaptation of a valve, its gain and its opening delay, and of the lag of the pressure, from the pressure after each run.
//!
//! A run of open time W moves the flow coordinate by g k (W - o): g is the gain over the nominal rate k, o the delay over
//! that of the table. The error e = Δσ/(g k) - W is known after the run. Gain and delay follow it by the gradient of e²
//! (least mean squares): o along -e, g along e W. A long run says more about g, a short one about o.

/// Largest error that a run counts with (µs): a larger one is a disturbance.
const ERROR_MAX_US: i32 = 3_000;
/// Shortest open time that says something about the valve (µs).
const OPEN_MIN_US: i32 = 500;
/// Open time below which a run says more about the delay than about the gain (µs).
const SHORT_US: i32 = 6_000;
/// Longest open time that counts (µs).
const OPEN_MAX_US: i32 = 32_000;
/// Fraction bits of an inverse gain.
const GAIN_BITS: u32 = 24;
/// log₂ of the share of an error that an offset follows.
const SHARE_BITS: u32 = 2;

/// Bounds of the adaptation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Bounds {
    /// Largest offset (µs).
    offset_max: i32,
    /// Largest deviation of the inverse gain from 1, 2⁻²⁴.
    gain_max: i32,
}

impl Bounds {
    /// Creates the bounds from an offset (µs) and a gain (%, 2⁻¹⁶).
    pub(super) const fn new(offset_max: i32, gain_max_pct: i32) -> Self {
        Self {
            offset_max,
            gain_max: (((gain_max_pct as i64) << (GAIN_BITS - 16)) / 100) as i32,
        }
    }
}

/// Adapted values of one valve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Adaptation {
    /// Additional on-time of a run (µs).
    offset_us: i32,
    /// Open time for the same change of the flow coordinate, over the nominal one, less 1; 2⁻²⁴.
    inverse_gain: i32,
}

impl Adaptation {
    /// Valve of the table.
    pub(super) const NOMINAL: Self = Self {
        offset_us: 0,
        inverse_gain: 0,
    };

    /// Returns the additional on-time of a run (µs).
    #[inline(always)]
    pub(super) const fn offset(&self) -> i32 {
        self.offset_us
    }

    /// Returns the open time (µs) that this valve needs where the nominal one needs `open_us`.
    #[inline(always)]
    pub(super) const fn open_time(&self, open_us: i32) -> i32 {
        let change = (open_us as i64).wrapping_mul(self.inverse_gain as i64) >> GAIN_BITS;
        open_us.wrapping_add(change as i32)
    }

    /// Follows the error of a run: its open time by the pressure, `seen_us`, and by the table, `given_us`.
    #[inline(always)]
    pub(super) fn learn(&mut self, bounds: &Bounds, seen_us: i32, given_us: i32) {
        if given_us < OPEN_MIN_US {
            return;
        }
        let error = seen_us
            .wrapping_sub(given_us)
            .clamp(-ERROR_MAX_US, ERROR_MAX_US);
        let bits = if given_us < SHORT_US {
            SHARE_BITS
        } else {
            SHARE_BITS + 2
        };
        let offset = self.offset_us.wrapping_sub(error >> bits);
        self.offset_us = within(offset, bounds.offset_max);
        // e W over 4 OPEN_MAX² in 2⁻²⁴: (32 ms)² is nearly 2³⁰ µs², and 30 + 2 - 24 is 8.
        let change = error.wrapping_mul(given_us.min(OPEN_MAX_US)) >> 8;
        self.inverse_gain = within(self.inverse_gain.wrapping_sub(change), bounds.gain_max);
    }
}

/// Time by which the measured pressure lags behind the flow, beyond the command delay (µs): a slow sensor, a dead volume,
/// or another command delay.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(super) struct Lag(i32);

/// Smallest lag (µs): the scatter of the command delay.
const LAG_MIN_US: i32 = -2_000;
/// Largest error of a lag that a run counts with (µs).
const LAG_ERROR_MAX_US: i32 = 8_000;
/// Shortest flow whose pressure shows a lag (µs).
const PASSED_MIN_US: i32 = 4_000;

impl Lag {
    /// No lag.
    pub(super) const NONE: Self = Self(0);

    /// Returns the lag (µs).
    #[inline(always)]
    pub(super) const fn get(self) -> i32 {
        self.0
    }

    /// Returns the error of the lag (µs) while flow is under way: open time that has passed, less the one that the
    /// pressure shows. It is 0 if too little has passed.
    #[inline(always)]
    pub(super) fn error(seen_us: i32, passed_us: i32) -> i32 {
        if passed_us < PASSED_MIN_US {
            return 0;
        }
        within(passed_us.wrapping_sub(seen_us), LAG_ERROR_MAX_US)
    }

    /// Follows the error of a run.
    #[inline(always)]
    pub(super) fn learn(&mut self, lag_max: i32, error_us: i32) {
        let lag = self.0.wrapping_add(error_us >> SHARE_BITS);
        self.0 = lag.max(LAG_MIN_US).min(lag_max);
    }
}

#[inline(always)]
fn within(value: i32, bound: i32) -> i32 {
    value.max(bound.wrapping_neg()).min(bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Bounds = Bounds::new(2_000, 20 << 16);

    /// Goal: gain and delay are separated. Method: runs of two lengths on a valve with another gain and delay.
    #[test]
    fn runs_of_two_lengths_find_gain_and_delay() {
        let (gain, delay_us) = (0.9, 600.0);
        let mut valve = Adaptation::NOMINAL;
        for run in 0..400 {
            let given = if run % 2 == 0 { 3_000 } else { 30_000 };
            // The offset lengthens the run, so it compensates the delay.
            let open = f64::from(given) - delay_us + f64::from(valve.offset());
            let seen = valve.open_time((gain * open).round() as i32);
            valve.learn(&BOUNDS, seen, given);
        }
        assert!(
            (f64::from(valve.offset()) - delay_us).abs() < 60.0,
            "{valve:?}"
        );
        let needed = f64::from(valve.open_time(9_000)) / 9_000.0;
        assert!((needed - 1.0 / gain).abs() < 0.01, "{needed}");
    }

    #[test]
    fn neither_leaves_its_bounds_and_a_run_without_flow_changes_nothing() {
        for (seen, offset, needed) in [(0, 2_000, 12_000), (100_000, -2_000, 8_000)] {
            let mut valve = Adaptation::NOMINAL;
            valve.learn(&BOUNDS, seen, OPEN_MIN_US - 1);
            assert_eq!(valve, Adaptation::NOMINAL);
            for _ in 0..100 {
                valve.learn(&BOUNDS, seen, 30_000);
            }
            assert_eq!(valve.offset(), offset);
            assert!(valve.open_time(10_000).abs_diff(needed) <= 1);
        }
    }

    /// One run of 2 ms that is 0.4 ms short.
    #[test]
    fn a_run_moves_the_offset_by_a_quarter_of_its_error_and_a_short_one_hardly_the_gain() {
        let mut valve = Adaptation::NOMINAL;
        valve.learn(&BOUNDS, 1_600, 2_000);
        assert_eq!(valve.offset(), 100);
        assert_eq!(valve.open_time(1 << 14), (1 << 14) + 3);
        let mut valve = Adaptation::NOMINAL;
        valve.learn(&BOUNDS, 0, OPEN_MIN_US);
        assert_eq!(valve.offset(), 125);
        let mut valve = Adaptation::NOMINAL;
        valve.learn(&BOUNDS, SHORT_US - 800, SHORT_US);
        assert_eq!(valve.offset(), 50);
        let mut valve = Adaptation::NOMINAL;
        valve.learn(&BOUNDS, 90_000, 80_000);
        // The error counts with 3 ms, the open time with 32 ms; a long run says little about the offset.
        assert_eq!(valve.offset(), -187);
        assert_eq!(valve.inverse_gain, -375_000);
    }

    #[test]
    fn a_lag_follows_a_quarter_of_its_error_within_its_bounds() {
        assert_eq!(Lag::error(1_000, PASSED_MIN_US - 1), 0);
        assert_eq!(Lag::error(1_000, PASSED_MIN_US), 3_000);
        assert_eq!(Lag::error(0, 30_000), LAG_ERROR_MAX_US);
        assert_eq!(Lag::error(30_000, 10_000), -LAG_ERROR_MAX_US);
        let mut lag = Lag::NONE;
        lag.learn(20_000, 3_000);
        assert_eq!(lag.get(), 750);
        for (error, bound) in [(8_000, 20_000), (-8_000, LAG_MIN_US)] {
            for _ in 0..100 {
                lag.learn(20_000, error);
            }
            assert_eq!(lag.get(), bound);
        }
    }
}
