//! What a comparison says, as it stands in its JSON.

use plant_sim::logger_clock::LoggerClock;
use recording::{Recording, Unit};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::bins::Bins;

/// Name and version of the JSON format.
pub const COMPARISON_SCHEMA: &str = "retarder.comparison/1";

/// The one sign convention of every residual, bias and worst error.
pub const RESIDUAL_SIGN: &str = "residual = measured - modelled";

/// Model against measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// Name and version of this format, `retarder.comparison/1`.
    pub schema: String,
    /// Source of the log.
    pub log: String,
    /// Sign of every residual, bias and worst error: measured minus modelled.
    pub sign: String,
    /// Instants of the log.
    pub samples: usize,
    /// From the first to the last instant in s.
    pub duration_s: f64,
    /// Median distance of two instants in s; null for a single one.
    pub sample_interval_s: Option<f64>,
    /// How the logged currents are meant.
    pub current_sampling: CurrentMeaning,
    /// Instants at which a command was missing and the last one was held.
    pub held_commands: usize,
    /// Where the model began.
    pub start: Start,
    /// Clock of the logger; absent where the rows are samples of the ECU.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock: Option<FoundClock>,
    /// Temperature of the gas when the log begins; absent where the chamber is empty or the gas as warm as its wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_gas: Option<FoundStart>,
    /// How the short-horizon error was made; null where no chamber pressure was logged.
    pub predictor: Option<Predictor>,
    /// Every signal that both sides have, chamber pressure first.
    pub signals: Vec<SignalComparison>,
    /// Signals with a name that the model knows, which could not be compared.
    pub not_compared: Vec<NotCompared>,
    /// Gaps and missing cells of the log; absent where it has none.
    #[serde(default, skip_serializing_if = "LogDefects::is_empty")]
    pub defects: LogDefects,
    /// What in the log probably is not what it is declared to be.
    #[serde(default)]
    pub warnings: Vec<Warning>,
    /// Whether the model holds.
    pub verdict: Verdict,
    /// Courses for plots; not part of the JSON.
    #[serde(skip)]
    pub traces: Traces,
}

impl Comparison {
    /// The JSON Schema of a comparison.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }
}

/// Time series of the compared signals on the instants of the log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Traces {
    /// The measurement in the units of the model, NaN where it is missing or in a gap. A signal of the log that is this
    /// already is shared with it.
    pub measured: Recording,
    /// The model driven by the commands alone.
    pub free_run: Recording,
    /// The model corrected by the measured pressure; empty where none was logged.
    pub short_horizon: Recording,
    /// The bin of each instant, for each compared signal and each way to sort.
    pub placements: Vec<Placement>,
}

impl Traces {
    /// Returns measured minus free run of the signal `name`; none where it is not compared.
    pub fn free_run_residual(&self, name: &str) -> Option<Residual<'_>> {
        self.residual(&self.free_run, name)
    }

    /// Returns measured minus short-horizon prediction of the signal `name`: the innovations. None where it is not
    /// compared, or where no pressure was logged.
    pub fn short_horizon_residual(&self, name: &str) -> Option<Residual<'_>> {
        self.residual(&self.short_horizon, name)
    }

    fn residual<'a>(&'a self, run: &'a Recording, name: &str) -> Option<Residual<'a>> {
        let measured = self.measured.signal(name)?;
        Some(Residual {
            measured: measured.values_or_nan(),
            modelled: run.signal(name)?.values_or_nan(),
        })
    }

    /// Returns the unit of a difference of two values of the signal `name`; none where it is not compared.
    pub fn residual_unit(&self, name: &str) -> Option<Unit> {
        Some(error_unit(self.measured.signal(name)?.unit()))
    }
}

/// The unit of the difference of two values in a unit of the model.
pub(crate) fn error_unit(unit: Unit) -> Unit {
    match unit {
        Unit::BarGauge => Unit::BarDifference,
        unit => unit,
    }
}

