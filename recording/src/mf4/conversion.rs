//! Conversion of a logged number into its physical value (ASAM MDF 4.1, CC block).

use std::io::{Read, Seek};

use super::blocks::{Block, Blocks};
use super::error::Located;

/// Size of a conversion before its parameters (bytes).
const HEAD_BYTES: usize = 24;
/// Maximum nesting: a table of texts may refer unlisted values to another conversion, which may do the same.
const DEPTH_MAX: usize = 4;

/// Conversion of a logged number.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Conversion {
    /// Identity: the number itself.
    Identity,
    /// offset + factor · x
    Linear { offset: f64, factor: f64 },
    /// (a x² + b x + c) / (d x² + e x + f)
    Rational([f64; 6]),
    /// Pairs of key and value: linear interpolation between the keys, the outermost value beyond them.
    Interpolated(Vec<(f64, f64)>),
    /// Pairs of key and value: the value of the nearest key, in the middle that of the lower one.
    Nearest(Vec<(f64, f64)>),
    /// Lower end, upper end and value of ranges in increasing order, and the value of all other numbers.
    Ranges(Vec<[f64; 3]>, f64),
    /// Ranges of numbers that represent texts, in increasing order, and the conversion of the other numbers. `None`:
    /// all numbers stay unchanged.
    Texts(Vec<[f64; 2]>, Option<Box<Conversion>>),
}

/// Conversion, or the reason why there is none.
pub(super) type Converted = Result<Conversion, &'static str>;

impl<R: Read + Seek> Blocks<R> {
    /// Reads the conversion at `offset`; `integers` says whether the channel has integers.
    pub(super) fn conversion(&mut self, offset: u64, integers: bool) -> Result<Converted, Located> {
        self.conversion_within(offset, integers, DEPTH_MAX)
    }

    fn conversion_within(
        &mut self,
        offset: u64,
        integers: bool,
        depth: usize,
    ) -> Result<Converted, Located> {
        if offset == 0 {
            return Ok(Ok(Conversion::Identity));
        }
        let block = self.block("##CC", offset)?;
        block.require(HEAD_BYTES)?;
        let parameters = block.floats(HEAD_BYTES);
        let is_finite = parameters.iter().all(|parameter| !parameter.is_nan());
        if !is_finite {
            return Ok(Err("its conversion has a parameter that is not a number"));
        }
        let at_least = |count: usize| block.require(HEAD_BYTES + 8 * count);
        let pairs = || -> Vec<(f64, f64)> {
            let pairs = parameters.chunks_exact(2);
            pairs.map(|pair| (pair[0], pair[1])).collect()
        };
        Ok(Ok(match block.u8(0) {
            0 => Conversion::Identity,
            1 => {
                at_least(2)?;
                let (offset, factor) = (parameters[0], parameters[1]);
                Conversion::Linear { offset, factor }
            }
            2 => {
                at_least(6)?;
                let [a, b, c, d, e, f] = [0, 1, 2, 3, 4, 5].map(|at| parameters[at]);
                Conversion::Rational([a, b, c, d, e, f])
            }
            3 => {
                return Ok(Err(
                    "its conversion is a formula as text; export it as numbers",
                ));
            }
            kind @ (4 | 5) => {
                at_least(2)?;
                let pairs = pairs();
                if pairs.windows(2).any(|pair| pair[1].0 <= pair[0].0) {
                    return Ok(Err("the keys of its conversion table do not increase"));
                }
                match kind {
                    4 => Conversion::Interpolated(pairs),
                    _ => Conversion::Nearest(pairs),
                }
            }
            6 => {
                at_least(1)?;
                let mut rows: Vec<[f64; 3]> = parameters
                    .chunks_exact(3)
                    .map(|row| [row[0], row[1], row[2]])
                    .collect();
                if !integers {
                    rows.iter_mut()
                        .for_each(|row| row[1] = below(row[0], row[1]));
                }
                rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
                if rows.windows(2).any(|pair| pair[1][0] <= pair[0][1]) {
                    return Ok(Err("the ranges of its conversion table overlap"));
                }
                let others = parameters.chunks_exact(3).remainder().first();
                Conversion::Ranges(rows, others.copied().unwrap_or(f64::NAN))
            }
            kind @ (7 | 8) => return self.texts(&block, kind, integers, depth),
            9 | 10 => return Ok(Err("it is a text")),
            11 => return Ok(Err("it is a set of bits with texts")),
            kind => {
                let expected = "0 to 11, the kinds of MDF 4";
                return Err(block.field("the kind of the conversion", u64::from(kind), expected));
            }
        }))
    }

