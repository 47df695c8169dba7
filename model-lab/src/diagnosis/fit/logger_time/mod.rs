//! Clock of a logger: the instants of its rows, in the time of the ECU.
//!
//! A log need not begin at a sample instant of the ECU, and its clock may run fast or slow. The commands of a fast logger determine its
//! clock directly. That of a slow logger is found by trying clocks on the model, together with the delay of the commands, which a wrong
//! clock would be mistaken for.

mod choice;
mod commands;
mod known_clock;
mod of_one_log;
mod pwm_lead;
mod sampling;
mod slow;
mod tries;

use plant_sim::PlantParameters;
use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::Part;
use rayon::prelude::*;

use super::{Descent, Fitter, Loss};
use crate::commands::COMMAND_DELAY;
use crate::conditions::Conditions;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::log::Log;
use crate::diagnosis::evidence::unknowns::Unknowns;
pub(crate) use choice::choose_clocks_again;
use commands::{CommandClock, DRIFT_MAX_PPM, clocks_from_commands, prove_own_clock};
use known_clock::known_clock;
pub(crate) use of_one_log::conditions_of;
use pwm_lead::find_pwm_lead;
pub(crate) use sampling::{find_sampling, take_sampling};
pub(crate) use slow::{Search, centre_slow_clocks, find_slow_clocks};
use tries::{Found, OUTLIER, Tries, loss};

/// Range of the tried delays to either side of the plant file's (s), ...
const DELAY_REACH_S: f64 = 8e-3;
/// ... and their step (s); a clock of a slow logger is tried with a wider one.
const DELAY_STEP_S: f64 = 1e-3;
const WIDE_DELAY_STEP_S: f64 = 2e-3;
/// Tried phases of a slow logger, over the sample time of the ECU: where the delay is also searched, which compensates for a phase, and
/// where it is not.
const PHASES: [f64; 3] = [0.17, 0.5, 0.83];
const CLOSE_PHASES: [f64; 9] = [0.05, 0.17, 0.28, 0.39, 0.5, 0.61, 0.72, 0.83, 0.95];
/// Step of the tried drifts of a slow logger: it moves the last row by this time (s).
const DRIFT_STEP_S: f64 = 3e-3;
/// Largest tried drift of a slow logger (ppm).
const SLOW_DRIFT_MAX_PPM: f64 = 0.6 * DRIFT_MAX_PPM;
/// Number of steps to either side, at most.
const DRIFTS_MAX: f64 = 8.0;
/// Mean loss of a sample below which rows count as samples of the ECU, with a first plant file and with a fitted plant. White noise has
/// 0.7.
const IN_TIME: f64 = 2.0;
const IN_TIME_FITTED: f64 = 0.8;
/// Largest loss with a clock, over that without one, at which the clock is accepted, with a first plant file and with a fitted plant.
const CLEAR: f64 = 0.7;
const CLEAR_FITTED: f64 = 0.98;
/// Number of fits of the clocks; the commands are reassigned after each.
const ROUNDS: usize = 2;
/// Tried phases within the range that the commands admit, over half of it.
const WITHIN_SLACK: [f64; 3] = [-0.67, 0.0, 0.67];

/// Prior knowledge of the delay of the commands during the search for a clock.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Delay {
    /// The plant's delay is right.
    AsGiven,
    /// The delay may be wrong by milliseconds, which looks like a wrong clock.
    Searched,
}

impl Delay {
    /// Returns the clocks to try around one that the commands determine. A delay that is searched compensates for a phase; a plant of on/off
    /// valves has none.
    fn clocks(self, middle: &CommandClock, plant: &PlantParameters) -> Vec<Option<LoggerClock>> {
        let shares = match self {
            Self::Searched if Part::DelayedOutput.is_in(plant) => &[0.0],
            _ => &WITHIN_SLACK[..],
        };
        let later = |share: &f64| LoggerClock {
            phase_s: middle.clock.phase_s + share * middle.phase_slack_s,
            ..middle.clock
        };
        shares.iter().map(|share| Some(later(share))).collect()
    }

