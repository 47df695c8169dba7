//! Duty log in, recording out, in memory that does not grow with the log.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use model_lab::result::{FoundClock, MissingCells};
use model_lab::{CompareError, LogConditions, find_conditions};
use plant_sim::replay::{
    CurrentSampling, ROW_SIGNALS, Replay, ReplayError, ReplayInput, Row, check_gap,
    initial_pressure, inputs, inputs_of_part, signals,
};
use plant_sim::{PlantParameters, Tolerance};
use recording::csv::{Column, Decimals, Options, Reader, WriteError};
use recording::{DefectCounter, Defects, OpenLog, Provenance, Recording, TimeBase, Unit};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::row_output::RowOutput;
use crate::failure::Failure;
use crate::input::{LogSource, NamedPlant};
use crate::interrupt;
use crate::progress::Progress;
use crate::targets::Existing;

/// What to simulate.
pub(crate) struct Task {
    pub(crate) plant: NamedPlant,
    pub(crate) log: LogSource,
    /// How a CSV log is read.
    pub(crate) options: Options,
    /// CSV or MF4 file; none is the standard output, as CSV.
    pub(crate) out: Option<PathBuf>,
    pub(crate) existing: Existing,
}

/// Name and version of the JSON form of a [`Simulation`].
pub(crate) const SIMULATION_SCHEMA: &str = "retarder.simulation/1";

/// A simulation and the work that it took.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct Simulation {
    /// Name and version of this format.
    pub(crate) schema: String,
    /// Name of the log.
    pub(crate) log: String,
    /// The plant: its file, and what was changed on the command line.
    pub(crate) plant: String,
    /// The file that was written; null for the standard output.
    pub(crate) recording: Option<String>,
    /// Rows read and written.
    pub(crate) rows: u64,
    /// From the first to the last row, s.
    pub(crate) duration_s: f64,
    /// Rows in which a command was missing and the last one was held.
    pub(crate) held_commands: u64,
    /// What the log lacks.
    pub(crate) defects: SimulatedDefects,
    /// Clock of the logger, by which the model is simulated; absent where rows are samples of the ECU or the log has no measured signal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(crate) clock: Option<FoundClock>,
    /// How the currents are meant: means of the interval before the row, or values of the instant.
    pub(crate) currents_are_means: bool,
    /// Accepted integration steps.
    pub(crate) steps: u64,
    /// Steps repeated with a smaller size.
    pub(crate) rejected_steps: u64,
    /// Intervals that were passed by formula alone.
    pub(crate) exact_intervals: u64,
    /// Events that were located: end stops, extinct currents, kinks.
    pub(crate) events: u64,
    /// Accepted and rejected steps per PWM period; null for a log without duration.
    pub(crate) steps_per_pwm_period: Option<f64>,
    /// Time that simulation, reading and writing took together, s.
    pub(crate) elapsed_s: f64,
    /// Duration over elapsed time.
    pub(crate) times_real_time: f64,
}

/// Gaps and missing cells of the log: over both, the last command is held.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SimulatedDefects {
    /// Pauses of the logger, in order of time, the first hundred.
    pub(crate) gaps: Vec<SimulatedGap>,
    /// Number of all pauses.
    pub(crate) gap_count: usize,
    /// Signals with missing cells.
    pub(crate) missing: Vec<MissingCells>,
    /// All of it in words, one sentence without a full stop for each.
    pub(crate) sentences: Vec<String>,
}

/// A time without rows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub(crate) struct SimulatedGap {
    /// Instant of the last row before it, s.
    pub(crate) start_s: f64,
    /// Instant of the first row after it, s.
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

/// Rows that are held at a time.
const CHUNK_ROWS: usize = 4096;
/// Signals of a log that tell the clock of its logger.
const MEASURED: [&str; 3] = ["p_ch", "i_fill", "i_vent"];