    /// Reads a table of texts, with the conversion of the numbers that it does not list.
    fn texts(
        &mut self,
        block: &Block,
        kind: u8,
        integers: bool,
        depth: usize,
    ) -> Result<Converted, Located> {
        let keys = block.floats(HEAD_BYTES);
        let rows: Vec<[f64; 2]> = match kind {
            7 => keys.iter().map(|&key| [key, key]).collect(),
            _ if integers => keys.chunks_exact(2).map(|row| [row[0], row[1]]).collect(),
            _ => {
                let rows = keys.chunks_exact(2);
                rows.map(|row| [row[0], below(row[0], row[1])]).collect()
            }
        };
        // The links after the four of every conversion: one for each row, then one for all other numbers.
        let link = block.link(4 + rows.len());
        let is_conversion = link != 0 && self.head("##CC", link)?.id == *b"##CC";
        if !is_conversion {
            return Ok(Ok(Conversion::Texts(Vec::new(), None)));
        }
        let texts = merged(rows);
        if depth == 0 {
            return Ok(Err("its conversion refers to others too often"));
        }
        let others = self.conversion_within(link, integers, depth - 1)?;
        Ok(others.map(|others| Conversion::Texts(texts, Some(Box::new(others)))))
    }
}

/// Returns the upper end of a range of floats, which is excluded unless it equals the lower end.
fn below(low: f64, high: f64) -> f64 {
    if high > low { high.next_down() } else { high }
}

/// Returns the same numbers in increasing ranges that do not touch.
fn merged(mut ranges: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut merged: Vec<[f64; 2]> = Vec::with_capacity(ranges.len());
    for [low, high] in ranges {
        match merged.last_mut() {
            Some(last) if low <= last[1] => last[1] = last[1].max(high),
            _ => merged.push([low, high]),
        }
    }
    merged
}

impl Conversion {
    /// Returns the treatment of the numbers that represent texts; `None` if there are none.
    pub(super) fn of_texts(&self) -> Option<&'static str> {
        match self {
            Self::Texts(_, None) => Some("it holds the numbers"),
            Self::Texts(_, Some(_)) => Some("samples that are texts are missing"),
            _ => None,
        }
    }

    /// Converts numbers. NaN stays NaN; a number that represents a text becomes NaN if other numbers of the channel are
    /// quantities.
    pub(super) fn apply(&self, values: &mut [f64]) {
        match self {
            Self::Identity | Self::Texts(_, None) => {}
            Self::Linear { offset, factor } => {
                // Adding 0.0 would turn -0.0 into 0.0.
                if *offset == 0.0 {
                    values.iter_mut().for_each(|value| *value *= factor);
                } else {
                    let convert = |value: &mut f64| *value = *value * factor + offset;
                    values.iter_mut().for_each(convert);
                }
            }
            _ => values
                .iter_mut()
                .for_each(|value| *value = self.meaning(*value)),
        }
    }

    fn meaning(&self, x: f64) -> f64 {
        if x.is_nan() {
            return x;
        }
        match self {
            Self::Identity | Self::Texts(_, None) => x,
            Self::Linear { offset, factor } => x * factor + offset,
            Self::Rational([a, b, c, d, e, f]) => ((a * x + b) * x + c) / ((d * x + e) * x + f),
            Self::Interpolated(pairs) => interpolated(pairs, x),
            Self::Nearest(pairs) => nearest(pairs, x),
            Self::Ranges(rows, others) => {
                let above = rows.partition_point(|row| row[0] <= x);
                let row = above.checked_sub(1).map(|below| rows[below]);
                row.filter(|row| x <= row[1]).map_or(*others, |row| row[2])
            }
            Self::Texts(texts, Some(others)) => {
                let above = texts.partition_point(|text| text[0] <= x);
                let is_text = above
                    .checked_sub(1)
                    .is_some_and(|below| x <= texts[below][1]);
                if is_text { f64::NAN } else { others.meaning(x) }
            }
        }
    }
}

