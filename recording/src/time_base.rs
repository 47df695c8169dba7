use std::sync::Arc;

use crate::{Bounds, Quantity};

/// Instants at which signals were sampled (s): at least one, strictly increasing. A clone shares them.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeBase {
    times_s: Arc<Vec<f64>>,
}

impl TimeBase {
    /// Creates a time base of these instants (s).
    ///
    /// # Errors
    /// Returns a [`TimeBaseError`] with the first instant that violates the order.
    pub fn new(times_s: Vec<f64>) -> Result<Self, TimeBaseError> {
        if times_s.is_empty() {
            return Err(TimeBaseError::Empty);
        }
        for (index, &time_s) in times_s.iter().enumerate() {
            if !time_s.is_finite() {
                return Err(TimeBaseError::NotFinite { index, time_s });
            }
            if time_s.abs() > Bounds::of(Quantity::Time).most {
                return Err(TimeBaseError::OutOfBounds { index, time_s });
            }
            let previous_s = if index == 0 {
                f64::NEG_INFINITY
            } else {
                times_s[index - 1]
            };
            if time_s <= previous_s {
                return Err(TimeBaseError::NotIncreasing {
                    index,
                    previous_s,
                    time_s,
                });
            }
        }
        Ok(Self {
            times_s: Arc::new(times_s),
        })
    }

    /// Creates `count` instants from `start_s`, `step_s` apart; each is computed from its index, so errors do not
    /// accumulate.
    ///
    /// # Errors
    /// Returns the errors of [`TimeBase::new`]: for a step that is not positive, or too small compared with the start
    /// to change the time.
    pub fn uniform(start_s: f64, step_s: f64, count: usize) -> Result<Self, TimeBaseError> {
        Self::new(
            (0..count)
                .map(|index| start_s + step_s * index as f64)
                .collect(),
        )
    }

    /// Returns the instants (s).
    pub fn times_s(&self) -> &[f64] {
        &self.times_s
    }

    /// Returns the instants (s) as a shared owner: they are not copied.
    pub fn shared_times_s(&self) -> Arc<Vec<f64>> {
        Arc::clone(&self.times_s)
    }

    /// Returns the number of instants, at least 1.
    #[expect(clippy::len_without_is_empty, reason = "a time base is never empty")]
    pub fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Returns the first instant (s).
    pub fn start_s(&self) -> f64 {
        self.times_s[0]
    }

    /// Returns the last instant (s).
    pub fn end_s(&self) -> f64 {
        self.times_s[self.times_s.len() - 1]
    }

    /// Returns the regularity of the sampling.
    pub fn sampling(&self) -> Sampling {
        let step_s = |pair: &[f64]| pair[1] - pair[0];
        let Some(median_s) = median_step_s(&self.times_s) else {
            return Sampling {
                median_step_s: None,
                uneven: false,
                gaps: Vec::new(),
            };
        };
        let mut sampling = Sampling {
            median_step_s: Some(median_s),
            uneven: false,
            gaps: Vec::new(),
        };
        for (index, pair) in self.times_s.windows(2).enumerate() {
            let step_s = step_s(pair);
            if step_s > Sampling::GAP_IN_MEDIAN_STEPS * median_s {
                sampling.gaps.push(Gap {
                    index_before: index,
                    start_s: pair[0],
                    end_s: pair[1],
                });
            } else if (step_s - median_s).abs() > Sampling::UNEVEN_SHARE * median_s {
                sampling.uneven = true;
            }
        }
        sampling
    }
}

