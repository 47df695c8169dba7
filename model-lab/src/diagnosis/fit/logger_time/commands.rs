//! Clock of a logger, from the commands that it logged.
//!
//! The ECU commands on its own grid, so every change of a logged duty cycle lies between the two rows that enclose a sample instant of the
//! ECU. Each change therefore admits only some phases of the logger's clock. A logger whose rows are closer than the ECU's samples thus
//! shows phase and drift of its clock without any model.

use plant_sim::logger_clock::LoggerClock;
use plant_sim::replay::ReplayInput;

/// Largest drift of a logger's clock (ppm).
pub(super) const DRIFT_MAX_PPM: f64 = 400.0;
/// Largest distance of a change's rows, over the ECU's sample time, at which it constrains the clock.
const FASTER: f64 = 0.75;
/// Smallest number of changes of a command that determines a clock.
const CHANGES_MIN: usize = 5;
/// Step of the tried drifts: it moves the last change by this share of the time between its rows.
const STEP_SHARE: f64 = 0.02;
/// Distance of the returned clocks at the last change, over the time between its rows.
const APART_SHARE: f64 = 0.3;
/// Number of changes of the commands that are not on a grid of the ECU by chance: two rows of a fast logger enclose an instant of any grid
/// with a probability of up to 3 in 4.
const CHANGES_PROVING: usize = 20;
/// Share of the time between its rows by which a change may lie outside of them, because of rounded times.
const SLACK: f64 = 0.02;
/// The same share for a fitted clock.
pub(super) const FITTED_SLACK: f64 = 0.1;
/// Share of the changes that a clock has to explain: a command may be set by hand, between the samples of the ECU.
const EXPLAINED: f64 = 0.98;

/// Clock as determined by the commands.
#[derive(Debug, Clone, Copy)]
pub(super) struct CommandClock {
    pub(super) clock: LoggerClock,
    /// Largest deviation of the phase to either side (s), ...
    pub(super) phase_slack_s: f64,
    /// ... and of the drift (ppm).
    pub(super) drift_slack_ppm: f64,
}

/// Change of a command, between two rows that show commands.
#[derive(Debug, Clone, Copy)]
struct Change {
    /// Instants of the two rows since the first one of the log (s).
    before_s: f64,
    at_s: f64,
}

/// Returns clocks in whose time all changes of the commands enclose a sample instant of the ECU, over the whole range of such drifts. None
/// for a logger that is hardly faster than the ECU, for few changes, and for commands that are not on such a grid.
pub(super) fn clocks_from_commands(
    inputs: &[ReplayInput],
    sample_time_s: f64,
) -> Vec<CommandClock> {
    let changes = changes(inputs, FASTER * sample_time_s);
    if changes.len() < CHANGES_MIN {
        return Vec::new();
    }
    let span_s = changes[changes.len() - 1].at_s - changes[0].at_s;
    let mut widths: Vec<f64> = changes.iter().map(|one| one.at_s - one.before_s).collect();
    widths.sort_by(f64::total_cmp);
    let interval_s = widths[widths.len() / 2];
    let step_ppm = (STEP_SHARE * interval_s / span_s * 1e6).min(DRIFT_MAX_PPM);
    let steps = (DRIFT_MAX_PPM / step_ppm).ceil() as i32;
    let drifts = (-steps..=steps).map(|step| f64::from(step) * step_ppm);
    let mut ranges: Vec<(f64, f64)> = Vec::new();
    for drift_ppm in
        drifts.filter(|&drift_ppm| phases(&changes, drift_ppm, sample_time_s).is_some())
    {
        match ranges.last_mut() {
            Some(last) if drift_ppm - last.1 < 1.5 * step_ppm => last.1 = drift_ppm,
            _ => ranges.push((drift_ppm, drift_ppm)),
        }
    }
    let apart_ppm = APART_SHARE * interval_s / span_s * 1e6;
    let drifts = ranges.into_iter().flat_map(|(least_ppm, most_ppm)| {
        let count = ((most_ppm - least_ppm) / apart_ppm).ceil().max(1.0);
        let slack_ppm = 0.5 * (most_ppm - least_ppm) / count;
        let place = move |n: usize| least_ppm + (2 * n + 1) as f64 * slack_ppm;
        (0..count as usize).map(move |n| (place(n), slack_ppm))
    });
    drifts
        .filter_map(|(drift_ppm, slack_ppm)| {
            let (least_s, most_s) = phases(&changes, drift_ppm, sample_time_s)?;
            Some(CommandClock {
                clock: LoggerClock {
                    phase_s: (0.5 * (least_s + most_s)).rem_euclid(sample_time_s),
                    drift_ppm,
                },
                phase_slack_s: 0.5 * (most_s - least_s),
                drift_slack_ppm: slack_ppm + step_ppm,
            })
        })
        .collect()
}

