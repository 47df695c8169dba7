//! Drawing area: a figure, its texts, and panels with axes.

use std::ops::Range;

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::curve::Point;
use super::figure::{FONT, Figure, PlotError, SCALE, printable};
use super::palette;
use super::quantity::tick;

/// Mean width of a character (em), for the positions of legend entries.
const CHARACTER_EM: f64 = 0.57;
/// Divisor that the backend applies to font sizes.
const BACKEND_FONT_SIZE: f64 = 1.24;
/// Size of ordinary text (px).
const TEXT_PX: f64 = 12.5;
/// Size of titles (px).
const TITLE_PX: f64 = 15.0;

/// Space left of a panel for its labels (px).
pub(super) const LABELS_PX: i32 = 52;
/// Width of a figure across the page (px).
pub(super) const WIDTH_PX: i32 = 960;
/// Left edge of titles and captions (px).
const LEFT_PX: i32 = 8;
/// Space right of a panel, so that the last label of its axis is not cut (px).
pub(super) const RIGHT_PX: i32 = 16;

type Backend<'a> = SVGBackend<'a>;
type DrawError = DrawingAreaErrorKind<<Backend<'static> as DrawingBackend>::ErrorType>;
type Plane = Cartesian2d<RangedCoordf64, RangedCoordf64>;

impl From<DrawError> for PlotError {
    fn from(error: DrawError) -> Self {
        Self::because(&error)
    }
}

/// Draws a figure; `description` is its text for screen readers.
pub(super) fn figure(
    width_px: i32,
    height_px: i32,
    description: impl Into<String>,
    draw: impl FnOnce(&Sheet<'_>) -> Result<(), PlotError>,
) -> Result<Figure, PlotError> {
    let mut text = String::new();
    {
        let size = ((width_px * SCALE) as u32, (height_px * SCALE) as u32);
        let sheet = Sheet {
            area: SVGBackend::with_string(&mut text, size).into_drawing_area(),
        };
        draw(&sheet)?;
        sheet.area.present()?;
    }
    Ok(Figure::from_backend(
        width_px,
        height_px,
        description.into(),
        &text,
    ))
}

/// Horizontal alignment of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Align {
    Left,
    Centre,
    Right,
}

/// Drawing area in pixels from the upper left.
pub(super) struct Sheet<'a> {
    area: DrawingArea<Backend<'a>, Shift>,
}

/// Position (px).
pub(super) type Pixel = (i32, i32);

impl<'a> Sheet<'a> {
    /// Writes the title in the first line.
    pub(super) fn title(&self, text: &str) -> Result<(), PlotError> {
        let style = font(TITLE_PX, palette::INK, Align::Left, true);
        self.write(text, (LEFT_PX, 14), style)
    }

    /// Writes a line of ordinary text, vertically centred at the position.
    pub(super) fn text(
        &self,
        text: &str,
        at: Pixel,
        align: Align,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        self.write(text, at, font(TEXT_PX, colour, align, false))
    }

    /// Writes a line of smaller text.
    pub(super) fn small_text(
        &self,
        text: &str,
        at: Pixel,
        align: Align,
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        self.write(text, at, font(TEXT_PX - 2.0, colour, align, false))
    }

    /// Writes a line of bold text.
    pub(super) fn bold_text(&self, text: &str, at: Pixel, align: Align) -> Result<(), PlotError> {
        self.write(text, at, font(TEXT_PX, palette::INK, align, true))
    }

    fn write(&self, text: &str, at: Pixel, style: TextStyle<'_>) -> Result<(), PlotError> {
        let text: String = text.chars().map(printable).collect();
        Ok(self.area.draw_text(&text, &style, scaled(at))?)
    }

    /// Draws a filled rectangle.
    pub(super) fn rectangle(
        &self,
        corners: [Pixel; 2],
        style: impl Into<ShapeStyle>,
    ) -> Result<(), PlotError> {
        let corners = corners.map(scaled);
        Ok(self
            .area
            .draw(&Rectangle::new(corners, style.into().filled()))?)
    }

    /// Draws a straight line.
    pub(super) fn line(
        &self,
        ends: [Pixel; 2],
        colour: RGBColor,
        width_px: f64,
    ) -> Result<(), PlotError> {
        let ends = ends.map(scaled).to_vec();
        Ok(self
            .area
            .draw(&PathElement::new(ends, stroke(colour, width_px)))?)
    }

    /// Draws a filled polygon.
    pub(super) fn polygon(&self, corners: &[Pixel], colour: RGBColor) -> Result<(), PlotError> {
        let corners: Vec<_> = corners.iter().copied().map(scaled).collect();
        Ok(self.area.draw(&Polygon::new(corners, colour.filled()))?)
    }

