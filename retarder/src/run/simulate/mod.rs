//! Simulation of a log's duty cycles into a recording, in memory that does not grow with the log.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use model_lab::result::{FoundClock, FoundStart, MissingCells};
use model_lab::{CompareError, LogConditions, SimulationStart, find_conditions};
use plant_sim::replay::{
    CurrentSampling, Inputs, ROW_SIGNALS, Replay, ReplayError, ReplayInput, Row, Surroundings,
    check_gap, signals, united,
};
use plant_sim::{PlantParameters, Tolerance};
use recording::csv::{Column, Decimals, Options, Reader, WriteError};
use recording::{DefectCounter, Defects, OpenLog, Provenance, Recording, Unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

mod rows;

use rows::Rows;

use super::row_output::RowOutput;
use crate::cli::Assignment;
use crate::failure::Failure;
use crate::input::{LogSource, NamedPlant};
use crate::interrupt;
use crate::progress::Progress;
use crate::targets::Existing;

/// Inputs of the simulation.
pub(crate) struct Task {
    pub(crate) plant: NamedPlant,
    pub(crate) log: LogSource,
    /// Options for reading a CSV log.
    pub(crate) options: Options,
    /// Given part of the initial state.
    pub(crate) start: Vec<Assignment>,
    /// CSV or MF4 file; `None` is the standard output, as CSV.
    pub(crate) out: Option<PathBuf>,
    pub(crate) existing: Existing,
}

/// Name and version of the JSON form of a [`Simulation`].
pub(crate) const SIMULATION_SCHEMA: &str = "retarder.simulation/1";

/// Simulation and the work of its solver.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Simulation {
    /// Name and version of this format, `retarder.simulation/1`.
    pub(crate) schema: String,
    /// Name of the log.
    pub(crate) log: String,
    /// Plant file, with the changes on the command line.
    pub(crate) plant: String,
    /// Written file; null for the standard output.
    pub(crate) recording: Option<String>,
    /// Number of rows that were read and written.
    pub(crate) rows: u64,
    /// Time from the first to the last row, s.
    pub(crate) duration_s: f64,
    /// Number of rows without a command, in which the last one stayed valid.
    pub(crate) held_commands: u64,
    /// Gaps and missing cells of the log.
    pub(crate) defects: SimulatedDefects,
    /// Clock of the logger for the simulation; absent if rows are ECU samples or the log has no measured signal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) clock: Option<FoundClock>,
    /// Source of the initial pressure, in words.
    #[serde(default)]
    pub(crate) start: String,
    /// Initial chamber pressure, bar gauge; 0 for a plant without chamber.
    #[serde(default)]
    pub(crate) start_pressure_bar_gauge: f64,
    /// Gas in the chamber at the first row; absent if it has the temperature of the wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) start_gas: Option<FoundStart>,
    /// Whether currents are means over the interval before the row, and not values of the instant.
    pub(crate) currents_are_means: bool,
    /// Accepted integration steps.
    pub(crate) steps: u64,
    /// Steps repeated with a smaller size.
    pub(crate) rejected_steps: u64,
    /// Intervals passed by formula alone.
    pub(crate) exact_intervals: u64,
    /// Located events: end stops, currents that decayed to zero, kinks.
    pub(crate) events: u64,
    /// Accepted and rejected steps per PWM period; null for a log without duration.
    pub(crate) steps_per_pwm_period: Option<f64>,
    /// Elapsed time of simulation, reading and writing together, s.
    pub(crate) elapsed_s: f64,
    /// Duration divided by elapsed time.
    pub(crate) times_real_time: f64,
}

/// Gaps and missing cells of the log: in both, the last command stays valid.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SimulatedDefects {
    /// Pauses of the logger, in order of time, the first hundred.
    pub(crate) gaps: Vec<SimulatedGap>,
    /// Number of all pauses.
    pub(crate) gap_count: usize,
    /// Signals with missing cells.
    pub(crate) missing: Vec<MissingCells>,
    /// All defects in words, each as one sentence without a full stop.
    pub(crate) sentences: Vec<String>,
}

/// Interval without rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SimulatedGap {
    /// Instant of the last row before the gap, s.
    pub(crate) start_s: f64,
    /// Instant of the first row after the gap, s.
    pub(crate) end_s: f64,
}

impl SimulatedDefects {
    fn of(defects: &Defects) -> Self {
        let gap = |gap: &recording::Pause| SimulatedGap {
            start_s: gap.start_s,
            end_s: gap.end_s,
        };
        let missing = |cells: &recording::MissingCells| MissingCells {
            signal: cells.signal.clone(),
            cells: cells.cells,
            out_of_bounds: cells
                .out_of_bounds
                .as_ref()
                .map_or(0, |outside| outside.count),
        };
        Self {
            gaps: defects.gaps.iter().map(gap).collect(),
            gap_count: defects.gap_count,
            missing: defects.missing.iter().map(missing).collect(),
            sentences: defects.sentences(),
        }
    }
}

