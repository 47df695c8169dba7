//! Short summary of a report.

use super::{Colour, Terminal, comparison, control, painted_paragraph, paragraph, title};
use crate::run::Answer;
use crate::run::session::Reported;

/// Returns each part with its answer; the file has the details.
pub(super) fn report(reported: &Reported, terminal: &Terminal) -> String {
    let mut text = String::new();
    for compared in &reported.compared {
        let heading = format!(
            "{} compared with {}",
            compared.plant.name, compared.comparison.log
        );
        text += &title(&heading, terminal);
        text += &comparison::warnings(&compared.comparison.warnings, terminal);
        text += &comparison::signals(compared, terminal);
        text += &comparison::answer(compared, terminal);
        text += "\n";
    }
    if let Some(diagnosed) = &reported.diagnosed {
        text += &title("What is missing", terminal);
        let colour = match diagnosed.answer() {
            Answer::Holds => Colour::Good,
            _ => Colour::Bad,
        };
        let sentence = report::capitalised(&diagnosed.diagnosis.sentence) + ".";
        text += &painted_paragraph(colour, &sentence, terminal);
        text += "\n";
    }
    if !reported.loops.is_empty() {
        text += &title("The closed loop", terminal);
    }
    for run in &reported.loops {
        text += &control::answer(run, Some(&run.scenario.plant), terminal);
    }
    for reason in &reported.not_run {
        text += &paragraph(&(report::capitalised(reason) + "."), terminal);
    }
    text
}
