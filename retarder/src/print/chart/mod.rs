//! Terminal plots of time series.

mod raster;

use std::fmt::Write as _;

use raster::{DOTS, Raster};

use recording::Trace;

use super::number::significant;
use super::{Colour, Terminal, painted_lines};

/// Plot of time series over one time axis.
pub(super) struct Chart<'a> {
    /// Shown quantity with its unit.
    pub(super) title: &'a str,
    pub(super) lines: Vec<Line<'a>>,
    /// Marked band of values around 0, and its meaning.
    pub(super) band: Option<(f64, &'a str)>,
    /// Height without title and axis (characters).
    pub(super) height: usize,
    /// First and last instant (s).
    pub(super) span_s: [f64; 2],
    /// Values that the axis must include.
    pub(super) at_least: Option<[f64; 2]>,
}

/// One time series, as it is drawn.
pub(super) struct Line<'a> {
    pub(super) name: &'a str,
    pub(super) colour: Colour,
    /// Character that draws the series without colours; `None` draws a line.
    pub(super) mark: Option<char>,
    pub(super) trace: Trace<'a>,
}

/// Characters for the labels of the values.
const LABELS: usize = 8;
/// Distance between marks without colours (characters).
const MARK_DISTANCE: usize = 3;

impl Chart<'_> {
    /// Draws the plot; returns an empty text if there is nothing to draw.
    pub(super) fn draw(&self, terminal: &Terminal) -> String {
        let Some([low, high]) = self.range() else {
            return String::new();
        };
        let columns = terminal.width.saturating_sub(LABELS + 2).max(10);
        let frame = Frame {
            columns,
            rows: self.height,
            span_s: rounded_up(self.span_s),
            range: [low, high],
        };
        let mut raster = Raster::new(columns, self.height);
        for line in &self.lines {
            frame.draw(line, &mut raster, terminal.is_coloured);
        }
        let mut text = self.heading(terminal);
        let ticks = frame.value_ticks();
        let band_rows = self
            .band
            .map(|(half_width, _)| [half_width, -half_width].map(|edge| frame.row(edge)));
        for row in 0..self.height {
            let label = ticks.iter().find(|(tick_row, _)| *tick_row == row);
            let axis = match label {
                Some((_, label)) => format!("{label:>LABELS$} ┤"),
                None => format!("{:LABELS$} │", ""),
            };
            text += &terminal.paint(Colour::Faint, &axis);
            let empty = match &band_rows {
                Some(rows) if rows.contains(&Some(row)) => '╌',
                _ => ' ',
            };
            text += paint_runs(raster.row(row, empty), terminal).trim_end();
            text.push('\n');
        }
        text + &frame.time_axis(terminal)
    }

    fn heading(&self, terminal: &Terminal) -> String {
        let mut text = terminal.paint(Colour::Title, self.title);
        for line in &self.lines {
            let key = match line.mark {
                Some(mark) if !terminal.is_coloured => mark.to_string().repeat(2),
                _ => "──".to_owned(),
            };
            let _ = write!(
                text,
                "   {} {}",
                terminal.paint(line.colour, &key),
                line.name
            );
        }
        if let Some((_, name)) = self.band {
            let _ = write!(text, "   {} {name}", terminal.paint(Colour::Faint, "╌╌"));
        }
        text + "\n"
    }

    /// Returns the lowest and highest value shown, or `None` without values.
    fn range(&self) -> Option<[f64; 2]> {
        let band = self.band.map(|(half_width, _)| [-half_width, half_width]);
        let bounds = band.into_iter().chain(self.at_least).flatten();
        let window_s = self.span_s[0]..self.span_s[1];
        let extents = self.lines.iter().map(|line| line.trace.extent(&window_s));
        let extents = extents
            .flatten()
            .flat_map(|extent| [extent.start, extent.end]);
        let all = extents.filter(|value| value.is_finite());
        let [low, high] = all
            .chain(bounds)
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
                [low.min(value), high.max(value)]
            });
        match low.partial_cmp(&high)? {
            std::cmp::Ordering::Less => {
                let margin = 0.03 * (high - low);
                // Values that are never negative get no negative axis.
                let low = if low >= 0.0 {
                    (low - margin).max(0.0)
                } else {
                    low - margin
                };
                Some([low, high + margin])
            }
            std::cmp::Ordering::Equal => Some([low - 0.5, high + 0.5]),
            std::cmp::Ordering::Greater => None,
        }
    }
}

