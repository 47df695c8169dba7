//! Plots of a diagnosis: error steps, competing effects, and the model before and after.

use std::ops::Range;

use model_lab::diagnosis::result::{Diagnosis, Step, StepKind};
use model_lab::result::{Comparison, SignalComparison};
use plotters::style::RGBColor;
use recording::{Recording, Trace};

use super::canvas::{
    Align, Chart, LABELS_PX, Panel, RIGHT_PX, Sheet, WIDTH_PX, figure, union, with_room,
};
use super::comparison::{DUTIES_PX, duties, span};
use super::curve;
use super::figure::{Figure, PlotError};
use super::palette;
use super::quantity::{SmallUnit, capitalised, pressure_first, short, signal_words, unit_of};

const PLOT_PX: i32 = WIDTH_PX - LABELS_PX - RIGHT_PX;
const OVERLAY_PX: i32 = 210;
const RESIDUAL_PX: i32 = 130;
/// Space between two panels, for the caption of the lower one (px).
const BETWEEN_PX: i32 = 44;
const FIRST_TOP_PX: i32 = 62;

/// Width of the names left of the bars (px).
const NAMES_PX: i32 = 236;
/// Width of the numbers right of the bars (px).
const FIGURES_PX: i32 = 190;
const BARS_PX: i32 = WIDTH_PX - NAMES_PX - FIGURES_PX;
const TOP_PX: i32 = 54;
const ROW_PX: i32 = 22;
const GROUP_PX: i32 = 14;

/// Draws the error of each signal divided by its noise floor, from the plain model to the last added effect.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn error_steps(steps: &[Step]) -> Result<Figure, PlotError> {
    let longest = steps.iter().map(Step::worst_in_noise).fold(1.0, f64::max);
    let rows: i32 = steps.iter().map(|step| step.check_rms.len() as i32).sum();
    let bottom = TOP_PX + rows * ROW_PX + steps.len() as i32 * (ROW_PX + GROUP_PX);
    let title = "How the error falls: rms on the validation data, divided by the noise floor";
    let place = |times: f64| NAMES_PX + (f64::from(BARS_PX) * times / longest).round() as i32;
    figure(WIDTH_PX, bottom + 36, title, |sheet| {
        sheet.title(title)?;
        let floor = place(1.0);
        let mut top_px = TOP_PX - GROUP_PX;
        for step in steps {
            top_px += GROUP_PX;
            sheet.bold_text(
                &capitalised(&step.name()),
                (8, top_px + ROW_PX / 2),
                Align::Left,
            )?;
            top_px += ROW_PX;
            let first_px = top_px;
            for (signal, rms) in pressure_first(&step.check_rms) {
                let middle = top_px + ROW_PX / 2;
                let times = step.in_noise(signal);
                let end = place(times);
                let words = capitalised(signal_words(signal));
                sheet.text(
                    &words,
                    (NAMES_PX - 10, middle),
                    Align::Right,
                    palette::LABEL,
                )?;
                let colour = match step.kind {
                    StepKind::EffectAdded => palette::ONE_STEP_AHEAD,
                    _ => palette::MODEL,
                };
                sheet.rectangle([(NAMES_PX, middle - 7), (end, middle + 7)], colour)?;
                let unit = SmallUnit::of_errors_in(unit_of(signal));
                let figures = format!(
                    "{} × noise, {} {}",
                    short(times),
                    short(rms * unit.per_unit),
                    unit.symbol
                );
                sheet.text(&figures, (end + 8, middle), Align::Left, palette::INK)?;
                top_px += ROW_PX;
            }
            // Beside the bars alone: a long name reaches over them.
            for (x, colour) in [(floor, palette::LIMIT), (NAMES_PX, palette::AXIS)] {
                sheet.line([(x, first_px), (x, top_px)], colour, 1.0)?;
            }
        }
        sheet.small_text(
            "noise floor",
            (floor, bottom + 12),
            Align::Centre,
            palette::LIMIT,
        )
    })
}

