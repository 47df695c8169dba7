//! The comparison, put together.

use std::collections::BTreeMap;

use plant_sim::parameters::PA_PER_BAR;
use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::{CurrentSampling, PLUNGER_SIGNAL, ROW_SIGNALS};
use plant_sim::{PlantParameters, Tolerance};
use recording::{Recording, TimeBase, Unit};

use crate::commands::{Commands, DUTIES};
use crate::error::CompareError;
use crate::metrics::{mean, present, residual};
use crate::noise_floor::{Floor, Quiet, noise_floor};
use crate::offset::{FineCourse, time_offset};
use crate::regime::{Excess, Features, error_map, find, shares};
use crate::result::{
    COMPARISON_SCHEMA, Comparison, CurrentMeaning, Horizon, LimitFrom, NotCompared, Predictor,
    RESIDUAL_SIGN, SignalComparison, Start, StartFrom, Traces, Verdict,
};
use crate::run::{Columns, Setup};
use crate::summary::summary;

/// The measured signal that corrects the predictor.
const PRESSURE: &str = "p_ch";
/// What drives the model is no result of it.
const INPUTS: [&str; 3] = [DUTIES[FILL], DUTIES[VENT], "u_bat"];
/// A first pressure this close to ambient [bar] is a start at rest ...
const REST_BAR: f64 = 0.05;
/// ... and so is one within this many noise sigmas.
const REST_SIGMAS: f64 = 5.0;
/// The time offset is taken from this many samples at most, which bounds memory on long logs.
const OFFSET_ROWS: usize = 12_000;

/// How to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareOptions {
    /// A signal holds if its free-run rms is at most this many times its noise floor; positive.
    pub allowed_noise_multiples: f64,
    /// Free-run rms that holds for a signal, instead of the multiple of its noise floor: name and value in the unit of
    /// its errors (bar, mA, mm); positive.
    pub tolerances: BTreeMap<String, f64>,
    /// Gain L of the short-horizon predictor, above 0 up to 1: it looks about 1/L samples ahead.
    pub predictor_gain: f64,
    /// Accuracy of the simulation.
    pub tolerance: Tolerance,
}

impl Default for CompareOptions {
    /// 1.5 noise floors, no tolerances, gain 0.3.
    fn default() -> Self {
        Self {
            allowed_noise_multiples: 1.5,
            tolerances: BTreeMap::new(),
            predictor_gain: 0.3,
            tolerance: Tolerance::default(),
        }
    }
}

/// A signal of the log in the unit of the model.
struct Measured {
    name: &'static str,
    /// Unit of the errors.
    error_unit: Unit,
    /// NaN where missing.
    values: Vec<f64>,
    floor: Floor,
}