/// Mapping of values to positions.
struct Frame {
    columns: usize,
    rows: usize,
    span_s: [f64; 2],
    range: [f64; 2],
}

impl Frame {
    fn x(&self, time_s: f64) -> isize {
        let share = (time_s - self.span_s[0]) / (self.span_s[1] - self.span_s[0]);
        (share * (DOTS[0] * self.columns - 1) as f64).round() as isize
    }

    fn y(&self, value: f64) -> isize {
        let share = (self.range[1] - value) / (self.range[1] - self.range[0]);
        (share * (DOTS[1] * self.rows - 1) as f64).round() as isize
    }

    /// Returns the row of characters that shows `value`; `None` outside.
    fn row(&self, value: f64) -> Option<usize> {
        let row = usize::try_from(self.y(value)).ok()? / DOTS[1];
        (row < self.rows).then_some(row)
    }

    fn draw(&self, line: &Line<'_>, raster: &mut Raster<Colour>, is_coloured: bool) {
        let trace = &line.trace;
        let mark = line.mark.filter(|_| !is_coloured);
        let rows = trace.rows(&(self.span_s[0]..self.span_s[1]));
        let mut last: Option<(isize, isize)> = None;
        let mut last_mark = isize::MIN;
        for row in trace.decimated(rows, DOTS[0] * self.columns) {
            let Some(row) = row.filter(|&row| trace.values()[row].is_finite()) else {
                last = None;
                continue;
            };
            let place = (self.x(trace.times_s()[row]), self.y(trace.values()[row]));
            match mark {
                Some(mark) if place.0 / (DOTS[0] * MARK_DISTANCE) as isize != last_mark => {
                    last_mark = place.0 / (DOTS[0] * MARK_DISTANCE) as isize;
                    raster.mark(place.0, place.1, mark, line.colour);
                }
                Some(_) => {}
                None => raster.line(last.unwrap_or(place), place, line.colour),
            }
            last = Some(place);
        }
    }

    /// Returns the rows with labels.
    fn value_ticks(&self) -> Vec<(usize, String)> {
        let step = nice_step((self.range[1] - self.range[0]) / (self.rows as f64 / 2.0).max(2.0));
        ticks(self.range, step)
            .filter_map(|value| Some((self.row(value)?, label(value, step))))
            .collect()
    }

    fn time_axis(&self, terminal: &Terminal) -> String {
        let span = self.span_s[1] - self.span_s[0];
        let step = nice_step(span / (self.columns as f64 / 12.0));
        let mut axis: Vec<char> = vec!['─'; self.columns];
        let mut labels: Vec<char> = vec![' '; LABELS + 2 + self.columns];
        for time_s in ticks(self.span_s, step) {
            let Ok(column) = usize::try_from(self.x(time_s)) else {
                continue;
            };
            let column = (column / DOTS[0]).min(self.columns - 1);
            axis[column] = '┬';
            let text = format!("{} s", label(time_s, step));
            let middle = LABELS + 2 + column;
            let start = (middle + 1).saturating_sub(text.chars().count().div_ceil(2));
            let start = start.min(labels.len() - text.chars().count());
            for (place, character) in labels[start..].iter_mut().zip(text.chars()) {
                *place = character;
            }
        }
        let axis: String = axis.into_iter().collect();
        let labels: String = labels.into_iter().collect();
        let text = format!("{:LABELS$} └{axis}\n{}", "", labels.trim_end());
        painted_lines(Colour::Faint, &text, terminal)
    }
}

/// Rounds the end up to a label of the axis: a log of 59.99 s is drawn to 60 s.
fn rounded_up([start_s, end_s]: [f64; 2]) -> [f64; 2] {
    let step = nice_step((end_s - start_s) / 1000.0);
    let rounded_s = (end_s / step).ceil() * step;
    [
        start_s,
        if rounded_s > start_s {
            rounded_s
        } else {
            start_s + 1.0
        },
    ]
}

/// Returns the next larger of 1, 2 and 5 times a power of ten.
fn nice_step(step: f64) -> f64 {
    let power = 10_f64.powf(step.log10().floor());
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|factor| factor * power)
        .find(|nice| *nice >= step * (1.0 - 1e-9))
        .unwrap_or(10.0 * power)
}

fn ticks([low, high]: [f64; 2], step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(move |index| index as f64 * step)
}

