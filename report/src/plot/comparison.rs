//! Plot of measured and modelled signal, residuals and commands on one time axis.

use std::ops::Range;

use model_lab::result::{Comparison, ErrorSummary, SignalComparison};
use recording::{Recording, Trace, Unit};

use super::canvas::{
    self, Chart, LABELS_PX, Panel, RIGHT_PX, Sheet, WIDTH_PX, clipped, figure, union, with_room,
};
use super::curve;
use super::figure::{Figure, PlotError};
use super::palette;
use super::quantity::{SmallUnit, capitalised, signal_words};

/// Width of the plot area (px).
const PLOT_PX: i32 = WIDTH_PX - LABELS_PX - RIGHT_PX;
const OVERLAY_PX: i32 = 210;
const RESIDUAL_PX: i32 = 110;
/// Space between two panels, for the caption of the lower one (px).
const BETWEEN_PX: i32 = 44;
const FIRST_TOP_PX: i32 = 62;

/// Draws the signal measured and modelled, both residuals with the noise band, and the duty cycles of `log`. `window_s`
/// is an excerpt; without it the whole log is drawn.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn comparison(
    log: &Recording,
    comparison: &Comparison,
    signal: &SignalComparison,
    window_s: Option<Range<f64>>,
) -> Result<Figure, PlotError> {
    let traces = &comparison.traces;
    let modelled = Trace::of(&traces.free_run, &signal.name);
    let residual = curve::free_run_residual(traces, &signal.name);
    let one_step_ahead = signal
        .one_step_ahead
        .as_ref()
        .zip(curve::one_step_ahead_residual(traces, &signal.name));
    let window_s = window_s
        .or_else(|| modelled.as_ref().map(Trace::window_s))
        .unwrap_or(0.0..1.0);
    let residuals = 1 + i32::from(one_step_ahead.is_some());
    let height_px = FIRST_TOP_PX
        + OVERLAY_PX
        + (residuals + 1) * BETWEEN_PX
        + residuals * RESIDUAL_PX
        + DUTIES_PX
        + 46;
    let words = clipped(signal_words(&signal.name), 40);
    let title = format!(
        "{}, measured and modelled, {}",
        capitalised(&words),
        span(&window_s)
    );
    figure(WIDTH_PX, height_px, title.clone(), |sheet| {
        sheet.title(&title)?;
        let mut top_px = FIRST_TOP_PX;
        let unit = traces
            .free_run
            .signal(&signal.name)
            .map_or("", |signal| signal.unit().symbol());
        let overlay = Overlay {
            words: &words,
            unit,
            window_s: &window_s,
        };
        overlay.draw(sheet, top_px, modelled.as_ref(), residual.as_ref())?;
        top_px += OVERLAY_PX + BETWEEN_PX;
        let runs = [
            residual.map(|trace| {
                (
                    "model driven by the duty cycles alone",
                    palette::MODEL,
                    &signal.free_run,
                    trace,
                )
            }),
            one_step_ahead.map(|(summary, trace)| {
                (
                    "model corrected by each measured pressure",
                    palette::ONE_STEP_AHEAD,
                    summary,
                    trace,
                )
            }),
        ];
        for (run, colour, summary, trace) in runs.into_iter().flatten() {
            let residual = Residual {
                run,
                colour,
                summary,
                unit: &signal.unit,
                window_s: &window_s,
            };
            residual.draw(sheet, top_px, trace)?;
            top_px += RESIDUAL_PX + BETWEEN_PX;
        }
        duties(sheet, (LABELS_PX, top_px), PLOT_PX, log, &window_s)
    })
}

/// Smallest number of samples in an excerpt: the samples of a slow log are farther apart.
const FEWEST_SAMPLES: f64 = 100.0;

