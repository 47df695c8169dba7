//! Assembly of the experiment into sentences and figures.

use super::distance::Rival;
use super::result::{
    Limits, NEXT_EXPERIMENT_SCHEMA, NextExperiment, Phase, RivalEffect, Sensor, TestSignal,
};
use super::test_signal::Sequence;
use crate::diagnosis::result::words::{all_of, spaced};
use crate::diagnosis::verdict::DISTINGUISHABLE;

/// Assembles the rivals with the excitations and sensors that distinguish them.
pub(super) fn assemble(
    logs: Vec<String>,
    rivals: &[Rival],
    limits: Limits,
    distance_now: f64,
    ranked: Vec<(Sequence, f64)>,
    sensors: Vec<Sensor>,
) -> NextExperiment {
    let rivals: Vec<RivalEffect> = rivals
        .iter()
        .map(|rival| {
            let (effect, variant) = rival.effect.clone().unzip();
            RivalEffect { effect, variant }
        })
        .collect();
    let best = &ranked[0];
    NextExperiment {
        schema: NEXT_EXPERIMENT_SCHEMA.to_owned(),
        logs,
        sentence: sentence(&rivals, best, &sensors),
        rivals,
        limits,
        sample_time_s: best.0.interval_s,
        distance_now,
        distinguishable_from: DISTINGUISHABLE,
        sequence: phases(&best.0),
        ranking: ranked
            .iter()
            .map(|(sequence, distance)| TestSignal {
                name: sequence.name.to_owned(),
                about: sequence.about.to_owned(),
                duration_s: sequence.duties.len() as f64 * sequence.interval_s,
                highest_bar: sequence.highest_bar,
                distance: *distance,
            })
            .collect(),
        sensors,
    }
}

pub(super) fn phases(sequence: &Sequence) -> Vec<Phase> {
    let mut phases: Vec<Phase> = Vec::new();
    for (row, &[duty_fill_pct, duty_vent_pct]) in sequence.duties.iter().enumerate() {
        let is_same = |last: &Phase| {
            last.duty_fill_pct == duty_fill_pct && last.duty_vent_pct == duty_vent_pct
        };
        if !phases.last().is_some_and(is_same) {
            let time_s = row as f64 * sequence.interval_s;
            phases.push(Phase {
                time_s,
                duty_fill_pct,
                duty_vent_pct,
            });
        }
    }
    phases
}

fn sentence(
    rivals: &[RivalEffect],
    (best, distance): &(Sequence, f64),
    sensors: &[Sensor],
) -> String {
    let name = |rival: &RivalEffect| {
        rival
            .effect
            .as_deref()
            .map_or_else(|| "the plain model".to_owned(), spaced)
    };
    let names: Vec<String> = rivals.iter().map(name).collect();
    let names = all_of(&names);
    if *distance >= DISTINGUISHABLE {
        format!(
            "\"{}\" distinguishes {names}: {distance:.1} standard deviations of the noise, {DISTINGUISHABLE} are enough",
            best.name
        )
    } else {
        let sensor = sensors.first().map_or_else(
            || "nor would a sensor that is usual on such rigs".to_owned(),
            |sensor| {
                format!(
                    "a sensor would: {}, {:.0} times its noise apart",
                    sensor.quantity, sensor.in_noise
                )
            },
        );
        format!(
            "no test signal within the limits distinguishes {names}; the best, \"{}\", gives {distance:.1} standard deviations \
             of the noise, {DISTINGUISHABLE} are needed; {sensor}",
            best.name
        )
    }
}
