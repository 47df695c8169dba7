//! The frame of the page.

use maud::{DOCTYPE, Markup, PreEscaped, html as markup};

use super::contents::Contents;
use super::{control, model, origin, thesis};
use crate::plot::palette::DARK;
use crate::plot::{Figure, PlotError};

/// Nothing may be loaded and nothing may run; the style stands in the page.
const SECURITY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

const STYLE: &str = include_str!("style.css");

/// The report as one self-contained HTML file: equal contents give equal bytes.
pub(crate) fn html(contents: &Contents<'_>) -> String {
    markup! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(SECURITY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content=(concat!("retarder ", env!("CARGO_PKG_VERSION")));
                title { (printable(contents.title)) }
                style { (PreEscaped(style())) }
            }
            body {
                main {
                    header {
                        h1 { (foreign(contents.title)) }
                        (summary(contents))
                        (navigation(contents))
                    }
                    @if let Some(part) = &contents.model { (model::section(part)) }
                    @if !contents.control.is_empty() { (control::section(contents.control)) }
                    @if let Some(table) = contents.thesis { (thesis::section(table)) }
                    @if !contents.next_steps.is_empty() { (next_steps(contents.next_steps)) }
                    (origin::section(&contents.origin))
                }
            }
        }
    }
    .into_string()
}

fn summary(contents: &Contents<'_>) -> Markup {
    markup! {
        div.summary {
            @if let Some(part) = &contents.model {
                (statement("Model", model::standing(part.comparison), &model::headline(part.comparison)))
            }
            @if !contents.control.is_empty() {
                (statement("Control loop", control::standing(contents.control), &control::headline(contents.control)))
            }
            @if let Some(table) = contents.thesis {
                (statement("Thesis", Standing::of(table.holds), &thesis::headline(table)))
            }
        }
    }
}

fn statement(what: &str, standing: Standing, sentence: &str) -> Markup {
    markup! {
        div.statement {
            p.badge-line { span.what { (what) } " " (standing.badge()) }
            p.finding { (foreign(sentence)) }
        }
    }
}

fn navigation(contents: &Contents<'_>) -> Markup {
    let has_next_steps = !contents.next_steps.is_empty();
    let entries = [
        (
            contents.model.is_some(),
            "#model",
            "Model against measurement",
        ),
        (!contents.control.is_empty(), "#control", "Control loop"),
        (contents.thesis.is_some(), "#thesis", "Thesis"),
        (has_next_steps, "#next", "What to try next"),
        (true, "#origin", "Origin"),
    ];
    markup! {
        nav aria-label="Contents" {
            @for (_, target, name) in entries.iter().filter(|(is_there, ..)| *is_there) {
                a href=(target) { (name) } " "
            }
        }
    }
}

fn next_steps(steps: &[String]) -> Markup {
    markup! {
        section #next {
            h2 { "What to try next" }
            ol { @for step in steps { li { (foreign(step)) } } }
        }
    }
}

fn style() -> String {
    let dark: String = DARK
        .iter()
        .map(|pair| {
            let (white, dark) = (pair.on_white, pair.on_dark);
            format!(
                "svg [fill=\"{white}\"]{{fill:{dark}}}svg [stroke=\"{white}\"]{{stroke:{dark}}}\n"
            )
        })
        .collect();
    format!("{STYLE}\n@media screen and (prefers-color-scheme: dark) {{\n{dark}}}\n")
}

/// Whether something holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    Holds,
    DoesNotHold,
    /// Nothing speaks against it, and something is unknown.
    Open,
    /// Beyond a limit that decides nothing.
    Beyond,
}

impl Standing {
    pub(super) fn of(holds: bool) -> Self {
        if holds {
            Self::Holds
        } else {
            Self::DoesNotHold
        }
    }

    /// A mark besides the colour, for those who do not tell them apart.
    pub(super) fn badge(self) -> Markup {
        let (class, words) = match self {
            Self::Holds => ("badge holds", "✓ holds"),
            Self::DoesNotHold => ("badge fails", "✗ does not hold"),
            Self::Open => ("badge open", "? open"),
            Self::Beyond => ("badge open", "beyond, not binding"),
        };
        markup! { span class=(class) { (words) } }
    }
}

/// Text from a file: escaped, printable, and of a direction of its own, so that it cannot turn what stands beside it.
pub(super) fn foreign(text: &str) -> Markup {
    markup! { bdi { (printable(text)) } }
}

/// Control characters are no part of a page.
fn printable(text: &str) -> String {
    let letter = |letter: char| match letter {
        '\n' | '\t' => ' ',
        letter if letter.is_control() => char::REPLACEMENT_CHARACTER,
        letter => letter,
    };
    text.chars().map(letter).collect()
}

/// A figure, or why there is none.
pub(super) fn figure(drawn: Result<Figure, PlotError>) -> Markup {
    match drawn {
        Ok(figure) => markup! { figure { (PreEscaped(figure.inline_svg())) } },
        Err(error) => markup! { p.note { (error) } },
    }
}
