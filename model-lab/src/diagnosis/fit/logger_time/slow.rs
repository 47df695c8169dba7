//! Clock of a logger that is no faster than the ECU.
//!
//! Such a log shows its clock only through the model. A previous fit of the plant has determined the time from a row to the effect of its
//! command, delay minus phase. Clocks with this time in the middle of the log are tried: all delays, since the phase decides which sample
//! of the ECU a row can show, and all drifts, which shift the ends of the log.

use std::ops::{Range, RangeInclusive};

use plant_sim::PlantParameters;
use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::Part;
use rayon::prelude::*;

use super::{DELAY_STEP_S, DRIFT_MAX_PPM, IN_TIME_FITTED, loss};
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::effect_unknown::EVEN_SD;
use crate::diagnosis::evidence::log::{KnownClock, KnownPhase, Log};

/// Step of the tried drifts: it moves the last row by this time (s).
const DRIFT_STEP_S: f64 = 1e-3;
/// Largest tried drift (ppm), and the largest number of steps to either side.
const DRIFT_REACH_PPM: f64 = 0.6 * DRIFT_MAX_PPM;
const STEPS_MAX: f64 = 12.0;
/// Largest loss with a clock, over that without one, at which the clock is accepted.
const CLEAR: f64 = 0.98;

/// Least standard deviation of a phase that rows and commands determine (s).
const LEAST_PHASE_SD_S: f64 = 0.1e-3;
/// Largest distance of a fitted phase from the one that rows and commands determine (standard deviations).
const PHASE_REACH_SD: f64 = 3.0;

/// Order of the search for delay and drifts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Search {
    /// One after the other.
    InTurn,
    /// All drifts with each delay: a drift that is wrong by a sample of the ECU over the log is in another valley.
    Together,
}

/// Log whose commands do not determine its clock, with the time (s) from a row in its middle to the effect of the row's command.
struct Open {
    log: usize,
    effect_s: f64,
    drift_ppm: f64,
}

impl Open {
    fn clock(&self, log: &Log, delay_s: f64, drift_ppm: f64) -> LoggerClock {
        LoggerClock::with_phase_at(log.middle_s(), delay_s - self.effect_s, drift_ppm)
    }
}

