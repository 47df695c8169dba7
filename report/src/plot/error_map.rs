//! Map of the error over duty cycle and pressure.

use std::ops::Range;

use model_lab::result::{ErrorMap, MapCell, SignalComparison};
use plotters::style::{Color, RGBColor};

use super::canvas::{Align, Sheet, WIDTH_PX, clipped, figure};
use super::figure::{Figure, PlotError};
use super::palette;
use super::quantity::{SmallUnit, capitalised, short, signal_words};

const ROW_LABELS_PX: i32 = 150;
const TOP_PX: i32 = 84;
const ROW_PX: i32 = 34;
/// Smallest share that is labelled with a number (-), so that the large ones stand out.
const SHARE_SHOWN: f64 = 0.005;

/// Draws the share of the excess in each cell, coloured by the sign of its mean error.
///
/// # Errors
/// Returns an error if the drawing fails.
pub(crate) fn error_map(signal: &SignalComparison) -> Result<Figure, PlotError> {
    let map = &signal.error_map;
    let grid = Grid::new(map);
    let height_px = grid.bottom_px() + 56;
    let title = format!(
        "{}: share of the excess error by duty cycle and pressure",
        capitalised(&clipped(signal_words(&signal.name), 40))
    );
    figure(WIDTH_PX, height_px, title.clone(), |sheet| {
        sheet.title(&title)?;
        grid.captions(sheet)?;
        let greatest = map.cells.iter().filter_map(share).fold(0.0, f64::max);
        for cell in &map.cells {
            grid.cell(sheet, cell, greatest, SmallUnit::of_errors_in(&signal.unit))?;
        }
        legend(sheet)
    })
}

fn share(cell: &MapCell) -> Option<f64> {
    cell.error.excess_share
}

fn legend(sheet: &Sheet<'_>) -> Result<(), PlotError> {
    sheet.legend(
        (WIDTH_PX - 16, 38),
        &[
            ("measured higher than modelled", palette::MODEL),
            ("measured lower", palette::FILL),
            ("below 0.5 % of the excess", palette::GRID),
        ],
    )
}

struct Grid<'a> {
    map: &'a ErrorMap,
    /// Duty bands from the first to the last one with samples.
    rows: Range<usize>,
    column_px: i32,
}

impl<'a> Grid<'a> {
    fn new(map: &'a ErrorMap) -> Self {
        let columns = map.pressure_bands.len().max(1) as i32;
        let column_px = ((WIDTH_PX - ROW_LABELS_PX - 16) / columns).clamp(3, 140);
        let rows = map.cells.iter().map(|cell| cell.duty_band);
        let first = rows.clone().min().unwrap_or(0);
        let end = rows.max().map_or(0, |last| last + 1);
        Self {
            map,
            rows: first..end,
            column_px,
        }
    }

    fn bottom_px(&self) -> i32 {
        TOP_PX + self.rows.len() as i32 * ROW_PX
    }

    fn corner(&self, row: usize, column: usize) -> (i32, i32) {
        (
            ROW_LABELS_PX + column as i32 * self.column_px,
            TOP_PX + row.saturating_sub(self.rows.start) as i32 * ROW_PX,
        )
    }

    fn captions(&self, sheet: &Sheet<'_>) -> Result<(), PlotError> {
        sheet.text("Duty cycle", (16, TOP_PX - 18), Align::Left, palette::INK)?;
        for row in self.rows.clone() {
            let (x, y) = self.corner(row, 0);
            let label = self.map.duty_bands.get(row).map_or("", String::as_str);
            sheet.text(
                &clipped(label, 22),
                (x - 12, y + ROW_PX / 2),
                Align::Right,
                palette::LABEL,
            )?;
        }
        let bottom = self.bottom_px();
        for (column, label) in self.map.pressure_bands.iter().enumerate() {
            let x = self.corner(0, column).0 + self.column_px / 2;
            sheet.text(
                &clipped(label, 16),
                (x, bottom + 16),
                Align::Centre,
                palette::LABEL,
            )?;
        }
        let middle = self.corner(0, self.map.pressure_bands.len()).0 / 2 + ROW_LABELS_PX / 2;
        sheet.text(
            "Chamber pressure of the model, gauge",
            (middle, bottom + 40),
            Align::Centre,
            palette::INK,
        )
    }

    fn cell(
        &self,
        sheet: &Sheet<'_>,
        cell: &MapCell,
        greatest: f64,
        unit: SmallUnit<'_>,
    ) -> Result<(), PlotError> {
        let (x, y) = self.corner(cell.duty_band, cell.pressure_band);
        let corners = [(x + 1, y + 1), (x + self.column_px - 1, y + ROW_PX - 1)];
        sheet.rectangle(corners, palette::GRID.mix(0.6))?;
        let share = share(cell).unwrap_or(0.0);
        if share < SHARE_SHOWN || greatest <= 0.0 {
            return Ok(());
        }
        let strength = 0.12 + 0.68 * (share / greatest).min(1.0);
        sheet.rectangle(corners, hue(cell.error.bias).mix(strength))?;
        let middle = x + self.column_px / 2;
        sheet.bold_text(&percent(share), (middle, y + 11), Align::Centre)?;
        let bias = cell.error.bias * unit.per_unit;
        let sign = if bias > 0.0 { "+" } else { "" };
        let mean = format!("{sign}{} {}", short(bias), unit.symbol);
        sheet.small_text(&mean, (middle, y + 25), Align::Centre, palette::INK)
    }
}

fn hue(bias: f64) -> RGBColor {
    if bias > 0.0 {
        palette::MODEL
    } else {
        palette::FILL
    }
}

fn percent(share: f64) -> String {
    if share < 0.095 {
        format!("{:.1} %", 100.0 * share)
    } else {
        format!("{:.0} %", 100.0 * share)
    }
}
