//! Commands of the log, and the time from which each is in force.

use std::ops::Range;
use std::sync::Arc;

use plant_sim::PlantParameters;
use plant_sim::parameters::{OnOffValveParameters, ParameterSpec};
use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::{Inputs, ReplayError};
use plant_sim::valve::ValveFunction;
use recording::{Recording, Signal};

use crate::gaps::Gaps;

/// Factor by which an on/off valve may be slower than its plant file says.
const SLOWER: f64 = 1.4;
/// Time from row to row, over the sample time of the ECU, above which commands are given between rows.
const SLOW_ROWS: f64 = 1.1;
/// Name of the time from a command to its effect in a plant file.
pub(crate) const COMMAND_DELAY: &str = "ecu.command_delay_s";
/// Signal names of the commands, fill and vent.
pub(crate) const DUTIES: [&str; 2] = ["duty_fill", "duty_vent"];

/// Commanded duty cycles at the instants of the log; where a command is missing, the last one stays in force.
#[derive(Debug, Clone)]
pub(crate) struct Commands {
    /// Instants since the start of the log (s).
    pub(crate) times_s: Arc<Vec<f64>>,
    /// Duty cycles of fill and vent valve (%).
    pub(crate) duty_pct: [Arc<Vec<f64>>; 2],
    /// Duty cycle that leaves each valve shut (%); NaN for an orifice without a valve.
    shut_pct: [f64; 2],
    /// Time from a command to its effect (s).
    delay_s: f64,
    /// Least and largest time from a command to its effect (s).
    delay_range_s: (f64, f64),
    /// Least delay of an on/off valve beside it (s); infinite without one.
    valve_delay_s: f64,
    /// Time from row to row (s).
    interval_s: f64,
    /// Time before the row that shows a command at which it may have been given already (s). 0 where each row shows the commands and rows
    /// are no further apart than samples of the ECU: no command acts before the row that shows it.
    early_s: f64,
    /// Time for which a command may remain in force after the next one took effect (s).
    pub(crate) pwm_period_s: f64,
    /// Position of an actuator that may change the volume of the chamber (m), if logged.
    pub(crate) actuator_position: Option<Arc<Vec<f64>>>,
    /// Gaps: times at which the log does not contain the command.
    pub(crate) gaps: Gaps,
}

/// Returns the least and the largest time from a command to its effect (s) according to the plant file. Without a range there, a command
/// may act a fifth earlier.
fn delay_range_s(parameters: &PlantParameters) -> (f64, f64) {
    let delay_s = parameters.ecu.command_delay_s;
    let spec = ParameterSpec::by_name(COMMAND_DELAY);
    let (least_s, most_s) = match (parameters.knowledge.get(COMMAND_DELAY), spec) {
        (Some(knowledge), Some(spec)) => knowledge.bounds(spec, delay_s),
        _ => (0.8 * delay_s, delay_s),
    };
    let of_valves = on_off_valves(parameters).map(|valve| {
        let closing_s = valve.closing_delay_s + valve.closing_ramp_s;
        valve.opening_delay_s.max(closing_s)
    });
    (least_s, most_s + SLOWER * of_valves.fold(0.0, f64::max))
}

/// Returns the usual delay from a command to its effect (s): that of the output, and the mean of the delays of on/off valves.
fn delay_s(parameters: &PlantParameters) -> f64 {
    let count = on_off_valves(parameters).count().max(1) as f64;
    let delays_s = on_off_valves(parameters)
        .map(|valve| 0.5 * (valve.opening_delay_s + valve.closing_delay_s));
    parameters.ecu.command_delay_s + delays_s.sum::<f64>() / count
}

/// Returns the on/off valves of the plant.
fn on_off_valves(parameters: &PlantParameters) -> impl Iterator<Item = &OnOffValveParameters> {
    let valves = [&parameters.on_off_fill, &parameters.on_off_vent];
    let functions = valves.into_iter().zip(parameters.functions);
    functions
        .filter(|(_, function)| *function == ValveFunction::OnOff)
        .map(|(valve, _)| valve)
}

