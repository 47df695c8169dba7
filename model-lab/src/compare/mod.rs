//! Assembly of the comparison.

use std::sync::Arc;

use plant_sim::PlantParameters;
use plant_sim::plant::{FILL, VENT};
use plant_sim::replay::{CurrentSampling, Surroundings, united};
use recording::{OwnSamples, Provenance, Recording, TimeBase, Unit};

use crate::commands::{Commands, DUTIES, shared};
use crate::conditions::LogConditions;
use crate::error::CompareError;
use crate::measured::{LogAsRead, Measured, PRESSURE, measured_signals, start};
use crate::metrics::picked;
use crate::noise_floor::Floor;
use crate::offset::{FineTrace, time_offset};
use crate::options::CompareOptions;
use crate::regime::{Excess, Features, States, Watched, error_map, find, placement, shares};
use crate::result::{
    COMPARISON_SCHEMA, Comparison, CurrentMeaning, Finding, FoundStart, Horizon, LimitFrom,
    LogDefects, Placement, Predictor, RESIDUAL_SIGN, Residual, SignalComparison, TimeOffset,
    Traces, Verdict, WarningKind,
};
use crate::run::{FineRun, OwnInstants, Setup};
use crate::summary::{Floors, summary};
use crate::warning::{misaligned, warnings};
use crate::whiteness::Input;

/// Number of samples from which the time offset is determined, at most; it bounds memory on long logs.
const OFFSET_ROWS: usize = 12_000;

/// Compares the model with `parameters` with `log`, which was made under `conditions`. Simulates from the logged commands and determines,
/// for each signal, the error relative to the noise of the measurement and the regime of the error.
///
/// Nothing is resampled and no missing sample is filled in. Calls `goes_on` every few milliseconds with the share of the work that is done
/// (0 to 1); a return value of false stops the comparison.
///
/// # Errors
/// [`CompareError`]: the log cannot drive the model, has no signal of the model, an option is out of range, or `goes_on` stopped the
/// comparison.
pub fn compare_under(
    parameters: &PlantParameters,
    log: &Recording,
    conditions: &LogConditions,
    options: &CompareOptions,
    goes_on: &dyn Fn(f64) -> bool,
) -> Result<Comparison, CompareError> {
    options.check()?;
    let original = log;
    let log = &*united(parameters, original);
    let surroundings = Surroundings::of(parameters, log)?;
    let parameters = &*surroundings.around(parameters);
    let commands = Commands::new(parameters, log)?;
    let setup = Setup::new(parameters, (log, conditions), options.tolerance)?;
    let (measured, not_compared) =
        measured_signals(parameters, LogAsRead { log, original }, &commands)?;
    let is_measured = |name: &str| measured.iter().any(|signal| signal.name == name);
    let mut setup = setup.watched(goes_on, OFFSET_ROWS).keeping(is_measured);
    options.check_tolerances(&measured)?;

    let pressure = measured.iter().find(|signal| signal.name == PRESSURE);
    let (start, level) = start(parameters, pressure, &commands);
    setup.begin_at(pressure, level);

    let free_run = setup.free_run()?;
    let gain = if pressure.is_some() {
        options.predictor_gain
    } else {
        0.0
    };
    // An event within this many rows still affects the error: a sample that stands for several rows corrects once for all of them.
    let rows_per_sample = |signal: &Measured| signal.interval_s / setup.inputs.interval_s();
    let memory = match pressure {
        Some(pressure) => {
            ((1.0 / gain).ceil() * rows_per_sample(pressure).max(1.0)).round() as usize
        }
        None => 1,
    };
    let mut watched = Watched::new(parameters, commands.len(), memory);
    let measured_bar = pressure.map(|signal| &signal.values[..]);
    let one_step_ahead = setup.predict(measured_bar, gain, |now| watched.push(now))?;
    let states = watched.finish(&commands.times_s);
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
        inputs: [FILL, VENT].map(|valve| Input::new(DUTIES[valve], &commands.duty_pct[valve])),
        states: &states,
        predictor: predictor.as_ref(),
        fine_run: &fine_run,
    };
    let mut signals = Vec::new();
    let mut placements = Vec::new();
    let mut warnings = warnings(parameters, log, &commands, &measured);
    let mut kinds = warnings.iter().map(|warning| warning.kind);
    let is_swapped = kinds.any(|kind| kind == WarningKind::SwappedValves);
    for signal in &measured {
        let free = free_run.get(signal.name).unwrap_or_default();
        let free = Residual::new(&signal.values, free);
        let short = one_step_ahead.get(signal.name);
        let short = short.map(|short| Residual::new(&signal.values, short));
        let short = short.filter(|_| predictor.is_some());
        let (mut compared, placed) = lab.compare_signal(signal, free, short);
        if let Some(warning) = misaligned(parameters, &compared).filter(|_| !is_swapped) {
            // The regime of such an error says nothing about the plant.
            compared.finding = Finding {
                regime: None,
                excess_share: None,
                sample_share: None,
                bias: None,
                sentence: "rows and commands do not line up in time, so the error is not placed"
                    .to_owned(),
                ..compared.finding
            };
            warnings.push(warning);
        }
        signals.push(compared);
        placements.extend(placed);
    }
    let source = &log.provenance().source;
    let traces = Traces {
        measured: recorded(&measured, source, setup.base)?,
        free_run: with_inputs(
            free_run.into_recording(
                format!("free run of the model of {source}"),
                setup.base,
                &measured,
            )?,
            log,
            &setup,
            &commands,
        )?,
        one_step_ahead: match &predictor {
            Some(_) => one_step_ahead.into_recording(
                format!("one-step-ahead prediction of {source}"),
                setup.base,
                &measured,
            )?,
            None => Recording::default(),
        },
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
            .shown_commands()
            .filter(|(_, command)| command.is_none())
            .count(),
        start,
        clock: conditions.clock(source),
        start_gas: conditions.start(source).filter(FoundStart::is_warm),
        predictor,
        verdict: verdict(&signals, options),
        signals,
        not_compared,
        defects: LogDefects::of(original, &commands, &measured),
        warnings,
        traces,
    })
}