/// Holds the model with `parameters` against `log`: simulates from the logged commands and tells, signal by signal,
/// how large the error is beside the noise of the measurement, and where it is.
///
/// Instants of the log are those of the model; nothing is resampled and no missing sample is filled in.
///
/// # Errors
/// [`CompareError`]: the log cannot drive the model, has no signal of the model, or an option is out of range.
pub fn compare(
    parameters: &PlantParameters,
    log: &Recording,
    options: &CompareOptions,
) -> Result<Comparison, CompareError> {
    options.check()?;
    let commands = Commands::new(parameters, log)?;
    let mut setup = Setup::new(parameters, log, options.tolerance)?;
    let (measured, not_compared) = measured_signals(parameters, log, &commands)?;
    options.check_tolerances(&measured)?;

    let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
    let (start, start_pressure) = start(parameters, pressure, &commands);
    setup.start_pressure = start_pressure;

    let free_run = setup.free_run();
    let no_pressure = vec![f64::NAN; commands.len()];
    let gain = if pressure.is_some() {
        options.predictor_gain
    } else {
        0.0
    };
    let (short_horizon, activities) =
        setup.predict(pressure.map_or(&no_pressure, |signal| &signal.values), gain);
    let memory = if gain > 0.0 {
        (1.0 / gain).ceil() as usize
    } else {
        1
    };
    let features = Features::new(parameters, &commands, &activities, memory);
    let (fine_times_s, fine_run) = setup.fine_run(OFFSET_ROWS);
    let predictor = pressure.map(|_| Predictor {
        signal: PRESSURE.to_owned(),
        gain,
        // An integrator corrected by L times white noise: the innovation has variance σ² 2 / (2 - L).
        innovation_floor_ratio: (2.0 / (2.0 - gain)).sqrt(),
    });

    let lab = Lab {
        options,
        commands: &commands,
        setup: &setup,
        features: &features,
        predictor: predictor.as_ref(),
        fine_times_s: &fine_times_s,
        fine_run: &fine_run,
    };
    let mut signals = Vec::new();
    let mut residuals = [Columns::default(), Columns::default()];
    for signal in &measured {
        let of = |run: &Columns| {
            run.get(signal.name)
                .map(|modelled| residual(&signal.values, modelled))
        };
        let free = of(&free_run).unwrap_or_default();
        let short = of(&short_horizon).filter(|_| predictor.is_some());
        signals.push(lab.compare_signal(signal, &free, short.as_deref()));
        residuals[0]
            .signals
            .push((signal.name, signal.error_unit, free));
        residuals[1]
            .signals
            .extend(short.map(|short| (signal.name, signal.error_unit, short)));
    }
    let [free_run_residual, short_horizon_residual] = residuals;
    let source = &log.provenance().source;
    let recording = |columns: Columns, what: &str| {
        columns.into_recording(format!("{what} {source}"), setup.base)
    };
    let traces = Traces {
        free_run: recording(free_run, "free run of the model of")?,
        short_horizon: match &predictor {
            Some(_) => recording(short_horizon, "short-horizon prediction of")?,
            None => Recording::default(),
        },
        free_run_residual: recording(free_run_residual, "free-run residual of")?,
        short_horizon_residual: recording(short_horizon_residual, "short-horizon residual of")?,
    };
    Ok(Comparison {
        schema: COMPARISON_SCHEMA.to_owned(),
        log: source.clone(),
        sign: RESIDUAL_SIGN.to_owned(),
        samples: commands.len(),
        duration_s: setup.base.end_s() - setup.base.start_s(),
        sample_interval_s: setup.base.sampling().median_step_s,
        current_sampling: match setup.sampling {
            CurrentSampling::MeanOfInterval => CurrentMeaning::MeanOfInterval,
            CurrentSampling::Instant => CurrentMeaning::Instant,
        },
        held_commands: setup
            .inputs
            .iter()
            .filter(|input| input.command.is_none())
            .count(),
        start,
        predictor,
        verdict: verdict(&signals, options),
        signals,
        not_compared,
        traces,
    })
}

impl CompareOptions {
    fn check(&self) -> Result<(), CompareError> {
        let refuse = |option: &str, value, range| {
            Err(CompareError::Option {
                option: option.to_owned(),
                value,
                range,
            })
        };
        if !(self.allowed_noise_multiples > 0.0 && self.allowed_noise_multiples.is_finite()) {
            return refuse(
                "allowed_noise_multiples",
                self.allowed_noise_multiples,
                "positive and finite",
            );
        }
        if !(self.predictor_gain > 0.0 && self.predictor_gain <= 1.0) {
            return refuse(
                "predictor_gain",
                self.predictor_gain,
                "above 0 and at most 1",
            );
        }
        let impossible = self
            .tolerances
            .iter()
            .find(|(_, value)| !(**value > 0.0 && value.is_finite()));
        match impossible {
            Some((name, &value)) => {
                refuse(&format!("tolerances.{name}"), value, "positive and finite")
            }
            None => Ok(()),
        }
    }

    fn check_tolerances(&self, measured: &[Measured]) -> Result<(), CompareError> {
        let unused = self
            .tolerances
            .keys()
            .find(|name| measured.iter().all(|signal| signal.name != **name));
        unused.map_or(Ok(()), |name| {
            Err(CompareError::UnusedTolerance {
                name: name.clone(),
                compared: measured
                    .iter()
                    .map(|signal| signal.name.to_owned())
                    .collect(),
            })
        })
    }
}

