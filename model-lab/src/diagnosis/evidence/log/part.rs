//! Part of a log: its beginning, or the rows of a fast log that a fit needs.
//!
//! The simulation stops at each row, so that a log of 5 kHz takes five times as long as one of 1 kHz, while the plant is equally slow in
//! both. Neighbouring rows are kept in pairs, since a current may be a mean over the time since the row before. The place of the pairs
//! changes from one to the next, so that rows at a multiple of the PWM frequency still cover every part of its period. Of a log with several
//! rates, every sample of a slower signal is kept.

use std::sync::Arc;

use plant_sim::PlantParameters;
use plant_sim::replay::{CurrentSampling, ReplayInput};

use super::Log;
use crate::measured::is_current;

/// Approximate rate of the rows that are kept of a faster log (1/s), without those at commands and gaps.
const ROWS_PER_S: f64 = 1000.0;
/// Golden section: the places of the pairs are spread uniformly and never repeat.
const GOLDEN: f64 = 0.618_033_988_749_894_9;

impl Log {
    /// Returns the log with the rows that a fit needs; a log of about 1 kHz is unchanged.
    pub(crate) fn thinned(self, parameters: &PlantParameters) -> Self {
        let rows = self.needed_rows();
        match rows.len() == self.inputs.len() {
            true => self,
            false => self.at_rows(&rows, parameters),
        }
    }

    /// Returns the first `least_s` of the log, and its continuation up to the given number of changes of the commands; none if that is all
    /// of it.
    pub(crate) fn beginning(
        &self,
        least_s: f64,
        changes: usize,
        parameters: &PlantParameters,
    ) -> Option<Self> {
        let count = self.inputs.len();
        let mut changing = (1..count).filter(|&row| self.changes_command(row));
        let changed = changing.nth(changes).unwrap_or(count);
        let times_s = &self.commands.times_s;
        let end = changed.max(times_s.partition_point(|&time_s| time_s <= least_s));
        let rows: Vec<usize> = (0..end).collect();
        (end < count).then(|| self.clone().at_rows(&rows, parameters))
    }

    fn changes_command(&self, row: usize) -> bool {
        self.inputs[row].command != self.inputs[row - 1].command
    }

    /// Returns the log with only these rows, in order.
    fn at_rows(mut self, rows: &[usize], parameters: &PlantParameters) -> Self {
        let is_mean = self.is_sampling_open() || self.sampling == CurrentSampling::MeanOfInterval;
        for channel in &mut self.channels {
            // A slow current has all of its own rows.
            let needs_row_before = is_mean && is_current(channel.signal) && !channel.has_own_rate;
            let value = |(place, &row): (usize, &usize)| {
                let has_row_before = row == 0 || rows[place - 1] == row - 1;
                match has_row_before || !needs_row_before {
                    true => channel.values[row],
                    false => f64::NAN,
                }
            };
            channel.values = Arc::new(rows.iter().enumerate().map(value).collect());
        }
        // A row that is left out may have a command that the next one lacks.
        let mut command = None;
        let mut kept = rows.iter().peekable();
        let mut inputs = Vec::with_capacity(rows.len());
        for (row, input) in self.inputs.iter().enumerate() {
            command = input.command.or(command);
            if kept.next_if_eq(&&row).is_some() {
                inputs.push(ReplayInput {
                    command: command.take(),
                    ..*input
                });
            }
        }
        self.inputs = inputs;
        if !self.issued_ns.is_empty() {
            self.issued_ns = rows.iter().map(|&row| self.issued_ns[row]).collect();
        }
        self.counted = rows.iter().map(|&row| self.counted[row]).collect();
        self.commands = self.commands.at_rows(rows);
        for restart in &mut self.start.restarts {
            restart.row = rows.partition_point(|&row| row < restart.row);
        }
        self.find_predictor(parameters);
        self
    }

    /// Returns the rows that a fit needs, in order.
    fn needed_rows(&self) -> Vec<usize> {
        let count = self.inputs.len();
        let group = (2.0 / (ROWS_PER_S * self.interval_s)).round();
        if !(group > 2.0 && group < count as f64) {
            return (0..count).collect();
        }
        let group = group as usize;
        let mut is_needed = vec![false; count];
        for (n, begin) in (0..count).step_by(group).enumerate() {
            let place = ((n as f64 * GOLDEN).fract() * (group - 1) as f64) as usize;
            let pair = begin + place..(begin + place + 2).min(count);
            is_needed[pair.start.min(count - 1)..pair.end].fill(true);
        }
        // Between these rows the ECU gave another command, which determines the clock.
        for row in 1..count {
            if self.changes_command(row) {
                is_needed[row - 1..=row].fill(true);
            }
        }
        for channel in self.channels.iter().filter(|one| one.has_own_rate) {
            for (is_needed, value) in is_needed.iter_mut().zip(channel.values.iter()) {
                *is_needed |= !value.is_nan();
            }
        }
        for gap in self.commands.gaps.iter() {
            is_needed[gap.rows.start.saturating_sub(1)..gap.rows.end].fill(true);
        }
        for end in [0, count - 1] {
            is_needed[end] = true;
        }
        (0..count).filter(|&row| is_needed[row]).collect()
    }
}

