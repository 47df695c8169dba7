//! Assignment of each command of a log to the sample of the ECU at which it was given.

use std::ops::{Range, RangeInclusive};

use plant_sim::logger_clock::LoggerClock;
use plant_sim::replay::{Replay, Row};
use plant_sim::{Command, PlantParameters, Tolerance};

use super::{Log, Timing};

use crate::conditions::{Conditions, shown_log_ns};
use crate::result::Horizon;

/// Number of PWM periods after a command took effect until its effect has shown.
const SHOWS_PERIODS: f64 = 2.0;
/// Share of a sample time by which a command may have been given outside the rows that enclose it: the clock may be slightly wrong.
const EDGE: f64 = 0.1;
/// Number of samples of the ECU between two rows above which the rows enclose a gap.
const SAMPLES_MAX: u64 = 20;

/// Number of changes of the commands that are assigned together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Changes {
    One,
    /// Changes of two rows: the best sample of one depends on the sample at which the next one ends it.
    Two,
}

/// Number of passes over the changes; each uses the previous assignment of the later changes.
const PASSES: usize = 2;

impl Log {
    /// Sets the clock of the logger, and assigns the command of each row to a sample of the ECU with it.
    pub(crate) fn set_clock(&mut self, clock: LoggerClock, parameters: &PlantParameters) {
        self.conditions.clock = Some(clock);
        self.issued_ns = self.issued_by(clock, parameters);
    }

    /// Reassigns the commands of a slow log, two changes together, beginning with the present assignment. Only a plant that fits determines
    /// two changes: a wrong one would be distorted until it fits such commands.
    pub(crate) fn settle_commands(&mut self, parameters: &PlantParameters) {
        let Some(clock) = self.conditions.clock.filter(|_| self.is_slow()) else {
            return;
        };
        let mut issued_ns = self.issued_ns.clone();
        for _ in 0..PASSES {
            self.assign_by_model(clock, parameters, Changes::Two, &mut issued_ns);
        }
        self.issued_ns = issued_ns;
    }

    /// Returns the instants of the rows that show the commands of the first `rows` (ns, clock of the logger), and the instants at which
    /// these were given (ns, ECU time).
    pub(super) fn shown_and_issued_ns(&self, rows: usize) -> Vec<(u64, u64)> {
        let issued = self.issued_ns.iter().take(rows).enumerate();
        let mut pairs: Vec<_> = issued
            .map(|(row, &issued)| (self.shown_ns(row), issued))
            .collect();
        // The first of several rows was assigned.
        pairs.dedup_by_key(|&mut (shown_ns, _)| shown_ns);
        pairs
    }

    /// Sets the instants (ns, ECU time), row after row, at which the commands were given.
    pub(crate) fn set_issued_ns(&mut self, issued_ns: Vec<u64>) {
        self.issued_ns = issued_ns;
    }

    /// Returns the instant (ns, ECU time) at which the command of each row was given if the logger has `clock`. Where several samples of
    /// the ECU lie between two rows, it is the one that explains the next rows best with the model.
    pub(super) fn issued_by(&self, clock: LoggerClock, parameters: &PlantParameters) -> Vec<u64> {
        let sample_time_ns = parameters.ecu.sample_time_ns();
        let interval_ns = (self.command_interval_s * 1e9) as u64;
        let sample = |row| clock.ecu_sample(self.shown_ns(row), interval_ns, sample_time_ns);
        let mut issued_ns: Vec<u64> = (0..self.inputs.len())
            .map(|row| sample_time_ns * sample(row))
            .collect();
        self.assign_first_by_model(clock, parameters, &mut issued_ns);
        if self.is_slow() {
            self.assign_by_model(clock, parameters, Changes::One, &mut issued_ns);
        }
        issued_ns
    }

    /// Assigns the command of the first row, which no row before encloses: to the last sample of the ECU before the row, or to the sample
    /// since the beginning that best explains the rows until its effect has shown.
    fn assign_first_by_model(
        &self,
        clock: LoggerClock,
        parameters: &PlantParameters,
        issued_ns: &mut [u64],
    ) {
        let (Some(first), Some(issued)) = (self.inputs.first(), issued_ns.first_mut()) else {
            return;
        };
        let sample_time_ns = parameters.ecu.sample_time_ns();
        let slack_ns = (EDGE * sample_time_ns as f64) as u64;
        let row_ns = clock.ecu_time_ns(0);
        *issued = row_ns / sample_time_ns * sample_time_ns;
        let is_at_rest = first.command.is_none_or(|one| one == Command::default());
        if is_at_rest || self.start.is_filled {
            return;
        }
        let conditions = Conditions {
            clock: Some(clock),
            ..self.conditions
        };
        let until = self.rows_until_shown(0, parameters);
        let samples = (0..=(row_ns + slack_ns) / sample_time_ns).rev();
        let tried = samples.map(|sample| {
            let replay = self.begin(parameters, &conditions, Tolerance::default());
            let mut trial = issued_ns[..until].to_vec();
            trial[0] = sample * sample_time_ns;
            (self.loss(replay, 0..until, &conditions, &trial), trial[0])
        });
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((_, best_ns)) = best {
            issued_ns[0] = best_ns;
        }
    }

    /// Returns the first row after those in which the command of `row` may show.
    fn rows_until_shown(&self, row: usize, parameters: &PlantParameters) -> usize {
        let shows_s =
            parameters.ecu.command_delay_s + SHOWS_PERIODS / parameters.ecu.pwm_frequency_hz;
        let rows = (shows_s / self.interval_s).ceil() as usize + 1;
        (self.shown_row(row) + rows).min(self.inputs.len())
    }

