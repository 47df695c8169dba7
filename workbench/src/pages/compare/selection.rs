//! Samples that the user selected in the error map or in a list of regimes, as time intervals.

use serde::Serialize;

use super::residual::residual_of;
use crate::refusal::Refusal;
use crate::results::Compared;

/// Largest number of intervals that a view can show.
const PIECES_MAX: usize = 400;

/// Samples of one regime.
#[derive(Serialize)]
pub(super) struct Selection {
    /// Description of the selection.
    label: String,
    samples: usize,
    /// Begin and end of each interval (s); neighbours are joined if there are too many.
    pieces_s: Vec<(f64, f64)>,
}

impl Selection {
    /// Returns the samples of `signal/dimension/label`, with the names of the comparison.
    pub(super) fn of(compared: &Compared, select: &str) -> Result<Self, Refusal> {
        let (label, is_in) = picked(compared, select)?;
        let signal = select.split('/').next().unwrap_or_default();
        let (base, _) = residual_of(compared, signal)?;
        let times_s = base.times_s();
        // A sample stands for the interval that ends with it.
        let mut pieces_s: Vec<(f64, f64)> = Vec::new();
        for (index, _) in is_in.iter().enumerate().filter(|(_, is_in)| **is_in) {
            let from_s = times_s[index.saturating_sub(1)];
            match pieces_s.last_mut() {
                Some(last) if last.1 >= from_s => last.1 = times_s[index],
                _ => pieces_s.push((from_s, times_s[index])),
            }
        }
        Ok(Self {
            label,
            samples: is_in.iter().filter(|is_in| **is_in).count(),
            pieces_s: joined(pieces_s),
        })
    }
}

/// Returns the label of the regime, and for each sample whether it belongs to it.
pub(super) fn picked(compared: &Compared, select: &str) -> Result<(String, Vec<bool>), Refusal> {
    let mut words = select.splitn(3, '/');
    let (signal, dimension, label) = (words.next(), words.next(), words.next());
    let placements = &compared.comparison.traces.placements;
    let placement = placements
        .iter()
        .filter(|placement| Some(placement.signal.as_str()) == signal)
        .find(|placement| Some(placement.dimension.as_str()) == dimension);
    let found = placement.and_then(|placement| {
        let bin = placement
            .labels
            .iter()
            .position(|one| Some(one.as_str()) == label)?;
        Some((placement, bin))
    });
    let (placement, bin) = found.ok_or_else(|| Refusal::not_found("regime"))?;
    let is_in = placement.bin_of.iter().map(|one| usize::from(one) == bin);
    Ok((placement.labels[bin].clone(), is_in.collect()))
}

/// Joins the intervals over increasing gaps until a view can show them.
fn joined(mut pieces_s: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    while pieces_s.len() > PIECES_MAX {
        let mut breaks_s: Vec<f64> = pieces_s
            .windows(2)
            .map(|pair| pair[1].0 - pair[0].1)
            .collect();
        let half = breaks_s.len() / 2;
        let widest_s = *breaks_s.select_nth_unstable_by(half, f64::total_cmp).1;
        let mut fewer: Vec<(f64, f64)> = Vec::new();
        for piece in pieces_s {
            match fewer.last_mut() {
                Some(last) if piece.0 - last.1 <= widest_s => last.1 = piece.1,
                _ => fewer.push(piece),
            }
        }
        pieces_s = fewer;
    }
    pieces_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_pieces_are_joined_over_their_narrow_breaks_first() {
        let few = vec![(0.0, 1.0), (2.0, 3.0)];
        assert_eq!(joined(few.clone()), few);
        let pair = |index: usize| {
            let begin = index as f64 * 10.0;
            [(begin, begin + 1.0), (begin + 2.0, begin + 3.0)]
        };
        let many: Vec<_> = (0..300).flat_map(pair).collect();
        let shown = joined(many);
        assert_eq!(shown.len(), 300);
        assert_eq!(shown[0], (0.0, 3.0));
    }
}