/// Returns the window of `length_s`, or of [`FEWEST_SAMPLES`], with the largest free-run residual of the signal `name`;
/// `None` if the log is not longer.
pub(crate) fn excerpt(comparison: &Comparison, name: &str, length_s: f64) -> Option<Range<f64>> {
    let residual = curve::free_run_residual(&comparison.traces, name)?;
    let length_s = length_s.max(FEWEST_SAMPLES * residual.step_s());
    let all_s = residual.window_s();
    if all_s.end - all_s.start <= length_s {
        return None;
    }
    let points: Vec<_> = curve::squares(&residual).collect();
    let (mut first, mut sum, mut best) = (0, 0.0, (f64::NEG_INFINITY, all_s.start));
    for (time_s, square) in &points {
        sum += square;
        while points[first].0 < time_s - length_s {
            sum -= points[first].1;
            first += 1;
        }
        // A window that begins before the log would be shorter than requested.
        if time_s - all_s.start >= length_s && sum > best.0 {
            best = (sum, time_s - length_s);
        }
    }
    // Whole seconds are easier to read, and stay within the log.
    let start_s = best.1.floor().max(all_s.start);
    Some(start_s..start_s + length_s)
}

/// Height of the strip of duty cycles (px).
pub(super) const DUTIES_PX: i32 = 70;

/// Draws the duty cycles of both valves, with the time axis below.
pub(super) fn duties(
    sheet: &Sheet<'_>,
    corner: canvas::Pixel,
    width_px: i32,
    recording: &Recording,
    window_s: &Range<f64>,
) -> Result<(), PlotError> {
    let commanded = [
        ("duty_fill", "fill valve", palette::FILL),
        ("duty_vent", "vent valve", palette::VENT),
    ];
    let traces: Vec<_> = commanded
        .into_iter()
        .filter_map(|(name, valve, colour)| {
            let trace = Trace::of_in(recording, name, Unit::Percent)?;
            Some(((valve, colour), trace))
        })
        .collect();
    let mut chart = sheet.panel(&Panel {
        corner,
        size: (width_px, DUTIES_PX),
        x: window_s.clone(),
        y: -4.0..104.0,
        x_caption: Some("time [s]"),
        y_caption: if traces.is_empty() {
            "Duty cycle [%]: nothing is commanded"
        } else {
            "Duty cycle [%]"
        },
    })?;
    let legend: Vec<_> = traces.iter().map(|(entry, _)| *entry).collect();
    sheet.legend((corner.0 + width_px, corner.1 - 16), &legend)?;
    for ((_, colour), trace) in traces.iter().rev() {
        chart.curve(
            &curve::stairs(trace, window_s, width_px as usize),
            *colour,
            1.25,
        )?;
    }
    Ok(())
}

/// Formats a range as `0 to 60 s`.
pub(super) fn span(window_s: &Range<f64>) -> String {
    let round = |time_s: f64| (time_s * 100.0).round() / 100.0;
    format!("{} to {} s", round(window_s.start), round(window_s.end))
}

struct Overlay<'a> {
    words: &'a str,
    unit: &'a str,
    window_s: &'a Range<f64>,
}

impl Overlay<'_> {
    fn draw(
        &self,
        sheet: &Sheet<'_>,
        top_px: i32,
        modelled: Option<&Trace<'_>>,
        residual: Option<&Trace<'_>>,
    ) -> Result<(), PlotError> {
        // Residuals are measured minus modelled, at the same instants.
        let measured = modelled
            .zip(residual)
            .and_then(|(modelled, residual)| modelled.plus(residual));
        let curves = [
            (measured.as_ref(), palette::INK, 2.0),
            (modelled, palette::MODEL, 1.25),
        ];
        let extent = curves
            .iter()
            .filter_map(|(trace, ..)| trace.and_then(|trace| trace.extent(self.window_s)))
            .reduce(union);
        let mut chart = sheet.panel(&Panel {
            corner: (LABELS_PX, top_px),
            size: (PLOT_PX, OVERLAY_PX),
            x: self.window_s.clone(),
            y: with_room(extent.unwrap_or(0.0..1.0)),
            x_caption: None,
            y_caption: &format!("{} [{}]", capitalised(self.words), self.unit),
        })?;
        sheet.legend(
            (LABELS_PX + PLOT_PX, top_px - 16),
            &[("measured", palette::INK), ("modelled", palette::MODEL)],
        )?;
        for (trace, colour, width_px) in curves {
            if let Some(trace) = trace {
                chart.curve(
                    &curve::lines(trace, self.window_s, PLOT_PX as usize),
                    colour,
                    width_px,
                )?;
            }
        }
        Ok(())
    }
}