    /// Returns the phases to try, over the sample time of the ECU. A plant of on/off valves has no delay that compensates for one.
    fn phases(self, plant: &PlantParameters) -> &'static [f64] {
        match self {
            Self::Searched if Part::DelayedOutput.is_in(plant) => &PHASES,
            _ => &CLOSE_PHASES,
        }
    }

    fn in_time(self) -> f64 {
        match self {
            Self::AsGiven => IN_TIME_FITTED,
            Self::Searched => IN_TIME,
        }
    }

    fn clear(self) -> f64 {
        match self {
            Self::AsGiven => CLEAR_FITTED,
            Self::Searched => CLEAR,
        }
    }

    /// Returns the delays to try with each clock (s), `step_s` apart.
    fn candidates_s(self, plant: &PlantParameters, step_s: f64) -> Vec<f64> {
        let there_s = plant.ecu.command_delay_s;
        match self {
            Self::Searched if Part::DelayedOutput.is_in(plant) => {
                let steps = (DELAY_REACH_S / step_s).round() as i32;
                let delays_s = (-steps..=steps).map(|step| there_s + f64::from(step) * step_s);
                delays_s.filter(|&delay_s| delay_s >= 0.0).collect()
            }
            _ => vec![there_s],
        }
    }
}

/// Finds the times of the rows of `log` in the time of the ECU, with the present `plant`. `drifts_ppm` are those of other logs, perhaps of
/// the same logger.
pub(crate) fn find_clock(plant: &PlantParameters, log: &mut Log, delay: Delay, drifts_ppm: &[f64]) {
    let is_commanded = Part::Commanded.is_in(plant);
    let has_rows = log.interval_s > 0.0 && log.duration_s() > log.interval_s;
    if !is_commanded || !has_rows {
        return;
    }
    find_pwm_lead(plant, log, delay);
    find_loggers_clock(plant, log, delay, drifts_ppm);
    if log.conditions.clock.is_some() {
        find_pwm_lead(plant, log, delay);
    }
}

/// Finds the clock of the logger of `log`, which has coils and several rows.
fn find_loggers_clock(plant: &PlantParameters, log: &mut Log, delay: Delay, drifts_ppm: &[f64]) {
    let sample_time_s = plant.ecu.sample_time_s;
    let from_commands = clocks_from_commands(log.inputs(), sample_time_s);
    let is_from_commands = !from_commands.is_empty();
    let tries = Tries::on(plant, log);
    let found = if is_from_commands {
        let clocks = from_commands
            .iter()
            .flat_map(|one| delay.clocks(one, plant));
        let clocks: Vec<_> = clocks.collect();
        Some(tries.best(&clocks, &delay.candidates_s(plant, DELAY_STEP_S)))
    } else {
        find_clock_on_model(plant, log, &tries, delay, drifts_ppm)
    };
    if let Some(clock) = found.and_then(|found| found.whole.clock) {
        let clock = clock.later(sample_time_s);
        log.set_clock(clock, plant);
        if is_from_commands {
            log.known_clock = known_clock(&from_commands, clock, log);
        }
    }
}

