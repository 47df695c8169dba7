//! Conversion of outcomes into text for a terminal. Nothing is computed here that another output also needs.

mod chart;
mod comparison;
mod control;
mod demo;
mod device;
mod diagnosis;
mod estimation;
mod inspection;
mod live;
mod monte_carlo;
mod next_experiment;
mod number;
mod parameters;
mod report;
mod serve;
mod simulation;
mod table;
mod thesis;
mod tuning;

use std::io::{stderr, stdout};

use anstream::{AutoStream, ColorChoice};

use hil_harness::Scenario;
use recording::Recording;
use recording::csv::Excerpt;
use recording::mf4::READER_NOTE;

use crate::failure::Failure;
use crate::run::Outcome;
use crate::targets::Targets;

pub(crate) use device::{measured, measuring};
pub(crate) use live::Live;
pub(crate) use serve::serving;
pub(crate) use simulation::simulation;
pub(crate) use tuning::tuning;

/// Properties of the terminal that text is laid out for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Terminal {
    /// Width (characters).
    width: usize,
    /// Whether colours are shown.
    is_coloured: bool,
}

/// Width if no terminal reports one.
const WIDTH_WITHOUT_TERMINAL: usize = 100;
/// Range of widths in which tables and plots keep their layout.
const WIDTH_RANGE: [usize; 2] = [60, 140];

impl Terminal {
    /// Returns the terminal of the standard output.
    pub(crate) fn standard_output() -> Self {
        Self {
            width: width(),
            is_coloured: AutoStream::choice(&stdout()) != ColorChoice::Never,
        }
    }

    /// Returns the terminal of the standard error.
    pub(crate) fn standard_error() -> Self {
        Self {
            width: width(),
            is_coloured: AutoStream::choice(&stderr()) != ColorChoice::Never,
        }
    }

    fn paint(&self, colour: Colour, text: &str) -> String {
        if self.is_coloured {
            format!("\u{1b}[{}m{text}\u{1b}[0m", colour.code())
        } else {
            text.to_owned()
        }
    }
}

/// Returns the width; COLUMNS has priority over the width of the terminal.
fn width() -> usize {
    let said = std::env::var("COLUMNS")
        .ok()
        .and_then(|text| text.parse().ok());
    let seen = || terminal_size::terminal_size().map(|(width, _)| usize::from(width.0));
    let [least, largest] = WIDTH_RANGE;
    said.or_else(seen)
        .unwrap_or(WIDTH_WITHOUT_TERMINAL)
        .clamp(least, largest)
}

/// Meanings that have a colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Colour {
    /// Title.
    Title,
    /// Passed.
    Good,
    /// Failed.
    Bad,
    /// Notice.
    Notice,
    /// Axes, notes.
    Faint,
    /// Measured, fill valve.
    First,
    /// Modelled, vent valve.
    Second,
}

impl Colour {
    /// Returns the parameters of the escape sequence, from the 16 colours that a user can choose in every terminal.
    fn code(self) -> &'static str {
        match self {
            Self::Title => "1",
            Self::Good => "32",
            Self::Bad => "1;31",
            Self::Notice => "33",
            Self::Faint => "2",
            Self::First => "36",
            Self::Second => "33",
        }
    }
}

