//! Result of a comparison, as in its JSON.

use plant_sim::logger_clock::LoggerClock;
use recording::{Recording, Samples, Unit};
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use crate::bins::Bins;

mod log_defects;

pub use log_defects::{LogDefects, LogGap, LogRepeat, LogSpike, MissingCells};

/// Name and version of the JSON format.
pub const COMPARISON_SCHEMA: &str = "retarder.comparison/2";

/// Sign convention of every residual, bias and worst error.
pub const RESIDUAL_SIGN: &str = "residual = measured - modelled";

/// Comparison of a model with a measurement.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Comparison {
    /// Name and version of this format, `retarder.comparison/2`.
    pub schema: String,
    /// Source of the log.
    pub log: String,
    /// Sign of every residual, bias and worst error: measured minus modelled.
    pub sign: String,
    /// Number of instants of the log.
    pub samples: usize,
    /// Time from the first to the last instant (s).
    pub duration_s: f64,
    /// Median distance of two instants (s); null for a single one.
    pub sample_interval_s: Option<f64>,
    /// Meaning of the logged currents.
    pub current_sampling: CurrentMeaning,
    /// Number of instants at which a command was missing and the last one stayed in force.
    pub held_commands: usize,
    /// Start of the simulation.
    pub start: Start,
    /// Clock of the logger; absent where the rows are samples of the ECU.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub clock: Option<FoundClock>,
    /// Temperature of the gas when the log begins; absent where the chamber is empty or the gas has the temperature of its wall.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_gas: Option<FoundStart>,
    /// Predictor of the one-step-ahead prediction; null where no chamber pressure was logged.
    pub predictor: Option<Predictor>,
    /// Every signal that log and model have in common, chamber pressure first.
    pub signals: Vec<SignalComparison>,
    /// Signals with a name that the model knows, which could not be compared.
    pub not_compared: Vec<NotCompared>,
    /// Gaps and missing cells of the log; absent where it has none.
    #[serde(default, skip_serializing_if = "LogDefects::is_empty")]
    pub defects: LogDefects,
    /// Properties of the log that probably differ from their declaration.
    #[serde(default)]
    pub warnings: Vec<Warning>,
    /// Verdict: whether the model is within tolerance.
    pub verdict: Verdict,
    /// Time series for plots; not part of the JSON.
    #[serde(skip)]
    pub traces: Traces,
}

impl Comparison {
    /// Returns the JSON Schema of a comparison.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }
}

/// Time series of the compared signals on the instants of the log.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Traces {
    /// Measurement in the units of the model, NaN where it is missing or in a gap. A signal that the log already has in this form is shared
    /// with it.
    pub measured: Recording,
    /// Free-run simulation: the model driven by the commands alone.
    pub free_run: Recording,
    /// One-step-ahead prediction: the model corrected by the measured pressure; empty where none was logged.
    pub one_step_ahead: Recording,
    /// Bin of each instant, for each compared signal and each dimension.
    pub placements: Vec<Placement>,
}

impl Traces {
    /// Returns measured minus free-run simulation of the signal `name`; none where it is not compared.
    pub fn free_run_residual(&self, name: &str) -> Option<Residual<'_>> {
        self.residual(&self.free_run, name)
    }

    /// Returns measured minus one-step-ahead prediction of the signal `name`: the innovations. None where it is not compared, or where no
    /// pressure was logged.
    pub fn one_step_ahead_residual(&self, name: &str) -> Option<Residual<'_>> {
        self.residual(&self.one_step_ahead, name)
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

/// Returns the unit of the difference of two values in a unit of the model.
pub(crate) fn error_unit(unit: Unit) -> Unit {
    match unit {
        Unit::BarGauge => Unit::BarDifference,
        unit => unit,
    }
}

/// Measured minus modelled, sample by sample. It is computed when read, since a copy would take as much memory as either signal.
#[derive(Debug, Clone, Copy)]
pub struct Residual<'a> {
    measured: &'a [f64],
    modelled: &'a [f64],
}

impl Samples for Residual<'_> {
    fn count(&self) -> usize {
        self.len()
    }

    fn value(&self, row: usize) -> f64 {
        self.at(row)
    }
}

impl<'a> Residual<'a> {
    /// Returns the residual of two signals with one value for each instant.
    pub(crate) fn new(measured: &'a [f64], modelled: &'a [f64]) -> Self {
        Self { measured, modelled }
    }

    /// Returns the number of samples, missing ones included.
    pub fn len(&self) -> usize {
        self.measured.len().min(self.modelled.len())
    }

    /// Returns whether there is no sample.
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

/// Bin of each instant in one dimension.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Placement {
    /// Compared signal.
    pub signal: String,
    /// Stable name, as in [`RegimeShares`], or [`ERROR_MAP`].
    pub dimension: String,
    /// Labels of all bins, those without samples included.
    pub labels: Vec<String>,
    /// For each instant of the log, an index into `labels`.
    pub bin_of: Bins,
}

