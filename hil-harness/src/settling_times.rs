//! Distribution of the settling times on scattered rigs.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::checks::Verdict;
use crate::rigs::RigVerdict;

/// Settling times of the steps to references of the operating range. The verdict on a rig depends on its slowest step,
/// so the slowest steps of the rigs are a distribution as well.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SettlingTimes {
    /// Settling times in ascending order (samples).
    pub samples: Vec<u32>,
    /// Number of steps that never settled while their reference was constant.
    pub never: usize,
}

impl SettlingTimes {
    /// Collects the settling times of every step on every rig.
    pub fn of_steps(rigs: &[RigVerdict]) -> Self {
        rigs.iter().flat_map(|rig| times(&rig.verdict)).collect()
    }

    /// Collects the settling time of the slowest step of each rig.
    pub fn of_rigs(rigs: &[RigVerdict]) -> Self {
        let slowest =
            |rig: &RigVerdict| times(&rig.verdict).reduce(|one, other| Some(one?.max(other?)));
        rigs.iter().filter_map(slowest).collect()
    }

    /// Returns the number of steps.
    pub fn count(&self) -> usize {
        self.samples.len() + self.never
    }

    /// Returns the share that settles within `samples`, 0 to 1; `None` without steps.
    pub fn share_within(&self, samples: u32) -> Option<f64> {
        let within = self.samples.partition_point(|&time| time <= samples);
        (self.count() > 0).then(|| within as f64 / self.count() as f64)
    }

    /// Returns the time within which this share, 0 to 1, settles (samples); `None` if too many steps never do.
    pub fn quantile(&self, share: f64) -> Option<u32> {
        let rank = (share * self.count() as f64).ceil().max(1.0) as usize;
        self.samples.get(rank - 1).copied()
    }

    /// Returns each time that occurs, with the share that has settled by then.
    pub fn distribution(&self) -> Vec<(u32, f64)> {
        let count = self.count() as f64;
        let mut steps: Vec<(u32, f64)> = Vec::new();
        for (index, &time) in self.samples.iter().enumerate() {
            let share = (index + 1) as f64 / count;
            match steps.last_mut() {
                Some(last) if last.0 == time => last.1 = share,
                _ => steps.push((time, share)),
            }
        }
        steps
    }
}

/// Returns the time of each step in the operating range; `None` for one that never settled.
fn times(verdict: &Verdict) -> impl Iterator<Item = Option<u32>> {
    let steps = verdict.steps.iter().filter(|step| step.in_operating_range);
    steps.map(|step| step.settled_samples)
}

impl FromIterator<Option<u32>> for SettlingTimes {
    fn from_iter<I: IntoIterator<Item = Option<u32>>>(times: I) -> Self {
        let mut collected = Self::default();
        for time in times {
            match time {
                Some(samples) => collected.samples.push(samples),
                None => collected.never += 1,
            }
        }
        collected.samples.sort_unstable();
        collected
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Requirement, Scenario, rigs};

    #[test]
    fn what_never_settles_counts_and_has_no_time() {
        let times: SettlingTimes = [Some(30), None, Some(10), Some(30)].into_iter().collect();
        assert_eq!(times.count(), 4);
        assert_eq!(times.distribution(), [(10, 0.25), (30, 0.75)]);
        assert_eq!(times.share_within(29), Some(0.25));
        assert_eq!(times.quantile(0.75), Some(30));
        assert_eq!(times.quantile(0.76), None);
        assert_eq!(SettlingTimes::default().share_within(50), None);
        assert_eq!(SettlingTimes::default().quantile(0.5), None);
    }

    /// Distribution and verdicts agree: a rig that meets T_req has its slowest step within it.
    #[test]
    fn the_slowest_step_of_a_rig_is_what_its_verdict_is_about() {
        let scenario = Scenario::built_in("figure-6.5").unwrap();
        let requirement = Requirement::THESIS;
        let rigs: Vec<_> = rigs::verdicts(&scenario, &requirement, 3)
            .collect::<Result<_, _>>()
            .unwrap();
        let slowest = SettlingTimes::of_rigs(&rigs);
        assert_eq!(slowest.count(), 3);
        let reached = rigs.iter().filter_map(|rig| {
            let check = rig.verdict.check(crate::checks::CheckId::SettlingTime)?;
            check.reached
        });
        let worst = reached.fold(0.0, f64::max);
        assert_eq!(
            slowest.samples.last().map(|&time| f64::from(time)),
            Some(worst)
        );
        let steps = SettlingTimes::of_steps(&rigs);
        assert_eq!(steps.quantile(1.0), slowest.quantile(1.0));
        assert!(steps.count() > slowest.count(), "{}", steps.count());
    }
}
