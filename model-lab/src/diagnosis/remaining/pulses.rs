//! Single instants at which much more or less air entered than a pulse delivers.

use super::alike::usual;
use super::trace::{Regime, Trace};
use crate::diagnosis::fit::vector::median;
use crate::diagnosis::result::LostPulse;

/// Ratio of an error to the usual one from which on it is a jump.
const JUMP: f64 = 6.0;
/// Share of the PWM periods above which jumps are not single instants.
const LARGEST_SHARE: f64 = 0.05;
/// Distance in time (s) within which rows show the same jump.
const SAME_S: f64 = 0.1;

/// Returns the instants of one log, in the order of time.
pub(super) fn lost_pulses(trace: &Trace) -> Vec<LostPulse> {
    let errors: Vec<f64> = trace
        .errors_bar
        .iter()
        .zip(&trace.floors_bar)
        .map(|(error, floor)| error / floor)
        .collect();
    let known: Vec<usize> = (0..errors.len())
        .filter(|&row| errors[row].is_finite())
        .collect();
    let asked: Vec<usize> = known
        .iter()
        .copied()
        .filter(|&row| errors[row].abs() > JUMP)
        .collect();
    let times_s = trace.times_s();
    let periods = times_s
        .last()
        .map_or(0.0, |end_s| end_s / trace.log.commands.pwm_period_s);
    if asked.len() as f64 > LARGEST_SHARE * periods {
        return Vec::new();
    }
    let scatter = |regime: Regime| {
        let of_regime = known.iter().filter(|&&row| trace.regimes[row] == regime);
        let mut sizes: Vec<f64> = of_regime.map(|&row| errors[row].abs()).collect();
        // A normal magnitude has its median at 0.6745 standard deviations.
        median(&mut sizes).map_or(1.0, |size| (size / 0.6745).max(1.0))
    };
    let mut jumps: Vec<(usize, f64)> = Vec::new();
    for (&row, usual) in asked.iter().zip(usual(trace.log, &errors, &known, &asked)) {
        let Some(usual) = usual.filter(|usual| usual.is_near) else {
            continue;
        };
        let in_noise =
            (errors[row] - usual.median) / usual.scatter.max(scatter(trace.regimes[row]));
        if in_noise.abs() <= JUMP {
            continue;
        }
        match jumps.last_mut() {
            Some((last, largest)) if times_s[row] - times_s[*last] < SAME_S => {
                if in_noise.abs() > largest.abs() {
                    *largest = in_noise;
                }
            }
            _ => jumps.push((row, in_noise)),
        }
    }
    jumps
        .into_iter()
        .filter_map(|(row, in_noise)| {
            let end = times_s.partition_point(|&time_s| time_s < times_s[row] + SAME_S);
            let level = |mut rows: core::ops::Range<usize>| {
                rows.find_map(|row| {
                    Some(trace.missing_bar[row]).filter(|missing| missing.is_finite())
                })
            };
            // A single false reading of the sensor leaves no step.
            let jump_bar = level(end.min(errors.len() - 1)..errors.len())?
                - level(row.saturating_sub(1)..row)?;
            (jump_bar.abs() > JUMP * trace.channel.sigma).then(|| LostPulse {
                log: trace.log.source.clone(),
                time_s: times_s[row],
                jump_bar,
                in_noise,
            })
        })
        .collect()
}
