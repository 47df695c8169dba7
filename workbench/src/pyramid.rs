//! Long time series in few points: the lowest and the highest sample of each part, so that no peak is lost at any zoom.
//!
//! Every point is a sample of the log at its own time; nothing is averaged. Level n of a pyramid has the extremes of
//! each 8ⁿ samples, so that the cost of a view depends on its points and not on its samples.

use std::ops::Range;

use model_lab::result::Residual;

/// Samples or parts in a part of the next level.
const FANOUT: usize = 8;

/// Index of no sample: all samples of the part are missing.
const NONE: u32 = u32::MAX;

/// Extremes of a time series, level by level.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pyramid {
    levels: Vec<Vec<Extremes>>,
}

/// Values of a time series, stored or computed.
pub(crate) trait Series {
    /// Returns the number of samples.
    fn count(&self) -> usize;
    /// Returns a sample, NaN where it is missing.
    fn value(&self, index: usize) -> f64;
}

impl Series for [f64] {
    fn count(&self) -> usize {
        self.len()
    }

    fn value(&self, index: usize) -> f64 {
        self[index]
    }
}

impl<S: Series + ?Sized> Series for &S {
    fn count(&self) -> usize {
        (**self).count()
    }

    fn value(&self, index: usize) -> f64 {
        (**self).value(index)
    }
}

impl Series for Residual<'_> {
    fn count(&self) -> usize {
        self.len()
    }

    fn value(&self, index: usize) -> f64 {
        self.at(index)
    }
}

/// Indices of the lowest and the highest sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Extremes {
    lowest: u32,
    highest: u32,
}

impl Extremes {
    const NONE: Self = Self {
        lowest: NONE,
        highest: NONE,
    };

    fn of_sample(index: usize, values: &(impl Series + ?Sized)) -> Self {
        if values.value(index).is_nan() {
            return Self::NONE;
        }
        Self {
            lowest: index as u32,
            highest: index as u32,
        }
    }

    fn with(self, other: Self, values: &(impl Series + ?Sized)) -> Self {
        if self == Self::NONE {
            return other;
        }
        if other == Self::NONE {
            return self;
        }
        let value = |index: u32| values.value(index as usize);
        Self {
            lowest: if value(other.lowest) < value(self.lowest) {
                other.lowest
            } else {
                self.lowest
            },
            highest: if value(other.highest) > value(self.highest) {
                other.highest
            } else {
                self.highest
            },
        }
    }
}

impl Pyramid {
    /// Creates the pyramid of `values`, NaN if missing; at most 2³² - 1 of them.
    pub(crate) fn new(values: &(impl Series + ?Sized)) -> Self {
        let mut levels: Vec<Vec<Extremes>> = Vec::new();
        let mut below = values.count();
        while below > FANOUT {
            let pieces = below.div_ceil(FANOUT);
            let level = (0..pieces).map(|piece| {
                let children = piece * FANOUT..((piece + 1) * FANOUT).min(below);
                children.fold(Extremes::NONE, |extremes, child| {
                    let of_child = match levels.last() {
                        Some(level) => level[child],
                        None => Extremes::of_sample(child, values),
                    };
                    extremes.with(of_child, values)
                })
            });
            let level = level.collect();
            levels.push(level);
            below = pieces;
        }
        Self { levels }
    }

    /// Returns the extremes of the samples in `range`, from the largest parts within it.
    fn extremes(&self, values: &(impl Series + ?Sized), range: Range<usize>) -> Extremes {
        let mut extremes = Extremes::NONE;
        let mut at = range.start;
        while at < range.end {
            let (mut size, mut piece) = (1, Extremes::NONE);
            for (level, pieces) in self.levels.iter().enumerate() {
                let larger = FANOUT.pow(level as u32 + 1);
                if !at.is_multiple_of(larger) || at + larger > range.end {
                    break;
                }
                (size, piece) = (larger, pieces[at / larger]);
            }
            if size == 1 {
                piece = Extremes::of_sample(at, values);
            }
            extremes = extremes.with(piece, values);
            at += size;
        }
        extremes
    }

    /// Returns the indices of at most about `points` samples that show the series between `from_s` and `to_s`, with the
    /// sample before and the one after; `None` in the list is a gap.
    pub(crate) fn thin(
        &self,
        (times_s, values): (&[f64], &(impl Series + ?Sized)),
        (from_s, to_s): (f64, f64),
        points: usize,
        gap_s: f64,
    ) -> Vec<Option<usize>> {
        let first = times_s.partition_point(|&time_s| time_s < from_s);
        let last = times_s.partition_point(|&time_s| time_s <= to_s);
        let range = first.saturating_sub(1)..(last + 1).min(times_s.len());
        let shown = if range.len() <= points {
            range
                .map(|index| (!values.value(index).is_nan()).then_some(index))
                .collect()
        } else {
            self.extremes_of_pieces((times_s, values), range, points / 2)
        };
        with_gaps(shown, times_s, gap_s)
    }