/// Measured minus modelled, sample by sample: computed where it is read, since it would take as much memory as either.
#[derive(Debug, Clone, Copy)]
pub struct Residual<'a> {
    measured: &'a [f64],
    modelled: &'a [f64],
}

impl<'a> Residual<'a> {
    /// Both have one value for each instant.
    pub(crate) fn new(measured: &'a [f64], modelled: &'a [f64]) -> Self {
        Self { measured, modelled }
    }

    /// Returns the number of samples, missing ones included.
    pub fn len(&self) -> usize {
        self.measured.len().min(self.modelled.len())
    }

    /// Whether there is no sample.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the value at instant `index`, NaN where the measurement is missing.
    ///
    /// # Panics
    /// If there is no such instant.
    pub fn at(&self, index: usize) -> f64 {
        self.measured[index] - self.modelled[index]
    }

    /// Returns all values in turn, NaN where the measurement is missing.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = f64> + Clone + 'a {
        let pairs = self.measured.iter().zip(self.modelled);
        pairs.map(|(measured, modelled)| measured - modelled)
    }

    /// Returns the residual at the instants of `range`.
    ///
    /// # Panics
    /// If there is no such instant.
    pub fn part(&self, range: std::ops::Range<usize>) -> Self {
        Self::new(&self.measured[range.clone()], &self.modelled[range])
    }
}

/// Dimension of the [`Placement`] into the cells of [`ErrorMap`]; labels are `duty band, pressure band`.
pub const ERROR_MAP: &str = "error_map";

/// The bin of each instant in one dimension.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placement {
    /// The compared signal.
    pub signal: String,
    /// Stable name, as in [`RegimeShares`], or [`ERROR_MAP`].
    pub dimension: String,
    /// Labels of all bins, those without samples included.
    pub labels: Vec<String>,
    /// For each instant of the log, an index into `labels`.
    pub bin_of: Bins,
}

/// How a current sample is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CurrentMeaning {
    /// Mean over the interval that ends at the sample.
    MeanOfInterval,
    /// Value of the instant.
    Instant,
}

/// Where the model began.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// At rest or at the measured pressure.
    pub from: StartFrom,
    /// Chamber pressure at the first instant in bar gauge.
    pub pressure_bar_gauge: f64,
    /// The same in words.
    pub statement: String,
}

/// Origin of the initial chamber pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StartFrom {
    /// Ambient pressure: the measurement begins there, or says nothing.
    Rest,
    /// The measured pressure, because it is away from ambient.
    Measurement,
}

/// The clock of a logger, as it was found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FoundClock {
    /// Source of the log.
    pub log: String,
    /// Time from the ECU sample before the first row to that row (s).
    pub phase_s: f64,
    /// Time that the ECU counts beyond the logger's, per logged time (ppm).
    pub drift_ppm: f64,
    /// What it was found from.
    #[serde(default)]
    pub source: ClockSource,
    /// Least and largest drift (ppm) that the logged commands admit, where the plant was not fitted and they leave it open.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub admitted_drifts_ppm: Option<(f64, f64)>,
    /// All of it in words, without a full stop.
    #[serde(default)]
    pub statement: String,
}

/// What the clock of a logger was found from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClockSource {
    /// The instants at which the logged commands change.
    Commands,
    /// The model: this clock leaves the least error.
    #[default]
    Model,
}

