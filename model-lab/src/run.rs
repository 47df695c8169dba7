//! Runs of the model at the instants of a log: free-run simulation, one-step-ahead prediction, and a fine run for time shifts.

use std::cell::Cell;
use std::sync::Arc;

use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::{
    CurrentSampling, Inputs, ROW_SIGNALS, Replay, ReplayError, ReplayInput, Row,
};
use plant_sim::{PlantParameters, Simulator, Tolerance};
use recording::{AddSignalError, Provenance, Recording, TimeBase, TimeBaseId, Unit};

use crate::conditions::LogConditions;
use crate::error::CompareError;
use crate::gaps::Gaps;
use crate::log_start::LogStart;
use crate::measured::Measured;
use crate::metrics::{picked, present};

/// Interval at which the valves are sampled within a sample interval (ns).
const LOOK_NS: u64 = 1_000_000;

/// Number of samples of the valves within a row, at most. A longer row than this many [`LOOK_NS`] is sampled less often.
const LOOKS_MAX: u64 = 1_000;
/// Number of points of a fine run, at most: 20 min at 100 Hz, whatever the interval.
const FINE_POINTS_MAX: usize = 1_200_000;

/// Data that all runs of one comparison share.
pub(crate) struct Setup<'a> {
    pub(crate) parameters: &'a PlantParameters,
    pub(crate) base: &'a TimeBase,
    pub(crate) inputs: Inputs<'a>,
    gaps: Gaps,
    /// Signals of the model that its runs keep: names, units and indices in a row.
    signals: Vec<(&'static str, Unit, usize)>,
    pub(crate) sampling: CurrentSampling,
    pub(crate) tolerance: Tolerance,
    /// Conditions under which the log was made.
    conditions: &'a LogConditions,
    /// Start of the simulation, and its restarts after gaps.
    pub(crate) start: LogStart,
    /// Measured chamber pressure (bar gauge), NaN where missing.
    pressure_bar: Option<Arc<Vec<f64>>>,
    watch: Option<Watch<'a>>,
}

/// Row of the log as the model receives it.
struct TimedRow {
    index: usize,
    /// Input in the time of the ECU, pauses shortened.
    input: ReplayInput,
    /// Time since the first row by the clock of the logger (ns), and the same with pauses shortened.
    log_ns: u64,
    shortened_ns: u64,
    /// Time since the first row by the clock of the logger (s).
    time_s: f64,
}

/// Progress observer: receives the share of all rows that is done, and returns whether to go on.
struct Watch<'a> {
    goes_on: &'a dyn Fn(f64) -> bool,
    done: Cell<usize>,
    all: usize,
}

/// Number of rows between two calls of a [`Watch`]: some milliseconds.
const ROWS_UNWATCHED: usize = 64;

impl Watch<'_> {
    fn count_row(&self) -> Result<(), CompareError> {
        let done = self.done.get() + 1;
        self.done.set(done);
        let share = || (done as f64 / self.all.max(1) as f64).min(1.0);
        if done.is_multiple_of(ROWS_UNWATCHED) && !(self.goes_on)(share()) {
            return Err(CompareError::Stopped);
        }
        Ok(())
    }
}

/// Signals of the model, one column per name.
#[derive(Debug, Clone, Default)]
pub(crate) struct Columns {
    pub(crate) signals: Vec<(&'static str, Unit, Vec<f64>)>,
    /// Index of each in a row of the model.
    places: Vec<usize>,
}

/// Activity of the model between two samples; it determines the regime of the later one.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Activity {
    /// Whether the fill and the vent valve were open at any time in the interval.
    pub(crate) open: [bool; 2],
    /// Chamber pressure at the sample (Pa abs), before a correction.
    pub(crate) pressure: f64,
    /// Change of the chamber pressure in the interval (Pa/s).
    pub(crate) pressure_rate: f64,
}

impl<'a> Setup<'a> {
    pub(crate) fn new(
        parameters: &'a PlantParameters,
        (log, conditions): (&'a Recording, &'a LogConditions),
        tolerance: Tolerance,
    ) -> Result<Self, ReplayError> {
        let inputs = Inputs::of(parameters, log)?;
        let base = inputs.base();
        let sampling = conditions.sampling(inputs.current_interval_s(), parameters);
        let supply_pressure = inputs.first_supply_pressure();
        Ok(Self {
            parameters,
            base,
            gaps: Gaps::of(parameters, &inputs),
            inputs,
            signals: ROW_SIGNALS
                .into_iter()
                .enumerate()
                .map(|(place, (name, unit))| (name, unit, place))
                .collect(),
            sampling,
            tolerance,
            conditions,
            start: LogStart::at_rest(parameters).supplied(supply_pressure),
            pressure_bar: None,
            watch: None,
        })
    }

