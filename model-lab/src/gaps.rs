//! Gaps of a log: times at which the command is unknown. The model restarts at the measured pressure after a gap, and nothing of the gap
//! counts in an error.
//!
//! A gap ends with the first row after it, but the valves there still follow earlier, unknown commands. Rows count again once the commands
//! of that row are in force and have settled: a delay, a PWM period and 50 ms later, and where a line leads to a second chamber, once the
//! two chambers are in balance.

use std::ops::Range;

use plant_sim::PlantParameters;
use plant_sim::parameters::Part;
use plant_sim::replay::{Inputs, ReplayInput};
use recording::TimeBase;

/// Number of median steps above which a pause is a gap, and number of consecutive rows without a command above which they form one; ...
const GAP_SAMPLES: f64 = 10.0;
/// ... for a slow logger, a pause is also a gap if it exceeds this time (s), ten samples of an ECU at 100 Hz, and this many median steps:
/// commands may change in it.
const UNSEEN_S: f64 = 0.1;
const GAP_STEPS: f64 = 2.5;
/// Time from a command in force until the valve has moved and the current no longer depends on the previous command (s).
const SETTLE_S: f64 = 0.05;
/// Number of time constants after which the pressure of the chamber without a sensor no longer depends on the gap: one twentieth of the
/// difference is left.
const BALANCES: f64 = 3.0;
/// Time for which a gap is simulated with the last command, plus less than a second (ns).
const SIMULATED_NS: u64 = 1_000_000_000;
/// Unit of time that is removed from longer gaps (ns): whole seconds, so that samples and PWM periods keep their phase.
const WHOLE_NS: u64 = 1_000_000_000;

/// Gaps of a log in order of time.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Gaps {
    /// Gaps, none within another one.
    list: Vec<Gap>,
    /// Duration above which a step is a pause (s).
    pause_s: f64,
}

/// Gap and the rows that it removes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Gap {
    /// Rows that count in no error: those without a command, and those after the gap where the state of the valves is still unknown. The
    /// model restarts at the last of them.
    pub(crate) rows: Range<usize>,
    /// Last instant before the gap and first one after it, in the time of the log (s).
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
    /// Whether the rows exist, but without commands.
    pub(crate) is_without_commands: bool,
}

impl Gaps {
    /// Returns the gaps of a log with these rows.
    pub(crate) fn of(parameters: &PlantParameters, inputs: &Inputs) -> Self {
        let shown = inputs.shown_commands();
        let shown = shown.map(|(row, command)| (row, command.is_some()));
        let step_s = inputs.command_interval_s();
        Self::at(parameters, (inputs.base(), step_s), shown)
    }

    /// Returns the gaps of a log on `base`, given the rows that show commands, `step_s` apart, and whether the command of each is known.
    fn at(
        parameters: &PlantParameters,
        (base, step_s): (&TimeBase, f64),
        shown: impl Iterator<Item = (usize, bool)>,
    ) -> Self {
        let is_commanded = Part::Commanded.is_in(parameters);
        let times_s = base.times_s();
        let settled_s = match is_commanded {
            true => {
                parameters.ecu.command_delay_s
                    + 1.0 / parameters.ecu.pwm_frequency_hz
                    + SETTLE_S
                    + BALANCES * parameters.balance_s()
            }
            false => 0.0,
        };
        let unseen_s = match is_commanded {
            true => UNSEEN_S.max(GAP_STEPS * step_s),
            false => f64::INFINITY,
        };
        let pause_s = unseen_s.min(GAP_SAMPLES * step_s);
        // A row with a known command, after a gap that began after row `before`.
        let gap = |before: usize, known: usize, is_without_commands: bool| {
            let open =
                times_s[known..].partition_point(|&time_s| time_s <= times_s[known] + settled_s);
            Gap {
                rows: before + 1..known + open,
                start_s: times_s[before],
                end_s: times_s[known],
                is_without_commands,
            }
        };
        let mut gaps: Vec<Gap> = Vec::new();
        // The last row that shows a command, and the last one whose command is known, with the number of such rows before them.
        let mut last_shown: Option<usize> = None;
        let mut last_known: Option<(usize, usize)> = None;
        let mut count = 0;
        for (n, (row, is_known)) in shown.enumerate() {
            if let Some(before) = last_shown
                && times_s[row] - times_s[before] > pause_s
            {
                let is_row_late = |pair: &[f64]| pair[1] - pair[0] > pause_s;
                let has_rows = !times_s[before..=row].windows(2).any(is_row_late);
                gaps.push(gap(before, row, has_rows));
            }
            last_shown = Some(row);
            count = n + 1;
            if is_commanded && !is_known {
                continue;
            }
            if let Some((_, before)) =
                last_known.filter(|(at, _)| (n - at) as f64 > GAP_SAMPLES + 1.0)
            {
                gaps.push(gap(before, row, true));
            }
            last_known = Some((n, row));
        }
        // The rows after the last command have nothing to compare.
        let is_end = |&(at, last): &(usize, usize)| {
            (count - at) as f64 > GAP_SAMPLES + 1.0
                || is_commanded && base.end_s() - times_s[last] > pause_s
        };
        if let Some((_, last)) = last_known.filter(is_end) {
            gaps.push(Gap {
                rows: last + 1..base.len(),
                start_s: times_s[last],
                end_s: base.end_s(),
                is_without_commands: true,
            });
        }
        gaps.sort_by_key(|gap| (gap.rows.start, std::cmp::Reverse(gap.rows.end)));
        let mut end = 0;
        gaps.retain(|gap| {
            let is_within = gap.rows.end <= end;
            end = end.max(gap.rows.end);
            !is_within
        });
        Self {
            list: gaps,
            pause_s,
        }
    }

