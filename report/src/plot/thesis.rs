//! Plot of the thesis' measured figures beside the simulated ones.

use model_lab::thesis::{Row, ThesisTable};

use super::canvas::{Align, Sheet, WIDTH_PX, clipped, figure, stroke};
use super::figure::{Figure, PlotError};
use super::palette;
use super::quantity::short;

const TOP_PX: i32 = 40;
const ROW_PX: i32 = 22;
const HEADER_PX: i32 = 26;
const FOOTER_PX: i32 = 36;
const LABELS_PX: i32 = 470;
const DOTS_PX: i32 = WIDTH_PX - LABELS_PX - 130;

/// Draws one row of dots per figure: measured and simulated, joined by their difference. Rows of one unit share a
/// logarithmic axis, so that equal distances are equal ratios.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn thesis(table: &ThesisTable) -> Result<Figure, PlotError> {
    let mut groups: Vec<Vec<&Row>> = Vec::new();
    for row in &table.rows {
        match groups.iter_mut().find(|group| group[0].unit == row.unit) {
            Some(group) => group.push(row),
            None => groups.push(vec![row]),
        }
    }
    let rows_px = |group: &Vec<&Row>| HEADER_PX + FOOTER_PX + group.len() as i32 * ROW_PX;
    let height_px = TOP_PX + groups.iter().map(rows_px).sum::<i32>();
    let title = "Figures of the thesis: measured and simulated by the nominal model";
    figure(WIDTH_PX, height_px, title, |sheet| {
        sheet.title(title)?;
        sheet.legend(
            (WIDTH_PX - 16, 38),
            &[("measured", palette::INK), ("simulated", palette::MODEL)],
        )?;
        let mut top_px = TOP_PX;
        for group in &groups {
            draw_group(sheet, top_px, group)?;
            top_px += rows_px(group);
        }
        Ok(())
    })
}

fn draw_group(sheet: &Sheet<'_>, top_px: i32, group: &[&Row]) -> Result<(), PlotError> {
    let axis = LogAxis::over(group);
    let first = top_px + HEADER_PX;
    let bottom = first + group.len() as i32 * ROW_PX;
    for tick in axis.ticks() {
        let x = axis.pixel(tick);
        sheet.line([(x, first), (x, bottom)], palette::GRID, 1.0)?;
        sheet.small_text(
            &tick.to_string(),
            (x, bottom + 10),
            Align::Centre,
            palette::LABEL,
        )?;
    }
    let caption = (LABELS_PX + DOTS_PX / 2, bottom + 27);
    sheet.text(
        &axis_caption(&group[0].unit),
        caption,
        Align::Centre,
        palette::INK,
    )?;
    for (index, row) in group.iter().enumerate() {
        draw_row(
            sheet,
            first + index as i32 * ROW_PX + ROW_PX / 2,
            row,
            &axis,
        )?;
    }
    Ok(())
}

fn axis_caption(unit: &str) -> String {
    let quantity = match unit {
        "%" => "duty cycle ",
        "mA" => "current ",
        "T_req" => "time ",
        _ => "",
    };
    format!("{quantity}[{}]", clipped(unit, 20))
}

fn draw_row(sheet: &Sheet<'_>, y: i32, row: &Row, axis: &LogAxis) -> Result<(), PlotError> {
    let rig = row
        .rig
        .as_deref()
        .map(|rig| format!(" ({rig})"))
        .unwrap_or_default();
    let label = clipped(&format!("{}{rig}", row.quantity), 74);
    sheet.text(&label, (LABELS_PX - 12, y), Align::Right, palette::LABEL)?;
    let measured = axis.pixel(row.measured);
    if let Some(simulated) = row.simulated.map(|value| axis.pixel(value)) {
        sheet.line([(measured, y), (simulated, y)], palette::AXIS, 1.5)?;
        sheet.dot((measured, y), 4.5, stroke(palette::INK, 1.5))?;
        sheet.dot((simulated, y), 3.5, stroke(palette::MODEL, 1.0).filled())?;
    } else {
        sheet.dot((measured, y), 4.5, stroke(palette::INK, 1.5))?;
    }
    let deviation = row
        .deviation
        .as_ref()
        .map_or("not reached".to_owned(), |deviation| {
            let sign = if deviation.value > 0.0 { "+" } else { "" };
            format!("{sign}{} {}", short(deviation.value), deviation.unit)
        });
    let colour = if row.holds == Some(false) {
        palette::LIMIT
    } else {
        palette::LABEL
    };
    sheet.small_text(&deviation, (WIDTH_PX - 8, y), Align::Right, colour)
}

/// Logarithmic axis: equal distances are equal ratios.
struct LogAxis {
    from: f64,
    to: f64,
}

impl LogAxis {
    fn over(rows: &[&Row]) -> Self {
        let values = rows
            .iter()
            .flat_map(|row| [Some(row.measured), row.simulated])
            .flatten();
        let positive = values.filter(|value| *value > 0.0);
        let (least, greatest) = positive.fold((f64::INFINITY, 0.0), |(least, greatest), value| {
            (value.min(least), value.max(greatest))
        });
        if greatest > 0.0 {
            Self {
                from: least / 1.12,
                to: greatest * 1.12,
            }
        } else {
            Self {
                from: 0.1,
                to: 10.0,
            }
        }
    }

    fn pixel(&self, value: f64) -> i32 {
        let share = (value.max(self.from) / self.from).ln() / (self.to / self.from).ln();
        LABELS_PX + (f64::from(DOTS_PX) * share.min(1.0)).round() as i32
    }

    /// Returns 1, 2, 5, 10, ...; in a short range every digit.
    fn ticks(&self) -> Vec<f64> {
        let digits: &[u32] = if self.to / self.from > 6.0 {
            &[1, 2, 5]
        } else {
            &[1, 2, 3, 4, 5, 6, 8]
        };
        (-6..6)
            .flat_map(|exponent| digits.iter().map(move |&digit| (digit, exponent)))
            // Parsed from decimal text, so that no tick has the rounding error of a product.
            .filter_map(|(digit, exponent)| format!("{digit}e{exponent}").parse().ok())
            .filter(|tick| (self.from..=self.to).contains(tick))
            .collect()
    }
}