/// Finds the clock of the logger of `log` if the commands do not determine it; none if the rows may be samples of the ECU, and no clock
/// leaves clearly less.
fn find_clock_on_model(
    plant: &PlantParameters,
    log: &Log,
    tries: &Tries,
    delay: Delay,
    drifts_ppm: &[f64],
) -> Option<Found> {
    // Phases and delays together are finer than the steps of the delay, which must not speak for a clock.
    let as_ecu = tries.best_delay(&delay.candidates_s(plant, DELAY_STEP_S), DELAY_STEP_S);
    // A delay that was fitted together with a clock is valid with that clock only.
    let is_stated = plant.knowledge.contains_key(COMMAND_DELAY);
    let fitted = (is_stated && delay == Delay::Searched).then_some(Delay::AsGiven);
    let ways: Vec<Delay> = fitted.into_iter().chain([delay]).collect();
    // The commands of a fast log that no clock explains were not given by samples of the ECU.
    let is_proven = log.is_slow() && prove_own_clock(log.inputs(), plant.ecu.sample_time_s);
    if !is_proven && as_ecu.whole.loss < ways[0].in_time() * log.counted_samples().max(1) as f64 {
        return None;
    }
    let drifts_ppm: Vec<f64> = (drifts_ppm.iter().copied())
        .chain(usual_drifts_ppm(log.duration_s()))
        .collect();
    ways.into_iter().find_map(|delay| {
        let phases_s: Vec<f64> = (delay.phases(plant).iter())
            .map(|share| share * plant.ecu.sample_time_s)
            .collect();
        let delays_s = delay.candidates_s(plant, WIDE_DELAY_STEP_S);
        let most = match delay {
            // A fitted plant leaves so little that a drift already shows at the beginning, where none is tried: the whole log decides.
            _ if is_proven => f64::INFINITY,
            Delay::AsGiven => f64::INFINITY,
            Delay::Searched => 0.5 * (1.0 + delay.clear()) * as_ecu.begun_loss,
        };
        let found = tries.best_drifting(&phases_s, &delays_s, &drifts_ppm, most)?;
        let is_clear = found.whole.loss <= delay.clear() * as_ecu.whole.loss;
        (is_proven || is_clear).then_some(found)
    })
}

/// Finds the clocks of all logs in `evidence` with `plant`, whose parameters are right, and fits all conditions. `drifts_ppm` are those of
/// other logs, perhaps of the same logger.
pub(crate) fn find_conditions(
    plant: &PlantParameters,
    evidence: &mut Evidence,
    drifts_ppm: &[f64],
) {
    for log in &mut evidence.logs {
        log.conditions.clock = None;
        find_clock(plant, log, Delay::AsGiven, drifts_ppm);
    }
    fit_conditions(plant, evidence);
}

/// Fits the conditions of the logs in `evidence`, including found clocks, with `plant`, whose parameters are right.
pub(crate) fn fit_conditions(plant: &PlantParameters, evidence: &mut Evidence) {
    for _ in 0..ROUNDS {
        let conditions = fitted_conditions(plant, evidence, 0.0);
        evidence.set_conditions(&conditions, plant);
        for log in &mut evidence.logs {
            log.settle_commands(plant);
        }
    }
}

/// Returns the conditions of the logs in `evidence` that suit `plant` best, with the present assignment of the commands. The delay of
/// `plant` may be wrong by up to `delay_slack_s`, for which the clocks compensate.
pub(crate) fn fitted_conditions(
    plant: &PlantParameters,
    evidence: &Evidence,
    delay_slack_s: f64,
) -> Vec<Conditions> {
    let mut conditions = evidence.conditions();
    let unknowns = Unknowns::of_logs(plant, &evidence.logs).with_looser_clocks(delay_slack_s);
    if unknowns.list().is_empty() {
        return conditions;
    }
    let mut fitter = Fitter::new(evidence, &unknowns);
    fitter.loss = Loss::Forgiving(OUTLIER);
    let start = fitter.at(unknowns.start());
    if let Some(fit) = start.and_then(|start| fitter.descend(start, Descent::Whole)) {
        unknowns.conditions(&fit.z, &mut conditions);
    }
    conditions
}

/// Returns the delay of the commands (s) that suits all logs in `evidence` best.
pub(crate) fn best_delay_s(plant: &PlantParameters, evidence: &Evidence) -> f64 {
    let delays_s = Delay::Searched.candidates_s(plant, DELAY_STEP_S);
    let losses = delays_s.into_par_iter().map(|delay_s| {
        let of_log = |log: &Log| loss(plant, log, log.conditions.clock, delay_s);
        (delay_s, evidence.logs.iter().map(of_log).sum::<f64>())
    });
    let best = losses.min_by(|a, b| a.1.total_cmp(&b.1));
    best.map_or(plant.ecu.command_delay_s, |(delay_s, _)| delay_s)
}

/// Returns drifts of usual quartz oscillators (ppm).
fn usual_drifts_ppm(duration_s: f64) -> impl Iterator<Item = f64> {
    let step_ppm = DRIFT_STEP_S / duration_s * 1e6;
    let steps = (SLOW_DRIFT_MAX_PPM / step_ppm).ceil().min(DRIFTS_MAX) as i32;
    (-steps..=steps).map(move |step| f64::from(step) * step_ppm)
}

