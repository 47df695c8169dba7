//! Tolerance band of a signal around its residual, and the share of the residual beyond it.

use recording::{Samples, TimeBase};
use serde::Serialize;

use crate::pages::points::{Drawn, Points, Range};
use crate::refusal::Refusal;
use crate::tolerance::Tolerance;

/// Tolerance in a view.
#[derive(Serialize)]
pub(super) struct Band {
    /// Lowest residual within the tolerance.
    low: Points,
    /// Highest residual within the tolerance.
    high: Points,
    /// Samples in the view with a residual.
    samples: usize,
    /// Share of these samples that is beyond the band.
    beyond: f64,
    /// Allowed share.
    beyond_max: f64,
    /// Whether the share in the view is allowed; `None` without samples.
    holds: Option<bool>,
}

impl Band {
    /// Returns the band of `tolerance` around the residual `errors` of `measured`, both on `base`. Only the visible
    /// range decides whether the samples are within it; it is also drawn beside that range.
    pub(super) fn of(
        tolerance: &Tolerance,
        (base, measured, errors): (&TimeBase, &[f64], &(impl Samples + ?Sized)),
        seen: Range,
        drawn: Drawn,
    ) -> Result<Self, Refusal> {
        let (within, _) = drawn.range.of(base)?;
        let times_s = base.times_s();
        // One more sample on either side, for lines that reach the edges.
        let rows = within.start.saturating_sub(1)..(within.end + 1).min(times_s.len());
        let [low, high] = tolerance.bounds(times_s, measured, rows.clone());
        let (judged, _) = seen.of(base)?;
        let judged = judged.map(|row| (errors.value(row), row - rows.start));
        let judged = judged.filter(|(error, _)| !error.is_nan());
        let is_beyond = |(error, row): (f64, usize)| error < low[row] || error > high[row];
        let (mut samples, mut beyond) = (0, 0);
        for sample in judged {
            samples += 1;
            beyond += usize::from(is_beyond(sample));
        }
        let share = if samples > 0 {
            beyond as f64 / samples as f64
        } else {
            0.0
        };
        let points = |bound: &[f64]| match TimeBase::new(times_s[rows.clone()].to_vec()) {
            Ok(base) => Points::of(&base, bound, drawn),
            // The view contains nothing of the log.
            Err(_) => Ok(Points::default()),
        };
        Ok(Self {
            low: points(&low)?,
            high: points(&high)?,
            samples,
            beyond: share,
            beyond_max: tolerance.beyond_max,
            holds: (samples > 0).then_some(share <= tolerance.beyond_max),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_beyond_the_band_are_counted_in_the_view_alone() {
        let base = TimeBase::uniform(0.0, 0.1, 100).unwrap();
        let measured = vec![1.0; 100];
        let mut errors = vec![0.0; 100];
        (errors[3], errors[10], errors[20], errors[30]) = (9.0, 0.3, -0.3, f64::NAN);
        let mut tolerance = Tolerance {
            absolute: 0.2,
            relative: 0.0,
            time_s: 0.0,
            beyond_max: 0.0,
        };
        let range = Range {
            from_s: Some(0.95),
            to_s: Some(4.95),
        };
        let band = |tolerance: &Tolerance| {
            Band::of(
                tolerance,
                (&base, &measured, &errors[..]),
                range,
                Drawn { range, points: 100 },
            )
            .unwrap()
        };
        let found = band(&tolerance);
        assert_eq!((found.samples, found.holds), (39, Some(false)));
        assert_eq!(found.beyond, 2.0 / 39.0);
        tolerance.beyond_max = 0.06;
        assert_eq!(band(&tolerance).holds, Some(true));
        let nowhere = Range {
            from_s: Some(900.0),
            to_s: Some(901.0),
        };
        let found = Band::of(
            &tolerance,
            (&base, &measured, &errors[..]),
            nowhere,
            Drawn {
                range: nowhere,
                points: 100,
            },
        )
        .unwrap();
        assert_eq!((found.samples, found.holds), (0, None));
    }
}
