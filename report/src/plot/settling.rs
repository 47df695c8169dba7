//! Plot of the settling time of each step.

use hil_harness::checks::{StepResponse, Verdict};
use hil_harness::rigs::RigVerdict;
use hil_harness::{Requirement, SettlingTimes};

use super::canvas::{Align, LABELS_PX, Panel, RIGHT_PX, WIDTH_PX, figure};
use super::figure::{Figure, PlotError};
use super::palette;

const PLOT_PX: i32 = WIDTH_PX - LABELS_PX - RIGHT_PX;
const HEIGHT_PX: i32 = 200;
const TOP_PX: i32 = 62;

/// Draws the settling time of every step over its new reference, with T_req. A ring marks a reference outside the
/// operating range; a step that never settled is drawn at the upper edge.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn settling(verdict: &Verdict, requirement: &Requirement) -> Result<Figure, PlotError> {
    let limit = f64::from(requirement.t_req_samples);
    let slowest = verdict
        .steps
        .iter()
        .filter_map(|step| step.settled_samples)
        .fold(limit, |slowest, samples| slowest.max(f64::from(samples)));
    let highest = 1.15 * slowest;
    let title = "Settling time of each step of the reference, compared with the limit";
    figure(WIDTH_PX, TOP_PX + HEIGHT_PX + 46, title, |sheet| {
        sheet.title(title)?;
        let references = verdict.steps.iter().map(|step| step.to_bar);
        let greatest_bar = references.fold(1.0, f64::max);
        let mut chart = sheet.panel(&Panel {
            corner: (LABELS_PX, TOP_PX),
            size: (PLOT_PX, HEIGHT_PX),
            x: -0.1..greatest_bar + 0.3,
            y: 0.0..highest,
            x_caption: Some("new reference [bar gauge]"),
            y_caption: "Settling time [samples]",
        })?;
        sheet.legend(
            (LABELS_PX + PLOT_PX, TOP_PX - 16),
            &[
                ("rising step", palette::FILL),
                ("falling step", palette::VENT),
                ("limit", palette::LIMIT),
            ],
        )?;
        chart.level(limit, palette::LIMIT)?;
        for step in &verdict.steps {
            let samples = step.settled_samples.map_or(highest, f64::from);
            chart.dot(
                (step.to_bar, samples),
                colour(step),
                step.in_operating_range,
            )?;
        }
        let note = "ring: outside the operating range; at the upper edge: never settled";
        sheet.small_text(
            note,
            (LABELS_PX + PLOT_PX, 14),
            Align::Right,
            palette::LABEL,
        )
    })
}

fn colour(step: &StepResponse) -> plotters::style::RGBColor {
    if step.to_bar >= step.from_bar {
        palette::FILL
    } else {
        palette::VENT
    }
}

/// Draws the share of the steps, and of the rigs by their slowest step, that have settled by each time. A curve that
/// ends below 100 % has steps that never settled.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn settling_on_rigs(
    rigs: &[RigVerdict],
    requirement: &Requirement,
) -> Result<Figure, PlotError> {
    let limit = f64::from(requirement.t_req_samples);
    let curves = [
        (SettlingTimes::of_steps(rigs), palette::FILL),
        (SettlingTimes::of_rigs(rigs), palette::MODEL),
    ];
    let longest = curves
        .iter()
        .filter_map(|(times, _)| times.samples.last())
        .fold(limit, |longest, &time| longest.max(f64::from(time)));
    let end = 1.1 * longest;
    let title = "Settling times on the scattered rigs, compared with the limit";
    figure(WIDTH_PX, TOP_PX + HEIGHT_PX + 46, title, |sheet| {
        sheet.title(title)?;
        let mut chart = sheet.panel(&Panel {
            corner: (LABELS_PX, TOP_PX),
            size: (PLOT_PX, HEIGHT_PX),
            x: 0.0..end,
            y: 0.0..105.0,
            x_caption: Some("settling time [samples]"),
            y_caption: "Settled by then [%]",
        })?;
        sheet.legend(
            (LABELS_PX + PLOT_PX, TOP_PX - 16),
            &[
                ("steps", palette::FILL),
                ("rigs, slowest step", palette::MODEL),
                ("limit", palette::LIMIT),
            ],
        )?;
        chart.curve(&[vec![(limit, 0.0), (limit, 105.0)]], palette::LIMIT, 1.25)?;
        for (times, colour) in &curves {
            chart.curve(&[stairs(times, end)], *colour, 1.75)?;
        }
        Ok(())
    })
}

/// Returns the distribution in percent over samples.
fn stairs(times: &SettlingTimes, end: f64) -> Vec<(f64, f64)> {
    let mut trace = vec![(0.0, 0.0)];
    let mut percent = 0.0;
    for (samples, share) in times.distribution() {
        trace.push((f64::from(samples), percent));
        percent = 100.0 * share;
        trace.push((f64::from(samples), percent));
    }
    trace.push((end, percent));
    trace
}
