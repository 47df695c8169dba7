//! Colours by their role. The hues are those of Okabe and Ito (Color Universal Design, 2008).

use plotters::style::RGBColor;

/// Colour on white and its counterpart on a dark background, both as `#RRGGBB`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Counterpart {
    /// Colour on white, as drawn.
    pub(crate) on_white: &'static str,
    /// Colour on a dark background.
    pub(crate) on_dark: &'static str,
}

/// Measurement; important text.
pub(super) const INK: RGBColor = RGBColor(0x1F, 0x1F, 0x1F);
/// Labels of axes.
pub(super) const LABEL: RGBColor = RGBColor(0x59, 0x59, 0x59);
/// Axes and zero lines.
pub(super) const AXIS: RGBColor = RGBColor(0x9A, 0x9A, 0x9A);
/// Grid lines and empty cells.
pub(super) const GRID: RGBColor = RGBColor(0xE6, 0xE6, 0xE6);
/// Inner part of a band: ±1 σ.
pub(super) const BAND_INNER: RGBColor = RGBColor(0xD2, 0xD8, 0xDE);
/// Outer part of a band: ±3 σ, or a tolerance.
pub(super) const BAND_OUTER: RGBColor = RGBColor(0xEA, 0xEE, 0xF1);
/// Model, and its free-run residual.
pub(super) const MODEL: RGBColor = RGBColor(0xD5, 0x5E, 0x00);
/// One-step-ahead prediction, and the refined model.
pub(super) const ONE_STEP_AHEAD: RGBColor = RGBColor(0x00, 0x9E, 0x73);
/// Fill valve.
pub(super) const FILL: RGBColor = RGBColor(0x00, 0x72, 0xB2);
/// Vent valve.
pub(super) const VENT: RGBColor = RGBColor(0xCC, 0x79, 0xA7);
/// Limit.
pub(super) const LIMIT: RGBColor = RGBColor(0xB0, 0x2A, 0x1E);

/// Colours on a dark background, by colour on white.
pub(crate) const DARK: &[Counterpart] = &[
    pair("#1F1F1F", "#EDEBE8"),
    pair("#595959", "#B3B0AC"),
    pair("#9A9A9A", "#75726E"),
    pair("#E6E6E6", "#383735"),
    pair("#D2D8DE", "#48525B"),
    pair("#EAEEF1", "#2F363C"),
    pair("#D55E00", "#F0802C"),
    pair("#009E73", "#2BC397"),
    pair("#0072B2", "#56B4E9"),
    pair("#CC79A7", "#DD94BD"),
    pair("#B02A1E", "#F0746A"),
];

const fn pair(on_white: &'static str, on_dark: &'static str) -> Counterpart {
    Counterpart { on_white, on_dark }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Goal: every colour has a dark counterpart. Method: compare every role with the table.
    #[test]
    fn every_colour_has_a_counterpart_on_a_dark_ground() {
        let roles = [
            INK,
            LABEL,
            AXIS,
            GRID,
            BAND_INNER,
            BAND_OUTER,
            MODEL,
            ONE_STEP_AHEAD,
            FILL,
            VENT,
            LIMIT,
        ];
        let written =
            roles.map(|RGBColor(red, green, blue)| format!("#{red:02X}{green:02X}{blue:02X}"));
        let listed: Vec<_> = DARK.iter().map(|pair| pair.on_white).collect();
        assert_eq!(written.to_vec(), listed);
    }
}