fn label(value: f64, step: f64) -> String {
    let decimals = (-step.log10().floor()).max(0.0) as usize;
    let text = format!("{:.decimals$}", value + 0.0);
    if text.chars().count() > LABELS {
        significant(value, 3)
    } else {
        text
    }
}

/// Uses one escape sequence for neighbours of one colour.
fn paint_runs(cells: impl Iterator<Item = (char, Option<Colour>)>, terminal: &Terminal) -> String {
    let mut text = String::new();
    let mut run = String::new();
    let mut run_colour = None;
    let finish = |run: &mut String, colour: Option<Colour>, text: &mut String| {
        match colour {
            Some(colour) => *text += &terminal.paint(colour, run),
            None if run.contains('╌') => *text += &terminal.paint(Colour::Faint, run),
            None => *text += run,
        }
        run.clear();
    };
    for (character, colour) in cells {
        if colour != run_colour {
            finish(&mut run, run_colour, &mut text);
            run_colour = colour;
        }
        run.push(character);
    }
    finish(&mut run, run_colour, &mut text);
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(is_coloured: bool) -> String {
        let times_s: Vec<f64> = (0..=100).map(|n| f64::from(n) * 0.1).collect();
        let values: Vec<f64> = times_s.iter().map(|time_s| time_s - 5.0).collect();
        let chart = Chart {
            title: "error [bar]",
            lines: vec![Line {
                name: "ramp",
                colour: Colour::First,
                mark: None,
                trace: Trace::new(times_s, values.into(), 0.1),
            }],
            band: Some((2.0, "noise")),
            height: 9,
            span_s: [0.0, 10.0],
            at_least: None,
        };
        chart.draw(&Terminal {
            width: 60,
            is_coloured,
        })
    }

    #[test]
    fn a_plot_keeps_to_the_width_and_shows_title_key_band_and_both_axes() {
        let text = ramp(false);
        assert!(
            text.lines().all(|line| line.chars().count() <= 60),
            "{text}"
        );
        assert!(
            text.starts_with("error [bar]   ── ramp   ╌╌ noise\n"),
            "{text}"
        );
        assert_eq!(
            text.lines().filter(|line| line.contains('╌')).count(),
            3,
            "{text}"
        );
        for label in ["5 ┤", "0 ┤", "-5 ┤", "0 s", "10 s"] {
            assert!(text.contains(label), "{label}: {text}");
        }
        assert_eq!(text.lines().count(), 1 + 9 + 2);
    }

    /// Defect seen: a pause of the logger was drawn as a line from its begin to its end.
    #[test]
    fn a_pause_of_the_log_breaks_the_line() {
        let tenths = (0..=20).chain(80..=100);
        let times_s: Vec<f64> = tenths.map(|tenth| f64::from(tenth) * 0.1).collect();
        let values = vec![1.0; times_s.len()];
        let chart = Chart {
            title: "pressure [bar]",
            lines: vec![Line {
                name: "chamber",
                colour: Colour::First,
                mark: None,
                trace: Trace::new(times_s, values.into(), 0.1),
            }],
            band: None,
            height: 3,
            span_s: [0.0, 10.0],
            at_least: Some([0.0, 2.0]),
        };
        let text = chart.draw(&Terminal {
            width: 60,
            is_coloured: false,
        });
        let is_dotted = |character: &char| ('\u{2801}'..='\u{28ff}').contains(character);
        let drawn = text.chars().filter(is_dotted).count();
        // Four of ten seconds, in 50 columns.
        assert!((18..26).contains(&drawn), "{drawn} columns:\n{text}");
    }

    #[test]
    fn colours_change_nothing_else() {
        let painted = ramp(true);
        assert!(painted.contains("\u{1b}[36m"));
        let plain = anstream::adapter::strip_str(&painted).to_string();
        let cut = |text: &str| {
            text.lines()
                .map(str::trim_end)
                .collect::<Vec<_>>()
                .join("\n")
        };
        assert_eq!(cut(&plain), cut(&ramp(false)));
    }

    #[test]
    fn steps_are_1_2_5() {
        for (step, expected) in [(0.011, 0.02), (0.1, 0.1), (3.0, 5.0), (70.0, 100.0)] {
            assert!(
                (nice_step(step) - expected).abs() < 1e-9 * expected,
                "{step}"
            );
        }
    }
}