    /// Draws a dot with a radius (px).
    pub(super) fn dot(
        &self,
        at: Pixel,
        radius_px: f64,
        style: impl Into<ShapeStyle>,
    ) -> Result<(), PlotError> {
        let radius = (radius_px * f64::from(SCALE)) as i32;
        Ok(self.area.draw(&Circle::new(scaled(at), radius, style))?)
    }

    /// Draws axes with ticks and the name of the vertical axis above them.
    pub(super) fn panel(&self, panel: &Panel<'_>) -> Result<Chart<'a>, PlotError> {
        let Panel {
            corner: (left, top),
            size: (width, height),
            x,
            y,
            ..
        } = panel;
        let label_height = 26;
        let area = self.area.clone().shrink(
            scaled((left - LABELS_PX, *top)),
            scaled((width + LABELS_PX, height + label_height)),
        );
        let mut chart = ChartBuilder::on(&area)
            .set_label_area_size(LabelAreaPosition::Left, LABELS_PX * SCALE)
            .set_label_area_size(LabelAreaPosition::Bottom, label_height * SCALE)
            .build_cartesian_2d(x.clone(), y.clone())?;
        let labels = font(TEXT_PX - 0.5, palette::LABEL, Align::Left, false);
        let mut mesh = chart.configure_mesh();
        let x_tick = |value: &f64| {
            if panel.x_caption.is_some() {
                tick(value)
            } else {
                String::new()
            }
        };
        mesh.disable_x_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(stroke(palette::GRID, 1.0))
            .axis_style(stroke(palette::AXIS, 1.0))
            .set_all_tick_mark_size(4 * SCALE)
            .label_style(labels)
            .x_labels((width / 60).max(3) as usize)
            .y_labels((height / 28).max(3) as usize)
            .y_label_formatter(&tick)
            .x_label_formatter(&x_tick)
            .draw()?;
        self.text(
            panel.y_caption,
            (left - LABELS_PX + LEFT_PX, top - 16),
            Align::Left,
            palette::INK,
        )?;
        if let Some(caption) = panel.x_caption {
            let at = (left + width / 2, top + height + label_height + 8);
            self.text(caption, at, Align::Centre, palette::INK)?;
        }
        Ok(Chart { chart })
    }

    /// Draws entries with a sample of their colour, right-aligned at `right`.
    pub(super) fn legend(
        &self,
        right: Pixel,
        entries: &[(&str, RGBColor)],
    ) -> Result<(), PlotError> {
        let (mut x, y) = right;
        for (text, colour) in entries.iter().rev() {
            x -= width_of(text);
            self.text(text, (x, y), Align::Left, palette::LABEL)?;
            x -= 26;
            self.rectangle([(x, y - 2), (x + 18, y + 1)], *colour)?;
            x -= 18;
        }
        Ok(())
    }
}

/// Axes to draw.
pub(super) struct Panel<'t> {
    /// Upper left corner of the plot area (px).
    pub(super) corner: Pixel,
    /// Width and height of the plot area (px).
    pub(super) size: Pixel,
    pub(super) x: Range<f64>,
    pub(super) y: Range<f64>,
    /// Quantity and unit of the horizontal axis; `None` if the panel below has it.
    pub(super) x_caption: Option<&'t str>,
    /// Quantity and unit of the vertical axis.
    pub(super) y_caption: &'t str,
}

/// Axes with curves.
pub(super) struct Chart<'a> {
    chart: ChartContext<'a, Backend<'a>, Plane>,
}

impl Chart<'_> {
    /// Draws a band between two values, across the whole panel.
    pub(super) fn band(&mut self, values: Range<f64>, colour: RGBColor) -> Result<(), PlotError> {
        let x = self.chart.x_range();
        let y = self.chart.y_range();
        let inside = |value: f64| value.clamp(y.start, y.end);
        let corners = [(x.start, inside(values.start)), (x.end, inside(values.end))];
        self.chart
            .plotting_area()
            .draw(&Rectangle::new(corners, colour.filled()))?;
        Ok(())
    }

    /// Draws a horizontal line at a value.
    pub(super) fn level(&mut self, value: f64, colour: RGBColor) -> Result<(), PlotError> {
        let x = self.chart.x_range();
        self.curve(&[vec![(x.start, value), (x.end, value)]], colour, 1.0)
    }

    /// Draws connected pieces; a piece of a single point is a dot.
    pub(super) fn curve(
        &mut self,
        pieces: &[Vec<Point>],
        colour: RGBColor,
        width_px: f64,
    ) -> Result<(), PlotError> {
        let area = self.chart.plotting_area();
        for piece in pieces {
            match piece.as_slice() {
                [] => {}
                [point] => area.draw(&Circle::new(*point, SCALE, colour.filled()))?,
                _ => area.draw(&PathElement::new(piece.clone(), stroke(colour, width_px)))?,
            }
        }
        Ok(())
    }

    /// Draws the area between two curves over the same instants.
    pub(super) fn area_between(
        &mut self,
        lower: &[Point],
        upper: &[Point],
        colour: RGBColor,
    ) -> Result<(), PlotError> {
        let outline: Vec<Point> = lower.iter().chain(upper.iter().rev()).copied().collect();
        self.chart
            .plotting_area()
            .draw(&Polygon::new(outline, colour.filled()))?;
        Ok(())
    }

    /// Draws a dot, filled or as a ring.
    pub(super) fn dot(
        &mut self,
        at: Point,
        colour: RGBColor,
        filled: bool,
    ) -> Result<(), PlotError> {
        let style = if filled {
            colour.filled()
        } else {
            stroke(colour, 1.5)
        };
        self.chart
            .plotting_area()
            .draw(&Circle::new(at, 9 * SCALE / 2, style))?;
        Ok(())
    }
}

