//! Distance of two fitted plants on a log that was not yet made.

use nalgebra::{DMatrix, DVector};
use plant_sim::effects::EffectSetting;
use plant_sim::replay::replay;
use plant_sim::{PlantParameters, Tolerance};
use recording::{Recording, Unit};

use super::test_signal::Sequence;
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::unknowns::Unknowns;
use crate::diagnosis::fit::gather::gather;
use crate::diagnosis::fit::trial::{Bench, Trial};
use crate::diagnosis::fit::vector::{dot, square};
use crate::diagnosis::fit::{Difference, Fitter};
use crate::noise::Noise;
use crate::result::Horizon;

/// Plant as fitted to the logs.
pub(super) struct Rival {
    /// Id and form of the effect; none for the plain model.
    pub(super) effect: Option<(String, String)>,
    pub(super) plant: PlantParameters,
    unknowns: Unknowns,
    z: Vec<f64>,
    /// Information on the unknowns from the logs and the datasheet: the curvature of the fit's cost.
    information: DMatrix<f64>,
    pub(super) cost: f64,
    correlation_samples: f64,
}

impl Rival {
    pub(super) fn of_trial(bench: &Bench, trial: Trial, id: Option<&str>) -> Self {
        let (information, _) = Fitter::new(bench.fitting, &trial.unknowns).normal(&trial.fit);
        // A log that was not made yet has its own conditions.
        let (unknowns, kept) = trial.unknowns.without_logs();
        let variant = trial
            .effects
            .last()
            .map_or("", |effect| effect.variant().name);
        Self {
            effect: id.map(|id| (id.to_owned(), variant.to_owned())),
            plant: trial.plant(),
            cost: trial.fit.cost,
            z: kept.iter().map(|&n| trial.fit.z[n]).collect(),
            unknowns,
            information: marginal(information, &kept),
            correlation_samples: trial.correlation_samples,
        }
    }

    /// Returns the plant with an unchanged effect; nothing new is known of it.
    pub(super) fn with(&self, setting: EffectSetting) -> Self {
        Self {
            effect: Some((setting.id().to_owned(), setting.variant().name.to_owned())),
            plant: self.plant.with_effect(setting),
            unknowns: self.unknowns.clone(),
            z: self.z.clone(),
            information: self.information.clone(),
            ..*self
        }
    }
}

/// Returns the information on the unknowns `kept` where the others are unknown: their Schur complement; 0 where the logs contain no
/// information on the others.
fn marginal(information: DMatrix<f64>, kept: &[usize]) -> DMatrix<f64> {
    let others: Vec<usize> = (0..information.nrows())
        .filter(|n| !kept.contains(n))
        .collect();
    let part = |rows: &[usize], columns: &[usize]| {
        DMatrix::from_fn(rows.len(), columns.len(), |a, b| {
            information[(rows[a], columns[b])]
        })
    };
    let of_kept = part(kept, kept);
    if others.is_empty() {
        return of_kept;
    }
    let across = part(&others, kept);
    match part(&others, &others).cholesky() {
        Some(factor) => of_kept - across.transpose() * factor.solve(&across),
        None => DMatrix::zeros(kept.len(), kept.len()),
    }
}

/// Reason why an excitation has no distance.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Unseen {
    /// A rival cannot be simulated with it in a bounded number of steps.
    NotSimulated,
    /// The signals of the logs do not show the change due to a rival, so that no fit can find its size.
    NotShown,
}