/// Returns `other` where it equals `values` bit for bit, and `values` otherwise. Sharing saves memory: an hour at 1 kHz takes 29 MB per
/// column.
pub(crate) fn shared(other: Option<Arc<Vec<f64>>>, values: Vec<f64>) -> Arc<Vec<f64>> {
    let is_same = |(a, b): (&f64, &f64)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan());
    let is_these = |other: &Arc<Vec<f64>>| {
        other.len() == values.len() && other.iter().zip(&values).all(is_same)
    };
    match other.filter(is_these) {
        Some(other) => other,
        None => Arc::new(values),
    }
}

impl Commands {
    pub(crate) fn new(parameters: &PlantParameters, log: &Recording) -> Result<Self, ReplayError> {
        let inputs = Inputs::of(parameters, log)?;
        let base = inputs.base();
        let start_s = base.start_s();
        let sample_time_s = parameters.ecu.sample_time_s;
        let mut last = plant_sim::Command::default();
        let mut duty_pct = [
            Vec::with_capacity(inputs.len()),
            Vec::with_capacity(inputs.len()),
        ];
        let mut shown = inputs.shown_commands().peekable();
        for row in 0..inputs.len() {
            if let Some((_, command)) = shown.next_if(|(shown, _)| *shown == row) {
                last = command.unwrap_or(last);
            }
            duty_pct[FILL].push(last.duty_fill_pct);
            duty_pct[VENT].push(last.duty_vent_pct);
        }
        Ok(Self {
            times_s: shared(
                Some(base.shared_times_s()),
                base.times_s()
                    .iter()
                    .map(|time_s| time_s - start_s)
                    .collect(),
            ),
            duty_pct: [FILL, VENT].map(|valve| {
                let logged = log.signal(DUTIES[valve]);
                shared(
                    logged.map(Signal::shared_values),
                    std::mem::take(&mut duty_pct[valve]),
                )
            }),
            shut_pct: parameters
                .functions
                .map(|function| function.shut_duty_pct().unwrap_or(f64::NAN)),
            delay_s: delay_s(parameters),
            delay_range_s: delay_range_s(parameters),
            valve_delay_s: on_off_valves(parameters)
                .map(|valve| valve.opening_delay_s)
                .fold(f64::INFINITY, f64::min),
            interval_s: inputs.interval_s(),
            early_s: match inputs.command_interval_s() {
                slow_s if slow_s > inputs.interval_s() || slow_s > SLOW_ROWS * sample_time_s => {
                    slow_s
                }
                _ => 0.0,
            },
            pwm_period_s: 1.0 / parameters.ecu.pwm_frequency_hz,
            actuator_position: inputs.actuator_position(),
            gaps: Gaps::of(parameters, &inputs),
        })
    }