/// Returns whether the fitted `clock` explains the changes of the commands: within a tenth of a row.
pub(super) fn admit(inputs: &[ReplayInput], sample_time_s: f64, clock: LoggerClock) -> bool {
    let changes = changes(inputs, FASTER * sample_time_s);
    let encloses = |change: &&Change| {
        let slack_s = FITTED_SLACK * (change.at_s - change.before_s);
        let [begin_s, end_s] = [change.before_s - slack_s, change.at_s + slack_s]
            .map(|log_s| (log_s + clock.phase_at_s(log_s)) / sample_time_s);
        end_s.floor() > begin_s.floor()
    };
    let explained = changes.iter().filter(encloses).count();
    explained as f64 >= EXPLAINED * changes.len() as f64
}

/// Returns the instants of the first and the last change that constrain a clock, since the first row (s); those of the first and the last
/// row where there is none.
pub(super) fn ends_s(inputs: &[ReplayInput], sample_time_s: f64) -> [f64; 2] {
    let changes = changes(inputs, FASTER * sample_time_s);
    let last_row_s = inputs.last().map_or(0.0, |last| last.time_ns as f64 * 1e-9);
    match (changes.first(), changes.last()) {
        (Some(first), Some(last)) if last.at_s > first.at_s => [first.at_s, last.at_s],
        _ => [0.0, last_row_s],
    }
}

/// Returns the number of changes of the commands.
pub(super) fn change_count(inputs: &[ReplayInput]) -> usize {
    changes(inputs, f64::INFINITY).len()
}

/// Returns whether the commands prove that the rows are no samples of the ECU: too many rows with a new command are not on its grid.
pub(super) fn prove_own_clock(inputs: &[ReplayInput], sample_time_s: f64) -> bool {
    change_count(inputs) >= CHANGES_PROVING && !admit_samples(inputs, sample_time_s)
}

/// Returns whether the rows may be instants of the ECU's own clock: its samples then are at multiples of `sample_time_s`, and so are the
/// rows that show a new command.
fn admit_samples(inputs: &[ReplayInput], sample_time_s: f64) -> bool {
    let changes = changes(inputs, f64::INFINITY);
    let is_at_sample = |change: &&Change| {
        let samples = change.at_s / sample_time_s;
        let off_s = (samples - samples.round()).abs() * sample_time_s;
        off_s <= SLACK * (change.at_s - change.before_s).min(sample_time_s)
    };
    let explained = changes.iter().filter(is_at_sample).count();
    explained as f64 >= EXPLAINED * changes.len() as f64
}

/// Returns the changes between rows that are closer than `closest_s`.
fn changes(inputs: &[ReplayInput], closest_s: f64) -> Vec<Change> {
    let pairs = inputs.windows(2).filter(|pair| {
        let (before, at) = (pair[0].command, pair[1].command);
        before.is_some() && at.is_some() && before != at
    });
    let change = |pair: &[ReplayInput]| Change {
        before_s: pair[0].time_ns as f64 * 1e-9,
        at_s: pair[1].shown_ns as f64 * 1e-9,
    };
    pairs
        .map(change)
        .filter(|change| change.at_s - change.before_s < closest_s)
        .collect()
}

