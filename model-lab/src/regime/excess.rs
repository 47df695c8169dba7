use crate::bins::Bins;
use crate::result::{BinError, Residual};

/// Standard deviations by which the excess must exceed chance before it is attributed to regimes.
const SIGNIFICANT: f64 = 3.0;

/// Largest error in noise floors that counts as within the noise, as in the verdict of a comparison.
const WITHIN_NOISE: f64 = 1.5;

/// Residual with the noise that a perfect model would leave in it.
pub(crate) struct Excess<'a> {
    /// Residual, NaN where the measurement is missing.
    pub(crate) residual: Residual<'a>,
    variance: f64,
    /// Σ (e² - variance); none where it is within chance.
    total: Option<f64>,
    /// Rms error over the noise; NaN where both are 0.
    in_noise: f64,
}

/// Sums over the samples of a bin.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct Sums {
    pub(crate) count: usize,
    pub(crate) error: f64,
    pub(crate) square: f64,
}

impl Sums {
    pub(crate) fn add(&mut self, error: f64) {
        self.count += 1;
        self.error += error;
        self.square += error * error;
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        Self {
            count: self.count + other.count,
            error: self.error + other.error,
            square: self.square + other.square,
        }
    }

    pub(crate) fn minus(&self, other: &Self) -> Self {
        Self {
            count: self.count - other.count,
            error: self.error - other.error,
            square: self.square - other.square,
        }
    }

    pub(crate) fn bias(&self) -> f64 {
        self.error / self.count.max(1) as f64
    }

    pub(crate) fn rms(&self) -> f64 {
        (self.square / self.count.max(1) as f64).sqrt()
    }
}

impl<'a> Excess<'a> {
    /// Returns the excess of `residual`. `sigma` is the rms of a perfect model, known with `freedom` degrees of freedom; 0 where unknown,
    /// which makes every error excess.
    pub(crate) fn new(residual: Residual<'a>, sigma: f64, freedom: f64) -> Self {
        let mut all = Sums::default();
        residual
            .iter()
            .filter(|error| !error.is_nan())
            .for_each(|error| all.add(error));
        let variance = sigma * sigma;
        let count = all.count as f64;
        let total = all.square - count * variance;
        // Scatter of Σ e² itself, and of the estimated floor times the number of samples.
        let chance = variance
            * (2.0 * count
                + if freedom > 0.0 {
                    2.0 * count * count / freedom
                } else {
                    0.0
                })
            .sqrt();
        let significant = total > SIGNIFICANT * chance && total > 0.0;
        Self {
            residual,
            variance,
            total: significant.then_some(total),
            in_noise: all.rms() / sigma,
        }
    }

    /// Returns whether there is an excess to attribute to regimes.
    pub(crate) fn is_significant(&self) -> bool {
        self.total.is_some()
    }

    /// Returns the reason why there is no excess to attribute to regimes.
    pub(crate) fn in_words(&self) -> String {
        let is_above = self.in_noise > WITHIN_NOISE;
        if !is_above {
            return "the error is within the noise: there is no excess to place".to_owned();
        }
        format!(
            "the error is {:.1} times its noise floor, but so few samples show that floor that this may be chance: there is no excess to place",
            self.in_noise
        )
    }

    /// Returns the sums over the compared samples of each of `bins` bins.
    pub(crate) fn sums(&self, bin_of: &Bins, bins: usize) -> Vec<Sums> {
        let mut sums = vec![Sums::default(); bins];
        for (error, bin) in self
            .residual
            .iter()
            .zip(bin_of.iter())
            .filter(|(error, _)| !error.is_nan())
        {
            sums[usize::from(bin)].add(error);
        }
        sums
    }

    /// Returns the share of these sums in the excess; none where the whole is within chance.
    pub(crate) fn share(&self, sums: &Sums) -> Option<f64> {
        self.total
            .map(|total| (sums.square - sums.count as f64 * self.variance) / total)
    }

    pub(crate) fn bin_error(&self, sums: &Sums) -> BinError {
        BinError {
            excess_share: self.share(sums),
            bias: sums.bias(),
            rms: sums.rms(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::Noise;

    /// Returns the residual of a model that is zero.
    fn residual(values: &[f64]) -> Residual<'_> {
        Residual::new(values, &[0.0; 4000][..values.len()])
    }

    #[test]
    fn shares_sum_to_one_and_an_innocent_bin_has_next_to_none() {
        let mut noise = Noise::new(1);
        let values: Vec<f64> = (0..4000)
            .map(|n| noise.normal() + if n % 4 == 0 { 3.0 } else { 0.0 })
            .collect();
        let bin_of: Bins = (0..4000).map(|n| u16::from(n % 4 == 0)).collect();
        let excess = Excess::new(residual(&values), 1.0, 1000.0);
        let sums = excess.sums(&bin_of, 2);
        let shares = sums
            .iter()
            .map(|sums| excess.share(sums).unwrap())
            .collect::<Vec<_>>();
        assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12);
        assert!(shares[0].abs() < 0.02, "{shares:?}");
        assert!((excess.bin_error(&sums[1]).bias - 3.0).abs() < 0.15);
        assert!((excess.bin_error(&sums[1]).rms - 10_f64.sqrt()).abs() < 0.15);
    }

    #[test]
    fn pure_noise_has_no_excess_to_share() {
        let significant = (0..300).filter(|&seed| {
            let mut noise = Noise::new(seed);
            let values: Vec<f64> = (0..1000).map(|_| noise.normal()).collect();
            Excess::new(residual(&values), 1.0, 1e9).is_significant()
        });
        assert!(significant.count() <= 3);
    }

    #[test]
    fn an_uncertain_floor_asks_for_more_excess() {
        let values = [1.05_f64; 2000];
        assert!(Excess::new(residual(&values), 0.95, 1e6).is_significant());
        assert!(!Excess::new(residual(&values), 0.95, 20.0).is_significant());
    }

    /// "Within the noise" once stood beside 4.25 noise floors.
    #[test]
    fn an_error_of_many_floors_is_not_said_to_be_within_the_noise() {
        let of =
            |value: f64, freedom: f64| Excess::new(residual(&[value; 20]), 1.0, freedom).in_words();
        assert!(of(1.0, 1e6).contains("within the noise"));
        assert!(
            of(4.25, 0.05).starts_with("the error is 4.2 times its noise floor"),
            "{}",
            of(4.25, 0.05)
        );
    }

    #[test]
    fn missing_samples_belong_to_no_bin() {
        let values = [1.0, f64::NAN, 2.0];
        let bin_of = [0, 0, 1].into_iter().collect();
        let sums = Excess::new(residual(&values), 0.0, 0.0).sums(&bin_of, 2);
        assert_eq!((sums[0].count, sums[1].count), (1, 1));
    }
}
