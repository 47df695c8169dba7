//! Simple rules on the same rigs. All except the regression choose among the fits of the diagnosis, so that only the
//! rule differs.

use super::super::format::Answer;
use super::finding::{BySignal, Candidate, Finding};
use super::log::Log;
use super::sparse_regression;

/// Names by a rule: from the answer (for the oracle), the fits of the diagnosis, and the id log.
type Names = fn(&Answer, Option<&Finding>, Option<&Log>) -> Vec<String>;

/// Rule that names effects.
pub(super) struct Rule {
    pub(super) name: &'static str,
    pub(super) names: Names,
}

/// All rules.
pub(super) const RULES: [Rule; 4] = [
    Rule {
        name: "largest fit",
        names: |_, finding, _| finding.and_then(largest_fit).into_iter().collect(),
    },
    Rule {
        name: "plain BIC",
        names: |_, finding, log| {
            let rows = log.map_or(0, Log::rows);
            finding
                .and_then(|finding| least_bic(finding, rows))
                .into_iter()
                .collect()
        },
    },
    Rule {
        name: "sparse regression",
        names: |_, _, log| log.map(sparse_regression::names).unwrap_or_default(),
    },
    Rule {
        name: "oracle",
        names: |answer, finding, _| {
            finding
                .map(|finding| oracle(answer, finding))
                .unwrap_or_default()
        },
    },
];

/// Returns the candidate with the best fit, if it fits better than the plain model.
fn largest_fit(finding: &Finding) -> Option<String> {
    let plain = finding.plain()?;
    let misfit = |rms: &BySignal| mean_ratio(rms, &plain.noise_floor);
    least(
        &finding.candidates,
        |candidate| misfit(&candidate.fit_rms),
        misfit(&plain.fit_rms),
    )
}

/// Returns the candidate with the smallest information criterion of G. Schwarz (1978), if it is smaller than the plain
/// model's.
fn least_bic(finding: &Finding, rows: usize) -> Option<String> {
    let plain = finding.plain()?;
    let criterion = |rms: &BySignal, parameters: usize| {
        let likelihood: f64 = rms.values().map(|rms| (rms * rms).ln()).sum();
        rows as f64 * likelihood + parameters as f64 * (rows as f64).ln()
    };
    least(
        &finding.candidates,
        |candidate| criterion(&candidate.fit_rms, candidate.free_parameters),
        criterion(&plain.fit_rms, plain.free_parameters),
    )
}

/// Returns the hidden effects that explain at least half of the excess on the check log. Unlike the other rules, this
/// one reads the answer.
fn oracle(answer: &Answer, finding: &Finding) -> Vec<String> {
    let Some(plain) = finding.plain() else {
        return vec![];
    };
    let beyond_noise = |rms: &BySignal| -> f64 {
        let excess = |(signal, rms): (&String, &f64)| {
            let ratio = rms / plain.noise_floor.get(signal)?;
            Some((ratio * ratio - 1.0).max(0.0))
        };
        rms.iter().filter_map(excess).sum()
    };
    let hides = |effect: &str| answer.hidden.iter().any(|hidden| hidden.effect == effect);
    finding
        .candidates
        .iter()
        .filter(|candidate| hides(&candidate.effect))
        .filter(|candidate| {
            beyond_noise(&candidate.check_rms) <= 0.5 * beyond_noise(&plain.check_rms)
        })
        .map(|candidate| candidate.effect.clone())
        .collect()
}

fn least(candidates: &[Candidate], of: impl Fn(&Candidate) -> f64, bound: f64) -> Option<String> {
    candidates
        .iter()
        .map(|candidate| (of(candidate), &candidate.effect))
        .filter(|(value, _)| *value < bound)
        .min_by(|(a, _), (b, _)| a.total_cmp(b))
        .map(|(_, effect)| effect.clone())
}

fn mean_ratio(rms: &BySignal, floor: &BySignal) -> f64 {
    let ratios = rms
        .iter()
        .filter_map(|(signal, rms)| Some(rms / floor.get(signal)?));
    ratios.sum::<f64>() / rms.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blind::score::finding::Step;

    fn by_signal(p: f64, i: f64) -> BySignal {
        [("p_ch".to_owned(), p), ("i_fill".to_owned(), i)].into()
    }

    fn candidate(effect: &str, p: f64, i: f64, free_parameters: usize) -> Candidate {
        Candidate {
            effect: effect.to_owned(),
            fit_rms: by_signal(p, i),
            check_rms: by_signal(p, i),
            free_parameters,
            parameters: vec![],
        }
    }

    fn finding(candidates: Vec<Candidate>) -> Finding {
        Finding {
            verdict: String::new(),
            effects: vec![],
            equivalents: [].into(),
            error_steps: vec![Step {
                kind: "parameters_refitted".to_owned(),
                added: None,
                variant: None,
                fit_rms: by_signal(2.0, 1.0),
                check_rms: by_signal(2.0, 1.0),
                noise_floor: by_signal(1.0, 1.0),
                explained_share: None,
                free_parameters: 10,
            }],
            candidates,
        }
    }

    #[test]
    fn the_largest_fit_wins_however_small_and_whatever_it_costs() {
        let found = finding(vec![
            candidate("a", 1.999, 1.0, 11),
            candidate("b", 1.998, 1.0, 90),
            candidate("c", 2.001, 1.0, 11),
        ]);
        assert_eq!(largest_fit(&found).as_deref(), Some("b"));
        assert_eq!(
            largest_fit(&finding(vec![candidate("c", 2.0, 1.0, 11)])),
            None
        );
    }

    /// 100 rows: 200 ln(2/1.95) = 5.06 is more than ln 100 = 4.61 for one parameter, and less than that for two.
    #[test]
    fn the_information_criterion_weighs_parameters_against_the_fit() {
        let one = finding(vec![candidate("a", 1.95, 1.0, 11)]);
        assert_eq!(least_bic(&one, 100).as_deref(), Some("a"));
        assert_eq!(
            least_bic(&finding(vec![candidate("a", 1.95, 1.0, 12)]), 100),
            None
        );
    }
}
