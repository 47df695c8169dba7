//! Compact storage of one small number per sample, for millions of samples.

use std::sync::Arc;

/// Bin of each sample. Consecutive samples mostly share a bin, so the bins are stored as runs where that takes less memory. A clone shares
/// the storage.
#[derive(Clone, Debug, Default)]
pub struct Bins {
    len: usize,
    store: Arc<Store>,
}

#[derive(Debug)]
enum Store {
    /// Lengths of the runs, and the bin of each.
    Runs(Vec<u32>, Vec<u16>),
    Bytes(Vec<u8>),
    Words(Vec<u16>),
}

impl Default for Store {
    fn default() -> Self {
        Self::Runs(Vec::new(), Vec::new())
    }
}

/// Bytes of a run: its length and its bin.
const RUN_BYTES: usize = 6;
/// Number of runs that are stored as runs regardless of their length.
const FEW_RUNS: usize = 1024;

impl Bins {
    /// Returns the number of samples.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Returns whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Returns the number of bytes that the bins take.
    pub fn bytes(&self) -> usize {
        match &*self.store {
            Store::Runs(lengths, _) => lengths.len() * RUN_BYTES,
            Store::Bytes(bins) => bins.len(),
            Store::Words(bins) => 2 * bins.len(),
        }
    }

    /// Returns the bins of these samples, which are in order.
    pub(crate) fn at_rows(&self, rows: &[usize]) -> Self {
        let mut rows = rows.iter().peekable();
        let bins = self.iter().enumerate();
        bins.filter_map(|(row, bin)| rows.next_if_eq(&&row).map(|_| bin))
            .collect()
    }

    /// Returns the bin of each sample in turn.
    pub fn iter(&self) -> impl Iterator<Item = u16> + '_ {
        let (mut run, mut left) = (0, 0_u32);
        (0..self.len).map(move |index| match &*self.store {
            Store::Runs(lengths, bins) => {
                if left == 0 {
                    left = lengths[run];
                    run += 1;
                }
                left -= 1;
                bins[run - 1]
            }
            Store::Bytes(bins) => bins[index].into(),
            Store::Words(bins) => bins[index],
        })
    }
}

impl PartialEq for Bins {
    fn eq(&self, other: &Self) -> bool {
        self.len == other.len && self.iter().eq(other.iter())
    }
}

impl FromIterator<u16> for Bins {
    fn from_iter<I: IntoIterator<Item = u16>>(bins: I) -> Self {
        let bins = bins.into_iter();
        let mut builder = BinsBuilder::for_about(bins.size_hint().0);
        bins.for_each(|bin| builder.push(bin));
        builder.finish()
    }
}

/// Builder that takes one bin after the other.
#[derive(Debug)]
pub(crate) struct BinsBuilder {
    len: usize,
    expected: usize,
    store: Store,
}

impl BinsBuilder {
    /// Creates a builder that reserves memory for about `expected` samples once runs no longer save memory.
    pub(crate) fn for_about(expected: usize) -> Self {
        Self {
            len: 0,
            expected,
            store: Store::default(),
        }
    }

    pub(crate) fn push(&mut self, bin: u16) {
        self.len += 1;
        match &mut self.store {
            Store::Runs(lengths, bins) => {
                if bins.last() == Some(&bin)
                    && let Some(length) = lengths.last_mut()
                    && *length < u32::MAX
                {
                    *length += 1;
                    return;
                }
                lengths.push(1);
                bins.push(bin);
                if lengths.len() > FEW_RUNS && lengths.len() * RUN_BYTES > self.len {
                    self.keep_each();
                }
            }
            Store::Bytes(bytes) => match u8::try_from(bin) {
                Ok(byte) => bytes.push(byte),
                Err(_) => {
                    let mut words = Vec::with_capacity(self.expected.max(bytes.len() + 1));
                    words.extend(bytes.iter().map(|&byte| u16::from(byte)));
                    words.push(bin);
                    self.store = Store::Words(words);
                }
            },
            Store::Words(words) => words.push(bin),
        }
    }

    fn keep_each(&mut self) {
        let Store::Runs(lengths, bins) = std::mem::take(&mut self.store) else {
            return;
        };
        self.store = Store::Bytes(Vec::with_capacity(self.expected.max(self.len)));
        self.len = 0;
        for (length, bin) in lengths.into_iter().zip(bins) {
            for _ in 0..length {
                self.push(bin);
            }
        }
    }

    pub(crate) fn finish(mut self) -> Bins {
        if let Store::Runs(lengths, bins) = &mut self.store {
            lengths.shrink_to_fit();
            bins.shrink_to_fit();
        }
        Bins {
            len: self.len,
            store: Arc::new(self.store),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bins_return_as_they_came_in_runs_or_without() {
        let long_runs: Vec<u16> = (0..100_000)
            .map(|n| n / 1000 % 7)
            .map(|n| n as u16)
            .collect();
        let no_runs: Vec<u16> = (0..100_000).map(|n: u32| (n % 200) as u16).collect();
        let mut wide = no_runs.clone();
        wide[70_000] = 8_999;
        let mut late = long_runs.clone();
        late.extend(&no_runs);
        let none = Vec::new();
        for (bins, bytes_max) in [
            (&long_runs, 600),
            (&no_runs, 100_000),
            (&wide, 200_000),
            (&late, 200_000),
            (&none, 0),
        ] {
            let kept: Bins = bins.iter().copied().collect();
            assert_eq!(kept.len(), bins.len());
            assert_eq!(&kept.iter().collect::<Vec<_>>(), bins);
            assert!(kept.bytes() <= bytes_max, "{} of {bytes_max}", kept.bytes());
        }
    }
}
