//! Removal costs of hidden effects: the change of a log's readings on the same rig without one of them.

use std::collections::BTreeMap;

use super::super::draw::departures;
use super::super::draw::plan::Dose;
use super::super::score::finding::BySignal;
use super::format::LoggerAnswer;
use super::logger::{Run, difference, replay};
use super::plan::LogPlan;
use crate::reference_plant::Rig;

/// Returns the cost of leaving out each of `doses`, by its effect: rms by which the logged readings of a run change, by
/// signal, in units of the noise and converter steps of the channel. The rig without the effect gets the commands of
/// the run, even if a controller would have given others.
pub(super) fn costs(
    plain: &Rig,
    doses: &[Dose],
    logger: &LoggerAnswer,
    plan: &LogPlan,
    run: &Run,
) -> BTreeMap<String, BySignal> {
    let cost = |left_out: usize| {
        let mut others = doses.to_vec();
        let dose = others.remove(left_out);
        let without = plain.with(departures(&others, plain));
        let readings = replay(&without, logger, plan, run);
        let cost = difference(logger, plan, run, &readings);
        (dose.form.effect.to_owned(), cost)
    };
    (0..doses.len()).map(cost).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blind::field::logger::record;
    use crate::blind::field::plan::{FieldPlan, Warm};
    use crate::blind::format::Profile;
    use crate::chance::Chance;
    use crate::reference_plant::catalogue::forms;

    /// Returns the costs in a closed loop of three seconds that begins warm and has a gap.
    fn costs_of(sizes: &[(&str, f64)]) -> BTreeMap<String, BySignal> {
        let mut chance = Chance::new(3);
        let FieldPlan {
            plain, mut logger, ..
        } = FieldPlan::draw(1, &mut chance);
        logger.currents = true;
        let plan = LogPlan {
            profile: Profile::ClosedLoop,
            length_s: 3.0,
            command_grid: 1,
            phase_s: 3e-3,
            gaps: vec![[1.0, 1.4]],
            warm: Some(Warm {
                fill_samples: 10,
                shut_samples: 10,
                hold_samples: 50,
                surplus_k: 10.0,
                relaxation_s: 0.2,
            }),
        };
        let dose = |&(effect, size_over_typical): &(&str, f64)| Dose {
            form: forms().find(|form| form.effect == effect).unwrap(),
            size_over_typical,
            shape: 0.5,
        };
        let doses: Vec<Dose> = sizes.iter().map(dose).collect();
        let rig = plain.with(departures(&doses, &plain));
        let recorded = record(&rig, &logger, &plan, &mut chance);
        costs(&plain, &doses, &logger, &plan, &recorded.run)
    }

    #[test]
    fn an_effect_of_no_size_costs_nothing_beside_one_that_does() {
        let costs = costs_of(&[("sensor_hysteresis", 3.0), ("chamber_leak", 0.0)]);
        assert!(costs["chamber_leak"].values().all(|&cost| cost == 0.0));
        assert!(costs["sensor_hysteresis"]["p_ch"] > 0.0);
        assert_eq!(costs["sensor_hysteresis"].len(), 3, "{costs:?}");
        assert_eq!(costs["sensor_hysteresis"]["i_fill"], 0.0);
    }

    /// An offset is in every reading of the sensor: the cost is the offset divided by the channel's noise.
    #[test]
    fn more_of_an_effect_costs_more() {
        let cost = |size| costs_of(&[("sensor_offset", size)])["sensor_offset"]["p_ch"];
        let [one, three] = [1.0, 3.0].map(cost);
        assert!((three / one - 3.0).abs() < 1e-9, "{one} {three}");
        let leak = |size| costs_of(&[("chamber_leak", size)])["chamber_leak"]["p_ch"];
        let [one, three] = [1.0, 3.0].map(leak);
        assert!(one > 0.0 && three > 1.5 * one, "{one} {three}");
    }

    #[test]
    fn no_effects_have_no_cost() {
        assert!(costs_of(&[]).is_empty());
    }
}
