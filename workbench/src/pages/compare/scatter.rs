//! Residual of a signal over another signal.

use std::collections::BTreeMap;

use recording::Samples;
use serde::{Deserialize, Serialize};

use super::residual::{residual_of, unit_of_errors};
use super::selection::picked;
use crate::pages::points::Range;
use crate::refusal::Refusal;
use crate::results::Compared;
use crate::session::Session;
use crate::shown_unit::{shown_unit, shown_values};

/// Cells of a scatter plot, across and down: one sample is drawn for each.
const CELLS: (usize, usize) = (170, 90);

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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scatter_keeps_one_sample_of_each_cell_and_every_outlier() {
        let x: Vec<f64> = (0..100_000).map(|index| (index % 1000) as f64).collect();
        let mut y = vec![0.0; x.len()];
        y[77_777] = 5.0;
        let shown = one_of_each_cell(|| 0..x.len(), &x, &y[..]);
        assert!(shown.len() <= CELLS.0 + 1, "{}", shown.len());
        assert!(shown.contains(&77_777));
    }
}