/// Returns a line style of this width.
pub(super) fn stroke(colour: RGBColor, width_px: f64) -> ShapeStyle {
    colour.stroke_width((width_px * f64::from(SCALE)) as u32)
}

/// Returns the approximate width of a line of text (px).
pub(super) fn width_of(text: &str) -> i32 {
    (text.chars().count() as f64 * TEXT_PX * CHARACTER_EM) as i32
}

/// Shortens long names, so that they cannot cover a figure.
pub(super) fn clipped(text: &str, characters: usize) -> String {
    if text.chars().count() <= characters {
        return text.to_owned();
    }
    let kept: String = text.chars().take(characters.saturating_sub(1)).collect();
    format!("{kept}…")
}

/// Returns the range with some margin on both sides, never empty and never too short for the digits of its ends.
pub(super) fn with_room(extent: Range<f64>) -> Range<f64> {
    let length = extent.end - extent.start;
    let magnitude = extent.start.abs().max(extent.end.abs());
    let room = if length > 0.0 {
        (0.06 * length).max(1e-6 * magnitude)
    } else {
        0.5_f64.max(1e-6 * magnitude)
    };
    extent.start - room..extent.end + room
}

/// Returns the smallest range that contains both.
pub(super) fn union(a: Range<f64>, b: Range<f64>) -> Range<f64> {
    a.start.min(b.start)..a.end.max(b.end)
}

fn scaled((x, y): Pixel) -> Pixel {
    (x * SCALE, y * SCALE)
}

fn font(size_px: f64, colour: RGBColor, align: Align, bold: bool) -> TextStyle<'static> {
    let style = if bold {
        FontStyle::Bold
    } else {
        FontStyle::Normal
    };
    let size = size_px * BACKEND_FONT_SIZE * f64::from(SCALE);
    let horizontal = match align {
        Align::Left => HPos::Left,
        Align::Centre => HPos::Center,
        Align::Right => HPos::Right,
    };
    TextStyle {
        color: colour.to_backend_color(),
        pos: Pos::new(horizontal, VPos::Center),
        ..TextStyle::from((FONT, size, style).into_font())
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn value() -> impl Strategy<Value = f64> {
        (-9.99..9.99, -12..12)
            .prop_map(|(digits, exponent): (f64, i32)| digits * 10_f64.powi(exponent))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Goal: no log prevents a figure from being drawn, whatever its values. Method: ends of any sign and size.
        #[test]
        fn axes_are_drawn_for_every_range(a in value(), b in value()) {
            let drawn = figure(400, 200, "made up", |sheet| {
                let mut chart = sheet.panel(&Panel {
                    corner: (LABELS_PX, 40),
                    size: (300, 100),
                    x: 0.0..1.0,
                    y: with_room(a.min(b)..a.max(b)),
                    x_caption: Some("time [s]"),
                    y_caption: "made up",
                })?;
                chart.curve(&[vec![(0.0, a), (1.0, b)]], palette::INK, 1.0)
            });
            let svg = drawn.unwrap().inline_svg();
            let ticks = svg.matches("<text").count();
            prop_assert!((2..60).contains(&ticks), "{} texts", ticks);
        }
    }

    #[test]
    fn a_long_name_is_shortened_and_a_short_one_is_not() {
        assert_eq!(clipped("p_ch", 4), "p_ch");
        assert_eq!(clipped("äöüßx", 4), "äöü…");
    }

    /// The page of the report has its own escaping; a figure is also a file of its own.
    #[test]
    fn text_in_a_figure_is_no_markup() {
        let hostile = "<script>\u{0}\"&";
        let drawn = figure(100, 100, hostile, |sheet| sheet.title(hostile)).unwrap();
        let svg = drawn.svg_file();
        assert_eq!(
            svg.matches("&lt;script&gt;\u{fffd}&quot;&amp;").count(),
            2,
            "{svg}"
        );
    }
}