struct Residual<'a> {
    run: &'a str,
    colour: plotters::style::RGBColor,
    summary: &'a ErrorSummary,
    unit: &'a str,
    window_s: &'a Range<f64>,
}

impl Residual<'_> {
    fn draw(&self, sheet: &Sheet<'_>, top_px: i32, trace: Trace<'_>) -> Result<(), PlotError> {
        let unit = SmallUnit::of_errors_in(self.unit);
        let trace = trace.times(unit.per_unit);
        let sigma = self.summary.expected_rms.map(|sigma| sigma * unit.per_unit);
        let band = 3.5 * sigma.unwrap_or(0.0);
        let extent = union(trace.extent(self.window_s).unwrap_or(0.0..0.0), -band..band);
        let mut chart = sheet.panel(&Panel {
            corner: (LABELS_PX, top_px),
            size: (PLOT_PX, RESIDUAL_PX),
            x: self.window_s.clone(),
            y: with_room(extent),
            x_caption: None,
            y_caption: &format!("Measured − modelled [{}], {}", unit.symbol, self.run),
        })?;
        let right = (LABELS_PX + PLOT_PX, top_px - 16);
        if let Some(sigma) = sigma {
            self.noise(&mut chart, sigma)?;
            sheet.legend(
                right,
                &[
                    ("noise ±1 σ", palette::BAND_INNER),
                    ("±3 σ", palette::BAND_OUTER),
                ],
            )?;
        }
        chart.level(0.0, palette::AXIS)?;
        chart.curve(
            &curve::lines(&trace, self.window_s, PLOT_PX as usize),
            self.colour,
            1.0,
        )
    }

    fn noise(&self, chart: &mut Chart<'_>, sigma: f64) -> Result<(), PlotError> {
        chart.band(-3.0 * sigma..3.0 * sigma, palette::BAND_OUTER)?;
        chart.band(-sigma..sigma, palette::BAND_INNER)
    }
}

#[cfg(test)]
mod tests {
    use model_lab::{CompareOptions, compare};
    use plant_sim::PlantParameters;
    use recording::csv;

    use super::*;

    const LOG: &str = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../data/synthetic/practice-01-id.csv"
    );

    fn practice_log() -> (Recording, Comparison) {
        let log = csv::read_file(LOG, &csv::Options::default()).unwrap();
        let options = CompareOptions::default();
        let comparison = compare(&PlantParameters::nominal(), &log, &options).unwrap();
        (log, comparison)
    }

    /// Goal: the excerpt shows the largest difference. Method: no other window of ten whole seconds has a tenth more.
    #[test]
    fn the_excerpt_is_where_the_residual_is_largest() {
        let (_, comparison) = practice_log();
        let residual = curve::free_run_residual(&comparison.traces, "p_ch").unwrap();
        let squares_in = |window_s: &Range<f64>| -> f64 {
            let inside = curve::squares(&residual).filter(|(time_s, _)| window_s.contains(time_s));
            inside.map(|(_, square)| square).sum()
        };
        let found_s = excerpt(&comparison, "p_ch", 10.0).unwrap();
        let greatest = (0..50)
            .map(|second| squares_in(&(f64::from(second)..f64::from(second) + 10.0)))
            .fold(0.0, f64::max);
        assert!(squares_in(&found_s) > 0.9 * greatest, "{found_s:?}");
        assert_eq!(
            excerpt(&comparison, "p_ch", 60.0),
            None,
            "the log is not longer"
        );
    }

    #[test]
    fn every_axis_names_its_quantity_and_unit() {
        let (log, comparison) = practice_log();
        let [pressure, fill_current, _] = comparison.signals.as_slice() else {
            panic!("three signals are compared");
        };
        let svg = |signal| {
            super::comparison(&log, &comparison, signal, None)
                .unwrap()
                .inline_svg()
        };
        for caption in [
            "Chamber pressure [bar gauge]",
            "Measured − modelled [mbar], model driven by the duty cycles alone",
            "Measured − modelled [mbar], model corrected by each measured pressure",
            "Duty cycle [%]",
            "time [s]",
        ] {
            assert_eq!(svg(pressure).matches(caption).count(), 1, "{caption}");
        }
        assert!(svg(fill_current).contains("Current of the fill valve [mA]"));
    }
}