#[cfg(test)]
mod tests {
    use plant_sim::effects::{EffectSetting, by_id};
    use plant_sim::parameters::Knowledge;
    use recording::Recording;

    use super::*;
    use crate::bench::{logged_through, pressure_alone, spiked};
    use crate::diagnosis::evidence::log::{KnownClock, KnownPhase};
    use crate::diagnosis::fit::gather::gather;
    use crate::noise::Noise;

    /// Fill, hold, vent, hold: duration (s) with the duty cycles (%).
    const PULSES: [(f64, f64, f64); 4] = [
        (0.07, 70.0, 0.0),
        (0.41, 0.0, 0.0),
        (0.09, 0.0, 70.0),
        (0.43, 0.0, 0.0),
    ];

    const CLOCK: LoggerClock = LoggerClock {
        phase_s: 9.5e-3,
        drift_ppm: -120.0,
    };

    /// Returns a log of the nominal plant whose commands determine its `CLOCK`.
    fn determining_log() -> Recording {
        let plant = PlantParameters::nominal();
        logged_through(&plant, CLOCK, 6.9e-3, 1, &PULSES.repeat(30))
    }

    /// Returns the difference of two phases (s) to the nearest whole sample of the ECU.
    fn within_sample_s(log: &Log, off_s: f64) -> f64 {
        off_s - (off_s / log.sample_time_s).round() * log.sample_time_s
    }

    /// Defect seen: about a hundred commands determined the phase of rows 6.9 ms apart to a tenth of a millisecond, and a fit moved it by
    /// 1.7 ms, 2.4 noise floors from the log.
    #[test]
    fn a_phase_is_known_as_well_as_the_commands_determine_it() {
        let plant = PlantParameters::nominal();
        let log = determining_log();
        let evidence = gather(&plant, [&log]).unwrap();
        let log = &evidence.logs[0];
        let KnownClock::Ends(ends) = log.known_clock else {
            panic!("the commands determine it");
        };
        for KnownPhase {
            at_s,
            value_s,
            sd_s,
            reach_s,
        } in ends
        {
            let off_s = within_sample_s(log, value_s - CLOCK.phase_at_s(at_s));
            assert!(sd_s < 0.5e-3 && reach_s < 1.6e-3, "{sd_s} {reach_s}");
            assert!(off_s.abs() < reach_s, "{off_s} {sd_s}");
        }
    }

    /// Defect seen: the commands of the fitted log left its clock open by 1.2 ms, and its fit took that away from the delay. Those of the
    /// check log did not leave as much open: its currents had 19 noise floors, and no effect was named.
    #[test]
    fn a_clock_compensates_for_a_delay_that_the_fitted_logs_leave_open() {
        let rig = PlantParameters::nominal();
        let log = determining_log();
        let evidence = gather(&rig, [&log]).unwrap();
        let log = &evidence.logs[0];
        let KnownClock::Ends([known, _]) = log.known_clock else {
            panic!("the commands determine it");
        };
        let [later_s, slack_s] = [known.reach_s + 1e-3, 1.5e-3];
        let mut plant = rig.clone();
        plant.ecu.command_delay_s += later_s;
        let off_s = |slack_s: f64| {
            let found = fitted_conditions(&plant, &evidence, slack_s)[0]
                .clock
                .unwrap();
            let at_s = log.middle_s();
            within_sample_s(
                log,
                found.phase_at_s(at_s) - CLOCK.phase_at_s(at_s) - later_s,
            )
        };
        assert!(off_s(0.0).abs() > 0.5e-3, "{}", off_s(0.0));
        assert!(off_s(slack_s).abs() < 0.2e-3, "{}", off_s(slack_s));
    }

