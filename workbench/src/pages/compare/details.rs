//! Detail charts: values at a cursor, residual over a signal, folding by PWM period.

use std::collections::BTreeMap;

use model_lab::result::Residual;
use recording::{Samples, Signal, TimeBase};
use serde::{Deserialize, Serialize};

use super::selection::picked;
use crate::pages::points::Range;
use crate::refusal::Refusal;
use crate::results::Compared;
use crate::session::Session;
use crate::shown_unit::{shown_unit, shown_values};

/// Cells of a scatter plot, across and down: one sample is drawn for each.
const CELLS: (usize, usize) = (170, 90);
/// Samples that a fold shows.
const FOLD_POINTS_MAX: usize = 3000;
/// Parts of the period for the averages of a fold.
const FOLD_PIECES: usize = 60;

/// Instant of the log (s).
#[derive(Deserialize)]
pub(super) struct Instant {
    pub(super) time_s: f64,
}

/// Values of the log at the sample nearest to an instant.
#[derive(Serialize)]
pub(super) struct Values {
    signals: Vec<ValueOf>,
}

#[derive(Serialize)]
struct ValueOf {
    name: String,
    /// Time of the sample (s).
    time_s: f64,
    measured: Option<f64>,
    model: Option<f64>,
    residual: Option<f64>,
}

/// Returns the values at the cursor.
pub(super) fn values(session: &Session, number: u32, time_s: f64) -> Result<Values, Refusal> {
    let log = session.log(number)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let compared = session.comparison(number);
    let parameters = session.project().plant.parameters()?;
    let traces = compared
        .as_ref()
        .map(|compared| &compared.comparison.traces);
    let value_of = |signal: &Signal| {
        let base = log.recording.time_base(signal.time_base())?;
        let index = nearest(base, time_s);
        let (_, converter) = shown_unit(signal, &parameters);
        let measured = signal.get(index);
        let errors = traces.and_then(|traces| traces.free_run_residual(signal.name()));
        let residual = errors.filter(|errors| index < errors.len());
        let residual = residual
            .map(|errors| errors.at(index))
            .filter(|error| !error.is_nan());
        Some(ValueOf {
            name: signal.name().to_owned(),
            time_s: base.times_s()[index],
            measured: match converter {
                Some(converter) => measured.map(|value| converter.apply(value)),
                None => measured,
            },
            model: traces
                .filter(|_| errors.is_some())
                .and_then(|traces| traces.free_run.signal(signal.name())?.get(index)),
            residual,
        })
    };
    Ok(Values {
        signals: log
            .recording
            .signals()
            .iter()
            .filter_map(value_of)
            .collect(),
    })
}

fn nearest(base: &TimeBase, time_s: f64) -> usize {
    let times_s = base.times_s();
    let after = times_s
        .partition_point(|&one| one < time_s)
        .min(times_s.len() - 1);
    let before = after.saturating_sub(1);
    if (times_s[before] - time_s).abs() <= (times_s[after] - time_s).abs() {
        before
    } else {
        after
    }
}

/// Axes of a scatter plot.
#[derive(Deserialize)]
pub(super) struct Axes {
    /// Signal whose residual is drawn.
    signal: String,
    /// Signal of the log or of the model on the horizontal axis.
    over: String,
    from_s: Option<f64>,
    to_s: Option<f64>,
    select: Option<String>,
}

#[derive(Serialize)]
pub(super) struct Scatter {
    unit: String,
    over_unit: &'static str,
    /// Number of samples behind the points.
    samples: usize,
    points: Points,
    /// Points of the selection.
    selected: Points,
}

#[derive(Default, Serialize)]
struct Points {
    x: Vec<f64>,
    y: Vec<f64>,
    t: Vec<f64>,
}

/// Returns the residual of one signal over another, thinned to one sample for each cell of the plot.
pub(super) fn scatter(session: &Session, number: u32, axes: &Axes) -> Result<Scatter, Refusal> {
    let compared = super::compared(session, number)?;
    let log = session.log(number)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let (base, residual) = residual_of(&compared, &axes.signal)?;
    let range = Range {
        from_s: axes.from_s,
        to_s: axes.to_s,
    };
    let (within, _) = range.of(base)?;
    let (over, over_unit) = over(&compared, &log.recording, axes, residual.len())?;
    let is_in = match &axes.select {
        Some(select) => Some(picked(&compared, select)?.1),
        None => None,
    };
    let usable: Vec<usize> = within
        .filter(|&index| !residual.at(index).is_nan() && !over[index].is_nan())
        .collect();
    let is_selected = |index: usize| is_in.as_ref().is_some_and(|is_in| is_in[index]);
    let of = |wanted: bool| {
        let chosen = || {
            usable
                .iter()
                .copied()
                .filter(|&index| is_selected(index) == wanted)
        };
        let mut points = Points::default();
        for index in one_of_each_cell(chosen, &over, &residual) {
            points.x.push(over[index]);
            points.y.push(residual.at(index));
            points.t.push(base.times_s()[index]);
        }
        points
    };
    Ok(Scatter {
        unit: unit_of_errors(&compared, &axes.signal),
        over_unit,
        samples: usable.len(),
        points: of(false),
        selected: of(true),
    })
}