    /// Lets `goes_on` observe a free-run simulation, a prediction and a fine run over `fine_rows` rows.
    pub(crate) fn watched(mut self, goes_on: &'a dyn Fn(f64) -> bool, fine_rows: usize) -> Self {
        let rows = self.inputs.len();
        self.watch = Some(Watch {
            goes_on,
            done: Cell::new(0),
            all: 2 * rows + rows.min(fine_rows),
        });
        self
    }

    /// Keeps only the signals of each run for whose name `is_kept` returns true: an hour at 1 kHz takes 29 MB for each signal.
    pub(crate) fn keeping(mut self, is_kept: impl Fn(&str) -> bool) -> Self {
        self.signals.retain(|(name, ..)| is_kept(name));
        self
    }

    /// Starts where the measured `pressure` starts, at `level` (Pa abs) where that is away from ambient.
    pub(crate) fn begin_at(&mut self, pressure: Option<&Measured>, level: Option<f64>) {
        let command = self.inputs.row(0).command;
        self.pressure_bar = pressure.map(|signal| signal.values.clone());
        self.start = LogStart::at(self.parameters, pressure, level, command)
            .supplied(self.inputs.first_supply_pressure());
    }

    /// Returns the rows of the log, pauses shortened.
    fn rows(&self) -> impl Iterator<Item = TimedRow> + '_ {
        let mut shortened = self.gaps.shortening();
        self.inputs.iter().enumerate().map(move |(index, input)| {
            let log_ns = input.time_ns;
            let input = shortened(input);
            let time_s = log_ns as f64 * 1e-9;
            TimedRow {
                index,
                input: self.conditions.on_ecu_time(input, log_ns),
                log_ns,
                shortened_ns: input.time_ns,
                time_s,
            }
        })
    }

    fn count_row(&self) -> Result<(), CompareError> {
        self.watch.as_ref().map_or(Ok(()), Watch::count_row)
    }

    fn begin(&self) -> Replay {
        let conditions = &self.conditions.conditions;
        self.start
            .begin(self.parameters, conditions, self.sampling, self.tolerance)
    }

    /// Returns the pressure at `row` over that of the model, whose gas has the temperature of the wall.
    fn warmth(&self, row: &TimedRow, replay: &mut Replay) -> f64 {
        let conditions = &self.conditions.conditions;
        self.start.warmth(replay, conditions, row.time_s)
    }

    /// Restarts the model where row `index` is the last one of a gap.
    fn restart(&self, replay: &mut Replay, index: usize) {
        self.start.restart(replay, index, || {
            let pressure = |row: usize| self.pressure_bar.as_ref().map_or(f64::NAN, |bar| bar[row]);
            let rows = self.rows().skip(index + 1);
            rows.map(move |row| (row.input, pressure(row.index)))
        });
    }

    /// Returns the model's row at the instant of `row`.
    fn row(&self, row: &TimedRow, replay: &mut Replay) -> Result<Row, CompareError> {
        let warmth = self.warmth(row, replay);
        let values = self.start.row(replay, row.input, warmth);
        values.ok_or_else(|| ReplayError::aborted(row.shortened_ns).into())
    }

    /// Runs the free-run simulation: the model driven by the commands alone.
    pub(crate) fn free_run(&self) -> Result<Columns, CompareError> {
        let mut replay = self.begin();
        let mut columns = Columns::of(self, self.inputs.len());
        for row in self.rows() {
            self.count_row()?;
            columns.push(self.row(&row, &mut replay)?);
            self.restart(&mut replay, row.index);
        }
        Ok(columns)
    }

    /// Runs the one-step-ahead prediction: after each sample, corrects the pressure of the model by `gain` times (measured - predicted),
    /// measured in bar gauge, NaN where missing. Without a measurement, or with gain 0, it is the free-run simulation. Calls `watch` with
    /// the activity at each sample.
    pub(crate) fn predict(
        &self,
        measured_bar: Option<&[f64]>,
        gain: f64,
        mut watch: impl FnMut(Activity),
    ) -> Result<Columns, CompareError> {
        let mut replay = self.begin();
        let mut columns = Columns::of(self, self.inputs.len());
        for row in self.rows() {
            self.count_row()?;
            let begin = (replay.time_ns(), replay.simulator().state().pressure);
            let mut open = [false; 2];
            replay.begin_row(&row.input);
            for time_ns in instants_between(begin.0, row.input.time_ns) {
                replay.advance_to_ns(time_ns);
                let simulator = replay.simulator();
                open = [FILL, VENT].map(|valve| open[valve] || is_open(simulator, valve));
            }
            let warmth = self.warmth(&row, &mut replay);
            let modelled = self.row(&row, &mut replay)?;
            columns.push(modelled);
            let pressure = replay.simulator().state().pressure;
            let span_s = row.input.time_ns.saturating_sub(begin.0) as f64 * 1e-9;
            watch(Activity {
                open,
                pressure,
                pressure_rate: if span_s > 0.0 {
                    (pressure - begin.1) / span_s
                } else {
                    0.0
                },
            });
            self.restart(&mut replay, row.index);
            let measured_bar =
                measured_bar.map_or(f64::NAN, |measured_bar| measured_bar[row.index]);
            self.start
                .correct(&mut replay, &modelled, warmth, measured_bar, gain);
        }
        Ok(columns)
    }

    /// Runs the free-run simulation on a grid of at most 1 ms over the first `rows` instants, or fewer where these are far apart. Returns
    /// times (s) and columns. A current that is a mean refers to the grid interval that ends at its time.
    pub(crate) fn fine_run(&self, rows: usize) -> Result<FineRun, CompareError> {
        let mut replay = self.begin();
        let mut fine = FineRun {
            rows: 0,
            times_s: Vec::new(),
            columns: Columns::of(self, 0),
        };
        let mut last_ns = None;
        for row in self.rows().take(rows) {
            self.count_row()?;
            if fine.times_s.len() > FINE_POINTS_MAX {
                break;
            }
            let (log_ns, input) = (row.log_ns as i64, row.input);
            // Difference of the clocks and the shortening of the gaps.
            let later_ns = log_ns - input.time_ns as i64;
            let begin_ns = last_ns.unwrap_or(input.time_ns);
            let warmth = self.warmth(&row, &mut replay);
            replay.begin_row(&input);
            for time_ns in
                instants_between(begin_ns, input.time_ns).take_while(|&t| t < input.time_ns)
            {
                let on_the_way = ReplayInput::at(time_ns);
                let values = self.start.row(&mut replay, on_the_way, warmth);
                let values = values.ok_or_else(|| ReplayError::aborted(row.shortened_ns))?;
                fine.columns.push(values);
                fine.times_s.push((time_ns as i64 + later_ns) as f64 * 1e-9);
            }
            // Each point has the mean of its own interval.
            let row = TimedRow {
                input: ReplayInput {
                    samples_current: [true; 2],
                    ..input
                },
                ..row
            };
            fine.columns.push(self.row(&row, &mut replay)?);
            fine.times_s.push(log_ns as f64 * 1e-9);
            self.restart(&mut replay, row.index);
            last_ns = Some(input.time_ns);
            fine.rows = row.index + 1;
        }
        Ok(fine)
    }
}

