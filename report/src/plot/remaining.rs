//! Plot of the mass flow that is missing after the named effects.

use model_lab::diagnosis::result::{FlowCurve, FlowPoint};

use super::canvas::{
    LABELS_PX, Panel, RIGHT_PX, Sheet, WIDTH_PX, clipped, figure, union, with_room,
};
use super::figure::{Figure, PlotError};
use super::palette;

const COLUMNS: usize = 2;
/// Size of a panel with its labels (px).
const CELL_PX: (i32, i32) = (WIDTH_PX / COLUMNS as i32, 236);
/// Size of the plot area (px).
const PLOT_PX: (i32, i32) = (CELL_PX.0 - LABELS_PX - RIGHT_PX, 140);
const TOP_PX: i32 = 62;
/// Number of caption characters that fit over a panel.
const CAPTION: usize = 60;

/// Draws the missing flow over each quantity that it depends on, with two standard errors on either side.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn missing_flow(curves: &[FlowCurve]) -> Result<Figure, PlotError> {
    let rows = curves.len().div_ceil(COLUMNS) as i32;
    let title = "The flow that is missing; above zero air comes in [bar/s]";
    figure(WIDTH_PX, TOP_PX - 40 + rows * CELL_PX.1, title, |sheet| {
        sheet.title(title)?;
        for (index, curve) in curves.iter().enumerate() {
            let (column, row) = ((index % COLUMNS) as i32, (index / COLUMNS) as i32);
            let corner = (LABELS_PX + column * CELL_PX.0, TOP_PX + row * CELL_PX.1);
            draw(sheet, corner, curve)?;
        }
        Ok(())
    })
}

fn draw(sheet: &Sheet<'_>, corner: (i32, i32), curve: &FlowCurve) -> Result<(), PlotError> {
    let ends = |point: &FlowPoint| {
        let twice = 2.0 * point.standard_error;
        point.bar_per_s - twice..point.bar_per_s + twice
    };
    let (Some(first), Some(last)) = (curve.points.first(), curve.points.last()) else {
        return Ok(());
    };
    let caption = format!(
        "{}: explains {:.0} % of it",
        curve.condition,
        100.0 * curve.explained_share
    );
    let mut chart = sheet.panel(&Panel {
        corner,
        size: PLOT_PX,
        x: with_room(first.at..last.at),
        y: with_room(curve.points.iter().map(ends).fold(0.0..0.0, union)),
        x_caption: Some(&format!("{} [{}]", curve.against, curve.unit)),
        y_caption: &clipped(&caption, CAPTION),
    })?;
    chart.level(0.0, palette::AXIS)?;
    for point in &curve.points {
        let bar = ends(point);
        let upright = vec![(point.at, bar.start), (point.at, bar.end)];
        chart.curve(&[upright], palette::LABEL, 1.0)?;
    }
    let trace = curve.points.iter().map(|point| (point.at, point.bar_per_s));
    chart.curve(&[trace.clone().collect()], palette::MODEL, 1.25)?;
    trace
        .into_iter()
        .try_for_each(|at| chart.dot(at, palette::MODEL, true))
}