impl FoundClock {
    /// The `clock` of the logger of `log`, beside an ECU that samples every `sample_time_s`.
    pub(crate) fn new(
        log: &str,
        clock: LoggerClock,
        sample_time_s: f64,
        (source, admitted_drifts_ppm): (ClockSource, Option<(f64, f64)>),
    ) -> Self {
        let phase_s = clock.phase_s.rem_euclid(sample_time_s);
        let drift = |drift_ppm: f64| {
            let side = if drift_ppm > 0.0 { "slow" } else { "fast" };
            format!("{:.1} ppm {side}", drift_ppm.abs())
        };
        let runs = match admitted_drifts_ppm {
            None => format!("the clock runs {}", drift(clock.drift_ppm)),
            Some((least, most)) => format!(
                "the clock runs {} to {}: only a fitted plant narrows this",
                drift(least),
                drift(most)
            ),
        };
        let statement = format!(
            "clock of the logger: the first row lies {:.2} ms behind a sample of the ECU, and {runs}; found {}",
            1e3 * phase_s,
            match source {
                ClockSource::Commands => "from the logged commands",
                ClockSource::Model => "with the model",
            },
        );
        Self {
            log: log.to_owned(),
            phase_s,
            drift_ppm: clock.drift_ppm,
            source,
            admitted_drifts_ppm,
            statement,
        }
    }
}

/// State of the gas in the chamber when a log begins.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FoundStart {
    /// Source of the log.
    pub log: String,
    /// Temperature of the gas above that of the wall (K).
    pub excess_k: f64,
    /// Time constant with which the gas takes the temperature of the wall (s).
    pub cooling_s: f64,
    /// All of it in words, without a full stop.
    #[serde(default)]
    pub statement: String,
}

/// Temperatures of the gas that differ less than this from the wall's are not worth a sentence (K).
const WARM_K: f64 = 1.0;

impl FoundStart {
    /// The gas in the chamber when `log` begins: `excess_k` warmer than the wall, whose temperature it takes within `cooling_s`.
    pub(crate) fn new(log: &str, excess_k: f64, cooling_s: f64) -> Self {
        Self {
            log: log.to_owned(),
            excess_k,
            cooling_s,
            statement: format!(
                "the gas in the chamber was {:.1} K {} than the wall at first and took its temperature with a time constant of {cooling_s:.2} s",
                excess_k.abs(),
                if excess_k > 0.0 { "warmer" } else { "colder" },
            ),
        }
    }

    /// Whether the temperature differs so much from the wall's that it is worth a sentence.
    #[must_use]
    pub fn is_warm(&self) -> bool {
        self.excess_k.abs() > WARM_K
    }
}

/// The short-horizon predictor: after each sample, pressure += gain * (measured - predicted).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Predictor {
    /// The corrected signal.
    pub signal: String,
    /// Gain L, 0 to 1; the prediction looks about 1/L samples ahead.
    pub gain: f64,
    /// Rms of the innovations of a perfect model over the noise floor: sqrt(2 / (2 - L)).
    pub innovation_floor_ratio: f64,
}

/// A signal that stays out of the comparison.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NotCompared {
    /// Its name.
    pub name: String,
    /// Why, and what to do.
    pub reason: String,
}

/// What a log lacks: pauses, cells without a value, and where the model began again.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogDefects {
    /// Times for which the log does not say what was commanded, in order; they are in no error.
    pub gaps: Vec<LogGap>,
    /// Signals with missing cells; these are in no error.
    pub missing: Vec<MissingCells>,
    /// All of it in words, one sentence without a full stop for each.
    pub sentences: Vec<String>,
}

/// A time for which the log does not say what was commanded.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogGap {
    /// Last instant before it in s, in the time of the log.
    pub start_s: f64,
    /// First instant behind it in s.
    pub end_s: f64,
    /// Samples in it and behind it that are in no error: commands need a delay, a PWM period and 50 ms to be in force.
    pub samples: usize,
    /// Pressure in bar gauge at which the model began again behind it; null where none was measured.
    pub restart_bar_gauge: Option<f64>,
}

/// Cells of a signal without a value.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MissingCells {
    /// The signal.
    pub signal: String,
    /// Number of such cells.
    pub cells: usize,
    /// How many of them held a value outside the hard bounds of the quantity.
    pub out_of_bounds: u64,
}