/// Returns the measured signals in the units of the model.
fn recorded(
    measured: &[Measured],
    source: &str,
    base: &TimeBase,
) -> Result<Recording, CompareError> {
    let mut recording = OwnInstants::new(Provenance::from_source(source), base);
    for signal in measured {
        let values = Arc::clone(&signal.values);
        recording.add((signal.name, signal.unit), values, Some(signal))?;
    }
    Ok(recording.recording)
}

/// Returns the free-run simulation together with its inputs, as far as the log has them. A missing command is replaced by the last one,
/// which was in force. Without missing commands, the columns are those of the log.
fn with_inputs(
    mut run: Recording,
    log: &Recording,
    setup: &Setup,
    commands: &Commands,
) -> Result<Recording, CompareError> {
    let Some((id, _)) = run.time_bases().next() else {
        return Ok(run);
    };
    for (name, duty_pct) in DUTIES.into_iter().zip(&commands.duty_pct) {
        if log.signal(name).is_some() {
            run.add_shared_signal(name, Unit::Percent, id, Arc::clone(duty_pct))?;
        }
    }
    if let Some(supply) = log.signal(SUPPLY) {
        let mut last = setup.parameters.ecu.supply_voltage_v;
        let held = setup.inputs.iter().map(|input| {
            last = input.supply_voltage_v.unwrap_or(last);
            last
        });
        let held = shared(Some(supply.shared_values()), held.collect());
        run.add_shared_signal(SUPPLY, Unit::Volt, id, held)?;
    }
    Ok(run)
}

/// Signal name of the supply voltage.
const SUPPLY: &str = "u_bat";

/// Data that the comparison of each signal needs.
struct Lab<'a> {
    options: &'a CompareOptions,
    commands: &'a Commands,
    setup: &'a Setup<'a>,
    /// Duty cycles.
    inputs: [Input<'a>; 2],
    states: &'a States,
    predictor: Option<&'a Predictor>,
    fine_run: &'a FineRun,
}