    fn extremes_of_pieces(
        &self,
        (times_s, values): (&[f64], &(impl Series + ?Sized)),
        range: Range<usize>,
        pieces: usize,
    ) -> Vec<Option<usize>> {
        let pieces = pieces.max(1);
        let begin_s = times_s[range.start];
        let span_s = times_s[range.end - 1] - begin_s;
        let mut shown = Vec::with_capacity(2 * pieces);
        let mut from = range.start;
        for piece in 1..=pieces {
            let end_s = begin_s + span_s * piece as f64 / pieces as f64;
            let within = &times_s[from..range.end];
            let to = if piece == pieces {
                range.end
            } else {
                from + within.partition_point(|&time_s| time_s < end_s)
            };
            if from < to {
                let Extremes { lowest, highest } = self.extremes(values, from..to);
                if lowest == NONE {
                    shown.push(None);
                } else {
                    let (one, other) = (lowest.min(highest), lowest.max(highest));
                    shown.push(Some(one as usize));
                    if other != one {
                        shown.push(Some(other as usize));
                    }
                }
            }
            from = to;
        }
        shown
    }
}

/// Inserts a gap between consecutive samples that are more than `gap_s` apart in the log.
fn with_gaps(shown: Vec<Option<usize>>, times_s: &[f64], gap_s: f64) -> Vec<Option<usize>> {
    let mut out: Vec<Option<usize>> = Vec::with_capacity(shown.len());
    for index in shown {
        if let (Some(Some(before)), Some(here)) = (out.last().copied(), index) {
            let is_far = times_s[here] - times_s[before] > gap_s;
            let has_gap = || {
                times_s[before..=here]
                    .windows(2)
                    .any(|pair| pair[1] - pair[0] > gap_s)
            };
            if is_far && has_gap() {
                out.push(None);
            }
        }
        out.push(index);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(count: usize) -> Vec<f64> {
        (0..count).map(|index| index as f64 * 0.001).collect()
    }

    /// Returns a mixture of a random walk and a sawtooth, the same each time.
    fn trace(count: usize) -> Vec<f64> {
        let value = |index: usize| ((index * 7919) % 10_007) as f64 - (index % 300) as f64;
        (0..count).map(value).collect()
    }

    #[test]
    fn extremes_of_any_range_are_those_of_its_samples() {
        let mut values = trace(5000);
        values[700..1500].fill(f64::NAN);
        let pyramid = Pyramid::new(&values[..]);
        for (from, to) in [
            (0, 5000),
            (1, 4999),
            (7, 9),
            (699, 1501),
            (1000, 1400),
            (513, 4097),
        ] {
            let found = pyramid.extremes(&values[..], from..to);
            let there = || {
                values[from..to]
                    .iter()
                    .copied()
                    .filter(|value| !value.is_nan())
            };
            let lowest = there().fold(f64::INFINITY, f64::min);
            let highest = there().fold(f64::NEG_INFINITY, f64::max);
            if lowest > highest {
                assert_eq!(found, Extremes::NONE, "{from}..{to}");
            } else {
                assert_eq!(values[found.lowest as usize], lowest, "{from}..{to}");
                assert_eq!(values[found.highest as usize], highest, "{from}..{to}");
            }
        }
    }

    #[test]
    fn one_peak_in_a_million_samples_is_shown_and_order_is_kept() {
        let mut values = vec![0.0; 1_000_000];
        values[654_321] = 9.0;
        let times = times(values.len());
        let shown = Pyramid::new(&values[..]).thin((&times, &values[..]), (0.0, 1000.0), 800, 1.0);
        assert!(shown.len() <= 1000, "{}", shown.len());
        assert!(shown.contains(&Some(654_321)));
        let indices: Vec<usize> = shown.into_iter().flatten().collect();
        assert!(indices.is_sorted());
    }

    #[test]
    fn a_narrow_view_has_every_sample_and_its_neighbours() {
        let values = trace(10_000);
        let times = times(values.len());
        let shown =
            Pyramid::new(&values[..]).thin((&times, &values[..]), (5.0005, 5.0025), 800, 1.0);
        assert_eq!(shown, [5000, 5001, 5002, 5003].map(Some));
    }

    #[test]
    fn missing_samples_and_pauses_of_the_log_are_gaps() {
        let values = [1.0, f64::NAN, 2.0, 3.0];
        let times = [0.0, 0.1, 0.2, 5.0];
        let shown = Pyramid::new(&values[..]).thin((&times, &values[..]), (0.0, 9.0), 800, 0.5);
        assert_eq!(shown, [Some(0), None, Some(2), None, Some(3)]);
    }
}