/// Free-run simulation on a grid that is finer than the log.
pub(crate) struct FineRun {
    /// Number of rows of the log that it covers, from the first one on.
    pub(crate) rows: usize,
    /// Instants since the start of the log (s).
    pub(crate) times_s: Vec<f64>,
    pub(crate) columns: Columns,
}

impl Columns {
    /// Returns columns for about `rows` rows of the signals that `setup` keeps.
    fn of(setup: &Setup, rows: usize) -> Self {
        let signals = setup.signals.iter();
        let column = |&(name, unit, _): &(_, _, _)| (name, unit, Vec::with_capacity(rows));
        Self {
            signals: signals.clone().map(column).collect(),
            places: signals.map(|&(_, _, place)| place).collect(),
        }
    }

    fn push(&mut self, row: Row) {
        for ((_, _, column), &place) in self.signals.iter_mut().zip(&self.places) {
            column.push(row[place]);
        }
    }

    /// Returns the column `name`.
    pub(crate) fn get(&self, name: &str) -> Option<&[f64]> {
        self.signals
            .iter()
            .find(|signal| signal.0 == name)
            .map(|signal| &signal.2[..])
    }

    /// Returns the columns as a recording on `base`, without those of parts that the plant lacks. A signal that was `measured` at instants
    /// of its own has these.
    pub(crate) fn into_recording(
        self,
        source: String,
        base: &TimeBase,
        measured: &[Measured],
    ) -> Result<Recording, AddSignalError> {
        let provenance = Provenance::from_source(source)
            .with_note("producer", concat!("model-lab ", env!("CARGO_PKG_VERSION")));
        let mut recording = OwnInstants::new(provenance, base);
        for (name, unit, column) in self.signals {
            if present(&column).next().is_some() {
                let of_log = measured.iter().find(|signal| signal.name == name);
                recording.add((name, unit), Arc::new(column), of_log)?;
            }
        }
        Ok(recording.recording)
    }
}

/// Recording of signals at all rows of a log, each with the instants that it has in the log.
pub(crate) struct OwnInstants {
    pub(crate) recording: Recording,
    /// Time base of all rows.
    all: TimeBaseId,
}

