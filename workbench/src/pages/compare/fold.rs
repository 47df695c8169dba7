//! Measurement and model folded by PWM period.

use serde::{Deserialize, Serialize};

use crate::pages::points::Range;
use crate::refusal::Refusal;
use crate::session::Session;
use crate::shown_unit::shown_unit;

/// Samples that a fold shows.
const FOLD_POINTS_MAX: usize = 3000;
/// Parts of the period for the averages of a fold.
const FOLD_PIECES: usize = 60;

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
}
