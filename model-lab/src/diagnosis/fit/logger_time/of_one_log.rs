//! Conditions of one log with an unchanged plant, which may be right or wrong.
//!
//! A wrong plant leaves errors that some clock makes smaller, and so does a wrong delay. Therefore a clock is accepted only if the commands
//! show it, or if it leaves clearly less than rows that are samples of the ECU do with any possible delay. A search over all clocks uses
//! the beginning of the log, where drifts do not matter; only a clock that shows there is sought in all of it.

use plant_sim::PlantParameters;
use plant_sim::logger_clock::LoggerClock;
use plant_sim::parameters::Part;
use plant_sim::replay::{CurrentSampling, Surroundings};
use recording::{Recording, TimeBase};

use super::commands::{CommandClock, admit, change_count, clocks_from_commands, prove_own_clock};
use super::{
    CLEAR, CLEAR_FITTED, DELAY_STEP_S, Delay, IN_TIME_FITTED, Search, Tries, find_clock,
    find_sampling, find_slow_clocks, fit_conditions, loss,
};
use crate::commands::COMMAND_DELAY;
use crate::conditions::LogConditions;
use crate::diagnosis::evidence::Evidence;
use crate::diagnosis::evidence::log::Log;
use crate::diagnosis::evidence::read_log::Read;
use crate::diagnosis::evidence::sensor_noise::SensorNoise;

/// Smallest number of changes of the commands from which a clock can be found.
const CHANGES_MIN: usize = 5;
/// Delays, over the time from row to row, with which rows of the ECU itself are tried where its clock and another one explain the commands
/// equally well: any phase within a row is such a delay.
const DELAYS_WITHIN_ROW: [f64; 9] = [-1.0, -0.75, -0.5, -0.25, 0.0, 0.25, 0.5, 0.75, 1.0];
/// Shift of the end of the log (s) from which on the drifts that the commands admit count as undetermined.
const OPEN_S: f64 = 0.2e-3;
/// Decrease of the loss from which on the temperature of the gas is accepted: three standard deviations of two quantities.
const GAS_SHOWS: f64 = 12.0;

/// Finds the conditions of `log` with an unchanged `plant`; none if the log cannot be compared, or where `goes_on` returns false.
pub(crate) fn conditions_of(
    plant: &PlantParameters,
    log: &Recording,
    goes_on: &dyn Fn() -> bool,
) -> Option<LogConditions> {
    let is_commanded = Part::Commanded.is_in(plant);
    let surroundings = Surroundings::of(plant, log).ok()?;
    let plant = &*surroundings.around(plant);
    let mut evidence = evidence_of(plant, &beginning(log))?;
    if !goes_on() {
        return None;
    }
    if is_commanded {
        find_clock_by(plant, &mut evidence, goes_on)?;
    } else if !evidence.logs[0].begins_filled() {
        // Neither a clock nor warm gas shows.
        return None;
    }
    if evidence.logs[0].is_slow() && evidence.logs[0].conditions.clock.is_some() {
        let delay_s = plant.ecu.command_delay_s;
        find_slow_clocks(plant, &mut evidence, delay_s..=delay_s, Search::Together);
    }
    if !goes_on() {
        return None;
    }
    fit(plant, &mut evidence);
    let log = &mut evidence.logs[0];
    forget_gas_that_does_not_show(plant, log);
    let mut found = log.found();
    if found.conditions.clock.is_some() {
        found.admitted_drifts_ppm = open_drifts_ppm(plant, log);
    }
    Some(found)
}

/// Returns the least and the largest drift (ppm) that the commands of `log` admit, if the difference matters.
fn open_drifts_ppm(plant: &PlantParameters, log: &Log) -> Option<(f64, f64)> {
    let from_commands = clocks_from_commands(log.inputs(), plant.ecu.sample_time_s);
    let drifts_ppm = from_commands.iter().map(|one| one.clock.drift_ppm);
    let (least, most) = drifts_ppm
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), one| {
            (least.min(one), most.max(one))
        });
    let moves_end_s = 1e-6 * (most - least) * log.duration_s();
    (moves_end_s > OPEN_S).then_some((least, most))
}