/// Simulates row by row.
pub(crate) fn run(task: Task) -> Result<Simulation, Failure> {
    let Task {
        plant,
        log: LogSource { name, log, size },
        options,
        start,
        out,
        existing,
    } = task;
    let progress = Progress::of_bytes("simulating", size);
    let rows = match log {
        OpenLog::Csv(bytes) => Rows::Csv(
            Box::new(Reader::new(&name, progress.watch(bytes), &options)?),
            DefectCounter::default(),
        ),
        OpenLog::Recording(recording) => {
            let defects = recording.defects();
            Rows::Recording(Some(recording), defects)
        }
    };
    let never = AtomicBool::new(false);
    let is_interrupted = match &out {
        None => &never,
        Some(_) => interrupt::flag()?,
    };
    let out = out.as_deref().map(|path| (path, existing));
    simulate(&plant, &start, &name, rows, out, is_interrupted)
}

fn simulate(
    plant: &NamedPlant,
    given: &[Assignment],
    log: &str,
    mut rows: Rows<impl Read>,
    out: Option<(&Path, Existing)>,
    is_interrupted: &AtomicBool,
) -> Result<Simulation, Failure> {
    let begin = Instant::now();
    let path = out.map(|(path, _)| path);
    let failed = |error: WriteError| Failure::write(path, error);
    // A log that is refused at its beginning leaves no header on the standard output.
    let First {
        parameters,
        start,
        conditions,
        mut chunk,
    } = First::of(&mut rows, (plant, given), log)?;
    let source = (&parameters, log);
    let mut model = Model::new(&parameters, (&chunk, &start), &conditions);
    let (places, columns) = columns(&plant.parameters);
    let provenance = provenance(log, plant);
    let mut output = RowOutput::begin(out, &provenance, &columns, &decimals()).map_err(failed)?;
    let mut values = Vec::with_capacity(columns.len());
    while !chunk.rows.is_empty() {
        for (time_s, input) in chunk.rows {
            interrupt::check(is_interrupted)?;
            let row = model.row(time_s, input).map_err(|error| Failure::Replay {
                path: log.into(),
                error,
            })?;
            values.clear();
            values.extend(places.iter().map(|&place| row[place]));
            output.write_row(time_s, &values).map_err(failed)?;
        }
        chunk = match rows.next(log, false)? {
            Some(recording) => Chunk::of(&recording, source, false)?,
            None => Chunk::default(),
        };
    }
    output.finish().map_err(failed)?;
    let statistics = model.replay.simulator().statistics();
    let duration_s = model.end_s - model.start_s.unwrap_or(model.end_s);
    let elapsed_s = begin.elapsed().as_secs_f64();
    let periods = duration_s * plant.parameters.ecu.pwm_frequency_hz;
    let tried = (statistics.steps + statistics.rejected_steps) as f64;
    let simulation = Simulation {
        schema: SIMULATION_SCHEMA.to_owned(),
        log: log.to_owned(),
        plant: plant.name.clone(),
        recording: path.map(|path| path.display().to_string()),
        rows: model.rows,
        duration_s,
        held_commands: model.held_commands,
        defects: SimulatedDefects::of(&rows.defects()),
        clock: conditions.clock(log),
        start: start.statement().to_owned(),
        start_pressure_bar_gauge: start.pressure_bar_gauge(),
        start_gas: conditions
            .start(log)
            .filter(|gas| gas.is_warm() && !start.is_given()),
        currents_are_means: model.sampling == CurrentSampling::MeanOfInterval,
        steps: statistics.steps,
        rejected_steps: statistics.rejected_steps,
        exact_intervals: statistics.exact_intervals,
        events: statistics.events,
        steps_per_pwm_period: (periods > 0.0).then(|| tried / periods),
        elapsed_s,
        times_real_time: duration_s / elapsed_s,
    };
    Ok(simulation)
}

/// State of the plant during the log.
struct Model<'a> {
    replay: Replay,
    start: &'a SimulationStart,
    conditions: &'a LogConditions,
    sampling: CurrentSampling,
    start_s: Option<f64>,
    end_s: f64,
    rows: u64,
    held_commands: u64,
}

