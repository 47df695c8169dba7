//! Location of the error: shares of the excess by regime.
//!
//! The excess is the squared error after the noise is subtracted: Σ (e² - floor²). A regime's share of the excess, compared with its share
//! of the samples, shows where the model is wrong. Shares refer to the one-step-ahead prediction error, whose memory is a few samples; a
//! free-run simulation would carry a wrong pressure into regimes that are modelled correctly.

mod dimension;
mod excess;
mod features;
mod finder;
mod map;

pub(crate) use dimension::Dimension;
pub(crate) use excess::Excess;
pub(crate) use features::{Features, States, Watched};
pub(crate) use finder::find;
pub(crate) use map::error_map;

use crate::result::{Placement, RegimeBin, RegimeShares};

/// Returns the shares in each bin of `dimension`.
pub(crate) fn shares(
    dimension: &Dimension,
    one_step_ahead: Option<&Excess>,
    free_run: &Excess,
) -> RegimeShares {
    let free_run_sums = free_run.sums(&dimension.bin_of, dimension.bins.len());
    let short_sums =
        one_step_ahead.map(|excess| excess.sums(&dimension.bin_of, dimension.bins.len()));
    let compared = free_run_sums.iter().map(|sums| sums.count).sum::<usize>();
    let bins = dimension
        .bins
        .iter()
        .enumerate()
        .filter(|&(index, _)| free_run_sums[index].count > 0);
    RegimeShares {
        dimension: dimension.id.to_owned(),
        title: dimension.title.to_owned(),
        bins: bins
            .map(|(index, bin)| RegimeBin {
                label: bin.label.clone(),
                samples: free_run_sums[index].count,
                sample_share: free_run_sums[index].count as f64 / compared as f64,
                one_step_ahead: one_step_ahead
                    .zip(short_sums.as_ref())
                    .map(|(excess, sums)| excess.bin_error(&sums[index])),
                free_run: free_run.bin_error(&free_run_sums[index]),
            })
            .collect(),
    }
}

/// Returns the bin of each sample in `dimension`, for the signal of this name.
pub(crate) fn placement(signal: &str, dimension: &Dimension) -> Placement {
    Placement {
        signal: signal.to_owned(),
        dimension: dimension.id.to_owned(),
        labels: dimension.bins.iter().map(|bin| bin.label.clone()).collect(),
        bin_of: dimension.bin_of.clone(),
    }
}