/// Returns the median distance of consecutive instants (s); `None` for fewer than two.
pub fn median_step_s(times_s: &[f64]) -> Option<f64> {
    let mut steps_s: Vec<f64> = times_s.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let middle = steps_s.len() / 2;
    (middle < steps_s.len()).then(|| *steps_s.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Regularity of a time base.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampling {
    /// Median distance of two samples (s); `None` for a single sample.
    pub median_step_s: Option<f64>,
    /// Whether a step, apart from gaps, differs from the median by more than [`Sampling::UNEVEN_SHARE`].
    pub uneven: bool,
    /// Intervals without samples, in order of time.
    pub gaps: Vec<Gap>,
}

impl Sampling {
    /// Ratio to the median step above which a step is a gap: a drop-out and not jitter.
    pub const GAP_IN_MEDIAN_STEPS: f64 = 5.0;
    /// Share of the median by which steps may differ before the sampling counts as uneven.
    pub const UNEVEN_SHARE: f64 = 0.01;
}

/// Interval without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Index of the last sample before the gap.
    pub index_before: usize,
    /// Instant of the last sample before the gap (s).
    pub start_s: f64,
    /// Instant of the first sample after the gap (s).
    pub end_s: f64,
}

/// Reason why instants form no time base.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum TimeBaseError {
    /// There is no instant.
    #[error("a time base needs at least one instant")]
    Empty,
    /// An instant is NaN or infinite.
    #[error("instant {index} is {time_s} s: times must be finite")]
    NotFinite {
        /// Index of the instant, from 0.
        index: usize,
        /// Time of the instant (s).
        time_s: f64,
    },
    /// An instant is beyond the range of any logger's clock.
    #[error("instant {index} is {time_s} s: times must be within {} s of zero", Bounds::of(Quantity::Time).most)]
    OutOfBounds {
        /// Index of the instant, from 0.
        index: usize,
        /// Time of the instant (s).
        time_s: f64,
    },
    /// An instant is repeated or goes backwards.
    #[error("instant {index} is {time_s} s after {previous_s} s: times must strictly increase")]
    NotIncreasing {
        /// Index of the instant, from 0.
        index: usize,
        /// Previous instant (s).
        previous_s: f64,
        /// Time of the instant (s).
        time_s: f64,
    },
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_that_do_not_strictly_increase_are_refused_with_the_first_offender() {
        let refusal = |times: &[f64]| TimeBase::new(times.to_vec()).unwrap_err();
        assert_eq!(refusal(&[]), TimeBaseError::Empty);
        assert!(matches!(
            refusal(&[0.0, f64::NAN]),
            TimeBaseError::NotFinite { index: 1, .. }
        ));
        assert!(matches!(
            refusal(&[f64::NEG_INFINITY]),
            TimeBaseError::NotFinite { index: 0, .. }
        ));
        for second in [0.1, 0.05] {
            let expected = TimeBaseError::NotIncreasing {
                index: 1,
                previous_s: 0.1,
                time_s: second,
            };
            assert_eq!(refusal(&[0.1, second, 0.0]), expected);
        }
        assert!(matches!(
            refusal(&[-0.0, 0.0]),
            TimeBaseError::NotIncreasing { index: 1, .. }
        ));
    }

    #[test]
    fn a_uniform_base_is_even_and_its_last_instant_carries_no_accumulated_error() {
        let base = TimeBase::uniform(0.0, 0.01, 6000).unwrap();
        assert_eq!(
            (base.len(), base.start_s(), base.end_s()),
            (6000, 0.0, 0.01 * 5999.0)
        );
        let sampling = base.sampling();
        assert!((sampling.median_step_s.unwrap() - 0.01).abs() < 1e-12);
        assert!(!sampling.uneven && sampling.gaps.is_empty());
        assert!(TimeBase::uniform(0.0, 0.0, 2).is_err());
    }

    #[test]
    fn a_gap_begins_above_five_median_steps_and_is_not_jitter() {
        let with_step = |step_s: f64| {
            let mut times: Vec<f64> = (0..10).map(f64::from).collect();
            times.extend([9.0 + step_s, 10.0 + step_s]);
            TimeBase::new(times).unwrap().sampling()
        };
        assert_eq!(
            (with_step(5.0).gaps.len(), with_step(5.0).uneven),
            (0, true)
        );
        assert_eq!(
            with_step(5.5).gaps,
            [Gap {
                index_before: 9,
                start_s: 9.0,
                end_s: 14.5
            }]
        );
        assert!(!with_step(5.5).uneven);
        assert!(!with_step(1.005).uneven && with_step(1.02).uneven);
    }
}