/// Returns the text of an outcome.
pub(crate) fn outcome(outcome: &Outcome, targets: &Targets, terminal: &Terminal) -> String {
    let mut text = match outcome {
        Outcome::Demo(demo) => demo::demo(demo, targets, terminal),
        Outcome::Inspection(inspected) => inspection::inspection(inspected, terminal),
        Outcome::Simulation(result) => simulation(result, terminal),
        Outcome::Comparison(compared) => comparison::comparison(compared, terminal),
        Outcome::Diagnosis(diagnosed) => diagnosis::diagnosis(diagnosed, targets, terminal),
        Outcome::Estimation(estimated) => estimation::estimation(estimated, targets, terminal),
        Outcome::Refinement(refined) => diagnosis::refinement(refined, terminal),
        Outcome::NextExperiment(planned) => next_experiment::next_experiment(planned, terminal),
        Outcome::DeterminingExperiment(planned) => next_experiment::determining(planned, terminal),
        Outcome::Control(controlled) => control::control(controlled, terminal),
        Outcome::RigTable(table) => monte_carlo::rig_table(table, terminal),
        Outcome::Report(reported) => report::report(reported, terminal),
        Outcome::BlackBox(black_box) => device::black_box(black_box, terminal),
        Outcome::DeviceSettings(settings) => device::settings(settings, terminal),
        Outcome::DeviceSignals => device::signals(terminal),
        Outcome::Measurement(result) if targets.recording.is_none() => result.csv.clone(),
        Outcome::Measurement(result) => device::measured(result, terminal),
        Outcome::Thesis(figures) => thesis::thesis(figures, terminal),
        Outcome::ThesisExplanation(explained) => thesis::explanation(explained, terminal),
        Outcome::Parameters(plant) => parameters::parameters(plant, terminal),
        Outcome::Settings(controller) => parameters::settings(controller, terminal),
        Outcome::Tuned(tuned) => tuning(tuned, terminal),
        Outcome::Text(text) => text.clone(),
    };
    if !matches!(outcome, Outcome::Demo(_)) {
        let files = [
            &targets.mapping,
            &targets.recording,
            &targets.plant,
            &targets.controller,
            &targets.html,
            &targets.json,
        ];
        for path in files.into_iter().flatten() {
            text += &format!("\nWritten: {}", path.display());
        }
    }
    if !text.ends_with('\n') {
        text.push('\n');
    }
    text
}

/// Returns the text of a failure.
pub(crate) fn failure(failure: &Failure, terminal: &Terminal) -> String {
    format!("{} {failure}\n", terminal.paint(Colour::Bad, "error:"))
}

/// Returns the notes of the log reader; empty if there are none.
pub(crate) fn log_notes(log: &Recording, terminal: &Terminal) -> String {
    let source = Excerpt::of(&log.provenance().source);
    let notes = log.provenance().notes.iter();
    let notes = notes.filter(|note| note.key == READER_NOTE);
    let mut lines: Vec<String> = notes.map(|note| note.value.clone()).collect();
    if !log.left_out().is_empty() {
        let left_out = log.left_out().iter();
        let names: Vec<&str> = left_out.map(|one| one.name.as_str()).collect();
        let (count, names) = (names.len(), Excerpt::of(&names.join(", ")));
        lines.push(format!(
            "channels that are no signals: {count}, {}",
            names.as_str()
        ));
    }
    lines
        .iter()
        .map(|line| note(&format!("{}: {line}", source.as_str()), terminal))
        .collect()
}

/// Returns the reasons, one a line, why the loop of a scenario is outside of what its controller was tuned for.
pub(crate) fn scenario_warnings(scenario: &Scenario, terminal: &Terminal) -> String {
    let warnings = scenario.warnings();
    let lines = warnings
        .iter()
        .map(|warning| note(&warning.to_string(), terminal));
    lines.collect()
}

/// Returns a line with a note that is not a failure.
pub(crate) fn note(text: &str, terminal: &Terminal) -> String {
    format!("{} {text}\n", terminal.paint(Colour::Title, "note:"))
}

/// Returns a title above a part of the text.
fn title(text: &str, terminal: &Terminal) -> String {
    painted_paragraph(Colour::Title, text, terminal)
}

/// Returns a paragraph, wrapped to the terminal.
fn paragraph(text: &str, terminal: &Terminal) -> String {
    indented(text, 0, terminal)
}

/// Returns a paragraph in a colour.
fn painted_paragraph(colour: Colour, text: &str, terminal: &Terminal) -> String {
    painted_lines(colour, &paragraph(text, terminal), terminal)
}

/// Colours each line separately, since callers split the text into lines.
fn painted_lines(colour: Colour, text: &str, terminal: &Terminal) -> String {
    text.lines()
        .map(|line| terminal.paint(colour, line) + "\n")
        .collect()
}

/// Returns a paragraph indented by `indent` characters.
fn indented(text: &str, indent: usize, terminal: &Terminal) -> String {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= terminal.width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(format!("{:indent$}{word}", "")),
        }
    }
    lines.join("\n") + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_paragraph_is_no_wider_than_the_terminal_and_loses_no_word() {
        let terminal = Terminal {
            width: 20,
            is_coloured: false,
        };
        let text = "one two three four five six seven eight nine ten";
        let wrapped = paragraph(text, &terminal);
        assert!(
            wrapped.lines().all(|line| line.chars().count() <= 20),
            "{wrapped}"
        );
        assert_eq!(
            wrapped.split_whitespace().collect::<Vec<_>>().join(" "),
            text
        );
    }
}
