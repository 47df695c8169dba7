//! Common elements of the page: badges, foreign text, figures.

use maud::{Markup, PreEscaped, html as markup};

use crate::plot::{Figure, PlotError};

/// Result of a check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Standing {
    Holds,
    DoesNotHold,
    /// No check failed, but at least one result is unknown.
    Open,
    /// Outside a limit that is not binding.
    Beyond,
    /// Outside its limit, for a reason that a diagnosis names.
    Explained,
}

impl Standing {
    pub(super) fn of(holds: bool) -> Self {
        if holds {
            Self::Holds
        } else {
            Self::DoesNotHold
        }
    }

    /// Returns the result of a check whose failure may be explained.
    pub(super) fn unless_explained(self, is_explained: bool) -> Self {
        match self {
            Self::DoesNotHold if is_explained => Self::Explained,
            other => other,
        }
    }

    /// Returns a badge with a mark in addition to the colour, for readers who cannot distinguish the colours.
    pub(super) fn badge(self) -> Markup {
        let (class, words) = match self {
            Self::Holds => ("badge holds", "✓ pass"),
            Self::DoesNotHold => ("badge fails", "✗ fail"),
            Self::Open => ("badge open", "? open"),
            Self::Beyond => ("badge open", "beyond, not binding"),
            Self::Explained => ("badge open", "explained, above the limit"),
        };
        markup! { span class=(class) { (words) } }
    }
}

/// Returns text from a file: escaped, printable, and with its own text direction, so that it cannot reverse the text
/// beside it. Text between backticks, as in the sentences of a diagnosis, is code.
pub(super) fn foreign(text: &str) -> Markup {
    let text = printable(text);
    let parts: Vec<&str> = text.split('`').collect();
    markup! {
        bdi {
            // A backtick without a partner is an ordinary character.
            @if parts.len().is_multiple_of(2) { (text) } @else {
                @for (at, part) in parts.iter().enumerate() {
                    @if at % 2 == 1 { code { (part) } } @else { (part) }
                }
            }
        }
    }
}

/// Removes control characters, which are invalid in a page.
pub(super) fn printable(text: &str) -> String {
    let letter = |letter: char| match letter {
        '\n' | '\t' => ' ',
        letter if letter.is_control() => char::REPLACEMENT_CHARACTER,
        letter => letter,
    };
    text.chars().map(letter).collect()
}

/// Returns a figure, or the reason for its absence.
pub(super) fn figure(drawn: Result<Figure, PlotError>) -> Markup {
    match drawn {
        Ok(figure) => markup! { figure { (PreEscaped(figure.inline_svg())) } },
        Err(error) => markup! { p.note { (error) } },
    }
}