/// A reason to doubt a log before its model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Warning {
    /// What is doubted.
    pub kind: WarningKind,
    /// What was seen, what it may be and what to do, in one sentence.
    pub statement: String,
}

/// What a warning doubts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WarningKind {
    /// The pressure falls while only the fill valve is commanded, and rises while only the vent valve is.
    SwappedValves,
    /// A pressure declared as gauge begins where an absolute one does at rest.
    AbsolutePressure,
    /// The pressure is further above the supply than any sensor is wrong.
    PressureAboveSupply,
    /// A signal has a name that the model does not know, and may be one that the log lacks.
    UnknownSignal,
    /// Rows and commands do not line up in time.
    Misaligned,
}

/// One signal, measured and modelled.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SignalComparison {
    /// Its name.
    pub name: String,
    /// Unit of every error here: `bar` for a pressure, `mA` for a current.
    pub unit: String,
    /// Instants with a measured value.
    pub compared: usize,
    /// Instants without; they are left out, not filled in.
    pub missing: usize,
    /// What the measurement itself scatters.
    pub noise_floor: NoiseFloor,
    /// Error of the model driven by the commands alone.
    pub free_run: ErrorSummary,
    /// Error of the prediction a few samples ahead; null where no pressure was logged.
    pub short_horizon: Option<ErrorSummary>,
    /// By how much the measurement lags the model; null where nothing changes. A hint only.
    pub time_offset: Option<TimeOffset>,
    /// Largest free-run rms that holds; null where neither noise floor nor tolerance is known.
    pub limit: Option<f64>,
    /// Where the limit comes from.
    pub limit_from: LimitFrom,
    /// Whether the free-run rms is within the limit; null where there is no limit.
    pub holds: Option<bool>,
    /// Shares of the excess error, one dimension at a time.
    pub regimes: Vec<RegimeShares>,
    /// The error over duty cycle and pressure.
    pub error_map: ErrorMap,
    /// Where most of the excess is, in one sentence.
    pub finding: Finding,
}

/// Origin of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitFrom {
    /// Allowed multiples of the noise floor.
    NoiseFloor,
    /// A tolerance given for this signal.
    Tolerance,
    /// Nowhere.
    Unknown,
}

/// Standard deviation of the measurement noise, estimated without the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoiseFloor {
    /// Standard deviation in the unit of the signal; null where it is unknown.
    pub value: Option<f64>,
    /// Step between neighbouring values of the log; null where none is seen.
    pub quantisation_step: Option<f64>,
    /// Quiet pieces of the log that were used.
    pub pieces: usize,
    /// Samples in them.
    pub samples: usize,
    /// How it was estimated, or what to do.
    pub statement: String,
}

/// An error over the whole log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ErrorSummary {
    /// Root mean square.
    pub rms: f64,
    /// Rms a perfect model would have here; null where the noise floor is unknown.
    pub expected_rms: Option<f64>,
    /// Rms over the noise floor.
    pub rms_in_noise: Option<f64>,
    /// The error of largest magnitude.
    pub worst: f64,
    /// Its magnitude over the noise floor.
    pub worst_in_noise: Option<f64>,
    /// Its instant in s.
    pub worst_time_s: f64,
    /// Mean error.
    pub bias: f64,
    /// 100 (1 - |measured - modelled| / |measured - mean|) in %; null for a constant measurement.
    pub fit_pct: Option<f64>,
    /// Samples over which the error remembers: 1 for white noise.
    pub autocorrelation_time_samples: Option<f64>,
    /// Test for whiteness; free run only, since the innovations of a perfect model are not white.
    pub whiteness: Option<LjungBox>,
    /// Correlation with each commanded duty cycle.
    pub input_correlation: Vec<InputCorrelation>,
}

/// Ljung-Box test: is the residual white?
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LjungBox {
    /// Lags in the sum.
    pub lags: usize,
    /// Q, chi-squared with as many degrees of freedom for white noise.
    pub q: f64,
    /// Probability of a Q at least as large for white noise.
    pub p_value: f64,
}

