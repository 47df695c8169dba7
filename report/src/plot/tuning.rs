//! Plot of a search of gains: settling time over overshoot, and over lifts.

use hil_harness::Requirement;
use hil_harness::gain_search::{Candidate, Found, Name};

use super::canvas::{Align, LABELS_PX, Panel, RIGHT_PX, Sheet, WIDTH_PX, figure, with_room};
use super::figure::{Figure, PlotError};
use super::palette;

const BETWEEN_PX: i32 = 40;
const PLOT_PX: i32 = (WIDTH_PX - 2 * (LABELS_PX + RIGHT_PX) - BETWEEN_PX) / 2;
const HEIGHT_PX: i32 = 260;
const TOP_PX: i32 = 62;
/// Largest multiple of the cost of the chosen candidate that is drawn: poor ones would compress the others.
const LARGEST_COST: f64 = 4.0;

/// Draws all candidates whose cost is not far from the chosen one.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn trade_off(found: &Found, requirement: &Requirement) -> Result<Figure, PlotError> {
    let most = LARGEST_COST * found.chosen().quality.cost_samples;
    let (drawn, left_out): (Vec<_>, Vec<_>) = found
        .candidates
        .iter()
        .partition(|candidate| candidate.quality.cost_samples <= most);
    let title = "Settling time, overshoot and lifts of the candidates";
    figure(WIDTH_PX, TOP_PX + HEIGHT_PX + 66, title, |sheet| {
        sheet.title(title)?;
        let overshoot = |candidate: &Candidate| candidate.quality.overshoot_p99_bar;
        let lifts = |candidate: &Candidate| candidate.quality.lifts_per_s;
        let limit = Some(requirement.p_tol_bar);
        let caption = "Overshoot that 99 % of the steps do not exceed [bar]";
        let axis = Axis {
            place: 0,
            caption,
            limit,
        };
        panel(sheet, found, &drawn, &axis, &overshoot)?;
        let axis = Axis {
            place: 1,
            caption: "Lifts of both valves [1/s]",
            limit: requirement.lifts_per_s,
        };
        panel(sheet, found, &drawn, &axis, &lifts)?;
        let legend = [
            ("candidate", palette::AXIS),
            ("trade-off", palette::FILL),
            ("named", palette::INK),
            ("chosen", palette::MODEL),
            ("limit", palette::LIMIT),
        ];
        sheet.legend((WIDTH_PX - RIGHT_PX, 14), &legend)?;
        if left_out.is_empty() {
            return Ok(());
        }
        let note = format!(
            "not drawn: {} candidates with more than {LARGEST_COST} times the cost of the chosen one",
            left_out.len()
        );
        let at = (WIDTH_PX - RIGHT_PX, TOP_PX + HEIGHT_PX + 54);
        sheet.small_text(&note, at, Align::Right, palette::LABEL)
    })
}

/// Vertical axis of a panel.
struct Axis<'t> {
    /// Place from the left, from 0.
    place: i32,
    caption: &'t str,
    limit: Option<f64>,
}

fn panel(
    sheet: &Sheet<'_>,
    found: &Found,
    drawn: &[&Candidate],
    axis: &Axis<'_>,
    value: &dyn Fn(&Candidate) -> f64,
) -> Result<(), PlotError> {
    let point = |candidate: &Candidate| (candidate.quality.settling_mean_samples, value(candidate));
    let points = || drawn.iter().map(|candidate| point(candidate));
    let slowest = points().fold(0.0, |most: f64, (x, _)| most.max(x));
    let fastest = points().fold(slowest, |least: f64, (x, _)| least.min(x));
    let highest = points().fold(axis.limit.unwrap_or_default(), |most, (_, y)| most.max(y));
    let left = LABELS_PX + axis.place * (PLOT_PX + LABELS_PX + RIGHT_PX + BETWEEN_PX);
    let mut chart = sheet.panel(&Panel {
        corner: (left, TOP_PX),
        size: (PLOT_PX, HEIGHT_PX),
        x: with_room(fastest..slowest),
        y: 0.0..1.08 * highest.max(1e-3),
        x_caption: Some("mean settling time [samples]"),
        y_caption: axis.caption,
    })?;
    if let Some(limit) = axis.limit {
        chart.level(limit, palette::LIMIT)?;
    }
    let front = found.trade_off();
    for candidate in drawn {
        let is_front = front.iter().any(|other| other.name == candidate.name);
        let colour = match candidate.name {
            name if name == found.chosen().name => continue,
            Name::Given | Name::Started(_) => palette::INK,
            Name::Drawn(_) if is_front => palette::FILL,
            Name::Drawn(_) => palette::AXIS,
        };
        chart.dot(point(candidate), colour, is_front)?;
    }
    chart.dot(point(found.chosen()), palette::MODEL, true)
}