/// Every signal of the log that the model has, and those which have the name but cannot be compared.
fn measured_signals(
    parameters: &PlantParameters,
    log: &Recording,
    commands: &Commands,
) -> Result<(Vec<Measured>, Vec<NotCompared>), CompareError> {
    let plunger = parameters
        .regulating_valve
        .is_some()
        .then_some(PLUNGER_SIGNAL);
    let modelled: Vec<(&'static str, Unit)> = ROW_SIGNALS
        .into_iter()
        .chain(plunger)
        .filter(|(name, _)| !INPUTS.contains(name))
        .collect();
    let base_of_commands = DUTIES
        .into_iter()
        .find_map(|name| log.signal(name))
        .map(|signal| signal.time_base());
    let mut measured = Vec::new();
    let mut not_compared = Vec::new();
    for &(name, unit) in &modelled {
        if log.signal(name).is_none() {
            continue;
        }
        let signal = log.require(name, unit.quantity())?;
        let mut refuse = |reason: &str| {
            not_compared.push(NotCompared {
                name: name.to_owned(),
                reason: reason.to_owned(),
            })
        };
        if Some(signal.time_base()) != base_of_commands {
            refuse("it has another time base than the duty cycles; resample it to theirs");
            continue;
        }
        if signal.missing_count() == signal.len() {
            refuse("every sample is missing");
            continue;
        }
        let values = signal.values_at_ambient(unit, parameters.gas.ambient_pressure_pa)?;
        let error_unit = if unit == Unit::BarGauge {
            Unit::BarDifference
        } else {
            unit
        };
        let floor = noise_floor(
            &values,
            error_unit.symbol(),
            Quiet::of_signal(name),
            commands,
        );
        measured.push(Measured {
            name,
            error_unit,
            values,
            floor,
        });
    }
    if measured.is_empty() {
        return Err(CompareError::NothingToCompare {
            log: log.provenance().source.clone(),
            logged: log
                .signals()
                .iter()
                .map(|signal| signal.name().to_owned())
                .collect(),
            modelled: modelled
                .into_iter()
                .map(|(name, _)| name.to_owned())
                .collect(),
        });
    }
    Ok((measured, not_compared))
}

/// Where the model begins: at rest, or at the measured pressure [Pa abs] if that is away from ambient.
fn start(
    parameters: &PlantParameters,
    pressure: Option<&Measured>,
    commands: &Commands,
) -> (Start, Option<f64>) {
    let at_rest = |statement: String| {
        (
            Start {
                from: StartFrom::Rest,
                pressure_bar_gauge: 0.0,
                statement,
            },
            None,
        )
    };
    let Some(pressure) = pressure else {
        return at_rest("from rest: the log has no chamber pressure".to_owned());
    };
    // Until something moves, every sample shows the initial pressure; their mean has less noise than the first.
    let still = &pressure.values[..commands.rows_before_first_action().max(1)];
    let Some(initial_bar) = mean(still).or_else(|| present(&pressure.values).next()) else {
        return at_rest("from rest: every sample of the chamber pressure is missing".to_owned());
    };
    let close_bar = REST_BAR.max(REST_SIGMAS * pressure.floor.sigma);
    if initial_bar.abs() <= close_bar {
        return at_rest(format!(
            "from rest: the first measured pressure, {initial_bar:.3} bar gauge, is within {close_bar:.3} bar of ambient"
        ));
    }
    let start = Start {
        from: StartFrom::Measurement,
        pressure_bar_gauge: initial_bar,
        statement: format!(
            "from the measured pressure, {initial_bar:.3} bar gauge, which is away from ambient"
        ),
    };
    (
        start,
        Some(initial_bar * PA_PER_BAR + parameters.gas.ambient_pressure_pa),
    )
}

/// What the comparison of each signal needs.
struct Lab<'a> {
    options: &'a CompareOptions,
    commands: &'a Commands,
    setup: &'a Setup<'a>,
    features: &'a Features,
    predictor: Option<&'a Predictor>,
    fine_times_s: &'a [f64],
    fine_run: &'a Columns,
}

