//! Extremes of long time series, level by level: level n has those of each 8ⁿ samples.

use std::ops::Range;

use super::Samples;

/// Samples or parts in a part of the next level.
const FANOUT: usize = 8;

/// Index of no sample: all samples of the part are missing.
const NONE: u32 = u32::MAX;

/// Extremes of a time series, from which those of any part follow without reading its samples.
#[derive(Clone, Debug, Default)]
pub struct Pyramid {
    levels: Vec<Vec<Extremes>>,
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

    fn of_sample(index: usize, values: &(impl Samples + ?Sized)) -> Self {
        if values.value(index).is_nan() {
            return Self::NONE;
        }
        Self {
            lowest: index as u32,
            highest: index as u32,
        }
    }

    fn with(self, other: Self, values: &(impl Samples + ?Sized)) -> Self {
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
    /// Creates the pyramid of `values`; at most 2³² - 1 of them.
    pub fn new(values: &(impl Samples + ?Sized)) -> Self {
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

    /// Returns the rows of the lowest and the highest sample in `range`, the earlier one first; `None` if all samples are
    /// missing. The extremes of the largest parts within the range are used.
    pub(super) fn extremes(
        &self,
        values: &(impl Samples + ?Sized),
        range: Range<usize>,
    ) -> Option<[usize; 2]> {
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
        (extremes != Extremes::NONE).then(|| {
            let Extremes { lowest, highest } = extremes;
            [lowest.min(highest), lowest.max(highest)].map(|row| row as usize)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_of_any_range_are_those_of_its_samples() {
        // A mixture of a random walk and a sawtooth.
        let value = |row: usize| ((row * 7919) % 10_007) as f64 - (row % 300) as f64;
        let mut values: Vec<f64> = (0..5000).map(value).collect();
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
            let there = values[from..to].iter().filter(|value| !value.is_nan());
            let least = there.clone().copied().min_by(f64::total_cmp);
            let greatest = there.copied().max_by(f64::total_cmp);
            let found = pyramid.extremes(&values[..], from..to);
            let found = found.map(|rows| rows.map(|row| values[row]));
            let found = found.map(|[a, b]| (a.min(b), a.max(b)));
            assert_eq!(found, least.zip(greatest), "{from}..{to}");
        }
    }
}