/// Draws the share of the excess error that each effect explains by itself.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn candidates(diagnosis: &Diagnosis) -> Result<Figure, PlotError> {
    let bottom = TOP_PX + diagnosis.candidates.len() as i32 * ROW_PX;
    let title = "What each effect explains by itself, everything refitted [% of the excess error]";
    figure(WIDTH_PX, bottom + 30, title, |sheet| {
        sheet.title(title)?;
        for percent in [0, 25, 50, 75, 100] {
            let x = NAMES_PX + BARS_PX * percent / 100;
            sheet.line([(x, TOP_PX), (x, bottom)], palette::GRID, 1.0)?;
            let label = percent.to_string();
            sheet.small_text(&label, (x, bottom + 12), Align::Centre, palette::LABEL)?;
        }
        for (row, candidate) in diagnosis.candidates.iter().enumerate() {
            let middle = TOP_PX + row as i32 * ROW_PX + ROW_PX / 2;
            let is_named = diagnosis.effects.contains(&candidate.effect);
            let name = candidate.effect.replace(['_', '.'], " ");
            let (colour, ink) = if is_named {
                (palette::ONE_STEP_AHEAD, palette::INK)
            } else {
                (palette::AXIS, palette::LABEL)
            };
            sheet.text(&name, (NAMES_PX - 10, middle), Align::Right, ink)?;
            let share = candidate.explained_share.clamp(0.0, 1.0);
            let end = NAMES_PX + (f64::from(BARS_PX) * share).round() as i32;
            sheet.rectangle([(NAMES_PX, middle - 7), (end, middle + 7)], colour)?;
            let mark = if is_named { "   named" } else { "" };
            let figures = format!("{:.0}{mark}", 100.0 * share);
            sheet.text(&figures, (end + 8, middle), Align::Left, ink)?;
        }
        sheet.line([(NAMES_PX, TOP_PX), (NAMES_PX, bottom)], palette::AXIS, 1.0)
    })
}

/// Draws one signal of a log with the plain model and, if there is one, the refined model in free run, and their
/// residuals. `models` begins with the plain one.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn before_and_after(
    log: &Recording,
    models: &[&Comparison],
    signal: &SignalComparison,
    window_s: Option<Range<f64>>,
) -> Result<Figure, PlotError> {
    let styles = [
        ("plain model", palette::MODEL),
        ("refined model", palette::ONE_STEP_AHEAD),
    ];
    let runs: Vec<Run<'_>> = models
        .iter()
        .zip(styles)
        .map(|(model, (name, colour))| Run::of(model, signal, name, colour))
        .collect();
    let window_s = window_s
        .or_else(|| runs.first()?.modelled.as_ref().map(Trace::window_s))
        .unwrap_or(0.0..1.0);
    let height_px = FIRST_TOP_PX + OVERLAY_PX + RESIDUAL_PX + 2 * BETWEEN_PX + DUTIES_PX + 46;
    let words = signal_words(&signal.name);
    let title = format!("{}, {}", capitalised(words), span(&window_s));
    figure(WIDTH_PX, height_px, title.clone(), |sheet| {
        sheet.title(&title)?;
        let plain = models.first();
        let unit = plain
            .and_then(|plain| plain.traces.free_run.signal(&signal.name))
            .map_or("", |signal| signal.unit().symbol());
        let caption = format!("{} [{unit}]", capitalised(words));
        draw_overlay(sheet, &caption, &runs, &window_s)?;
        let top_px = FIRST_TOP_PX + OVERLAY_PX + BETWEEN_PX;
        draw_residuals(sheet, top_px, signal, &runs, &window_s)?;
        let top_px = top_px + RESIDUAL_PX + BETWEEN_PX;
        duties(sheet, (LABELS_PX, top_px), PLOT_PX, log, &window_s)
    })
}

/// One of the two models on the log.
struct Run<'a> {
    name: &'static str,
    colour: RGBColor,
    modelled: Option<Trace<'a>>,
    residual: Option<Trace<'a>>,
}

