//! Determination of a parameter by the logs: from its interval, and from its correlation with others.

use nalgebra::DMatrix;

use super::profile;
use super::result::{Determination, EstimatedParameter};
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::unknowns::{Unknown, Unknowns};
use crate::diagnosis::fit::interval::{NORMAL_95, between_programs, covariance, half_widths};
use crate::diagnosis::fit::trial::Trial;

/// Largest width of an interval, over that before the logs, at which a parameter counts as determined.
pub(in crate::diagnosis) const DETERMINED: f64 = 0.18;
/// Largest width of an interval with all other parameters known, over that before the logs, at which a parameter counts as excited.
const NOT_EXCITED: f64 = 0.18;
/// Magnitude of the correlation from which on two parameters compensate for each other.
const MAKES_UP: f64 = 0.5;
/// Distance from a bound, in coordinates, within which a parameter counts as at its limit.
const AT_LIMIT: f64 = 1e-6;

/// Steps of a correlation in the result: finer ones differ between machines.
const CORRELATION_STEPS: f64 = 1e3;

/// Returns the parameters of `trial`, whose Jacobian is accurate, with the determination of each by `evidence`, and their correlations.
pub(super) fn estimated_parameters(
    evidence: &Evidence,
    trial: &Trial,
) -> (Vec<EstimatedParameter>, Vec<Vec<f64>>) {
    let mut distances = profile::distances(evidence, trial, &half_widths(evidence, trial));
    for (unknown, ends) in trial.unknowns.list().iter().zip(&mut distances) {
        *ends = ends.map(|end| between_programs(unknown, end));
    }
    let covariance = covariance(evidence, trial);
    let list = trial.unknowns.list();
    let parameters = list.iter().enumerate().filter_map(|(n, unknown)| {
        let spec = match unknown {
            Unknown::Nuisance(nuisance) => nuisance.spec,
            Unknown::Effect(effect) => effect.spec,
            Unknown::Log(_) => return None,
        };
        let z = trial.fit.z[n];
        let (least, most) = unknown.bounds();
        let value_at = |z: f64| unknown.value(z.clamp(least, most));
        let is_at_limit = z - least < AT_LIMIT || most - z < AT_LIMIT;
        let [below, above] = distances[n];
        let possible = NORMAL_95 * unknown.believed_sd();
        let alone = NORMAL_95
            / trial.fit.jacobian[n]
                .iter()
                .map(|slope| slope * slope)
                .sum::<f64>()
                .sqrt();
        let determination = if is_at_limit {
            Determination::AtLimit
        } else if 0.5 * (below + above) <= DETERMINED * possible {
            Determination::Determined
        } else {
            let together = partners(&trial.unknowns, covariance.as_ref(), n);
            if alone > NOT_EXCITED * possible || together.is_empty() {
                Determination::NotExcited
            } else {
                Determination::OnlyTogetherWith {
                    parameters: together,
                }
            }
        };
        let (low, high) = (value_at(z - below), value_at(z + above));
        Some(EstimatedParameter {
            name: spec.name(),
            unit: spec.unit.to_owned(),
            before: unknown.value(trial.unknowns.start()[n]),
            after: value_at(z),
            low: low.min(high),
            high: high.max(low),
            within: within(unknown),
            determined_by: (determination != Determination::Determined)
                .then(|| unknown.determined_by())
                .flatten(),
            is_beyond_usual: match unknown {
                Unknown::Nuisance(nuisance) => nuisance.usual.is_some_and(|usual| {
                    low > nuisance.datasheet + usual || high < nuisance.datasheet - usual
                }),
                _ => false,
            },
            determination,
        })
    });
    let parameters = parameters.collect();
    let correlations = covariance.map_or_else(Vec::new, |covariance| {
        correlations(&trial.unknowns, &covariance)
    });
    (parameters, correlations)
}

/// Returns the least and the largest value of a fit; none where one of them is infinite.
fn within(unknown: &Unknown) -> Option<[f64; 2]> {
    let (least, most) = unknown.bounds();
    let (one, other) = (unknown.value(least), unknown.value(most));
    (one.is_finite() && other.is_finite()).then(|| [one.min(other), one.max(other)])
}

/// Returns the correlations between the parameters of the plant and its effects; those with the conditions of a log are left out.
fn correlations(unknowns: &Unknowns, covariance: &DMatrix<f64>) -> Vec<Vec<f64>> {
    let list = unknowns.list().iter().enumerate();
    let listed: Vec<usize> = list
        .filter(|(_, unknown)| !matches!(unknown, Unknown::Log(_)))
        .map(|(n, _)| n)
        .collect();
    let rounded = |value: f64| (value * CORRELATION_STEPS).round() / CORRELATION_STEPS;
    let row = |&n: &usize| {
        let each = listed
            .iter()
            .map(|&m| rounded(correlation(covariance, n, m)));
        each.collect()
    };
    listed.iter().map(row).collect()
}

fn correlation(covariance: &DMatrix<f64>, n: usize, m: usize) -> f64 {
    covariance[(n, m)] / (covariance[(n, n)] * covariance[(m, m)]).sqrt()
}

/// Returns the names of the parameters whose errors are correlated with those of parameter `n`, the closest first.
fn partners(unknowns: &Unknowns, covariance: Option<&DMatrix<f64>>, n: usize) -> Vec<String> {
    let Some(covariance) = covariance else {
        return Vec::new();
    };
    let correlation = |m: usize| correlation(covariance, n, m).abs();
    let mut partners: Vec<(f64, String)> = unknowns
        .list()
        .iter()
        .enumerate()
        .filter(|&(m, _)| m != n && correlation(m) > MAKES_UP)
        .map(|(m, unknown)| (correlation(m), unknown.name()))
        .collect();
    partners.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut names: Vec<String> = partners.into_iter().map(|(_, name)| name).collect();
    names.dedup();
    names
}