/// Finds the clock of the one log in `evidence`; none where `goes_on` returns false.
fn find_clock_by(
    plant: &PlantParameters,
    evidence: &mut Evidence,
    goes_on: &dyn Fn() -> bool,
) -> Option<()> {
    let log = &mut evidence.logs[0];
    let changes = change_count(log.inputs());
    if changes < CHANGES_MIN || log.duration_s() <= log.interval_s {
        return Some(());
    }
    let sample_time_s = plant.ecu.sample_time_s;
    let from_commands = clocks_from_commands(log.inputs(), sample_time_s);
    let is_shown = !from_commands.is_empty() || log.is_slow();
    if is_shown && prove_own_clock(log.inputs(), sample_time_s) {
        find_clock(plant, log, Delay::AsGiven, &[]);
        find_sampling(plant, evidence, Delay::AsGiven);
        return Some(());
    }
    let counted = log.counted_samples().max(1) as f64;
    if loss(plant, log, None, plant.ecu.command_delay_s) < IN_TIME_FITTED * counted {
        return Some(());
    }
    if !goes_on() {
        return None;
    }
    // A plant file that states the tolerance of the delay was fitted, and its delay as well.
    let delay = match plant.knowledge.contains_key(COMMAND_DELAY) {
        true => Delay::AsGiven,
        false => Delay::Searched,
    };
    // A fitted plant distinguishes clocks on the whole log only, where drifts are tried.
    let is_decided_by_all = from_commands.is_empty() && delay == Delay::AsGiven;
    if !is_decided_by_all && !may_have_clock(plant, log, &from_commands, delay) {
        return Some(());
    }
    if !goes_on() {
        return None;
    }
    find_clock(plant, log, delay, &[]);
    find_sampling(plant, evidence, delay);
    Some(())
}

/// Returns whether the beginning of `log` shows a clock of its own.
fn may_have_clock(
    plant: &PlantParameters,
    log: &Log,
    from_commands: &[CommandClock],
    delay: Delay,
) -> bool {
    let tries = Tries::on(plant, log);
    let sample_time_s = plant.ecu.sample_time_s;
    let (delay_s, interval_s) = (plant.ecu.command_delay_s, log.command_interval_s);
    let (clocks, delays_s, own_delays_s) = if from_commands.is_empty() {
        let delays_s = delay.candidates_s(plant, DELAY_STEP_S);
        let clock = |share: &f64| LoggerClock::with_phase_at(0.0, share * sample_time_s, 0.0);
        let clocks = delay.phases(plant).iter().map(|share| Some(clock(share)));
        (clocks.collect(), delays_s.clone(), delays_s)
    } else {
        let clocks = from_commands
            .iter()
            .flat_map(|one| Delay::AsGiven.clocks(one, plant));
        let shares = match delay {
            Delay::AsGiven => &[0.0],
            Delay::Searched => &DELAYS_WITHIN_ROW[..],
        };
        let own_delays_s = shares.iter().map(|share| delay_s + share * interval_s);
        let own_delays_s = own_delays_s.filter(|&delay_s| delay_s >= 0.0);
        (
            clocks.collect::<Vec<_>>(),
            vec![delay_s],
            own_delays_s.collect(),
        )
    };
    let without = tries.begun(&[None], &own_delays_s)[0];
    let with = tries.begun(&clocks, &delays_s)[0];
    let noise = IN_TIME_FITTED * tries.beginning().counted_samples().max(1) as f64;
    let is_clear = with.loss < CLEAR * without.loss;
    let leaves_noise = with.loss < noise && with.loss < CLEAR_FITTED * without.loss;
    is_clear || leaves_noise
}