    #[test]
    fn the_clocks_leave_a_fitted_delay_open_as_far_as_their_own_range() {
        let plant = PlantParameters::nominal();
        let log = determining_log();
        let slack_s = |plant: &PlantParameters| {
            let evidence = gather(plant, [&log]).unwrap();
            Unknowns::new(plant, &[], &evidence.logs).delay_slack_s()
        };
        assert!((0.3e-3..1.6e-3).contains(&slack_s(&plant)));
        let mut exact = plant.clone();
        exact
            .knowledge
            .insert(COMMAND_DELAY.to_owned(), Knowledge::Exact);
        assert_eq!(slack_s(&exact), 0.0);
    }

    /// Defect seen: rows 50 ms apart were taken for samples that are 40 ms apart, and a sensor lag of 57 ms explained 3 %.
    #[test]
    fn rows_off_the_grid_of_the_ecu_have_a_clock() {
        let plant = PlantParameters::nominal();
        let has_clock = |interval_s: f64| {
            let log = pressure_alone(&logged_through(
                &plant,
                LoggerClock::default(),
                interval_s,
                1,
                &PULSES.repeat(15),
            ));
            let pressure = log.signal("p_ch").unwrap().len();
            // The noise is so large that a clock does not show.
            let mut noise = Noise::new(3);
            let spikes = (0..pressure).map(|row| (row..row + 1, 0.3 * noise.normal()));
            let log = spiked(&log, "p_ch", &spikes.collect::<Vec<_>>());
            gather(&plant, [&log]).unwrap().logs[0]
                .conditions
                .clock
                .is_some()
        };
        assert!(!has_clock(20e-3));
        assert!(has_clock(16e-3));
    }

    /// Defect seen: a plant of on/off valves has no delay that compensates for a phase, and of three tried phases none showed its clock.
    #[test]
    fn phases_are_tried_closely_without_a_delay() {
        let valves = "
            supply_pressure_bar_gauge = 7
            command_frequency_hz = 50
            chamber_volume_cm3 = 300
            fill_C_dm3_per_s_bar = 0.6
            fill_b = 0.3
            fill_opening_delay_ms = 6
            fill_closing_delay_ms = 5
            fill_opening_ramp_ms = 3
            fill_closing_ramp_ms = 3
            vent_C_dm3_per_s_bar = 0.6
            vent_b = 0.3
            vent_opening_delay_ms = 6
            vent_closing_delay_ms = 5
            vent_opening_ramp_ms = 3
            vent_closing_ramp_ms = 3
        ";
        let on_off = PlantParameters::from_datasheet(valves, "plate").unwrap();
        let count = |plant: &PlantParameters| Delay::Searched.phases(plant).len();
        assert_eq!(count(&on_off), CLOSE_PHASES.len());
        assert!(count(&PlantParameters::nominal()) < CLOSE_PHASES.len());
    }

    /// Defect seen: `diagnose` rejected the clock that `refine` had found. At the beginning of the log, where no drift was tried, 185 ppm
    /// left more than rows of the ECU with a wrong delay did.
    #[test]
    fn a_fitted_plant_finds_a_clock_that_drifts_beside_a_missing_effect() {
        let leak = EffectSetting::typical(by_id("chamber_leak").unwrap());
        let rig = PlantParameters::nominal().with_effect(leak.with("area_m2", 3e-8));
        let mut plant = PlantParameters::nominal();
        let stated = Knowledge::Range(9e-3, 21e-3);
        plant.knowledge.insert(COMMAND_DELAY.to_owned(), stated);
        let clock = LoggerClock {
            phase_s: 0.5e-3,
            drift_ppm: -185.0,
        };
        let log = logged_through(&rig, clock, 8.05e-3, 1, &PULSES.repeat(60));
        let mut evidence = gather(&plant, [&log]).unwrap();
        fit_conditions(&plant, &mut evidence);
        let log = &evidence.logs[0];
        let found = log.conditions.clock.expect("it has a clock of its own");
        let [found_s, true_s] = [found, clock].map(|one| one.phase_at_s(log.middle_s()));
        let off_s = within_sample_s(log, found_s - true_s);
        assert!(off_s.abs() < 0.3e-3, "{found:?}: {off_s}");
        assert!(
            (found.drift_ppm - clock.drift_ppm).abs() < 20.0,
            "{found:?}"
        );
    }
}
