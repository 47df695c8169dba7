//! Removal costs of hidden effects: residual of a log for the same rig without one of its effects, after the ordinary
//! parameters are fitted.
//!
//! A warm coil changes every reading like a larger resistance, so its removal costs nothing. The share of an effect
//! that the ordinary parameters cannot absorb is determined at a small size of the effect, where the plant is linear.
//! It is the sine of the angle between the change by the effect and the changes by the parameters.

use std::collections::BTreeMap;

use super::super::draw::departures;
use super::super::draw::plan::Dose;
use super::super::score::finding::BySignal;
use super::format::LoggerAnswer;
use super::logger::{Run, differences, replay};
use super::ordinary;
use super::plan::LogPlan;
use crate::least_squares::{rms, weights};
use crate::reference_plant::{Reading, Rig};

/// Change of the most affected signal by an effect of small size, in units of the noise of its channel.
const SMALL: f64 = 1.0;
/// Step of the difference quotients, relative to the largest errors of the parameters.
const STEP: f64 = 0.02;
/// Regularisation of each parameter towards its true value: volume and discharge coefficients are nearly dependent.
const PULL: f64 = 1.0;

/// Returns the removal cost of each of `doses`, by its effect: rms of the change of a run's logged readings that
/// remains after a fit of the ordinary parameters, by signal, in units of the noise and converter steps of the channel.
/// The rig without the effect gets the commands of the run, even if a controller would have given others.
pub(super) fn costs(
    plain: &Rig,
    doses: &[Dose],
    logger: &LoggerAnswer,
    plan: &LogPlan,
    run: &Run,
) -> BTreeMap<String, BySignal> {
    let cost = |left_out: usize| {
        let effect = doses[left_out].form.effect.to_owned();
        (effect, cost(plain, (doses, left_out), (logger, plan, run)))
    };
    (0..doses.len()).map(cost).collect()
}

/// Returns the removal cost of one of `doses`, computed at a small size and scaled to its actual size.
fn cost(plain: &Rig, (doses, left_out): (&[Dose], usize), seen: Seen) -> BySignal {
    let (logger, plan, run) = seen;
    let readings = |rig: &Rig| replay(rig, logger, plan, run);
    let mut doses = doses.to_vec();
    let dose = doses.remove(left_out);
    let without = plain.with(departures(&doses, plain));
    let bare = readings(&without);
    let removed = differences(seen, &run.readings, &bare);
    let worst = by_signal(&removed).into_values().fold(0.0, f64::max);
    doses.push(Dose {
        size_over_typical: dose.size_over_typical * (SMALL / worst).min(1.0),
        ..dose
    });
    let with_small = readings(&plain.with(departures(&doses, plain)));
    let small = differences(seen, &with_small, &bare);
    let scale = rms(whole(&removed)) / rms(whole(&small));
    if !scale.is_finite() {
        // A small size changes nothing, so the parameters cannot absorb anything.
        return by_signal(&removed);
    }
    let mut left = by_signal(&beside_parameters((&without, &bare), small, seen));
    left.values_mut().for_each(|left| *left *= scale);
    left
}

type Changes = BTreeMap<&'static str, Vec<f64>>;
type Seen<'a> = (&'a LoggerAnswer, &'a LogPlan, &'a Run);

fn whole(changes: &Changes) -> Vec<f64> {
    changes.values().flatten().copied().collect()
}

fn by_signal(changes: &Changes) -> BySignal {
    let rms =
        |(signal, values): (&&str, &Vec<f64>)| ((*signal).to_owned(), rms(values.iter().copied()));
    changes.iter().map(rms).collect()
}

/// Returns the residual of small `changes` after a fit of the ordinary parameters of `rig`, whose readings are `bare`.
fn beside_parameters((rig, bare): (&Rig, &[Reading]), mut changes: Changes, seen: Seen) -> Changes {
    let (logger, plan, run) = seen;
    let columns: [Vec<f64>; ordinary::COUNT] = std::array::from_fn(|n| {
        let mut shares = [0.0; ordinary::COUNT];
        shares[n] = STEP;
        let there = replay(&ordinary::moved(rig, &shares), logger, plan, run);
        let column = differences(seen, &there, bare);
        whole(&column)
            .into_iter()
            .map(|change| change / STEP)
            .collect()
    });
    let weights = weights(&columns, &whole(&changes), &[PULL; ordinary::COUNT]);
    for (row, change) in changes.values_mut().flatten().enumerate() {
        let fitted = columns
            .iter()
            .zip(&weights)
            .map(|(column, weight)| weight * column[row]);
        *change -= fitted.sum::<f64>();
    }
    changes
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
    }

    #[test]
    fn more_of_an_effect_costs_more() {
        let offset = |size| costs_of(&[("sensor_offset", size)])["sensor_offset"]["p_ch"];
        let [one, three] = [1.0, 3.0].map(offset);
        assert!(one > 0.0 && three > 2.0 * one, "{one} {three}");
        let leak = |size| costs_of(&[("chamber_leak", size)])["chamber_leak"]["p_ch"];
        let [one, three] = [1.0, 3.0].map(leak);
        assert!(one > 0.0 && three > 1.5 * one, "{one} {three}");
    }

    /// Warm coils are equivalent to coils of a larger resistance.
    #[test]
    fn what_the_ordinary_parameters_take_over_is_no_cost() {
        let effect = "coil_ambient_temperature";
        let costs = costs_of(&[(effect, 3.0)]);
        let worst = costs[effect].values().copied().fold(0.0, f64::max);
        assert!(worst < 0.3, "{costs:?}");
    }

    #[test]
    fn no_effects_have_no_cost() {
        assert!(costs_of(&[]).is_empty());
    }
}