/// Finds the clocks of logs that are no faster than the ECU with `plant`, whose delay lies within `delays_s`, and returns the delay that
/// goes with them; none if no clock leaves less than before, or where rows without one agree with `plant`.
pub(crate) fn find_slow_clocks(
    plant: &PlantParameters,
    evidence: &mut Evidence,
    delays_s: RangeInclusive<f64>,
    search: Search,
) -> Option<f64> {
    let there_s = plant.ecu.command_delay_s;
    // A plant of on/off valves has no delay but those of its valves: all phases are tried with it.
    let has_delay = Part::DelayedOutput.is_in(plant);
    let reach_s = 0.5 * plant.ecu.sample_time_s;
    let delays_s = if has_delay {
        delays_s
    } else {
        there_s - reach_s..=there_s + reach_s
    };
    let of_plant = |delay_s: f64| if has_delay { delay_s } else { there_s };
    let logs = evidence.logs.iter().enumerate();
    let mut open: Vec<Open> = logs
        .filter(|(_, log)| log.is_clock_open())
        .map(|(index, log)| {
            let clock = log.conditions.clock.unwrap_or_default();
            Open {
                log: index,
                effect_s: there_s - clock.phase_at_s(log.middle_s()),
                drift_ppm: clock.drift_ppm,
            }
        })
        .collect();
    if open.is_empty() {
        return None;
    }
    let logs = &evidence.logs;
    let before: f64 = open
        .iter()
        .map(|one| {
            loss(
                plant,
                &logs[one.log],
                logs[one.log].conditions.clock,
                there_s,
            )
        })
        .sum();
    // Without a clock `plant` leaves hardly more than the noise. A clock must not explain the rest, which may come from a missing effect.
    let has_none = |one: &Open| logs[one.log].conditions.clock.is_none();
    let counted = open.iter().map(|one| logs[one.log].counted_samples());
    if open.iter().all(has_none) && before < IN_TIME_FITTED * counted.sum::<usize>() as f64 {
        return None;
    }
    let loss_of = |one: &Open, delay_s: f64, drift_ppm: f64| {
        let log = &logs[one.log];
        let clock = one.clock(log, delay_s, drift_ppm);
        loss(plant, log, Some(clock), of_plant(delay_s))
    };
    // A log whose commands determine its clock also determines the delay.
    let is_pinned = open.len() < logs.len();
    let candidates = if is_pinned {
        vec![there_s]
    } else {
        delays_between(&delays_s)
    };
    let best_drift = |one: &Open, delay_s: f64| {
        let tried = drifts_ppm(logs[one.log].duration_s(), one.drift_ppm).into_par_iter();
        let tried = tried.map(|drift_ppm| (loss_of(one, delay_s, drift_ppm), drift_ppm));
        let least = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        least.unwrap_or((f64::INFINITY, one.drift_ppm))
    };
    let mut best = (before, there_s);
    match search {
        Search::Together => {
            let tried = candidates.into_par_iter().map(|delay_s| {
                let drifts: Vec<_> = open.iter().map(|one| best_drift(one, delay_s)).collect();
                let loss: f64 = drifts.iter().map(|(loss, _)| loss).sum();
                (loss, delay_s, drifts)
            });
            if let Some((loss, delay_s, drifts)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) {
                best = (loss, delay_s);
                for (one, (_, drift_ppm)) in open.iter_mut().zip(drifts) {
                    one.drift_ppm = drift_ppm;
                }
            }
        }
        Search::InTurn => {
            for _ in 0..2 {
                for one in &mut open {
                    (_, one.drift_ppm) = best_drift(one, best.1);
                }
                let tried = candidates.par_iter().map(|&delay_s| {
                    let losses = open.iter().map(|one| loss_of(one, delay_s, one.drift_ppm));
                    (losses.sum::<f64>(), delay_s)
                });
                best = tried.min_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or(best);
            }
        }
    }
    if best.0 > CLEAR * before {
        return None;
    }
    for one in open {
        let clock = one.clock(&evidence.logs[one.log], best.1, one.drift_ppm);
        let mut there = plant.clone();
        there.ecu.command_delay_s = of_plant(best.1);
        evidence.logs[one.log].set_clock(clock.later(plant.ecu.sample_time_s), &there);
    }
    Some(of_plant(best.1))
}

/// Moves the clocks of logs that are no faster than the ECU, together with the delay, to the middle of the range that the rows admit: data
/// show only the difference of delay and phase, but each command was given between two rows. Returns the delay that goes with the clocks,
/// within `delays_s`; none where there is no such log.
pub(crate) fn centre_slow_clocks(
    plant: &PlantParameters,
    evidence: &mut Evidence,
    delays_s: RangeInclusive<f64>,
) -> Option<f64> {
    // A log whose commands determine its clock also determines the delay.
    let is_determined = !evidence.logs.iter().all(Log::is_clock_open);
    if evidence.logs.is_empty() || is_determined || !Part::DelayedOutput.is_in(plant) {
        return None;
    }
    let there_s = plant.ecu.command_delay_s;
    let shifts = evidence.logs.iter().flat_map(Log::possible_shifts_s);
    let delays = delays_s.start() - there_s..delays_s.end() - there_s;
    let admitted = most_admitted(&shifts.collect::<Vec<_>>(), delays)?;
    let shift_s = 0.5 * (admitted.start + admitted.end);
    let sd_s = (EVEN_SD * 0.5 * (admitted.end - admitted.start)).max(LEAST_PHASE_SD_S);
    let mut there = plant.clone();
    there.ecu.command_delay_s += shift_s;
    for log in &mut evidence.logs {
        let clock = log.conditions.clock?;
        let (phase_s, drift_ppm) = (clock.phase_s + shift_s, clock.drift_ppm);
        let clock = LoggerClock { phase_s, drift_ppm }.later(plant.ecu.sample_time_s);
        log.set_clock(clock, &there);
        let at_s = log.middle_s();
        log.known_clock = KnownClock::Middle(KnownPhase {
            at_s,
            value_s: clock.phase_at_s(at_s),
            sd_s,
            reach_s: (PHASE_REACH_SD * sd_s).min(0.5 * log.sample_time_s),
        });
    }
    Some(there.ecu.command_delay_s)
}