/// Largest correlation of the residual with an earlier input.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct InputCorrelation {
    /// Name of the input.
    pub input: String,
    /// Correlation coefficient of largest magnitude.
    pub rho: f64,
    /// By how many samples the input is earlier than the residual.
    pub lag_samples: usize,
    /// Magnitude that the largest of all lags exceeds by chance in 1 % of the cases.
    pub bound_99: f64,
}

/// Time by which the measurement lags the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeOffset {
    /// Lag in ms; positive where the measurement is late.
    pub lag_ms: f64,
    /// Correlation of the changes as they are.
    pub correlation_unshifted: f64,
    /// Correlation of the changes with the model late by `lag_ms`.
    pub correlation_shifted: f64,
    /// Share of the mismatch of the changes, 1 - correlation², that the shift takes away; near 0 the lag is an
    /// artefact of another error.
    pub mismatch_explained: f64,
    /// True if the best lag is the end of the searched range.
    pub at_search_limit: bool,
    /// The same in words.
    pub statement: String,
}

/// Shares of the excess error in the bins of one dimension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegimeShares {
    /// Stable name, such as `valve_state`.
    pub dimension: String,
    /// What it is, for people.
    pub title: String,
    /// Bins that have samples, in their natural order.
    pub bins: Vec<RegimeBin>,
}

/// One bin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegimeBin {
    /// What the bin holds.
    pub label: String,
    /// Compared samples.
    pub samples: usize,
    /// Their share of all compared samples, 0 to 1.
    pub sample_share: f64,
    /// Short-horizon error: local, does not carry history into innocent regimes.
    pub short_horizon: Option<BinError>,
    /// Free-run error: carries history.
    pub free_run: BinError,
}

/// The error in a bin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BinError {
    /// Share of the excess, sum of e² - floor² over that of all samples; scatters below 0 in an innocent bin.
    /// Null where the whole excess is within chance.
    pub excess_share: Option<f64>,
    /// Mean error.
    pub bias: f64,
    /// Root mean square error.
    pub rms: f64,
}

/// The error over duty cycle of the acting valve and chamber pressure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ErrorMap {
    /// Which error is mapped.
    pub horizon: Horizon,
    /// Labels of the rows: full venting first, both shut in the middle, full filling last.
    pub duty_bands: Vec<String>,
    /// Labels of the columns, rising pressure.
    pub pressure_bands: Vec<String>,
    /// Cells that have samples.
    pub cells: Vec<MapCell>,
}

/// One cell of the error map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapCell {
    /// Row: index into the duty bands.
    pub duty_band: usize,
    /// Column: index into the pressure bands.
    pub pressure_band: usize,
    /// Compared samples.
    pub samples: usize,
    /// The error there.
    pub error: BinError,
}

/// How far ahead the model looks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Horizon {
    /// From the commands alone.
    FreeRun,
    /// A few samples, corrected by the measured pressure.
    ShortHorizon,
}

/// Where most of the excess is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Finding {
    /// Which error was searched.
    pub horizon: Horizon,
    /// The regime in words; null where there is no excess to place.
    pub regime: Option<String>,
    /// Share of the excess in it.
    pub excess_share: Option<f64>,
    /// Share of the samples in it, 0 to 1.
    pub sample_share: Option<f64>,
    /// Mean error in it.
    pub bias: Option<f64>,
    /// All of it in one sentence.
    pub sentence: String,
}

/// Whether the model holds.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Verdict {
    /// True if every compared signal is within its limit.
    pub holds: bool,
    /// Signals beyond their limit.
    pub failing: Vec<String>,
    /// Signals without a limit: if none fails, the verdict is open.
    pub undecided: Vec<String>,
    /// The rule in words.
    pub rule: String,
}
