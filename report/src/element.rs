//! What every part of the page is made of: badges, foreign text, figures.

use maud::{Markup, PreEscaped, html as markup};

use crate::plot::{Figure, PlotError};

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
pub(super) fn printable(text: &str) -> String {
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