/// Meaning of a current sample.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum CurrentMeaning {
    /// Mean over the interval that ends at the sample.
    MeanOfInterval,
    /// Instantaneous value.
    Instant,
}

/// Start of the simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Start {
    /// Origin of the initial chamber pressure.
    pub from: StartFrom,
    /// Chamber pressure at the first instant (bar gauge).
    pub pressure_bar_gauge: f64,
    /// Origin of the initial pressure in words.
    pub statement: String,
}

/// Origin of the initial chamber pressure.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StartFrom {
    /// Ambient pressure: the measurement begins there, or is not available.
    Rest,
    /// The measured pressure, because it is away from ambient.
    Measurement,
}

/// Clock of a logger, as found.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FoundClock {
    /// Source of the log.
    pub log: String,
    /// Time from the ECU sample before the first row to that row (s).
    pub phase_s: f64,
    /// Drift (ppm): time that the ECU counts beyond the logger's, per logged time.
    pub drift_ppm: f64,
    /// Origin of the clock.
    #[serde(default)]
    pub source: ClockSource,
    /// Least and largest drift (ppm) that the logged commands admit; present where the plant was not fitted and the commands do not
    /// determine the drift.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub admitted_drifts_ppm: Option<(f64, f64)>,
    /// The clock in words, without a full stop.
    #[serde(default)]
    pub statement: String,
}

/// Origin of the found clock of a logger.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ClockSource {
    /// The instants at which the logged commands change.
    Commands,
    /// The model: this clock leaves the smallest error.
    #[default]
    Model,
}

impl FoundClock {
    /// Returns the `clock` of the logger of `log`, relative to an ECU that samples every `sample_time_s`.
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
    /// The state of the gas in words, without a full stop.
    #[serde(default)]
    pub statement: String,
}

/// Temperature difference of gas and wall below which the gas is not reported (K).
const WARM_K: f64 = 1.0;

impl FoundStart {
    /// Returns the state of the gas in the chamber when `log` begins: `excess_k` warmer than the wall, whose temperature it approaches
    /// within `cooling_s`.
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

    /// Returns whether the temperature differs enough from the wall's to be reported.
    #[must_use]
    pub fn is_warm(&self) -> bool {
        self.excess_k.abs() > WARM_K
    }
}

/// One-step-ahead predictor: after each sample, pressure += gain * (measured - predicted).
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Predictor {
    /// Corrected signal.
    pub signal: String,
    /// Gain L, 0 to 1; the memory of the predictor is about 1/L samples.
    pub gain: f64,
    /// Rms of the innovations of a perfect model over the noise floor: sqrt(2 / (2 - L)).
    pub innovation_floor_ratio: f64,
}

/// Signal that is excluded from the comparison.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NotCompared {
    /// Its name.
    pub name: String,
    /// Reason, and what to do.
    pub reason: String,
}

/// Reason to doubt a log before its model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Warning {
    /// Kind of the doubt.
    pub kind: WarningKind,
    /// Observation, possible cause and what to do, in one sentence.
    pub statement: String,
}

/// Kind of a warning.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum WarningKind {
    /// The pressure falls while only the fill valve is commanded, and rises while only the vent valve is.
    SwappedValves,
    /// A pressure declared as gauge begins where an absolute one does at rest.
    AbsolutePressure,
    /// The pressure exceeds the supply by more than any sensor error.
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
    /// Instants without a measured value; they are left out, not filled in.
    pub missing: usize,
    /// Noise floor of the measurement.
    pub noise_floor: NoiseFloor,
    /// Error of the free-run simulation, driven by the commands alone.
    pub free_run: ErrorSummary,
    /// Error of the one-step-ahead prediction; null where no pressure was logged.
    pub one_step_ahead: Option<ErrorSummary>,
    /// Lag of the measurement behind the model; null where nothing changes. A hint only.
    pub time_offset: Option<TimeOffset>,
    /// Largest free-run rms that is within tolerance; null where neither noise floor nor tolerance is known.
    pub limit: Option<f64>,
    /// Origin of the limit.
    pub limit_from: LimitFrom,
    /// Whether the free-run rms is within the limit; null where there is no limit.
    pub holds: Option<bool>,
    /// Shares of the excess error, one dimension at a time.
    pub regimes: Vec<RegimeShares>,
    /// Error over duty cycle and pressure.
    pub error_map: ErrorMap,
    /// Location of most of the excess, in one sentence.
    pub finding: Finding,
}

/// Origin of a limit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LimitFrom {
    /// Allowed multiple of the noise floor.
    NoiseFloor,
    /// Tolerance given for this signal.
    Tolerance,
    /// No limit is known.
    Unknown,
}

/// Standard deviation of the measurement noise, estimated without the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct NoiseFloor {
    /// Standard deviation in the unit of the signal; null where it is unknown.
    pub value: Option<f64>,
    /// Step between neighbouring values of the log; null where none is visible.
    pub quantisation_step: Option<f64>,
    /// Number of quiet pieces of the log that were used.
    pub pieces: usize,
    /// Number of samples in the pieces.
    pub samples: usize,
    /// Method of the estimation, or what to do.
    pub statement: String,
}