/// Returns the least and the largest phase (s) with which a clock of `drift_ppm` explains the changes; none if it does not. Phases
/// are cyclic in the sample time of the ECU.
fn phases(changes: &[Change], drift_ppm: f64, sample_time_s: f64) -> Option<(f64, f64)> {
    let rate = 1.0 + drift_ppm * 1e-6;
    // Each change admits an arc of phases; +1 where one begins, -1 where one ends.
    let mut turns: Vec<(f64, i32)> = Vec::with_capacity(2 * changes.len());
    let mut admitted = 0;
    for change in changes {
        let slack_s = SLACK * (change.at_s - change.before_s);
        let begin_s = (-(change.at_s * rate + slack_s)).rem_euclid(sample_time_s);
        let end_s = begin_s + (change.at_s - change.before_s) * rate + 2.0 * slack_s;
        turns.extend([(begin_s, 1), (end_s.rem_euclid(sample_time_s), -1)]);
        admitted += i32::from(end_s >= sample_time_s);
    }
    turns.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best = (0, 0.0, 0.0);
    for (n, &(begin_s, turn)) in turns.iter().enumerate() {
        admitted += turn;
        if admitted > best.0 {
            let end_s = match turns.get(n + 1) {
                Some(&(end_s, _)) => end_s,
                None => turns[0].0 + sample_time_s,
            };
            best = (admitted, begin_s, end_s);
        }
    }
    let (count, least_s, most_s) = best;
    (f64::from(count) >= EXPLAINED * changes.len() as f64).then_some((least_s, most_s))
}

#[cfg(test)]
mod tests {
    use plant_sim::Command;

    use super::*;

    const SAMPLE_TIME_S: f64 = 10e-3;

    /// Returns the log of a logger with `clock` at `instants_s`, of commands that change at samples of the ECU throughout the log.
    fn logged(clock: LoggerClock, instants_s: impl Iterator<Item = f64>) -> Vec<ReplayInput> {
        let row = |instant_s: f64| {
            let time_ns = (instant_s * 1e9) as u64;
            let sample = clock.ecu_time_ns(time_ns) / 10_000_000;
            // Changes every 7 to 9 samples.
            let duty_fill_pct = (sample / 8 + sample / 71) as f64 % 2.0 * 50.0;
            ReplayInput {
                command: Some(Command {
                    duty_fill_pct,
                    duty_vent_pct: 0.0,
                }),
                ..ReplayInput::at(time_ns)
            }
        };
        instants_s.map(row).collect()
    }

    fn check(clock: LoggerClock, instants_s: impl Iterator<Item = f64>) {
        let found = clocks_from_commands(&logged(clock, instants_s), SAMPLE_TIME_S);
        let is_right = |one: &CommandClock| {
            let off_s = one.clock.phase_s - clock.phase_s
                + (one.clock.drift_ppm - clock.drift_ppm) * 1e-6 * 15.0;
            let off_s = off_s - (off_s / SAMPLE_TIME_S).round() * SAMPLE_TIME_S;
            off_s.abs() < one.phase_slack_s + 5e-4
        };
        assert!(found.iter().any(is_right), "{clock:?}: {found:?}");
    }

    #[test]
    fn even_and_uneven_rows_determine_phase_and_drift() {
        for (phase_s, drift_ppm) in [(0.3e-3, 0.0), (6.2e-3, 180.0), (9.9e-3, -150.0)] {
            let clock = LoggerClock { phase_s, drift_ppm };
            for interval_s in [0.2e-3, 2e-3, 5e-3] {
                let rows = (30.0 / interval_s) as usize;
                check(clock, (0..rows).map(|row| row as f64 * interval_s));
                // Rows up to 0.8 intervals late, in irregular order.
                let late = |row: usize| (row as f64 * 0.618).fract() * 0.8;
                check(
                    clock,
                    (0..rows).map(|row| (row as f64 + late(row)) * interval_s),
                );
            }
        }
    }

    #[test]
    fn rows_that_are_further_apart_than_samples_determine_nothing() {
        let rows = (0..3000).map(|row| f64::from(row) * 10e-3);
        assert!(
            clocks_from_commands(&logged(LoggerClock::default(), rows), SAMPLE_TIME_S).is_empty()
        );
    }
}