/// Returns the part of `within` that most of `ranges` contain, if any do.
fn most_admitted(ranges: &[Range<f64>], within: Range<f64>) -> Option<Range<f64>> {
    let count = |shift: f64| ranges.iter().filter(|range| range.contains(&shift)).count();
    let ends = ranges.iter().flat_map(|range| [range.start, range.end]);
    let mut ends: Vec<f64> = ends
        .chain([within.start, within.end])
        .filter(|end| (within.start..=within.end).contains(end))
        .collect();
    ends.sort_by(f64::total_cmp);
    let parts = ends.windows(2).map(|pair| pair[0]..pair[1]);
    let counted = parts.map(|part| (count(0.5 * (part.start + part.end)), part));
    let best = counted.rev().max_by_key(|(count, _)| *count)?;
    (best.0 > 0).then_some(best.1)
}

/// Returns the drifts to try, including the present one (ppm).
fn drifts_ppm(duration_s: f64, there_ppm: f64) -> Vec<f64> {
    let step_ppm = (DRIFT_STEP_S / duration_s * 1e6).max(DRIFT_REACH_PPM / STEPS_MAX);
    let steps = (DRIFT_REACH_PPM / step_ppm).ceil() as i32;
    let all = (-steps..=steps).map(|step| f64::from(step) * step_ppm);
    all.chain([there_ppm]).collect()
}

/// Returns the delays to try (s).
fn delays_between(delays_s: &RangeInclusive<f64>) -> Vec<f64> {
    let (least_s, most_s) = (delays_s.start(), delays_s.end());
    let parts = ((most_s - least_s) / DELAY_STEP_S).ceil().max(1.0);
    let place = |part: usize| least_s + (part as f64 + 0.5) / parts * (most_s - least_s);
    (0..parts as usize).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::{logged, pressure_alone, with_values};
    use crate::diagnosis::fit::gather::gather;
    use crate::noise::Noise;

    /// Defect seen: of the barely more than the noise that a missing effect left of a log, a clock explained 3 %, and two effects were
    /// named that did not exist.
    #[test]
    fn a_clock_is_sought_where_more_than_the_noise_is_left() {
        let plant = PlantParameters::nominal();
        let clock = LoggerClock {
            phase_s: 5e-3,
            drift_ppm: 0.0,
        };
        let log = pressure_alone(&logged(&plant, clock, 0.01, 1));
        let found = |noise_bar: f64| {
            let mut noise = Noise::new(3);
            let noisy = with_values(&log, "p_ch", |_, bar| bar + noise_bar * noise.normal());
            let mut evidence = gather(&plant, [&noisy]).unwrap();
            assert!(evidence.logs[0].conditions.clock.is_none());
            let delays_s = 9e-3..=19e-3;
            find_slow_clocks(&plant, &mut evidence, delays_s, Search::Together)
        };
        assert!(found(0.02).is_some());
        assert_eq!(found(0.2), None);
    }

    #[test]
    fn most_commands_decide_and_one_that_was_assigned_wrong_does_not() {
        let ranges = [-3.0..1.0, -1.0..2.0, -0.5..4.0, 3.0..5.0];
        assert_eq!(most_admitted(&ranges, -8.0..8.0), Some(-0.5..1.0));
        assert_eq!(most_admitted(&ranges, 0.0..8.0), Some(0.0..1.0));
        assert_eq!(most_admitted(&ranges, 6.0..8.0), None);
        assert_eq!(most_admitted(&[], -8.0..8.0), None);
    }
}