    /// Returns the gaps where only `rows` are left, which contain those of every gap up to the last of them.
    pub(crate) fn at_rows(&self, rows: &[usize]) -> Self {
        let place = |row: usize| rows.partition_point(|&kept| kept < row);
        let moved = |gap: &Gap| Gap {
            rows: place(gap.rows.start)..place(gap.rows.end),
            ..gap.clone()
        };
        Self {
            list: (self.list.iter().map(moved))
                .filter(|gap| !gap.rows.is_empty())
                .collect(),
            pause_s: self.pause_s,
        }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.list.is_empty()
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = &Gap> {
        self.list.iter()
    }

    /// Marks `values` that count in no error as missing.
    pub(crate) fn blank(&self, values: &mut [f64]) {
        for gap in &self.list {
            values[gap.rows.clone()].fill(f64::NAN);
        }
    }

    /// Returns the parts of an interval of rows that lie between gaps.
    pub(crate) fn between(&self, segment: Range<usize>) -> Vec<Range<usize>> {
        let mut parts = Vec::new();
        let mut begin = segment.start;
        let before = self.list.partition_point(|gap| gap.rows.end <= begin);
        let gaps = self.list[before..].iter();
        for gap in gaps.take_while(|gap| gap.rows.start < segment.end) {
            let end = gap.rows.start.min(segment.end);
            if begin < end {
                parts.push(begin..end);
            }
            begin = begin.max(gap.rows.end);
        }
        if begin < segment.end {
            parts.push(begin..segment.end);
        }
        parts
    }

    /// Returns the longest part of the first `rows` rows without a gap.
    pub(crate) fn longest(&self, rows: usize) -> Range<usize> {
        let parts = self.between(0..rows).into_iter();
        parts.rev().max_by_key(|part| part.len()).unwrap_or(0..0)
    }

    /// Removes time from long pauses, so that they cost no more than short ones: the plant receives the rows after a pause earlier.
    pub(crate) fn shorten(&self, inputs: &mut [ReplayInput]) {
        let mut shortened = self.shortening();
        for input in inputs {
            *input = shortened(*input);
        }
    }

    /// Returns a function that does the same as [`Gaps::shorten`] for one row after the other.
    pub(crate) fn shortening(&self) -> impl FnMut(ReplayInput) -> ReplayInput + use<> {
        let pause_ns = self.pause_s * 1e9;
        let mut taken_ns = 0;
        let mut before_ns = 0;
        move |mut input| {
            let span_ns = input.time_ns - before_ns;
            before_ns = input.time_ns;
            if span_ns > SIMULATED_NS && span_ns as f64 > pause_ns {
                taken_ns += (span_ns - SIMULATED_NS) / WHOLE_NS * WHOLE_NS;
            }
            input.time_ns -= taken_ns;
            input.shown_ns -= taken_ns;
            input.issued_ns -= taken_ns;
            input
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn inputs(base: &TimeBase, silent: Range<usize>) -> Vec<ReplayInput> {
        let time_ns = |time_s: f64| ((time_s - base.start_s()) * 1e9).round() as u64;
        let input = |(row, &time_s): (usize, &f64)| ReplayInput {
            command: (!silent.contains(&row)).then(Default::default),
            ..ReplayInput::at(time_ns(time_s))
        };
        base.times_s().iter().enumerate().map(input).collect()
    }

    /// Returns a time base of 100 Hz with a pause of `pause` samples after row 49.
    fn paused(pause: u32) -> TimeBase {
        let times = (0..100).map(|row| f64::from(row + if row < 50 { 0 } else { pause }) * 0.01);
        TimeBase::new(times.collect()).unwrap()
    }

    fn gaps(base: &TimeBase, silent: Range<usize>) -> Gaps {
        let inputs = inputs(base, silent);
        let shown = inputs.iter().map(|input| input.command.is_some());
        let step_s = base.sampling().median_step_s.unwrap();
        Gaps::at(
            &PlantParameters::nominal(),
            (base, step_s),
            shown.enumerate(),
        )
    }

    #[test]
    fn a_pause_of_more_than_ten_samples_is_a_gap_until_the_next_command_is_in_force() {
        assert!(gaps(&paused(9), 0..0).list.is_empty());
        let found = gaps(&paused(11), 0..0);
        // 15 ms of delay, 10 ms of period and 50 ms after row 50: rows 50 to 57.
        let [gap] = &found.list[..] else {
            panic!("{found:?}")
        };
        assert_eq!((gap.rows.clone(), gap.is_without_commands), (50..58, false));
        assert!((gap.start_s - 0.49).abs() < 1e-12 && (gap.end_s - 0.61).abs() < 1e-12);
        assert_eq!(found.between(10..90), [10..50, 58..90]);
        assert_eq!(found.between(51..52), []);
        assert_eq!(found.longest(100), 0..50);
        assert_eq!(found.longest(30), 0..30);
    }

    /// Defects seen: the chamber without a sensor began in balance with the other one after each gap, 0.34 bar off during a fill; after one
    /// time constant in place of three, 33 noise floors were left with the true parameters.
    #[test]
    fn rows_after_a_gap_count_once_two_chambers_are_in_balance() {
        let mut plant = PlantParameters::nominal();
        plant.chamber.volume_m3 = 80e-6;
        plant.second_chamber.volume_m3 = 120e-6;
        plant.second_chamber.conductance_dm3_per_s_bar = 0.4;
        // 48 cm3 in series over 0.4 dm3/(s bar) times 1 bar.
        assert!((plant.balance_s() - 0.12).abs() < 1e-12);
        let shown = (0..100).map(|row| (row, true));
        let found = Gaps::at(&plant, (&paused(11), 0.01), shown);
        assert_eq!(found.list[0].rows, 50..94);
    }

    /// Defect seen: ten samples of a slow ECU were 0.4 s, and the model held the old command through a pause of that length.
    #[test]
    fn a_pause_of_a_slow_logger_is_a_gap_whatever_the_sample_time() {
        let times_s = (0..100).map(|row| 0.05 * f64::from(row + if row < 50 { 0 } else { 7 }));
        let base = TimeBase::new(times_s.collect()).unwrap();
        let mut plant = PlantParameters::nominal();
        for sample_time_s in [0.01, 0.04] {
            plant.ecu.sample_time_s = sample_time_s;
            plant.ecu.pwm_frequency_hz = 1.0 / sample_time_s;
            let shown = (0..100).map(|row| (row, true));
            let found = Gaps::at(&plant, (&base, 0.05), shown);
            assert_eq!(found.list.len(), 1, "{sample_time_s}");
        }
    }

    #[test]
    fn more_than_ten_rows_without_a_command_are_a_gap() {
        let whole = paused(0);
        assert!(gaps(&whole, 50..60).list.is_empty());
        assert_eq!(gaps(&whole, 50..61).list[0].rows, 50..69);
        assert_eq!(gaps(&whole, 50..100).list[0].rows, 50..100);
        // Nothing was commanded at all: the plant is at rest.
        assert!(gaps(&whole, 0..100).list.is_empty());
    }

    #[test]
    fn a_long_gap_is_simulated_for_a_second_and_keeps_the_phase_of_the_samples() {
        let base = paused(500);
        let mut inputs = inputs(&base, 0..0);
        gaps(&base, 0..0).shorten(&mut inputs);
        // 5.01 s of pause, 4 s of it removed.
        assert_eq!(inputs[50].time_ns, 490_000_000 + 1_010_000_000);
        assert_eq!(inputs[50].issued_ns, inputs[50].time_ns);
        assert_eq!(inputs[99].time_ns, inputs[50].time_ns + 490_000_000);
        let mut short = self::inputs(&paused(20), 0..0);
        let before = short.clone();
        gaps(&paused(20), 0..0).shorten(&mut short);
        assert_eq!(short, before);
    }
}