/// Simulates row by row.
pub(crate) fn run(task: Task) -> Result<Simulation, Failure> {
    let Task {
        plant,
        log: LogSource { name, log, size },
        options,
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
    simulate(&plant, &name, rows, out, is_interrupted)
}

fn simulate(
    plant: &NamedPlant,
    log: &str,
    mut rows: Rows<impl Read>,
    out: Option<(&Path, Existing)>,
    is_interrupted: &AtomicBool,
) -> Result<Simulation, Failure> {
    let begin = Instant::now();
    let path = out.map(|(path, _)| path);
    let failed = |error: WriteError| Failure::write(path, error);
    // A log that is refused at its beginning leaves no header on the standard output.
    let source = (&plant.parameters, log);
    let mut chunk = Chunk::next(&mut rows, source, true)?;
    let conditions = std::mem::take(&mut chunk.conditions);
    let mut model = Model::new(&plant.parameters, &chunk, &conditions);
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
        chunk = Chunk::next(&mut rows, source, false)?;
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

/// The rows of a log: a CSV as it is read, or a recording that was read as a whole.
enum Rows<R: Read> {
    Csv(Box<Reader<R>>, DefectCounter),
    Recording(Option<Box<Recording>>, Defects),
}

impl<R: Read> Rows<R> {
    /// Returns the next rows, none at the end. A recording comes at once; a CSV file with measured signals begins with as many rows as
    /// the search for the clock of the logger needs.
    fn next(&mut self, log: &str, is_first: bool) -> Result<Option<Recording>, Failure> {
        match self {
            Self::Csv(reader, counter) => {
                let is_measured = |column: &Column| MEASURED.contains(&&*column.name);
                let rows = match is_first && reader.columns().iter().any(is_measured) {
                    true => LogConditions::ROWS_MAX,
                    false => CHUNK_ROWS,
                };
                let rows = next_rows(reader, log, rows)?;
                if let Some(rows) = &rows {
                    counter.add(rows);
                }
                Ok(rows)
            }
            Self::Recording(recording, _) => Ok(recording.take().map(|recording| *recording)),
        }
    }

    /// What the rows so far lack.
    fn defects(self) -> Defects {
        match self {
            Self::Csv(reader, counter) => {
                let outside: Vec<_> = reader.out_of_bounds().collect();
                counter.finish(outside.iter().copied())
            }
            Self::Recording(_, defects) => defects,
        }
    }
}

/// The next `count` rows at most.
fn next_rows(
    reader: &mut Reader<impl Read>,
    log: &str,
    count: usize,
) -> Result<Option<Recording>, Failure> {
    let columns = reader.columns().to_vec();
    let mut times_s = Vec::with_capacity(CHUNK_ROWS);
    let mut samples = vec![Vec::with_capacity(CHUNK_ROWS); columns.len()];
    while times_s.len() < count
        && let Some(row) = reader.next_row()?
    {
        times_s.push(row.time_s);
        for (samples, &value) in samples.iter_mut().zip(row.values) {
            samples.push(value);
        }
    }
    if times_s.is_empty() {
        return Ok(None);
    }
    let mut recording = Recording::new(Provenance::from_source(log));
    let base = TimeBase::new(times_s).expect("the reader refuses times that do not increase");
    let base = recording.add_time_base(base);
    for (column, samples) in columns.into_iter().zip(samples) {
        recording
            .add_signal(column.name, column.unit, base, samples)
            .expect("the reader refuses names that are taken or impossible");
    }
    Ok(Some(recording))
}

/// The plant on its way through the log.
struct Model<'a> {
    replay: Replay,
    conditions: &'a LogConditions,
    sampling: CurrentSampling,
    start_s: Option<f64>,
    end_s: f64,
    rows: u64,
    held_commands: u64,
}

impl<'a> Model<'a> {
    fn new(parameters: &PlantParameters, begin: &Chunk, conditions: &'a LogConditions) -> Self {
        let step_s = begin.median_step_s.unwrap_or(f64::INFINITY);
        let sampling = conditions.sampling(step_s, parameters);
        let mut replay = Replay::new(parameters, sampling, Tolerance::default());
        if let Some(pressure) = begin.pressure {
            replay.begin_showing(pressure);
        }
        Self {
            replay,
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
        let index = self.rows as usize;
        self.rows += 1;
        self.held_commands += u64::from(input.command.is_none());
        let time_ns = ((time_s - start_s) * 1e9).round() as u64;
        let input = ReplayInput {
            time_ns,
            issued_ns: time_ns,
            ..input
        };
        let row = self
            .replay
            .row(self.conditions.on_ecu_time(index, input, time_ns));
        match self.replay.simulator().is_given_up() {
            true => Err(ReplayError::given_up(time_ns)),
            false => Ok(row),
        }
    }
}

/// Some rows of the log: instants and commands. Empty at the end.
#[derive(Default)]
struct Chunk {
    rows: Vec<(f64, ReplayInput)>,
    median_step_s: Option<f64>,
    /// Chamber pressure that a plant begins with which nothing else could have filled (Pa abs).
    pressure: Option<f64>,
    /// Of the first rows, what they tell of how the log was made.
    conditions: LogConditions,
}

impl Chunk {
    /// The next rows. They pass through a recording, so that the library reads and refuses signals as in a whole log.
    fn next(
        rows: &mut Rows<impl Read>,
        (parameters, log): (&PlantParameters, &str),
        is_first: bool,
    ) -> Result<Self, Failure> {
        let Some(recording) = rows.next(log, is_first)? else {
            return Ok(Self::default());
        };
        let failed = |error| match error {
            // These name the log themselves.
            ReplayError::MissingSignal(_) | ReplayError::NoCommand { .. } => {
                Failure::Compare(CompareError::Replay(error))
            }
            error => Failure::Replay {
                path: PathBuf::from(log),
                error,
            },
        };
        // A command may be missing throughout a chunk, but not from the beginning.
        let inputs = match is_first {
            true => inputs(parameters, &recording),
            false => inputs_of_part(parameters, &recording),
        };
        let (base, inputs) = inputs.map_err(failed)?;
        Ok(Self {
            rows: base.times_s().iter().copied().zip(inputs).collect(),
            median_step_s: base.sampling().median_step_s,
            pressure: initial_pressure(parameters, &recording).map_err(failed)?,
            conditions: match is_first {
                true => find_conditions(parameters, &recording),
                false => LogConditions::default(),
            },
        })
    }
}

fn provenance(log: &str, plant: &NamedPlant) -> Provenance {
    let mut provenance =
        Provenance::from_source(format!("model of {log}")).with_note("plant", &plant.name);
    provenance.producer = Some(concat!("retarder ", env!("CARGO_PKG_VERSION")).to_owned());
    provenance
}

/// The columns that a plant has, and their places in a row.
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

/// Digits beyond the tolerance of the solver are noise: 0.1 Pa, 0.1 µA, 1 nm and 0.1 mK are written.
fn decimals() -> Decimals {
    Decimals::shortest()
        .with(Unit::BarGauge, 6)
        .with(Unit::Milliampere, 4)
        .with(Unit::Millimetre, 6)
        .with(Unit::Kelvin, 4)
}
