//! The comparison, put together.

use plant_sim::PlantParameters;
use plant_sim::replay::CurrentSampling;
use recording::{Recording, TimeBase, Unit};

use crate::commands::Commands;
use crate::error::CompareError;
use crate::measured::{Measured, PRESSURE, measured_signals, start};
use crate::metrics::{present, residual};
use crate::noise_floor::Floor;
use crate::offset::{FineCourse, time_offset};
use crate::options::CompareOptions;
use crate::regime::{Excess, Features, error_map, find, placement, shares};
use crate::result::{
    COMPARISON_SCHEMA, Comparison, CurrentMeaning, Horizon, LimitFrom, LogDefects, Placement,
    Predictor, RESIDUAL_SIGN, SignalComparison, TimeOffset, Traces, Verdict,
};
use crate::run::{Activity, Columns, FineRun, Setup};
use crate::summary::summary;
use crate::warning::warnings;

/// The time offset is taken from this many samples at most, which bounds memory on long logs.
const OFFSET_ROWS: usize = 12_000;

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
    compare_watched(parameters, log, options, &|_| true)
}

/// As [`compare`], for somebody who waits: `goes_on` is told every few milliseconds which share of the work is done,
/// 0 to 1, and ends it by saying false.
///
/// # Errors
/// Those of [`compare`], and [`CompareError::Stopped`].
pub fn compare_watched(
    parameters: &PlantParameters,
    log: &Recording,
    options: &CompareOptions,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Comparison, CompareError> {
    options.check()?;
    let commands = Commands::new(parameters, log)?;
    let setup = Setup::new(parameters, log, options.tolerance)?;
    let mut setup = setup.watched(goes_on, OFFSET_ROWS);
    let (measured, not_compared) = measured_signals(parameters, (log, setup.base), &commands)?;
    options.check_tolerances(&measured)?;

    let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
    let (start, start_pressure) = start(parameters, pressure, &commands);
    setup.start_pressure = start_pressure;
    setup.restarts = pressure.map_or_else(Vec::new, |signal| signal.restarts.clone());

    let free_run = setup.free_run()?;
    let no_pressure = vec![f64::NAN; commands.len()];
    let gain = if pressure.is_some() {
        options.predictor_gain
    } else {
        0.0
    };
    let (short_horizon, activities) =
        setup.predict(pressure.map_or(&no_pressure, |signal| &signal.values), gain)?;
    let fine_run = setup.fine_run(OFFSET_ROWS)?;
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
        activities: &activities,
        predictor: predictor.as_ref(),
        fine_run: &fine_run,
    };
    let mut signals = Vec::new();
    let mut placements = Vec::new();
    let mut residuals = [Columns::default(), Columns::default()];
    for signal in &measured {
        let of = |run: &Columns| {
            run.get(signal.name)
                .map(|modelled| residual(&signal.values, modelled))
        };
        let free = of(&free_run).unwrap_or_default();
        let short = of(&short_horizon).filter(|_| predictor.is_some());
        let (compared, placed) = lab.compare_signal(signal, &free, short.as_deref());
        signals.push(compared);
        placements.extend(placed);
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
        placements,
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
        defects: LogDefects::of(log, &commands, pressure),
        warnings: warnings(parameters, log, &commands, &measured),
        traces,
    })
}

/// What the comparison of each signal needs.
struct Lab<'a> {
    options: &'a CompareOptions,
    commands: &'a Commands,
    setup: &'a Setup<'a>,
    activities: &'a [Activity],
    predictor: Option<&'a Predictor>,
    fine_run: &'a FineRun,
}

impl Lab<'_> {
    fn compare_signal(
        &self,
        signal: &Measured,
        free: &[f64],
        short: Option<&[f64]>,
    ) -> (SignalComparison, Vec<Placement>) {
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
        let features = self.features(signal);
        let dimensions = features.dimensions();
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
        let (error_map, mut cells) = error_map(&features, local, horizon);
        signal.name.clone_into(&mut cells.signal);
        let placements = dimensions
            .iter()
            .map(|dimension| placement(signal.name, dimension))
            .chain([cells]);
        let placements = placements.collect();
        let compared = SignalComparison {
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
            error_map,
            finding: find(&dimensions, &features, local, horizon),
        };
        (compared, placements)
    }

    fn features(&self, signal: &Measured) -> Features {
        let memory = self
            .predictor
            .map_or(1.0, |predictor| (1.0 / predictor.gain).ceil());
        let coil = signal.coil();
        Features::new(
            self.setup.parameters,
            self.commands,
            self.activities,
            memory as usize,
            coil,
        )
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

    fn time_offset(&self, signal: &Measured) -> Option<TimeOffset> {
        let rows = self.commands.gaps.longest(self.fine_run.rows);
        let times_s = &self.commands.times_s[rows.clone()];
        let fine = self.fine_run.columns.get(signal.name)?;
        let fine_times_s = &self.fine_run.times_s;
        let is_mean = matches!(self.setup.sampling, CurrentSampling::MeanOfInterval);
        let course = if is_mean && signal.error_unit == Unit::Milliampere {
            FineCourse::of_means(fine_times_s, fine)
        } else {
            FineCourse::of_instants(fine_times_s, fine)
        };
        time_offset(times_s, &signal.values[rows], &course, signal.name)
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

#[cfg(test)]
mod gap_tests;
#[cfg(test)]
mod tests;