/// Returns the residual of a compared signal with its time base.
pub(super) fn residual_of<'a>(
    compared: &'a Compared,
    name: &str,
) -> Result<(&'a TimeBase, Residual<'a>), Refusal> {
    let traces = &compared.comparison.traces;
    let base = traces.free_run.time_base_of(name);
    let found = base.zip(traces.free_run_residual(name));
    found.ok_or_else(|| Refusal::not_found("compared signal"))
}

/// Returns the unit of the signal's errors.
pub(super) fn unit_of_errors(compared: &Compared, name: &str) -> String {
    let signals = &compared.comparison.signals;
    let signal = signals.iter().find(|signal| signal.name == name);
    signal.map_or_else(String::new, |signal| signal.unit.clone())
}

/// Returns the values of the horizontal axis: time, a signal of the log, or one of the model.
fn over(
    compared: &Compared,
    log: &recording::Recording,
    axes: &Axes,
    samples: usize,
) -> Result<(Vec<f64>, &'static str), Refusal> {
    let run = &compared.comparison.traces.free_run;
    if axes.over == "time" {
        let (base, _) = residual_of(compared, &axes.signal)?;
        return Ok((base.times_s().to_vec(), "s"));
    }
    let (values, unit) = match axes.over.strip_suffix("_model") {
        Some(name) => {
            let signal = run
                .signal(name)
                .ok_or_else(|| Refusal::not_found("signal"))?;
            (signal.values_or_nan().to_vec(), signal.unit())
        }
        None => {
            let signal = log.signal(&axes.over);
            let signal = signal.ok_or_else(|| Refusal::not_found("signal"))?;
            let (unit, _) = shown_unit(signal, &compared.parameters);
            let values = shown_values(signal, &compared.parameters);
            (values.into_owned(), unit)
        }
    };
    if values.len() != samples {
        return Err(Refusal::value(format!(
            "{} has another time base than {}; choose another signal",
            axes.over, axes.signal
        )));
    }
    Ok((values, unit.symbol()))
}

/// Returns the first sample in each occupied cell of the rectangle around all samples.
fn one_of_each_cell<I: Iterator<Item = usize>>(
    samples: impl Fn() -> I,
    x: &[f64],
    y: &(impl Samples + ?Sized),
) -> Vec<usize> {
    let range = |value: &dyn Fn(usize) -> f64| {
        let values = || samples().map(value);
        let low = values().fold(f64::INFINITY, f64::min);
        let high = values().fold(f64::NEG_INFINITY, f64::max);
        (low, (high - low).max(f64::MIN_POSITIVE))
    };
    let x_range = range(&|index| x[index]);
    let y_range = range(&|index| y.value(index));
    let cell = |value: f64, (low, span): (f64, f64), cells: usize| {
        (((value - low) / span * cells as f64) as usize).min(cells - 1)
    };
    let mut cells = BTreeMap::new();
    for index in samples() {
        let place = (
            cell(x[index], x_range, CELLS.0),
            cell(y.value(index), y_range, CELLS.1),
        );
        cells.entry(place).or_insert(index);
    }
    cells.into_values().collect()
}

