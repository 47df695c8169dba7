//! Values of one time series at the instants of another.

use recording::Trace;
use serde::{Deserialize, Serialize};

/// Instants closer than this share of a step count as equal: shifted times differ in their last bits.
const SAME_IN_MEDIAN_STEPS: f64 = 1e-6;

/// Interpolation between two samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Between {
    /// Linear between both.
    Linear,
    /// Value of the earlier one, as for a command.
    Hold,
}

/// Returns the values of a series at the increasing `instants_s`. NaN before its first and after its last sample, in its
/// gaps, and if a required sample is missing.
pub(crate) fn at_instants(
    trace: &Trace<'_, &[f64]>,
    instants_s: impl Iterator<Item = f64>,
    between: Between,
) -> Vec<f64> {
    let (times_s, values) = (trace.times_s(), trace.values());
    let same_s = SAME_IN_MEDIAN_STEPS * trace.step_s();
    let gap_s = trace.gap_s();
    let mut next = 0;
    let value = |instant_s: f64| {
        while times_s
            .get(next)
            .is_some_and(|time_s| *time_s <= instant_s + same_s)
        {
            next += 1;
        }
        let Some(last) = next.checked_sub(1) else {
            return f64::NAN;
        };
        let since_s = instant_s - times_s[last];
        if since_s <= same_s {
            return values[last];
        }
        let Some(interval_s) = times_s.get(next).map(|time_s| time_s - times_s[last]) else {
            return f64::NAN;
        };
        match between {
            _ if interval_s > gap_s => f64::NAN,
            Between::Hold => values[last],
            Between::Linear => values[last] + since_s / interval_s * (values[next] - values[last]),
        }
    };
    instants_s.map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const TIMES_S: [f64; 6] = [0.0, 1.0, 2.0, 3.0, 30.0, 31.0];
    const VALUES: [f64; 6] = [0.0, 10.0, f64::NAN, 30.0, 40.0, 50.0];

    fn at(instants_s: &[f64], between: Between) -> Vec<Option<f64>> {
        let found = at_instants(
            &Trace::new(&TIMES_S[..], &VALUES[..], 1.0),
            instants_s.iter().copied(),
            between,
        );
        found
            .into_iter()
            .map(|value| (!value.is_nan()).then_some(value))
            .collect()
    }

    #[test]
    fn between_two_samples_it_is_the_line_or_the_earlier_one() {
        let instants_s = [0.0, 0.25, 1.0, 30.5, 31.0];
        let expected = |inner: [f64; 2]| [0.0, inner[0], 10.0, inner[1], 50.0].map(Some);
        assert_eq!(at(&instants_s, Between::Linear), expected([2.5, 45.0]));
        assert_eq!(at(&instants_s, Between::Hold), expected([0.0, 40.0]));
    }

    #[test]
    fn there_is_nothing_outside_in_a_gap_or_beside_a_missing_sample() {
        let instants_s = [-0.5, 1.5, 2.0, 2.5, 10.0, 31.5];
        assert_eq!(at(&instants_s, Between::Linear), [None; 6]);
        let held = [None, Some(10.0), None, None, None, None];
        assert_eq!(at(&instants_s, Between::Hold), held);
    }

    #[test]
    fn instants_that_differ_in_their_last_bits_are_the_same() {
        assert_eq!(at(&[1.0 - 1e-9], Between::Hold), [Some(10.0)]);
        assert_eq!(at(&[31.0 + 1e-9], Between::Linear), [Some(50.0)]);
    }
}
