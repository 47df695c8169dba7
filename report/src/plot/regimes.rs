//! Plot of the shares of the excess error along one dimension.

use model_lab::result::{RegimeBin, RegimeShares};

use super::canvas::{Align, Sheet, clipped, figure};
use super::figure::{Figure, PlotError};
use super::palette;

const WIDTH_PX: i32 = 464;
const LABELS_PX: i32 = 148;
const TOP_PX: i32 = 50;
const ROW_PX: i32 = 26;
const BARS_PX: i32 = WIDTH_PX - LABELS_PX - 52;

/// Draws the share of the excess and the share of the samples for each bin of the dimension.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn regime(shares: &RegimeShares) -> Result<Figure, PlotError> {
    let height_px = TOP_PX + shares.bins.len() as i32 * ROW_PX + 30;
    let description = format!("Share of the excess error by {}", shares.title);
    figure(WIDTH_PX, height_px, description, |sheet| {
        let title = clipped(&format!("By {}", shares.title), 60);
        sheet.bold_text(&title, (8, 14), Align::Left)?;
        sheet.legend(
            (WIDTH_PX - 8, 36),
            &[
                ("share of the excess [%]", palette::MODEL),
                ("of the samples [%]", palette::AXIS),
            ],
        )?;
        let bottom = TOP_PX + shares.bins.len() as i32 * ROW_PX;
        for percent in [0, 25, 50, 75, 100] {
            let x = LABELS_PX + BARS_PX * percent / 100;
            sheet.line([(x, TOP_PX), (x, bottom)], palette::GRID, 1.0)?;
            sheet.small_text(
                &percent.to_string(),
                (x, bottom + 12),
                Align::Centre,
                palette::LABEL,
            )?;
        }
        for (row, bin) in shares.bins.iter().enumerate() {
            draw_bin(sheet, TOP_PX + row as i32 * ROW_PX, bin)?;
        }
        sheet.line(
            [(LABELS_PX, TOP_PX), (LABELS_PX, bottom)],
            palette::AXIS,
            1.0,
        )
    })
}

fn draw_bin(sheet: &Sheet<'_>, top_px: i32, bin: &RegimeBin) -> Result<(), PlotError> {
    let middle = top_px + ROW_PX / 2;
    sheet.text(
        &clipped(&bin.label, 22),
        (LABELS_PX - 8, middle),
        Align::Right,
        palette::LABEL,
    )?;
    // Use the one-step-ahead error if there is one: a free run also accumulates errors of other regimes.
    let error = bin.one_step_ahead.as_ref().unwrap_or(&bin.free_run);
    let length = |share: f64| (f64::from(BARS_PX) * share.clamp(0.0, 1.0)).round() as i32;
    let excess = error.excess_share.unwrap_or(0.0);
    sheet.rectangle(
        [
            (LABELS_PX, middle - 8),
            (LABELS_PX + length(excess), middle + 2),
        ],
        palette::MODEL,
    )?;
    sheet.rectangle(
        [
            (LABELS_PX, middle + 3),
            (LABELS_PX + length(bin.sample_share), middle + 7),
        ],
        palette::AXIS,
    )?;
    let end = LABELS_PX + length(excess.max(bin.sample_share)) + 6;
    let number = error
        .excess_share
        .map_or("within chance".to_owned(), |share| {
            format!("{:.0}", (100.0 * share).max(0.0))
        });
    sheet.text(&number, (end, middle - 1), Align::Left, palette::INK)
}