/// Options of a fold.
#[derive(Deserialize)]
pub(super) struct Folding {
    signal: String,
    /// Length of the fold (ms); `None` takes the PWM period of the plant.
    period_ms: Option<f64>,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

#[derive(Serialize)]
pub(super) struct Fold {
    period_ms: f64,
    unit: &'static str,
    samples: usize,
    /// Median sample interval (ms), which shows whether the period can be resolved.
    sample_interval_ms: Option<f64>,
    measured: FoldedPoints,
    model: FoldedPoints,
}

#[derive(Serialize)]
struct FoldedPoints {
    /// Time within the period (ms).
    phase_ms: Vec<f64>,
    value: Vec<f64>,
    /// Means over parts of the period; null for a part without samples.
    mean_phase_ms: Vec<f64>,
    mean: Vec<Option<f64>>,
}

/// Folds the samples of a view by their time within the period.
pub(super) fn fold(session: &Session, number: u32, fold: &Folding) -> Result<Fold, Refusal> {
    let compared = super::compared(session, number)?;
    let log = session.log(number)?;
    let log = log.as_ref().as_ref().map_err(Clone::clone)?;
    let period_ms = fold
        .period_ms
        .unwrap_or(1e3 / compared.parameters.ecu.pwm_frequency_hz);
    if !(period_ms > 0.0 && period_ms.is_finite()) {
        return Err(Refusal::value(format!(
            "the fold period is {period_ms} ms; enter a value above 0"
        )));
    }
    let signal = log.recording.signal(&fold.signal);
    let signal = signal.ok_or_else(|| Refusal::not_found("signal"))?;
    let base = log.recording.time_base(signal.time_base());
    let base = base.ok_or_else(|| Refusal::not_found("time base"))?;
    let range = Range {
        from_s: fold.from_s,
        to_s: fold.to_s,
    };
    let (within, _) = range.of(base)?;
    let (unit, converter) = shown_unit(signal, &compared.parameters);
    let times_s = &base.times_s()[within.clone()];
    let measured: Vec<f64> = signal.values_or_nan()[within.clone()]
        .iter()
        .map(|&value| converter.map_or(value, |converter| converter.apply(value)))
        .collect();
    let run = &compared.comparison.traces.free_run;
    let model = match run.signal(&fold.signal) {
        Some(run) if run.len() == signal.len() => &run.values_or_nan()[within],
        _ => &[],
    };
    Ok(Fold {
        period_ms,
        unit: unit.symbol(),
        samples: times_s.len(),
        sample_interval_ms: base.sampling().median_step_s.map(|step_s| 1e3 * step_s),
        measured: folded(times_s, &measured, period_ms),
        model: folded(times_s, model, period_ms),
    })
}

fn folded(times_s: &[f64], values: &[f64], period_ms: f64) -> FoldedPoints {
    let present: Vec<(f64, f64)> = times_s
        .iter()
        .zip(values)
        .filter(|(_, value)| !value.is_nan())
        .map(|(&time_s, &value)| ((1e3 * time_s).rem_euclid(period_ms), value))
        .collect();
    let mut sums = [(0.0, 0_u32); FOLD_PIECES];
    for &(phase_ms, value) in &present {
        let piece = (phase_ms / period_ms * FOLD_PIECES as f64) as usize;
        let (sum, count) = &mut sums[piece.min(FOLD_PIECES - 1)];
        *sum += value;
        *count += 1;
    }
    let middle = |piece: usize| (piece as f64 + 0.5) * period_ms / FOLD_PIECES as f64;
    let step = present.len().div_ceil(FOLD_POINTS_MAX).max(1);
    let shown = || present.iter().step_by(step);
    FoldedPoints {
        phase_ms: shown().map(|(phase_ms, _)| *phase_ms).collect(),
        value: shown().map(|(_, value)| *value).collect(),
        mean_phase_ms: (0..FOLD_PIECES).map(middle).collect(),
        mean: sums
            .iter()
            .map(|&(sum, count)| (count > 0).then(|| sum / f64::from(count)))
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fold_puts_the_same_phase_on_top_of_each_other() {
        let times_s = [0.0, 0.0025, 0.01, 0.0125, 0.02];
        let folded = folded(&times_s, &[1.0, 5.0, 3.0, 7.0, f64::NAN], 10.0);
        assert_eq!(folded.value.len(), 4);
        assert!((folded.phase_ms[2] - 0.0).abs() < 1e-9 && (folded.phase_ms[3] - 2.5).abs() < 1e-9);
        assert_eq!(folded.mean[0], Some(2.0));
        assert_eq!(folded.mean[15], Some(6.0));
        assert_eq!(folded.mean[30], None);
    }

    #[test]
    fn a_scatter_keeps_one_sample_of_each_cell_and_every_outlier() {
        let x: Vec<f64> = (0..100_000).map(|index| (index % 1000) as f64).collect();
        let mut y = vec![0.0; x.len()];
        y[77_777] = 5.0;
        let shown = one_of_each_cell(|| 0..x.len(), &x, &y[..]);
        assert!(shown.len() <= CELLS.0 + 1, "{}", shown.len());
        assert!(shown.contains(&77_777));
    }

    #[test]
    fn the_nearest_sample_is_found_at_both_ends_and_between() {
        let base = TimeBase::new(vec![0.0, 1.0, 3.0]).unwrap();
        for (time_s, index) in [(-5.0, 0), (0.4, 0), (0.6, 1), (2.1, 2), (99.0, 2)] {
            assert_eq!(nearest(&base, time_s), index, "{time_s}");
        }
    }
}