    /// Returns the time of the row that shows the command of `row` (ns), since the first row, by the clock of the logger.
    fn shown_ns(&self, row: usize) -> u64 {
        shown_log_ns(&self.inputs[row], self.log_ns(row))
    }

    /// Returns the row that shows the command of `row`: itself, or a later one where the commands have a lower rate.
    fn shown_row(&self, row: usize) -> usize {
        let shown_ns = self.inputs[row].shown_ns;
        let later = self.inputs[row..].iter();
        row + later
            .skip(1)
            .take_while(|input| input.time_ns <= shown_ns)
            .count()
    }

    /// Returns the sum of squared residuals in `rows` from the state of `replay` on, if their commands were given at `issued_ns`.
    fn loss(
        &self,
        mut replay: Replay,
        rows: Range<usize>,
        conditions: &Conditions,
        issued_ns: &[u64],
    ) -> f64 {
        let errors = rows.map(|row| {
            let timing = Timing {
                conditions,
                issued_ns,
            };
            self.step(&mut replay, row, timing, Horizon::OneStepAhead)
                .map_or(f64::INFINITY, |values| self.square_error(&values, row))
        });
        errors.sum()
    }

    /// Assigns each change of the commands to the sample of the ECU between its two rows that best explains the rows until its effect has
    /// shown, alone or together with a change in the next row.
    fn assign_by_model(
        &self,
        clock: LoggerClock,
        parameters: &PlantParameters,
        changes: Changes,
        issued_ns: &mut [u64],
    ) {
        let sample_time_ns = parameters.ecu.sample_time_ns();
        let conditions = Conditions {
            clock: Some(clock),
            ..self.conditions
        };
        let mut replay = self.begin(parameters, &conditions, Tolerance::default());
        for row in 0..self.inputs.len() {
            let possible = |row| self.possible_samples(row, clock, sample_time_ns);
            let after = self.shown_row(row) + 1;
            let follows = (changes == Changes::Two && after < self.inputs.len())
                .then(|| possible(after))
                .flatten();
            let next = if follows.is_some() { after } else { row };
            let pairs: Vec<[u64; 2]> = match (possible(row), follows) {
                (None, _) => Vec::new(),
                (Some(first), None) => first.map(|sample| [sample; 2]).collect(),
                (Some(first), Some(second)) => first
                    .flat_map(|first| second.clone().map(move |second| [first, second]))
                    .filter(|[first, second]| first < second)
                    .collect(),
            };
            if pairs.len() > 1 {
                let until = self.rows_until_shown(next, parameters);
                let assigned = |[first, second]: [u64; 2], issued_ns: &mut [u64]| {
                    issued_ns[next - row] = second * sample_time_ns;
                    issued_ns[0] = first * sample_time_ns;
                };
                let mut loss = |pair: [u64; 2]| {
                    assigned(pair, &mut issued_ns[row..]);
                    self.loss(replay.clone(), row..until, &conditions, issued_ns)
                };
                let tried = pairs.into_iter().map(|pair| (loss(pair), pair));
                if let Some((_, best)) = tried.min_by(|a, b| a.0.total_cmp(&b.0)) {
                    assigned(best, &mut issued_ns[row..]);
                }
            }
            let timing = Timing {
                conditions: &conditions,
                issued_ns: &*issued_ns,
            };
            if self
                .step(&mut replay, row, timing, Horizon::OneStepAhead)
                .is_none()
            {
                return;
            }
        }
    }

    /// Returns the samples of the ECU at which the command of `row` may have been given first: those since the row before, which showed
    /// another command, with a small margin because the clock may be slightly wrong. None where the command does not change, and in a gap.
    fn possible_samples(
        &self,
        row: usize,
        clock: LoggerClock,
        sample_time_ns: u64,
    ) -> Option<RangeInclusive<u64>> {
        let before = row.checked_sub(1)?;
        let command = self.inputs[row].command?;
        if Some(command) == self.inputs[before].command {
            return None;
        }
        let slack_ns = (EDGE * sample_time_ns as f64) as u64;
        let before_ns = clock.ecu_time_ns(self.log_ns(before));
        let until_ns = clock.ecu_time_ns(self.shown_ns(row)) + slack_ns;
        let first = before_ns.saturating_sub(slack_ns) / sample_time_ns + 1;
        let last = until_ns / sample_time_ns;
        (last.saturating_sub(first) <= SAMPLES_MAX).then_some(first..=last)
    }

    /// Returns the sum of the squared residuals of a predicted row.
    fn square_error(&self, values: &Row, row: usize) -> f64 {
        let errors = self.channels.iter().map(|channel| {
            let error = channel.values[row] - values[channel.column];
            error / self.floor(channel, Horizon::OneStepAhead, row)
        });
        errors
            .filter(|error| error.is_finite())
            .map(|error| error * error)
            .sum()
    }

    /// Returns for each change of the commands the range of times (s) by which the clock of the logger may be shifted later, so that the
    /// command was given between the row before and the row that shows it.
    pub(crate) fn possible_shifts_s(&self) -> Vec<Range<f64>> {
        let Some(clock) = self.conditions.clock else {
            return Vec::new();
        };
        let rows = (1..self.inputs.len()).filter(|&row| {
            let command = self.inputs[row].command;
            command.is_some() && command != self.inputs[row - 1].command
        });
        let shifts = rows.map(|row| {
            let ecu_s = |log_ns| clock.ecu_time_ns(log_ns) as f64 * 1e-9;
            let issued_s = self.issued_ns[row] as f64 * 1e-9;
            issued_s - ecu_s(self.shown_ns(row))..issued_s - ecu_s(self.log_ns(row - 1))
        });
        shifts.collect()
    }
}