#[cfg(test)]
mod tests {
    use plant_sim::logger_clock::LoggerClock;
    use plant_sim::replay::ReplayInput;
    use recording::Recording;

    use super::super::Log;

    use crate::bench::{logged, without_rows};
    use crate::diagnosis::evidence::Evidence;
    use crate::diagnosis::fit::gather::gather;
    use crate::metrics::rms;
    use crate::result::Horizon;
    use plant_sim::PlantParameters;

    const CLOCK: LoggerClock = LoggerClock {
        phase_s: 6.2e-3,
        drift_ppm: 120.0,
    };

    fn evidence(log: &Recording) -> Evidence {
        gather(&PlantParameters::nominal(), [log]).unwrap()
    }

    /// Currents that are means of 0.25 ms, and a pause of 0.3 s after which the model restarts.
    #[test]
    fn a_true_plant_leaves_the_noise_on_a_thinned_log() {
        let plant = PlantParameters::nominal();
        let whole = logged(&plant, CLOCK, 0.25e-3, 3);
        let log = without_rows(&whole, 20_000..21_200);
        let evidence = evidence(&log);
        assert!(evidence.logs[0].inputs.len() < 14_000);
        for horizon in [Horizon::OneStepAhead, Horizon::FreeRun] {
            let residuals = evidence.residuals(&plant, horizon).unwrap();
            for (_, channel, range) in evidence.channels() {
                let errors = residuals[range].iter().copied();
                let errors: Vec<f64> = errors.filter(|error| *error != 0.0).collect();
                let error = rms(&errors).unwrap();
                assert!(
                    (0.8..1.2).contains(&error),
                    "{} {horizon:?}: {error}",
                    channel.signal
                );
                assert!(errors.len() > 3_000, "{}: {}", channel.signal, errors.len());
            }
        }
    }

    #[test]
    fn rows_around_each_command_are_kept_and_show_every_part_of_a_pwm_period() {
        let log = logged(&PlantParameters::nominal(), CLOCK, 0.2e-3, 3);
        let evidence = evidence(&log);
        let thinned = &evidence.logs[0];
        let changes = |pair: &&[ReplayInput]| pair[0].command != pair[1].command;
        let changes: Vec<_> = thinned.inputs.windows(2).filter(changes).collect();
        assert!(changes.len() > 20);
        for pair in changes {
            assert_eq!(pair[1].time_ns - pair[0].time_ns, 200_000);
        }
        // Fifty rows of a period of 10 ms.
        let mut rows_of_place = [0; 50];
        for input in &thinned.inputs {
            rows_of_place[input.time_ns as usize / 200_000 % 50] += 1;
        }
        let fewest = rows_of_place.iter().min().unwrap();
        assert!(*fewest * 100 > thinned.inputs.len(), "{rows_of_place:?}");
    }

    #[test]
    fn a_log_of_1_khz_stays_as_it_is() {
        let log = logged(&PlantParameters::nominal(), CLOCK, 1e-3, 3);
        assert_eq!(
            evidence(&log).logs[0].inputs.len(),
            log.time_bases().next().unwrap().1.len()
        );
    }

    /// A log with a pause in its beginning and another one after it.
    #[test]
    fn the_beginning_of_a_log_has_its_first_errors() {
        let plant = PlantParameters::nominal();
        let log = logged(&plant, CLOCK, 1e-3, 3);
        let log = without_rows(&without_rows(&log, 9_000..9_200), 2_000..2_300);
        let whole = &evidence(&log).logs[0];
        let beginning = whole.beginning(4.0, 4, &plant).unwrap();
        let rows = beginning.inputs.len();
        assert!((3_700..3_800).contains(&rows), "{rows}");
        let mut wrong = plant.clone();
        wrong.chamber.volume_m3 *= 1.1;
        let errors = |log: &Log| {
            log.residuals_assigned(&wrong, Some(CLOCK), Horizon::FreeRun)
                .unwrap()
        };
        let (begun, all) = (errors(&beginning), errors(whole));
        for (channel, of_channel) in begun.chunks(rows).enumerate() {
            assert_eq!(of_channel, &all[channel * whole.inputs.len()..][..rows]);
        }
        let changes = |log: &Log| {
            (1..log.inputs.len())
                .filter(|&row| log.changes_command(row))
                .count()
        };
        let long = whole.beginning(0.1, 10, &plant).unwrap();
        assert_eq!(changes(&long), 10);
        assert!(whole.beginning(4.0, 1_000, &plant).is_none());
    }
}
