//! Figure as SVG text.

use super::palette::DARK;

/// Drawing units per pixel: the backend uses integers, and a screen resolves fractions of a pixel.
pub(super) const SCALE: i32 = 4;
/// Font of the reader's system; no file is loaded.
pub(super) const FONT: &str =
    "system-ui, -apple-system, Segoe UI, Roboto, Helvetica, Arial, sans-serif";

/// Failure of a drawing.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the figure cannot be drawn: {reason}")]
pub(crate) struct PlotError {
    reason: String,
}

impl PlotError {
    pub(super) fn because(error: &impl ToString) -> Self {
        Self {
            reason: error.to_string(),
        }
    }
}

/// Drawn figure.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Figure {
    width_px: i32,
    height_px: i32,
    description: String,
    /// Elements between `<svg>` and `</svg>`.
    elements: String,
}

impl Figure {
    /// Creates the figure from the backend's output, without its outermost element and with the font stated once.
    pub(super) fn from_backend(
        width_px: i32,
        height_px: i32,
        description: String,
        text: &str,
    ) -> Self {
        let begin = text.find('>').map_or(0, |end| end + 1);
        let end = text.rfind("</svg>").unwrap_or(text.len());
        let font = format!(" font-family=\"{FONT}\"");
        Self {
            width_px,
            height_px,
            description,
            elements: text[begin..end].trim_start().replace(&font, ""),
        }
    }

    /// Returns the figure for an HTML page, with the colours for a white background.
    pub(crate) fn inline_svg(&self) -> String {
        self.svg("", "")
    }

    /// Returns the figure as an image of its own without a background, in its colours on white, and in those on a dark
    /// background.
    pub(crate) fn images(&self) -> [String; 2] {
        let on_white = self.svg(" xmlns=\"http://www.w3.org/2000/svg\"", "");
        let on_dark = DARK.iter().fold(on_white.clone(), |svg, pair| {
            let quoted = |colour: &str| format!("\"{colour}\"");
            svg.replace(&quoted(pair.on_white), &quoted(pair.on_dark))
        });
        [on_white, on_dark]
    }

    /// Returns the text for screen readers.
    pub(crate) fn description(&self) -> &str {
        &self.description
    }

    /// Returns the figure as a file of its own, on a white background.
    #[cfg(test)]
    pub(crate) fn svg_file(&self) -> String {
        let mut file = self.svg(
            " xmlns=\"http://www.w3.org/2000/svg\"",
            "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n",
        );
        file.push('\n');
        file
    }

    fn svg(&self, namespace: &str, ground: &str) -> String {
        let Self {
            width_px,
            height_px,
            description,
            elements,
        } = self;
        let (width, height) = (width_px * SCALE, height_px * SCALE);
        let description = escaped(description);
        format!(
            "<svg{namespace} width=\"{width_px}\" height=\"{height_px}\" viewBox=\"0 0 {width} {height}\" \
             role=\"img\" font-family=\"{FONT}\" stroke-linejoin=\"round\">\n<title>{description}</title>\n{ground}{elements}</svg>"
        )
    }
}

/// Escapes text for SVG and HTML.
fn escaped(text: &str) -> String {
    text.chars().fold(String::new(), |mut escaped, character| {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            other => escaped.push(printable(other)),
        }
        escaped
    })
}

/// Replaces control characters, which are invalid in SVG.
pub(super) fn printable(character: char) -> char {
    if character.is_control() {
        char::REPLACEMENT_CHARACTER
    } else {
        character
    }
}