impl OwnInstants {
    pub(crate) fn new(provenance: Provenance, base: &TimeBase) -> Self {
        let mut recording = Recording::new(provenance);
        let all = recording.add_time_base(base.clone());
        Self { recording, all }
    }

    /// Adds a signal with a value for each row; it is compared with `measured`, if it is.
    pub(crate) fn add(
        &mut self,
        (name, unit): (&str, Unit),
        column: Arc<Vec<f64>>,
        measured: Option<&Measured>,
    ) -> Result<(), AddSignalError> {
        let (id, column) = match measured.and_then(|signal| signal.own.as_ref()) {
            None => (self.all, column),
            Some((own, rows)) => (self.base(own), Arc::new(picked(&column, rows))),
        };
        self.recording.add_shared_signal(name, unit, id, column)?;
        Ok(())
    }

    fn base(&mut self, own: &TimeBase) -> TimeBaseId {
        let known = self.recording.time_bases().find(|(_, base)| *base == own);
        match known.map(|(id, _)| id) {
            Some(id) => id,
            None => self.recording.add_time_base(own.clone()),
        }
    }
}

/// Returns equally spaced instants in (begin, end], [`LOOK_NS`] apart at most or [`LOOKS_MAX`] of them, `end` last.
fn instants_between(begin_ns: u64, end_ns: u64) -> impl Iterator<Item = u64> {
    let span = end_ns.saturating_sub(begin_ns);
    let count = span.div_ceil(LOOK_NS).min(LOOKS_MAX);
    (1..=count).map(move |part| {
        begin_ns + (u128::from(span) * u128::from(part) / u128::from(count)) as u64
    })
}

fn is_open(simulator: &Simulator, valve: usize) -> bool {
    let x = simulator.state().valves[valve].x;
    simulator.plant().valves[valve].effective_area(x) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Bench;

    #[test]
    fn the_free_run_is_the_replay_of_the_simulator_bit_for_bit() {
        let bench = Bench::default();
        let log = bench.measure();
        let conditions = LogConditions::default();
        let setup = Setup::new(&bench.plant, (&log, &conditions), Tolerance::default()).unwrap();
        let replayed =
            plant_sim::replay::replay(&bench.plant, &log, Tolerance::default(), |_, _| {}).unwrap();
        let pressure = replayed.recording.signal("p_ch").unwrap();
        assert_eq!(
            setup.free_run().unwrap().get("p_ch").unwrap(),
            pressure.values_or_nan()
        );
    }

    #[test]
    fn looking_between_the_samples_changes_nothing_beyond_the_solver_tolerance() {
        let bench = Bench::default();
        let log = bench.measure();
        let conditions = LogConditions::default();
        let setup = Setup::new(&bench.plant, (&log, &conditions), Tolerance::default()).unwrap();
        let free = setup.free_run().unwrap();
        let watched = setup.predict(None, 0.0, |_| ()).unwrap();
        let FineRun {
            times_s,
            columns: fine,
            ..
        } = setup.fine_run(usize::MAX).unwrap();
        for (row, &expected) in free.get("p_ch").unwrap().iter().enumerate() {
            let time_s = row as f64 * 0.01;
            let nearest = times_s.partition_point(|&t| t < time_s - 1e-6);
            let found = [
                watched.get("p_ch").unwrap()[row],
                fine.get("p_ch").unwrap()[nearest],
            ];
            assert!(
                found.iter().all(|found| (found - expected).abs() < 2e-3),
                "{row}: {found:?}, {expected}"
            );
        }
    }

    #[test]
    fn a_full_correction_follows_the_measurement() {
        let bench = Bench::default();
        let log = bench.measure();
        let conditions = LogConditions::default();
        let mut setup =
            Setup::new(&bench.plant, (&log, &conditions), Tolerance::default()).unwrap();
        setup.start.pressure = Some(3e5);
        let measured = vec![2.5; log.signals()[0].len()];
        let mut activity = Vec::new();
        let columns = setup
            .predict(Some(&measured), 1.0, |now| activity.push(now))
            .unwrap();
        let still = activity
            .iter()
            .position(|activity| activity.open != [false; 2])
            .unwrap();
        assert!((columns.get("p_ch").unwrap()[0] - (3e5 - 101_325.0) / 1e5).abs() < 1e-9);
        assert!((columns.get("p_ch").unwrap()[still - 1] - 2.5).abs() < 1e-9);
    }

    #[test]
    fn instants_end_with_the_last_and_are_never_further_apart_than_a_look() {
        assert_eq!(instants_between(5, 5).count(), 0);
        let instants: Vec<u64> = instants_between(500, 2_500_500).collect();
        assert_eq!(instants, [833_833, 1_667_166, 2_500_500]);
    }
}