/// Error over the whole log.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ErrorSummary {
    /// Root mean square.
    pub rms: f64,
    /// Rms of a perfect model; null where the noise floor is unknown.
    pub expected_rms: Option<f64>,
    /// Rms over the noise floor.
    pub rms_in_noise: Option<f64>,
    /// Error of largest magnitude.
    pub worst: f64,
    /// Its magnitude over the noise floor.
    pub worst_in_noise: Option<f64>,
    /// Its instant (s).
    pub worst_time_s: f64,
    /// Mean error.
    pub bias: f64,
    /// 100 (1 - |measured - modelled| / |measured - mean|) (%); null for a constant measurement.
    pub fit_pct: Option<f64>,
    /// Autocorrelation time of the error (samples): 1 for white noise.
    pub autocorrelation_time_samples: Option<f64>,
    /// Test for whiteness; free-run simulation only, since the innovations of a perfect model are not white.
    pub whiteness: Option<LjungBox>,
    /// Correlation with each commanded duty cycle.
    pub input_correlation: Vec<InputCorrelation>,
}

/// Ljung-Box test for whiteness of the residual.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LjungBox {
    /// Number of lags in the sum.
    pub lags: usize,
    /// Statistic Q; for white noise chi-squared with `lags` degrees of freedom.
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
    /// Number of samples by which the input is earlier than the residual.
    pub lag_samples: usize,
    /// Magnitude that the largest of all lags exceeds by chance in 1 % of the cases.
    pub bound_99: f64,
}

/// Time by which the measurement lags the model.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TimeOffset {
    /// Lag (ms); positive where the measurement is late.
    pub lag_ms: f64,
    /// Correlation of the changes without shift.
    pub correlation_unshifted: f64,
    /// Correlation of the changes with the model delayed by `lag_ms`.
    pub correlation_shifted: f64,
    /// Share of the mismatch of the changes, 1 - correlation², that the shift removes; near 0 the lag is an artefact of another error.
    pub mismatch_explained: f64,
    /// Whether the best lag is the end of the searched range.
    pub at_search_limit: bool,
    /// The time offset in words.
    pub statement: String,
}

/// Shares of the excess error in the bins of one dimension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegimeShares {
    /// Stable name, such as `valve_state`.
    pub dimension: String,
    /// Title for people.
    pub title: String,
    /// Bins that have samples, in their natural order.
    pub bins: Vec<RegimeBin>,
}

/// One bin of a dimension.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegimeBin {
    /// Label of the bin.
    pub label: String,
    /// Number of compared samples in the bin.
    pub samples: usize,
    /// Their share of all compared samples, 0 to 1.
    pub sample_share: f64,
    /// Error of the one-step-ahead prediction: local, carries no history into other regimes.
    pub one_step_ahead: Option<BinError>,
    /// Error of the free-run simulation: carries history.
    pub free_run: BinError,
}

/// Error in a bin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BinError {
    /// Share of the excess, sum of e² - floor² over that of all samples; scatters below 0 in a bin without excess.
    /// Null where the whole excess is within chance.
    pub excess_share: Option<f64>,
    /// Mean error.
    pub bias: f64,
    /// Root mean square error.
    pub rms: f64,
}

/// Error over duty cycle of the acting valve and chamber pressure.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ErrorMap {
    /// Mapped error.
    pub horizon: Horizon,
    /// Labels of the rows: full venting first, both shut in the middle, full filling last.
    pub duty_bands: Vec<String>,
    /// Labels of the columns, by rising pressure.
    pub pressure_bands: Vec<String>,
    /// Cells that have samples.
    pub cells: Vec<MapCell>,
}

/// Cell of the error map.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapCell {
    /// Row: index into the duty bands.
    pub duty_band: usize,
    /// Column: index into the pressure bands.
    pub pressure_band: usize,
    /// Number of compared samples.
    pub samples: usize,
    /// Error in the cell.
    pub error: BinError,
}

/// Prediction horizon of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Horizon {
    /// Free-run simulation, from the commands alone.
    FreeRun,
    /// One-step-ahead prediction, corrected by the measured pressure.
    OneStepAhead,
}

/// Location of most of the excess.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Finding {
    /// Searched error.
    pub horizon: Horizon,
    /// Regime in words; null where there is no excess to place.
    pub regime: Option<String>,
    /// Share of the excess in it.
    pub excess_share: Option<f64>,
    /// Share of the samples in it, 0 to 1.
    pub sample_share: Option<f64>,
    /// Mean error in it.
    pub bias: Option<f64>,
    /// The finding in one sentence.
    pub sentence: String,
}

/// Verdict of a comparison: whether the model is within tolerance.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Verdict {
    /// Whether every compared signal is within its limit.
    pub holds: bool,
    /// Signals beyond their limit.
    pub failing: Vec<String>,
    /// Signals without a limit: if no other fails, the verdict is open.
    pub undecided: Vec<String>,
    /// Rule of the verdict in words.
    pub rule: String,
}
