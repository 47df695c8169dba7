//! Share with its exact 95 % limits (C. J. Clopper and E. S. Pearson, *Biometrika* 26, 1934, 404).

use serde::Serialize;
use statrs::distribution::{Beta, ContinuousCDF};

/// Share `count` / `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
pub struct Share {
    /// Number of hits.
    pub count: usize,
    /// Number of all.
    pub of: usize,
}

impl Share {
    /// Counts the elements for which `is` is true.
    pub fn of<T>(all: impl IntoIterator<Item = T>, is: impl Fn(&T) -> bool) -> Self {
        all.into_iter().fold(Self::default(), |share, one| Self {
            count: share.count + usize::from(is(&one)),
            of: share.of + 1,
        })
    }

    /// Returns the share; `None` if there are no elements.
    pub fn value(self) -> Option<f64> {
        (self.of > 0).then(|| self.count as f64 / self.of as f64)
    }

    /// Returns the limits that contain the true share with 95 %.
    pub fn limits(self) -> [f64; 2] {
        let (count, missing) = (self.count as f64, (self.of - self.count) as f64);
        // A beta distribution needs positive parameters: at 0 and 1 the limit is the end itself.
        let quantile = |share, a, b| Beta::new(a, b).map_or(share, |beta| beta.inverse_cdf(share));
        [
            if self.count == 0 {
                0.0
            } else {
                quantile(0.025, count, missing + 1.0)
            },
            if self.count == self.of {
                1.0
            } else {
                quantile(0.975, count + 1.0, missing)
            },
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 of 60 and 0 of 60 from the tables of the binomial distribution: (1 - x)^60 = 0.025.
    #[test]
    fn limits_are_those_of_the_binomial_distribution() {
        let [low, high] = Share { count: 0, of: 60 }.limits();
        assert!(low == 0.0 && (high - (1.0 - 0.025_f64.powf(1.0 / 60.0))).abs() < 1e-9);
        let [low, high] = Share { count: 60, of: 60 }.limits();
        assert!(high == 1.0 && (low - 0.025_f64.powf(1.0 / 60.0)).abs() < 1e-9);
        let [low, high] = Share { count: 5, of: 10 }.limits();
        assert!(
            (low - 0.1871).abs() < 1e-4 && (high - 0.8129).abs() < 1e-4,
            "{low} {high}"
        );
    }

    #[test]
    fn nothing_has_no_share_and_any_limit() {
        let none = Share::default();
        assert_eq!(none.value(), None);
        assert_eq!(none.limits(), [0.0, 1.0]);
    }
}