fn interpolated(pairs: &[(f64, f64)], x: f64) -> f64 {
    let above = pairs.partition_point(|&(key, _)| key <= x);
    match (
        above.checked_sub(1).map(|below| pairs[below]),
        pairs.get(above),
    ) {
        (Some((low, from)), Some(&(high, to))) => from + (to - from) * ((x - low) / (high - low)),
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => f64::NAN,
    }
}

fn nearest(pairs: &[(f64, f64)], x: f64) -> f64 {
    let above = pairs.partition_point(|&(key, _)| key <= x);
    match (
        above.checked_sub(1).map(|below| pairs[below]),
        pairs.get(above),
    ) {
        (Some((low, from)), Some(&(high, to))) => {
            if x - low <= high - x {
                from
            } else {
                to
            }
        }
        (Some((_, value)), None) | (None, Some(&(_, value))) => value,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(conversion: &Conversion, expected: &[(f64, f64)]) {
        for &(x, y) in expected {
            let mut values = [x];
            conversion.apply(&mut values);
            let is_same = values[0] == y || (values[0].is_nan() && y.is_nan());
            assert!(
                is_same,
                "{conversion:?}: {x} became {}, expected {y}",
                values[0]
            );
        }
    }

    #[test]
    fn each_kind_means_what_the_format_says() {
        let nan = f64::NAN;
        let linear = Conversion::Linear {
            offset: -1.0,
            factor: 0.5,
        };
        check(&linear, &[(0.0, -1.0), (4.0, 1.0), (nan, nan)]);
        check(
            &Conversion::Rational([0.0, 2.0, 1.0, 0.0, 0.0, 4.0]),
            &[(3.5, 2.0)],
        );
        check(
            &Conversion::Rational([1.0, 0.0, 0.0, 0.0, 1.0, 0.0]),
            &[(3.0, 3.0), (0.0, nan)],
        );
        let pairs = vec![(0.0, 10.0), (2.0, 20.0), (4.0, 0.0)];
        let ends = [(-1.0, 10.0), (5.0, 0.0), (2.0, 20.0), (nan, nan)];
        check(&Conversion::Interpolated(pairs.clone()), &ends);
        check(
            &Conversion::Interpolated(pairs.clone()),
            &[(1.0, 15.0), (3.0, 10.0)],
        );
        check(&Conversion::Nearest(pairs.clone()), &ends);
        check(
            &Conversion::Nearest(pairs),
            &[(1.0, 10.0), (1.1, 20.0), (3.0, 20.0)],
        );
        let ranges = Conversion::Ranges(vec![[0.0, 1.0, 5.0], [3.0, 4.0, 6.0]], 7.0);
        check(&ranges, &[(0.0, 5.0), (1.0, 5.0), (2.0, 7.0), (4.0, 6.0)]);
    }

    #[test]
    fn a_number_that_stands_for_a_text_is_missing_only_where_others_are_quantities() {
        let states = Conversion::Texts(vec![[0.0, 0.0], [1.0, 1.0]], None);
        check(&states, &[(0.0, 0.0), (1.0, 1.0), (9.0, 9.0)]);
        let half = Conversion::Linear {
            offset: 0.0,
            factor: 0.5,
        };
        let quantity = Conversion::Texts(vec![[254.0, 255.0]], Some(Box::new(half)));
        check(
            &quantity,
            &[(255.0, f64::NAN), (254.0, f64::NAN), (10.0, 5.0)],
        );
    }

    #[test]
    fn ranges_that_touch_become_one() {
        let ranges = vec![[5.0, 6.0], [0.0, 2.0], [1.0, 3.0], [0.0, 0.0]];
        assert_eq!(merged(ranges), [[0.0, 3.0], [5.0, 6.0]]);
    }

    #[test]
    fn a_range_of_floats_ends_before_its_upper_end() {
        assert!(below(0.0, 1.0) < 1.0);
        assert_eq!(below(1.0, 1.0), 1.0);
    }
}
