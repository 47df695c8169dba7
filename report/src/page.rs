//! Frame of the page.

use maud::{DOCTYPE, Markup, PreEscaped, html as markup};

use super::contents::{Contents, ModelPart};
use super::element::{Standing, foreign, printable};
use super::{control, diagnosis, history, logs, model, origin, plant, thesis, tuning};
use crate::plot::palette::DARK;

/// Content policy of the page: nothing may be loaded or run, and the style is inline.
const SECURITY: &str = "default-src 'none'; style-src 'unsafe-inline'; img-src data:; base-uri 'none'; form-action 'none'";

const STYLE: &str = include_str!("style.css");

/// Name of this program in the head of a report.
const GENERATOR: &str = "retarder";

/// Returns whether a file that begins with `beginning` is a report of this program; its first kilobyte is enough.
pub fn is_report(beginning: &[u8]) -> bool {
    let mark = format!("<meta name=\"generator\" content=\"{GENERATOR} ");
    String::from_utf8_lossy(beginning).contains(&mark)
}

/// Returns the report as one self-contained HTML file: equal contents give equal bytes.
pub fn html(contents: &Contents<'_>) -> String {
    markup! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(SECURITY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                meta name="generator" content={ (GENERATOR) " " (env!("CARGO_PKG_VERSION")) };
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
                    @if !contents.logs.is_empty() { (logs::section(contents.logs)) }
                    @if let Some(part) = &contents.plant { (plant::section(part)) }
                    @for (index, part) in contents.models.iter().enumerate() { (model::section(index, part)) }
                    @if let Some(part) = &contents.diagnosis { (diagnosis::section(part)) }
                    @if let Some(part) = &contents.history { (history::section(part)) }
                    @if !contents.control.is_empty() { (control::section(contents.control)) }
                    @if let Some(part) = &contents.tuning { (tuning::section(part)) }
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
            @for part in contents.models {
                (statement("Model", &model::standing(part).badge(), &model_sentence(contents, part)))
            }
            @if let Some(part) = &contents.diagnosis {
                (statement("Diagnosis", &diagnosis::badge(part.diagnosis), &diagnosis::headline(part.diagnosis)))
            }
            @if !contents.control.is_empty() {
                (statement("Control loop", &control::standing(contents.control).badge(), &control::headline(contents.control)))
            }
            @if let Some(part) = &contents.tuning {
                (statement("Gains", &markup! {}, &tuning::headline(part)))
            }
            @if let Some(table) = contents.thesis {
                (statement("Thesis", &Standing::of(table.holds).badge(), &thesis::headline(table)))
            }
        }
    }
}

/// Returns the sentence with the size of the model error; with several logs, it names the log.
fn model_sentence(contents: &Contents<'_>, part: &ModelPart<'_>) -> String {
    let headline = model::headline(part.comparison);
    match contents.models {
        [_] => headline,
        _ => format!("{}: {headline}", part.comparison.log),
    }
}

fn statement(what: &str, badge: &Markup, sentence: &str) -> Markup {
    markup! {
        div.statement {
            p.badge-line { span.what { (what) } " " (badge) }
            p.finding { (foreign(sentence)) }
        }
    }
}

fn navigation(contents: &Contents<'_>) -> Markup {
    let has_next_steps = !contents.next_steps.is_empty();
    let entries = [
        (!contents.logs.is_empty(), "#logs", "Logs"),
        (contents.plant.is_some(), "#plant", "Plant"),
        (
            !contents.models.is_empty(),
            "#model",
            "Model compared with measurement",
        ),
        (
            contents.diagnosis.is_some(),
            "#diagnosis",
            "Which effect is missing?",
        ),
        (contents.history.is_some(), "#history", "How it was refined"),
        (!contents.control.is_empty(), "#control", "Control loop"),
        (contents.tuning.is_some(), "#tuning", "Gains"),
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

/// Returns the text of the one style element of every report.
pub fn style() -> String {
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
