//! Text of the demo.

use hil_harness::checks::CheckId;

use super::{
    Colour, Terminal, comparison, control, indented, painted_lines, painted_paragraph, paragraph,
    title,
};
use crate::page::NEXT_STEPS;
use crate::run::control::Controlled;
use crate::run::demo::Demo;
use crate::targets::Targets;

/// Number of regime dimensions that the demo shows; `retarder compare` shows all.
const DIMENSIONS: usize = 3;

/// Returns comparison, loop, report, and the commands to try next.
pub(super) fn demo(demo: &Demo, targets: &Targets, terminal: &Terminal) -> String {
    let focus = demo.compared.focus();
    let mut text = step(
        1,
        "Does the model describe the bench? A log of 60 s and the model of the thesis",
        terminal,
    );
    text += &comparison::head(&demo.compared, terminal);
    text += "\n";
    text += &comparison::signals(&demo.compared, terminal);
    text += "\n";
    text += &comparison::plots(&demo.compared, terminal);
    text += "\n";
    let shown = &focus.regimes[..DIMENSIONS.min(focus.regimes.len())];
    text += &comparison::regimes(focus, shown, terminal);
    text += "\n";
    for signal in &demo.compared.comparison.signals {
        text += &comparison::finding(signal, terminal);
    }
    text += &comparison::answer(&demo.compared, terminal);
    text += &paragraph(
        "This is expected: the rig of this log has an effect that the plain model lacks.",
        terminal,
    );
    text += "\n";
    text += &closed_loop(demo, terminal);
    text += "\n";
    text += &step(3, "What now?", terminal);
    if let Some(path) = &targets.html {
        let path = terminal.paint(Colour::Good, &path.display().to_string());
        text += &format!("All plots are in {path}; open it in a browser.\n");
    }
    text + &next_steps(terminal)
}

fn closed_loop(demo: &Demo, terminal: &Terminal) -> String {
    let mut text = step(
        2,
        "Does the loop meet its requirements? The controller on the model",
        terminal,
    );
    let loops: Vec<&Controlled> = demo.loops.iter().collect();
    let Some(first) = loops.first() else {
        return text;
    };
    let names: Vec<&str> = loops
        .iter()
        .map(|run| run.scenario.scenario.name.as_str())
        .collect();
    text += &paragraph(
        &format!(
            "The {} on the nominal plant, with sensor noise; profiles {}. Plotted is {}.",
            first.scenario.controller,
            names.join(", "),
            names[0]
        ),
        terminal,
    );
    text += "\n";
    text += &control::plots(&first.run.recording, terminal);
    text += "\n";
    text += &control::requirements(&loops, terminal);
    text += "\n";
    text += &painted_paragraph(
        Colour::Faint,
        "T_req is 50 samples of 10 ms, p_sup is 8.4 bar. A limit that the thesis does not set is not binding.",
        terminal,
    );
    for run in &loops {
        text += &control::answer(run, Some(&run.scenario.scenario.name), terminal);
    }
    let vents_late = loops
        .iter()
        .filter_map(|run| run.verdict.check(CheckId::VentTime))
        .any(|check| !check.holds);
    if vents_late {
        text += &paragraph(
            "The venting time is a finding of the thesis as well. With the valve fully open its bench took 2.6 samples to \
             the level (table 4.3). The nominal rig takes 2.40 samples to within 0.1 bar of the level and 2.59 to the \
             level itself, so the limit of 2.5 leaves a controller a tenth of a sample by the first reading.",
            terminal,
        );
    }
    text
}

fn step(number: u32, text: &str, terminal: &Terminal) -> String {
    title(&format!("{number}. {text}"), terminal)
}

/// Returns commands to type, each with its reason below.
fn next_steps(terminal: &Terminal) -> String {
    let not_installed = "Where `retarder` is not installed (`cargo install --path retarder`), write \
                         `cargo run --release --` in its place.";
    let mut text = paragraph(not_installed, terminal);
    for [command, reason] in NEXT_STEPS {
        text += &format!("  {}\n", terminal.paint(Colour::First, command));
        text += &painted_lines(Colour::Faint, &indented(reason, 6, terminal), terminal);
    }
    text
}