impl<'a> Run<'a> {
    fn of(
        comparison: &'a Comparison,
        signal: &SignalComparison,
        name: &'static str,
        colour: RGBColor,
    ) -> Self {
        let traces = &comparison.traces;
        Self {
            name,
            colour,
            modelled: Trace::of(&traces.free_run, &signal.name),
            residual: curve::free_run_residual(traces, &signal.name),
        }
    }
}

fn legend(first: (&'static str, RGBColor), runs: &[Run<'_>]) -> Vec<(&'static str, RGBColor)> {
    let models = runs.iter().map(|run| (run.name, run.colour));
    [first].into_iter().chain(models).collect()
}

fn draw_overlay(
    sheet: &Sheet<'_>,
    caption: &str,
    runs: &[Run<'_>],
    window_s: &Range<f64>,
) -> Result<(), PlotError> {
    // Residuals are measured minus modelled, at the same instants.
    let measured = runs.first().and_then(|plain| {
        let both = plain.modelled.as_ref().zip(plain.residual.as_ref());
        both.and_then(|(modelled, residual)| modelled.plus(residual))
    });
    let modelled = runs
        .iter()
        .map(|run| (run.modelled.as_ref(), run.colour, 1.25));
    let curves = || {
        [(measured.as_ref(), palette::INK, 2.0)]
            .into_iter()
            .chain(modelled.clone())
    };
    let extents = curves().filter_map(|(trace, ..)| trace.and_then(|trace| trace.extent(window_s)));
    let mut chart = sheet.panel(&Panel {
        corner: (LABELS_PX, FIRST_TOP_PX),
        size: (PLOT_PX, OVERLAY_PX),
        x: window_s.clone(),
        y: with_room(extents.reduce(union).unwrap_or(0.0..1.0)),
        x_caption: None,
        y_caption: caption,
    })?;
    let legend = legend(("measured", palette::INK), runs);
    sheet.legend((LABELS_PX + PLOT_PX, FIRST_TOP_PX - 16), &legend)?;
    for (trace, colour, width_px) in curves() {
        draw(&mut chart, trace, colour, width_px, window_s)?;
    }
    Ok(())
}

fn draw_residuals(
    sheet: &Sheet<'_>,
    top_px: i32,
    signal: &SignalComparison,
    runs: &[Run<'_>],
    window_s: &Range<f64>,
) -> Result<(), PlotError> {
    let unit = SmallUnit::of_errors_in(&signal.unit);
    let residuals = runs.iter().map(|run| run.residual.clone());
    let traces: Vec<_> = residuals
        .map(|trace| trace.map(|trace| trace.times(unit.per_unit)))
        .collect();
    let sigma = signal.noise_floor.value.unwrap_or(0.0) * unit.per_unit;
    let extents = traces
        .iter()
        .flatten()
        .filter_map(|trace| trace.extent(window_s));
    let extent = extents.fold(-3.5 * sigma..3.5 * sigma, union);
    let mut chart = sheet.panel(&Panel {
        corner: (LABELS_PX, top_px),
        size: (PLOT_PX, RESIDUAL_PX),
        x: window_s.clone(),
        y: with_room(extent),
        x_caption: None,
        y_caption: &format!(
            "Measured − modelled [{}], driven by the commands alone",
            unit.symbol
        ),
    })?;
    chart.band(-3.0 * sigma..3.0 * sigma, palette::BAND_OUTER)?;
    let legend = legend(("noise ±3 σ", palette::BAND_OUTER), runs);
    sheet.legend((LABELS_PX + PLOT_PX, top_px - 16), &legend)?;
    chart.level(0.0, palette::AXIS)?;
    for (run, trace) in runs.iter().zip(&traces) {
        draw(&mut chart, trace.as_ref(), run.colour, 1.0, window_s)?;
    }
    Ok(())
}

fn draw(
    chart: &mut Chart<'_>,
    trace: Option<&Trace<'_>>,
    colour: RGBColor,
    width_px: f64,
    window_s: &Range<f64>,
) -> Result<(), PlotError> {
    match trace {
        Some(trace) => chart.curve(
            &curve::lines(trace, window_s, PLOT_PX as usize),
            colour,
            width_px,
        ),
        None => Ok(()),
    }
}
