//! Picture of measured points and the traces of two models, as SVG.

use core::fmt::Write as _;

/// Picture of one signal.
#[derive(Debug)]
pub(crate) struct Picture<'a> {
    /// Headline.
    pub(crate) title: String,
    /// Label of the vertical axis, with the unit.
    pub(crate) axis: &'a str,
    /// Instants (s).
    pub(crate) times_s: &'a [f64],
    /// Measured values, NaN where missing.
    pub(crate) measured: &'a [f64],
    /// Name, colour and values of each model's trace.
    pub(crate) traces: Vec<(String, &'static str, &'a [f64])>,
}

const SIZE: [f64; 2] = [720.0, 380.0];
/// Margins: left, right, top, bottom.
const MARGINS: [f64; 4] = [64.0, 16.0, 40.0, 48.0];
const LINES: usize = 5;

impl Picture<'_> {
    /// Returns the picture as SVG; equal contents give equal bytes.
    pub(crate) fn svg(&self) -> String {
        let [width, height] = SIZE;
        let [left, right, top, bottom] = MARGINS;
        let all = || {
            let values = self.traces.iter().flat_map(|(_, _, values)| values.iter());
            values
                .chain(self.measured)
                .copied()
                .filter(|value| !value.is_nan())
        };
        let (low, high) = (
            all().fold(f64::INFINITY, f64::min),
            all().fold(f64::NEG_INFINITY, f64::max),
        );
        let (begin, end) = (self.times_s[0], self.times_s[self.times_s.len() - 1]);
        let x = |time_s: f64| left + (time_s - begin) / (end - begin) * (width - left - right);
        let y =
            |value: f64| height - bottom - (value - low) / (high - low) * (height - top - bottom);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" role=\"img\" \
             font-family=\"system-ui, sans-serif\" font-size=\"13\">\n<title>{0}</title>\n\
             <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
             <text x=\"{left}\" y=\"20\" font-weight=\"bold\">{0}</text>\n",
            self.title
        );
        for line in 0..=LINES {
            let share = line as f64 / LINES as f64;
            let (value, time_s) = (low + share * (high - low), begin + share * (end - begin));
            let (at_y, at_x) = (y(value), x(time_s));
            let _ = writeln!(
                svg,
                "<line x1=\"{left}\" x2=\"{}\" y1=\"{at_y:.1}\" y2=\"{at_y:.1}\" stroke=\"#e0e0e0\"/>\n\
                 <text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>\n\
                 <text x=\"{at_x:.1}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
                width - right,
                left - 6.0,
                at_y + 4.0,
                short(value, high - low),
                height - bottom + 18.0,
                short(time_s, end - begin),
            );
        }
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">time (s)</text>\n\
             <text transform=\"translate(14 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            0.5 * (left + width - right),
            height - 8.0,
            0.5 * (top + height - bottom),
            self.axis
        );
        let shown = self
            .times_s
            .iter()
            .zip(self.measured)
            .filter(|(_, value)| !value.is_nan());
        // A number of points sufficient to show the trace.
        let every = (shown.clone().count() / 150).max(1);
        for (time_s, value) in shown.step_by(every) {
            let _ = writeln!(
                svg,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2\" fill=\"#444\"/>",
                x(*time_s),
                y(*value)
            );
        }
        let legend = [("measured".to_owned(), "#444")];
        let models = self
            .traces
            .iter()
            .map(|(name, colour, _)| (name.clone(), *colour));
        for (n, (name, colour)) in legend.into_iter().chain(models).enumerate() {
            let at_y = top + 14.0 + 18.0 * n as f64;
            let _ = writeln!(
                svg,
                "<text x=\"{:.1}\" y=\"{at_y:.1}\" text-anchor=\"end\" fill=\"{colour}\">{name}</text>",
                width - right - 8.0
            );
        }
        for (_, colour, values) in &self.traces {
            let points = self.times_s.iter().zip(*values);
            let points: Vec<_> = points
                .map(|(t, v)| format!("{:.1},{:.1}", x(*t), y(*v)))
                .collect();
            let _ = writeln!(
                svg,
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.5\"/>",
                points.join(" ")
            );
        }
        svg + "</svg>\n"
    }
}

/// Returns a number of an axis that spans `span`.
fn short(value: f64, span: f64) -> String {
    let decimals = (1.0 - span.log10().floor()).clamp(0.0, 4.0) as usize;
    format!("{value:.decimals$}")
}