/// Fits the conditions of the one log in `evidence`. Means since the row before look like instantaneous values half a row earlier, so both
/// are fitted where the currents may be either.
fn fit(plant: &PlantParameters, evidence: &mut Evidence) {
    let (begun, usual) = (evidence.conditions(), evidence.logs[0].sampling);
    let begun_clock = begun[0].clock;
    let samplings = match begun_clock.is_some() && evidence.logs[0].is_sampling_open() {
        true => vec![CurrentSampling::MeanOfInterval, CurrentSampling::Instant],
        false => vec![usual],
    };
    let mut best = (f64::INFINITY, usual, begun.clone());
    for sampling in samplings {
        evidence.logs[0].sampling = sampling;
        evidence.set_conditions(&begun, plant);
        fit_conditions(plant, evidence);
        keep_to_commands(plant, &mut evidence.logs[0], begun_clock);
        let loss = loss_of(plant, &evidence.logs[0]);
        if loss < best.0 {
            best = (loss, sampling, evidence.conditions());
        }
    }
    evidence.logs[0].sampling = best.1;
    evidence.set_conditions(&best.2, plant);
}

/// Returns the loss of `log` under its conditions.
fn loss_of(plant: &PlantParameters, log: &Log) -> f64 {
    loss(plant, log, log.conditions.clock, plant.ecu.command_delay_s)
}

/// Restores the clock `from_commands` where the commands do not admit the fitted one: the error of a wrong plant moved it.
fn keep_to_commands(plant: &PlantParameters, log: &mut Log, from_commands: Option<LoggerClock>) {
    let (Some(from_commands), Some(fitted)) = (from_commands, log.conditions.clock) else {
        return;
    };
    if !log.is_clock_open() && !admit(log.inputs(), plant.ecu.sample_time_s, fitted) {
        log.set_clock(from_commands, plant);
    }
}

/// Resets the gas to the temperature of the wall where the log does not show another one.
fn forget_gas_that_does_not_show(plant: &PlantParameters, log: &mut Log) {
    if !log.begins_filled() {
        return;
    }
    let (fitted, with) = (log.conditions.start_gas, loss_of(plant, log));
    log.conditions.start_gas.excess_k = 0.0;
    // The pressure of a leaking vessel falls like that of a cooling one: without commands, only a model that leaves just the noise
    // distinguishes them.
    let noise = IN_TIME_FITTED * log.counted_samples().max(1) as f64;
    let leaves_noise = log.is_commanded() || with < noise;
    if leaves_noise && with < loss_of(plant, log) - GAS_SHOWS {
        log.conditions.start_gas = fitted;
    }
}

/// Returns the log as evidence, without its conditions; none if it cannot be compared.
fn evidence_of(plant: &PlantParameters, log: &Recording) -> Option<Evidence> {
    let mut noise = SensorNoise::default();
    let read = Read::of(plant, log).ok()?;
    read.add_noise_to(&mut noise);
    let log = Log::new(plant, log, read, &noise).ok()?;
    Some(Evidence::of(vec![log.thinned(plant)]))
}

/// Returns the beginning of a log, which may be all of it.
fn beginning(log: &Recording) -> Recording {
    let mut part = Recording::new(log.provenance().clone());
    let mut ids = Vec::new();
    for (id, base) in log.time_bases() {
        let times_s = base.times_s();
        let is_later = |&row: &usize| {
            let time_s = times_s[row] - times_s[0];
            !LogConditions::is_in_beginning(row, time_s)
        };
        let rows = (0..times_s.len()).find(is_later).unwrap_or(times_s.len());
        let base = TimeBase::new(times_s[..rows].to_vec()).expect("it is the beginning of one");
        ids.push((id, part.add_time_base(base), rows));
    }
    for signal in log.signals() {
        let of_signal = ids.iter().find(|(id, ..)| *id == signal.time_base());
        let Some(&(_, id, rows)) = of_signal else {
            continue;
        };
        let values = signal.values_or_nan()[..rows].to_vec();
        part.add_signal(signal.name(), signal.unit(), id, values)
            .expect("the log has it as well");
    }
    part
}
