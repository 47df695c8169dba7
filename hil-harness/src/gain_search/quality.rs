//! Result of a candidate on scattered rigs, and its cost.

use crate::condition_table::Row;
use crate::requirement::Requirement;
use crate::rigs::RigVerdict;

/// Settling, overshoot and wear on scattered rigs.
#[derive(Clone, Debug, PartialEq)]
pub struct Quality {
    /// Mean settling time (samples); a step that never settles counts as
    /// [`NEVER_SAMPLES`](crate::condition_table::NEVER_SAMPLES).
    pub settling_mean_samples: f64,
    /// Time within which 90 % of the steps settle (samples); `None`: never.
    pub settling_p90_samples: Option<u32>,
    /// Share of steps that settle later than T_req, 0 to 1.
    pub late_share: f64,
    /// Overshoot that 99 % of the steps do not exceed (bar).
    pub overshoot_p99_bar: f64,
    /// Lifts of both valves (1/s).
    pub lifts_per_s: f64,
    /// Number of rigs on which every binding requirement is met.
    pub rigs_that_hold: usize,
    /// Number of rigs.
    pub rigs: usize,
    /// Cost, which ranks the candidates (samples): mean settling time, and what late steps, overshoot, lifts and failed
    /// requirements are worth in samples.
    pub cost_samples: f64,
}

/// A late step in a hundred is worth two samples of mean settling time: T_req is a requirement.
const PER_LATE_SHARE: f64 = 200.0;
/// An overshoot of P_tol at the 99th percentile is worth five samples: the truck brakes harder than it was asked to, and
/// the other valve has to correct it.
const PER_TOLERANCE: f64 = 5.0;
/// A lift per second is worth a third of a sample: ten lifts fewer may cost three samples of settling.
const PER_LIFT: f64 = 0.3;
/// A binding requirement that every rig fails is worth ten samples; late steps count again above.
const PER_FAILED_CHECK: f64 = 10.0;

impl Quality {
    /// Summarises the verdicts on `rigs`.
    pub(super) fn of(rigs: &[RigVerdict], requirement: &Requirement) -> Self {
        let Row {
            settling_mean_samples,
            settling_p90_samples,
            late_share,
            overshoot_p99_bar,
            lifts_per_s,
            ..
        } = Row::of(String::new(), rigs, requirement);
        let rigs_that_hold = rigs.iter().filter(|rig| rig.verdict.holds).count();
        let failed_checks: usize = rigs.iter().map(failed_checks).sum();
        Self {
            settling_mean_samples,
            settling_p90_samples,
            late_share,
            overshoot_p99_bar,
            lifts_per_s,
            rigs_that_hold,
            rigs: rigs.len(),
            cost_samples: settling_mean_samples
                + PER_LATE_SHARE * late_share
                + PER_TOLERANCE * overshoot_p99_bar / requirement.p_tol_bar
                + PER_LIFT * lifts_per_s
                + PER_FAILED_CHECK * failed_checks as f64 / rigs.len().max(1) as f64,
        }
    }

    /// Returns the rule of [`cost_samples`](Self::cost_samples) in words.
    pub fn cost_in_words() -> String {
        format!(
            "mean settling time in samples + {} per late step in a hundred + {PER_TOLERANCE} per multiple of P_tol of \
             overshoot + {PER_LIFT} per lift and s + {PER_FAILED_CHECK} per binding requirement that all rigs fail",
            PER_LATE_SHARE / 100.0
        )
    }

    /// Returns whether `other` settles as soon, overshoots as little and lifts as seldom, with as few late steps, and is
    /// better in one of these.
    pub fn is_dominated_by(&self, other: &Self) -> bool {
        let [own, others] = [self, other].map(|quality| {
            [
                quality.late_share,
                quality.settling_mean_samples,
                quality.overshoot_p99_bar,
                quality.lifts_per_s,
            ]
        });
        let pairs = || others.into_iter().zip(own);
        pairs().all(|(other, own)| other <= own) && pairs().any(|(other, own)| other < own)
    }
}

/// Returns the number of binding requirements that a rig fails.
fn failed_checks(rig: &RigVerdict) -> usize {
    let checks = rig.verdict.checks.iter();
    checks.filter(|check| check.binding && !check.holds).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quality(settling_mean_samples: f64, lifts_per_s: f64) -> Quality {
        Quality {
            settling_mean_samples,
            settling_p90_samples: None,
            late_share: 0.0,
            overshoot_p99_bar: 0.1,
            lifts_per_s,
            rigs_that_hold: 1,
            rigs: 1,
            cost_samples: 0.0,
        }
    }

    #[test]
    fn a_candidate_is_dominated_by_one_that_is_nowhere_worse_and_somewhere_better() {
        let one = quality(10.0, 5.0);
        assert!(one.is_dominated_by(&quality(9.0, 5.0)));
        assert!(one.is_dominated_by(&quality(9.0, 4.0)));
        assert!(!one.is_dominated_by(&one));
        assert!(!one.is_dominated_by(&quality(9.0, 6.0)), "a trade-off");
    }
}