    /// Returns the commands at some of the instants, which contain the rows of every gap up to the last of them.
    pub(crate) fn at_rows(&self, rows: &[usize]) -> Self {
        let at = |values: &[f64]| Arc::new(rows.iter().map(|&row| values[row]).collect());
        Self {
            times_s: at(&self.times_s),
            duty_pct: [FILL, VENT].map(|valve| at(&self.duty_pct[valve])),
            actuator_position: self.actuator_position.as_ref().map(|all| at(all)),
            gaps: self.gaps.at_rows(rows),
            ..self.clone()
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.times_s.len()
    }

    /// Returns whether the command of a row opens `valve`.
    pub(crate) fn opens(&self, valve: usize, row: usize) -> bool {
        self.duty_pct[valve][row] != self.shut_pct[valve]
    }

    /// Returns the commands as they may act at the earliest: an on/off valve may open before the row that shows its command, if rows are
    /// further apart than its delay.
    pub(crate) fn at_the_earliest(&self) -> Self {
        let mut earliest = self.clone();
        if self.interval_s > self.delay_range_s.0 + self.valve_delay_s {
            earliest.early_s = self.early_s.max(self.interval_s);
        }
        earliest
    }

    /// Returns whether a row shows each command before it acts.
    pub(crate) fn are_all_shown(&self) -> bool {
        self.early_s == 0.0
    }

    /// Returns the intervals of samples in which both valves are shut, from `settle_s` after the last command acted.
    pub(crate) fn holds(&self, settle_s: f64) -> Vec<Range<usize>> {
        let acts = |row: usize| self.opens(FILL, row) || self.opens(VENT, row);
        self.segments_without(acts, settle_s)
    }

    /// Returns the intervals of samples in which `valve` is shut, from `settle_s` after its last command acted.
    pub(crate) fn shut(&self, valve: usize, settle_s: f64) -> Vec<Range<usize>> {
        self.segments_without(|row| self.opens(valve, row), settle_s)
    }

    /// Returns the intervals of samples in which the coil of `valve` carries no current, from `settle_s` after its last command acted.
    pub(crate) fn dead_coil(&self, valve: usize, settle_s: f64) -> Vec<Range<usize>> {
        self.segments_without(|row| self.duty_pct[valve][row] != 0.0, settle_s)
    }

    /// Returns the intervals of samples in which the coil of `valve` carries the current of a duty cycle of 100 %, from `settle_s` after its
    /// last other command acted.
    pub(crate) fn full_coil(&self, valve: usize, settle_s: f64) -> Vec<Range<usize>> {
        // A log may begin with a current that still rises.
        let is_other = |row: usize| row == 0 || self.duty_pct[valve][row] != 100.0;
        let mut segments = self.segments_without(is_other, settle_s);
        segments.retain(|segment| segment.start > 0);
        segments
    }

    fn segments_without(&self, acts: impl Fn(usize) -> bool, settle_s: f64) -> Vec<Range<usize>> {
        let (earliest_s, delay_s) = self.delay_range_s;
        let latest_s = delay_s + self.pwm_period_s + settle_s;
        let mut segments = Vec::new();
        let mut begin = 0;
        let mut close = |from: usize, until_s: f64| {
            let end = self.times_s.partition_point(|&time_s| time_s <= until_s);
            if end > from {
                segments.extend(self.gaps.between(from..end));
            }
        };
        for row in (0..self.len()).filter(|&row| acts(row)) {
            close(begin, self.times_s[row] - self.early_s + earliest_s);
            let replaced_s = self.times_s.get(row + 1).copied().unwrap_or(f64::INFINITY);
            begin = begin.max(
                self.times_s
                    .partition_point(|&time_s| time_s <= replaced_s + latest_s),
            );
        }
        close(begin, f64::INFINITY);
        segments
    }

    /// Returns the row of the command in force at `time_s`; none before the first one acts.
    pub(crate) fn row_in_force(&self, time_s: f64) -> Option<usize> {
        self.times_s
            .partition_point(|&commanded_s| commanded_s + self.delay_s <= time_s)
            .checked_sub(1)
    }

    /// Returns the number of samples before anything can have moved.
    pub(crate) fn rows_before_first_action(&self) -> usize {
        self.holds(0.0)
            .first()
            .filter(|hold| hold.start == 0)
            .map_or(0, |hold| hold.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands(duty_fill: &[f64], duty_vent: &[f64]) -> Commands {
        Commands {
            times_s: Arc::new((0..duty_fill.len()).map(|row| row as f64 * 0.01).collect()),
            duty_pct: [duty_fill, duty_vent].map(|duty| Arc::new(duty.to_vec())),
            shut_pct: [0.0, 0.0],
            delay_s: 0.015,
            delay_range_s: (0.012, 0.015),
            valve_delay_s: f64::INFINITY,
            interval_s: 0.01,
            early_s: 0.0,
            pwm_period_s: 0.01,
            gaps: Gaps::default(),
            actuator_position: None,
        }
    }

    fn pulse(rows: Range<usize>, count: usize) -> Vec<f64> {
        (0..count)
            .map(|row| if rows.contains(&row) { 60.0 } else { 0.0 })
            .collect()
    }

    #[test]
    fn a_hold_ends_with_the_delay_and_begins_a_period_after_the_last_command_acts() {
        let commands = commands(&pulse(20..30, 100), &[0.0; 100]);
        // On at 0.20 s: acts from 0.212 s at the earliest. Replaced at 0.30 s: in force to 0.325 s at the latest.
        assert_eq!(commands.holds(0.0), [0..22, 33..100]);
        assert_eq!(commands.holds(0.1), [0..22, 43..100]);
        assert_eq!(commands.rows_before_first_action(), 22);
    }

    /// Defect seen: rows 39 ms apart. The vent valve had opened before the row that shows its command; this row counted in the hold before,
    /// and the model began again 86 mbar too high after a gap.
    #[test]
    fn a_hold_ends_before_the_row_that_shows_a_command_of_a_slow_logger() {
        let slow = Commands {
            early_s: 0.01,
            delay_range_s: (0.004, 0.005),
            ..commands(&pulse(20..30, 100), &[0.0; 100])
        };
        assert_eq!(slow.holds(0.0)[0], 0..20);
    }

    /// Defect seen: a vent valve with a delay of 2.5 ms opened before the row, 20 ms later, that shows its command. The fall of the pressure
    /// was a dropout, and 0.66 s of the log counted as missing.
    #[test]
    fn a_fast_valve_may_open_before_the_row_that_shows_its_command() {
        let first_hold = |valve_delay_s: f64| {
            let commands = Commands {
                valve_delay_s,
                delay_range_s: (0.0, 0.0),
                ..commands(&pulse(20..30, 100), &[0.0; 100])
            };
            commands.at_the_earliest().holds(0.0)[0].clone()
        };
        assert_eq!(first_hold(2.5e-3), 0..20);
        assert_eq!(first_hold(12e-3), 0..21);
    }

    #[test]
    fn rows_further_apart_than_samples_show_commands_late() {
        let early_s = |interval_s: f64| {
            let log = crate::bench::logged(
                &PlantParameters::nominal(),
                Default::default(),
                interval_s,
                1,
            );
            Commands::new(&PlantParameters::nominal(), &log)
                .unwrap()
                .early_s
        };
        assert_eq!(early_s(0.01), 0.0);
        assert!((early_s(0.039) - 0.039).abs() < 1e-9);
    }

    #[test]
    fn a_coil_is_dead_while_only_the_other_valve_acts() {
        let commands = commands(&pulse(20..30, 100), &pulse(60..70, 100));
        assert_eq!(commands.dead_coil(VENT, 0.0), [0..62, 73..100]);
        assert_eq!(commands.holds(0.0), [0..22, 33..62, 73..100]);
    }

    #[test]
    fn a_coil_at_full_duty_carries_its_whole_current_after_the_command_acted() {
        let mut duty = vec![100.0; 100];
        duty[40..50].fill(30.0);
        let commands = commands(&pulse(0..0, 100), &duty);
        assert_eq!(commands.full_coil(VENT, 0.0), [4..42, 53..100]);
        assert_eq!(commands.full_coil(FILL, 0.0), []);
    }

    #[test]
    fn a_normally_open_valve_is_shut_by_full_duty() {
        let mut commands = commands(&pulse(0..0, 50), &[100.0; 50]);
        assert!(commands.holds(0.0).iter().all(|hold| hold.len() < 3));
        commands.shut_pct[VENT] = 100.0;
        assert_eq!(commands.rows_before_first_action(), 50);
    }

    #[test]
    fn the_command_in_force_is_late_by_the_delay() {
        let commands = commands(&[0.0; 10], &[0.0; 10]);
        assert_eq!(commands.row_in_force(0.0149), None);
        assert_eq!(commands.row_in_force(0.0151), Some(0));
        assert_eq!(commands.row_in_force(0.0351), Some(2));
    }
}