/// Noise of the signals in the logs.
pub(super) struct Noises(Vec<(&'static str, f64)>);

impl Noises {
    pub(super) fn of(evidence: &Evidence) -> Self {
        let mut noises: Vec<(&'static str, f64)> = Vec::new();
        for (_, channel, _) in evidence.channels() {
            if noises.iter().all(|(signal, _)| *signal != channel.signal) {
                noises.push((channel.signal, channel.sigma));
            }
        }
        Self(noises)
    }
}

impl Noises {
    /// Returns the names of the signals.
    pub(super) fn signals(&self) -> impl Iterator<Item = &'static str> + '_ {
        self.0.iter().map(|(signal, _)| *signal)
    }
}

/// Returns the distance of two rivals on the logs to which both were fitted (standard deviations of the noise).
pub(super) fn on_the_logs(a: &Rival, b: &Rival) -> f64 {
    let remembered = a.correlation_samples.min(b.correlation_samples);
    ((a.cost - b.cost).abs() / remembered).sqrt()
}

/// Returns the distance of `model` from a log of `sequence` that `truth` made (standard deviations of the noise).
///
/// # Errors
/// [`Unseen`]: the reason why there is none.
pub(super) fn distance(
    truth: &Rival,
    model: &Rival,
    sequence: &Sequence,
    noises: &Noises,
) -> Result<f64, Unseen> {
    let log = made(&truth.plant, sequence, noises).ok_or(Unseen::NotSimulated)?;
    let evidence = gather(&truth.plant, &[log]).map_err(|error| match error {
        DiagnoseError::NothingToFit { .. } => Unseen::NotShown,
        _ => Unseen::NotSimulated,
    })?;
    let noise = evidence.residuals(&truth.plant, Horizon::OneStepAhead);
    let noise = noise.ok_or(Unseen::NotSimulated)?;
    let fitter = Fitter::new(&evidence, &model.unknowns);
    let mut fit = fitter.at(model.z.clone()).ok_or(Unseen::NotSimulated)?;
    let differentiated = fitter.differentiate(&mut fit, 0, Difference::Forward);
    differentiated.ok_or(Unseen::NotSimulated)?;
    let columns = &fit.jacobian;
    let mut change: Vec<f64> = fit
        .residuals
        .iter()
        .zip(&noise)
        .map(|(seen, noise)| seen - noise)
        .collect();
    let count = columns.len();
    let curvature = DMatrix::from_fn(count, count, |a, b| dot(&columns[a], &columns[b]));
    let pull = DVector::from_iterator(count, columns.iter().map(|column| -dot(column, &change)));
    // An unknown without information from the logs and from this one has no curvature.
    let factor = (curvature + &model.information).cholesky();
    let moved = factor.ok_or(Unseen::NotShown)?.solve(&pull);
    for (column, moved) in columns.iter().zip(moved.iter()) {
        for (change, column) in change.iter_mut().zip(column) {
            *change += moved * column;
        }
    }
    let resisted = moved.dot(&(&model.information * &moved));
    let remembered = truth.correlation_samples.min(model.correlation_samples);
    Ok(((square(&change) + resisted) / remembered).sqrt())
}

/// Returns the log that `plant` would give.
pub(super) fn made(
    plant: &PlantParameters,
    sequence: &Sequence,
    noises: &Noises,
) -> Option<Recording> {
    let mut log = sequence.recording();
    let run = replay(plant, &log, Tolerance::default(), |_, _| {})
        .ok()?
        .recording;
    let base = log.signals().first()?.time_base();
    let mut noise = Noise::new(1);
    for (name, sigma) in &noises.0 {
        let signal = run.signal(name)?;
        let values = signal
            .values_or_nan()
            .iter()
            .map(|value| value + sigma * noise.normal());
        let unit: Unit = signal.unit();
        log.add_signal(*name, unit, base, values.collect()).ok()?;
    }
    Some(log)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The information on two coordinates with an unknown third one is the inverse of their covariance.
    #[test]
    fn what_stays_of_the_information_is_the_inverse_of_the_covariance() {
        let information =
            DMatrix::from_row_slice(3, 3, &[4.0, 1.0, 0.5, 1.0, 3.0, -1.0, 0.5, -1.0, 2.0]);
        let covariance = information.clone().try_inverse().unwrap();
        let kept = [0, 2];
        let of_kept = DMatrix::from_fn(2, 2, |a, b| covariance[(kept[a], kept[b])]);
        let found = marginal(information, &kept);
        let expected = of_kept.try_inverse().unwrap();
        assert!((found - expected).abs().max() < 1e-12);
    }
}
