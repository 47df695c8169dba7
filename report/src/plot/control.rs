//! Plot of the closed loop: reference, pressure and valves.

use std::ops::Range;

use hil_harness::Requirement;
use hil_harness::checks::{StepResponse, Verdict};
use plotters::style::RGBColor;
use recording::{Recording, Trace, Unit};

use super::canvas::{
    LABELS_PX, Panel, RIGHT_PX, Sheet, WIDTH_PX, clipped, figure, union, with_room,
};
use super::comparison::{DUTIES_PX, duties, span};
use super::curve;
use super::figure::{Figure, PlotError};
use super::palette;

const PLOT_PX: i32 = WIDTH_PX - LABELS_PX - RIGHT_PX;
const PRESSURE_PX: i32 = 250;
const LIFTS_PX: i32 = 70;
const BETWEEN_PX: i32 = 44;
const FIRST_TOP_PX: i32 = 62;
/// Time shown before and after a step (s), so that its beginning and its end are visible.
const AROUND_STEP_S: [f64; 2] = [0.05, 0.85];

/// Draws reference, pressure with the tolerance around the reference, plunger and lifts of the armatures if recorded, and
/// duty cycles. `window_s` is an excerpt; without it the whole run is drawn.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn control(
    recording: &Recording,
    requirement: &Requirement,
    title: &str,
    window_s: Option<Range<f64>>,
) -> Result<Figure, PlotError> {
    let pressure = Trace::of_in(recording, "p_ch", Unit::BarGauge);
    let window_s = window_s
        .or_else(|| pressure.as_ref().map(Trace::window_s))
        .unwrap_or(0.0..1.0);
    let lifts = ["x_fill", "x_vent"].map(|name| Trace::of_in(recording, name, Unit::Millimetre));
    let has_lifts = lifts.iter().any(Option::is_some);
    let lifts_px = if has_lifts { LIFTS_PX + BETWEEN_PX } else { 0 };
    let plunger = Trace::of_in(recording, "x_plunger", Unit::Millimetre);
    let plunger_px = plunger.as_ref().map_or(0, |_| LIFTS_PX + BETWEEN_PX);
    let height_px =
        FIRST_TOP_PX + PRESSURE_PX + BETWEEN_PX + plunger_px + lifts_px + DUTIES_PX + 46;
    let title = format!("{}, {}", clipped(title, 80), span(&window_s));
    figure(WIDTH_PX, height_px, title.clone(), |sheet| {
        sheet.title(&title)?;
        let mut top_px = FIRST_TOP_PX;
        let reference = Trace::of_in(recording, "p_ref", Unit::BarGauge);
        pressures(
            sheet,
            top_px,
            [reference, pressure],
            requirement.p_tol_bar,
            &window_s,
        )?;
        top_px += PRESSURE_PX + BETWEEN_PX;
        if let Some(plunger) = plunger {
            let caption = "Position of the regulating valve's plunger [mm]";
            let curves = [(Some(plunger), palette::MODEL)];
            draw_positions(sheet, top_px, caption, &curves, &window_s)?;
            top_px += LIFTS_PX + BETWEEN_PX;
        }
        if has_lifts {
            let [fill, vent] = lifts;
            let caption = "Lift of the armature at the sample [mm]";
            let curves = [(vent, palette::VENT), (fill, palette::FILL)];
            draw_positions(sheet, top_px, caption, &curves, &window_s)?;
            top_px += LIFTS_PX + BETWEEN_PX;
        }
        duties(sheet, (LABELS_PX, top_px), PLOT_PX, recording, &window_s)
    })
}

/// Returns the step to show in detail, with its window: of the steps in the operating range, or else of all, the one
/// that settled last.
pub(crate) fn step_of_interest(verdict: &Verdict) -> Option<(&StepResponse, Range<f64>)> {
    let step = verdict.steps.iter().max_by_key(|step| {
        (
            step.in_operating_range,
            step.settled_samples.unwrap_or(u32::MAX),
        )
    })?;
    let [before_s, after_s] = AROUND_STEP_S;
    Some((step, step.time_s - before_s..step.time_s + after_s))
}

fn pressures(
    sheet: &Sheet<'_>,
    top_px: i32,
    [reference, pressure]: [Option<Trace<'_>>; 2],
    tolerance_bar: f64,
    window_s: &Range<f64>,
) -> Result<(), PlotError> {
    let extent = [&reference, &pressure]
        .into_iter()
        .flatten()
        .filter_map(|trace| trace.extent(window_s))
        .reduce(union)
        .unwrap_or(0.0..1.0);
    let mut chart = sheet.panel(&Panel {
        corner: (LABELS_PX, top_px),
        size: (PLOT_PX, PRESSURE_PX),
        x: window_s.clone(),
        y: with_room(extent.start - tolerance_bar..extent.end + tolerance_bar),
        x_caption: None,
        y_caption: "Chamber pressure [bar gauge]",
    })?;
    sheet.legend(
        (LABELS_PX + PLOT_PX, top_px - 16),
        &[
            ("chamber pressure", palette::MODEL),
            ("reference", palette::INK),
            (&format!("±{tolerance_bar} bar"), palette::BAND_INNER),
        ],
    )?;
    if let Some(reference) = reference {
        let stairs = curve::stairs(&reference, window_s, PLOT_PX as usize);
        for stair in &stairs {
            let [lower, upper] = [-tolerance_bar, tolerance_bar].map(|offset| {
                stair
                    .iter()
                    .map(|(time_s, bar)| (*time_s, bar + offset))
                    .collect::<Vec<_>>()
            });
            chart.area_between(&lower, &upper, palette::BAND_INNER)?;
        }
        chart.curve(&stairs, palette::INK, 1.0)?;
    }
    if let Some(pressure) = pressure {
        chart.curve(
            &curve::lines(&pressure, window_s, PLOT_PX as usize),
            palette::MODEL,
            1.75,
        )?;
    }
    Ok(())
}

fn draw_positions(
    sheet: &Sheet<'_>,
    top_px: i32,
    caption: &str,
    curves: &[(Option<Trace<'_>>, RGBColor)],
    window_s: &Range<f64>,
) -> Result<(), PlotError> {
    let greatest_mm = curves
        .iter()
        .filter_map(|(trace, _)| trace.as_ref())
        .filter_map(|trace| trace.extent(window_s))
        .fold(0.1, |greatest: f64, extent| greatest.max(extent.end));
    let mut chart = sheet.panel(&Panel {
        corner: (LABELS_PX, top_px),
        size: (PLOT_PX, LIFTS_PX),
        x: window_s.clone(),
        y: with_room(0.0..greatest_mm),
        x_caption: None,
        y_caption: caption,
    })?;
    for (trace, colour) in curves {
        if let Some(trace) = trace {
            chart.curve(
                &curve::lines(trace, window_s, PLOT_PX as usize),
                *colour,
                1.25,
            )?;
        }
    }
    Ok(())
}