impl Lab<'_> {
    fn compare_signal(
        &self,
        signal: &Measured,
        free: Residual,
        short: Option<Residual>,
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
            Some(short) => (Horizon::OneStepAhead, short),
            None => (Horizon::FreeRun, &free_excess),
        };
        let features = Features::new(self.states, self.commands, signal.coil());
        let dimensions = features.dimensions();
        let summary = |errors: Residual, expected, horizon| {
            let times_s = self.setup.base.times_s();
            let errors: Vec<f64> = errors.iter().collect();
            let floors = Floors {
                noise: sigma,
                expected_rms: expected,
            };
            let Some(own) = OwnSamples::of(times_s, &signal.values) else {
                let values = &signal.values;
                return summary(&errors, values, times_s, floors, &self.inputs, horizon);
            };
            let of_rows = |values: &[f64]| picked(values, &own.rows);
            let duties_pct = [FILL, VENT].map(|valve| of_rows(&self.commands.duty_pct[valve]));
            let inputs = [FILL, VENT].map(|valve| Input::new(DUTIES[valve], &duties_pct[valve]));
            let errors = of_rows(&errors);
            summary(&errors, &own.values, &own.times_s, floors, &inputs, horizon)
        };
        let free_run = summary(free, sigma, Horizon::FreeRun);
        let (limit, limit_from) = self.limit(signal);
        let (error_map, mut cells) = error_map(&features, local, horizon);
        signal.name.clone_into(&mut cells.signal);
        let placements = dimensions
            .iter()
            .map(|dimension| placement(signal.name, dimension))
            .chain([cells]);
        let at_own_instants = |placement: Placement| match &signal.own {
            None => placement,
            Some((_, rows)) => Placement {
                bin_of: placement.bin_of.at_rows(rows),
                ..placement
            },
        };
        let placements = placements.map(at_own_instants).collect();
        let compared_samples = free.iter().filter(|error| !error.is_nan()).count();
        let samples = signal
            .own
            .as_ref()
            .map_or(free.len(), |(_, rows)| rows.len());
        let holds = limit.map(|limit| free_run.rms <= limit);
        let mut finding = find(&dimensions, &features, local, horizon);
        let short_is_noise = |short: &Excess| !short.is_significant();
        let is_only_added_up = short_excess.as_ref().is_some_and(short_is_noise);
        if is_only_added_up && holds == Some(false) {
            finding.sentence = format!(
                "{}; in free run it adds up, and where it is says nothing of its cause",
                finding.sentence
            );
        }
        let compared = SignalComparison {
            name: signal.name.to_owned(),
            unit: signal.error_unit.symbol().to_owned(),
            compared: compared_samples,
            missing: samples - compared_samples,
            noise_floor: signal.floor.summary.clone(),
            one_step_ahead: short.map(|short| summary(short, short_sigma, Horizon::OneStepAhead)),
            time_offset: self.time_offset(signal),
            limit,
            limit_from,
            holds,
            free_run,
            regimes: dimensions
                .iter()
                .map(|dimension| shares(dimension, short_excess.as_ref(), &free_excess))
                .collect(),
            error_map,
            finding,
        };
        (compared, placements)
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
        let (times_s, values) = (&self.commands.times_s[rows.clone()], &signal.values[rows]);
        let own = OwnSamples::of(times_s, values);
        let (times_s, values) = match &own {
            None => (times_s, values),
            Some(own) => (&own.times_s[..], &own.values[..]),
        };
        let fine = self.fine_run.columns.get(signal.name)?;
        let fine_times_s = &self.fine_run.times_s;
        let is_mean = matches!(self.setup.sampling, CurrentSampling::MeanOfInterval);
        let trace = if is_mean && signal.error_unit == Unit::Milliampere {
            FineTrace::of_means(fine_times_s, fine)
        } else {
            FineTrace::of_instants(fine_times_s, fine)
        };
        time_offset(times_s, values, &trace, signal.name)
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
mod clock_tests;
#[cfg(test)]
mod gap_tests;
#[cfg(test)]
mod rate_tests;
#[cfg(test)]
mod tests;
