//! Errors of a model, signal by signal, relative to the noise.

use std::collections::BTreeMap;

use super::Evidence;
use crate::diagnosis::result::BySignal;
use crate::diagnosis::verdict::{ADDS_UP_FLOORS, CHANCE, LITTLE_FLOORS, MATERIAL_EXCESS};
use crate::measured::is_current;
use crate::result::Horizon;

/// Sums over the samples of one signal in all logs.
#[derive(Debug, Clone, Default)]
struct Sums {
    count: f64,
    /// Sum of squares of the error, in its unit.
    square: f64,
    /// Sum of squares of the error of a perfect model.
    floor_square: f64,
    /// Sum of squares of the error over that of a perfect model.
    normalised_square: f64,
}

impl Sums {
    /// Returns the excess above which an error is material: more than two correct programs differ by, and more than chance gives for this
    /// number of samples.
    fn material_excess(&self) -> f64 {
        MATERIAL_EXCESS * MATERIAL_EXCESS + CHANCE * (2.0 / self.count).sqrt()
    }

    fn is_material(&self) -> bool {
        self.normalised_square / self.count - 1.0 >= self.material_excess()
    }
}

/// Errors of one horizon by signal.
#[derive(Debug, Clone)]
pub(crate) struct Errors {
    horizon: Horizon,
    by_signal: BTreeMap<&'static str, Sums>,
}

impl Errors {
    pub(crate) fn new(evidence: &Evidence, residuals: &[f64], horizon: Horizon) -> Self {
        let mut by_signal: BTreeMap<&'static str, Sums> = BTreeMap::new();
        for (log, channel, range) in evidence.channels() {
            let sums = by_signal.entry(channel.signal).or_default();
            for (row, residual) in residuals[range].iter().enumerate() {
                if log.counted[row] && !channel.values[row].is_nan() {
                    let floor = log.floor(channel, horizon, row);
                    sums.count += 1.0;
                    sums.square += (residual * floor).powi(2);
                    sums.floor_square += floor * floor;
                    sums.normalised_square += residual * residual;
                }
            }
        }
        by_signal.retain(|_, sums| sums.count > 0.0);
        Self { horizon, by_signal }
    }

    /// Returns the rms error in the unit of each signal.
    pub(crate) fn rms(&self) -> BySignal {
        self.each(|sums| (sums.square / sums.count).sqrt())
    }

    /// Returns the rms error of a perfect model.
    pub(crate) fn floor(&self) -> BySignal {
        self.each(|sums| (sums.floor_square / sums.count).sqrt())
    }

    /// Returns the mean square over the noise's, minus one, of each signal: 0 for a perfect model.
    pub(crate) fn excess(&self) -> BySignal {
        self.each(|sums| (sums.normalised_square / sums.count - 1.0).max(0.0))
    }

    /// Returns the excess of all signals together.
    pub(crate) fn total_excess(&self) -> f64 {
        self.excess().values().sum()
    }

    /// Returns whether a signal has more excess than a correct model may have, and more than chance gives for this number of samples.
    pub(crate) fn is_material(&self) -> bool {
        self.by_signal.values().any(Sums::is_material)
    }

    /// Returns whether `signal` has a material excess.
    pub(crate) fn is_signal_material(&self, signal: &str) -> bool {
        self.by_signal.get(signal).is_some_and(Sums::is_material)
    }

    /// Returns whether a current has a material excess.
    pub(crate) fn is_current_material(&self) -> bool {
        let mut currents = self
            .by_signal
            .iter()
            .filter(|(signal, _)| is_current(signal));
        currents.any(|(_, sums)| sums.is_material())
    }

    /// Returns the ratio of these errors to the size at which they are material, of the signal with the largest ratio.
    pub(crate) fn over_material(&self) -> f64 {
        let each =
            self.each(|sums| (sums.normalised_square / sums.count / sums.material_excess()).sqrt());
        each.into_values().fold(0.0, f64::max)
    }

    /// Returns the rms error over that of a perfect model, of the signal with the largest ratio.
    pub(crate) fn most_floors(&self) -> f64 {
        self.worst().map_or(0.0, |(_, floors)| floors)
    }

    /// Returns the signal with the largest rms error over that of a perfect model, and this ratio; none without a signal.
    pub(crate) fn worst(&self) -> Option<(&'static str, f64)> {
        let floors = |sums: &Sums| (sums.normalised_square / sums.count).sqrt();
        let each = self.by_signal.iter();
        let each = each.map(|(&signal, sums)| (signal, floors(sums)));
        each.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Returns whether they are too small to say whether physics is missing.
    pub(crate) fn are_little(&self) -> bool {
        let most = match self.horizon {
            Horizon::OneStepAhead => LITTLE_FLOORS,
            Horizon::FreeRun => ADDS_UP_FLOORS,
        };
        self.most_floors() <= most
    }

    /// Returns the number of samples of all signals.
    pub(crate) fn count(&self) -> f64 {
        self.by_signal.values().map(|sums| sums.count).sum()
    }

    /// Returns the sum of squares in noise standard deviations.
    pub(crate) fn square(&self) -> f64 {
        self.by_signal
            .values()
            .map(|sums| sums.normalised_square)
            .sum()
    }

    fn each(&self, figure: impl Fn(&Sums) -> f64) -> BySignal {
        self.by_signal
            .iter()
            .map(|(signal, sums)| ((*signal).to_owned(), figure(sums)))
            .collect()
    }
}