impl Lab<'_> {
    fn compare_signal(
        &self,
        signal: &Measured,
        free: &[f64],
        short: Option<&[f64]>,
    ) -> SignalComparison {
        let Floor { sigma, freedom, .. } = signal.floor;
        let short_sigma =
            self.predictor
                .filter(|_| signal.name == PRESSURE)
                .map_or(sigma, |predictor| {
                    // Only the corrected signal takes on noise by the correction.
                    sigma * predictor.innovation_floor_ratio
                });
        let free_excess = Excess::new(free, sigma, freedom);
        let short_excess = short.map(|short| Excess::new(short, short_sigma, freedom));
        let (horizon, local) = match &short_excess {
            Some(short) => (Horizon::ShortHorizon, short),
            None => (Horizon::FreeRun, &free_excess),
        };
        let dimensions = self.features.dimensions(coil_of(signal.name));
        let summary = |errors, expected, horizon| {
            let base: &TimeBase = self.setup.base;
            summary(
                errors,
                &signal.values,
                base.times_s(),
                (sigma, expected),
                &self.commands.duty_pct,
                horizon,
            )
        };
        let free_run = summary(free, sigma, Horizon::FreeRun);
        let (limit, limit_from) = self.limit(signal);
        SignalComparison {
            name: signal.name.to_owned(),
            unit: signal.error_unit.symbol().to_owned(),
            compared: present(free).count(),
            missing: free.len() - present(free).count(),
            noise_floor: signal.floor.summary.clone(),
            short_horizon: short.map(|short| summary(short, short_sigma, Horizon::ShortHorizon)),
            time_offset: self.time_offset(signal),
            limit,
            limit_from,
            holds: limit.map(|limit| free_run.rms <= limit),
            free_run,
            regimes: dimensions
                .iter()
                .map(|dimension| shares(dimension, short_excess.as_ref(), &free_excess))
                .collect(),
            error_map: error_map(self.features, local, horizon),
            finding: find(&dimensions, self.features, local, horizon),
        }
    }

    fn limit(&self, signal: &Measured) -> (Option<f64>, LimitFrom) {
        match (
            self.options.tolerances.get(signal.name),
            signal.floor.summary.value,
        ) {
            (Some(&tolerance), _) => (Some(tolerance), LimitFrom::Tolerance),
            (None, Some(sigma)) => (
                Some(self.options.allowed_noise_multiples * sigma),
                LimitFrom::NoiseFloor,
            ),
            (None, None) => (None, LimitFrom::Unknown),
        }
    }

    fn time_offset(&self, signal: &Measured) -> Option<crate::result::TimeOffset> {
        let rows = signal.values.len().min(OFFSET_ROWS);
        let times_s = &self.commands.times_s[..rows];
        let fine = self.fine_run.get(signal.name)?;
        let is_mean = matches!(self.setup.sampling, CurrentSampling::MeanOfInterval);
        let course = if is_mean && signal.error_unit == Unit::Milliampere {
            FineCourse::of_means(self.fine_times_s, fine)
        } else {
            FineCourse::of_instants(self.fine_times_s, fine)
        };
        time_offset(times_s, &signal.values[..rows], &course, signal.name)
    }
}

/// The coil that a signal belongs to.
fn coil_of(name: &str) -> Option<usize> {
    match name {
        "i_fill" | "x_fill" => Some(FILL),
        "i_vent" | "x_vent" => Some(VENT),
        _ => None,
    }
}

fn verdict(signals: &[SignalComparison], options: &CompareOptions) -> Verdict {
    let named = |holds: Option<bool>| {
        signals
            .iter()
            .filter(|signal| signal.holds == holds)
            .map(|signal| signal.name.clone())
            .collect()
    };
    let rule = format!(
        "the free-run rms of every compared signal is at most {} times its noise floor{}",
        options.allowed_noise_multiples,
        if options.tolerances.is_empty() {
            ""
        } else {
            ", or at most the tolerance given for it"
        }
    );
    Verdict {
        holds: signals.iter().all(|signal| signal.holds == Some(true)),
        failing: named(Some(false)),
        undecided: named(None),
        rule,
    }
}