impl<'a> Model<'a> {
    fn new(
        parameters: &PlantParameters,
        (begin, start): (&Chunk, &'a SimulationStart),
        conditions: &'a LogConditions,
    ) -> Self {
        let sampling = conditions.sampling(begin.current_interval_s, parameters);
        Self {
            replay: start.begin(parameters, conditions, sampling, Tolerance::default()),
            start,
            conditions,
            sampling,
            start_s: None,
            end_s: 0.0,
            rows: 0,
            held_commands: 0,
        }
    }

    fn row(&mut self, time_s: f64, input: ReplayInput) -> Result<Row, ReplayError> {
        let start_s = *self.start_s.get_or_insert(time_s);
        if self.rows > 0 {
            check_gap(self.end_s, time_s)?;
        }
        self.end_s = time_s;
        self.rows += 1;
        self.held_commands += u64::from(input.command.is_none());
        let time_ns = ((time_s - start_s) * 1e9).round() as u64;
        let shown_ns = time_ns + (input.shown_ns - input.time_ns);
        let input = ReplayInput {
            time_ns,
            shown_ns,
            issued_ns: shown_ns,
            ..input
        };
        let input = self.conditions.on_ecu_time(input, time_ns);
        let at = (input, time_s - start_s);
        let row = self.start.row(&mut self.replay, self.conditions, at);
        row.ok_or_else(|| ReplayError::aborted(time_ns))
    }
}

/// First rows of a log, and the facts that they determine.
struct First {
    /// Plant in the surroundings of the log.
    parameters: PlantParameters,
    start: SimulationStart,
    /// Conditions under which the log was made.
    conditions: LogConditions,
    chunk: Chunk,
}

impl First {
    fn of(
        rows: &mut Rows<impl Read>,
        (plant, given): (&NamedPlant, &[Assignment]),
        log: &str,
    ) -> Result<Self, Failure> {
        let parameters = &plant.parameters;
        let recording = rows.next(log, true)?.unwrap_or_default();
        let surroundings = Surroundings::of(parameters, &recording);
        let surroundings = surroundings.map_err(|error| refused(log, error))?;
        let parameters = surroundings.around(parameters).into_owned();
        let chunk = Chunk::of(&recording, (&parameters, log), true)?;
        let mut start = SimulationStart::of(&parameters, &recording)?;
        for Assignment { name, value } in given {
            start = start.given(&parameters, name, *value)?;
        }
        Ok(Self {
            start,
            conditions: find_conditions(&parameters, &recording),
            parameters,
            chunk,
        })
    }
}

fn refused(log: &str, error: ReplayError) -> Failure {
    match error {
        // These errors already name the log.
        ReplayError::MissingSignal(_)
        | ReplayError::NoCommand { .. }
        | ReplayError::GaugeAmbient { .. }
        | ReplayError::Surroundings { .. } => Failure::Compare(CompareError::Replay(error)),
        error => Failure::Replay {
            path: PathBuf::from(log),
            error,
        },
    }
}

/// Some rows of the log: instants and commands. Empty at the end.
#[derive(Default)]
struct Chunk {
    rows: Vec<(f64, ReplayInput)>,
    /// Median time between two samples of a current (s).
    current_interval_s: f64,
}

impl Chunk {
    /// Creates the chunk from the rows of a recording, so that the library reads and refuses signals as in a whole log.
    fn of(
        recording: &Recording,
        (parameters, log): (&PlantParameters, &str),
        is_first: bool,
    ) -> Result<Self, Failure> {
        // A command may be missing in a later chunk, but not in the first one.
        let recording = &*united(parameters, recording);
        let inputs = match is_first {
            true => Inputs::of(parameters, recording),
            false => Inputs::of_part(parameters, recording),
        };
        let inputs = inputs.map_err(|error| refused(log, error))?;
        let times_s = inputs.base().times_s().iter().copied();
        Ok(Self {
            rows: times_s.zip(inputs.iter()).collect(),
            current_interval_s: inputs.current_interval_s(),
        })
    }
}

fn provenance(log: &str, plant: &NamedPlant) -> Provenance {
    let mut provenance =
        Provenance::from_source(format!("model of {log}")).with_note("plant", &plant.name);
    provenance.producer = Some(concat!("retarder ", env!("CARGO_PKG_VERSION")).to_owned());
    provenance
}

/// Returns the columns of a plant, and their places in a row.
fn columns(parameters: &PlantParameters) -> (Vec<usize>, Vec<Column>) {
    let place = |signal| ROW_SIGNALS.iter().position(|one| *one == signal);
    signals(parameters)
        .filter_map(|(name, unit)| {
            let column = Column {
                name: name.to_owned(),
                unit,
            };
            Some((place((name, unit))?, column))
        })
        .unzip()
}

/// Returns the written decimals; digits below the tolerance of the solver are noise: 0.1 Pa, 0.1 µA, 1 nm and 0.1 mK
/// remain.
fn decimals() -> Decimals {
    Decimals::shortest()
        .with(Unit::BarGauge, 6)
        .with(Unit::Milliampere, 4)
        .with(Unit::Millimetre, 6)
        .with(Unit::Kelvin, 4)
}
