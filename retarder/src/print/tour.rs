//! The tour.

use super::{Colour, Terminal, comparison, control, paragraph, title};
use crate::run::control::Controlled;
use crate::run::tour::Tour;
use crate::task::Targets;

/// Dimensions of the regimes that the tour shows; `retarder compare` shows all.
const DIMENSIONS: usize = 3;

/// Comparison, loop, report, and what to try next.
pub(super) fn tour(tour: &Tour, targets: &Targets, terminal: &Terminal) -> String {
    let focus = tour.compared.focus();
    let step = |number: u32, text: &str| title(&format!("{number}. {text}"), terminal);
    let mut text = step(
        1,
        "Does the model describe the bench? A log of 60 s against the model of the thesis",
    );
    text += &comparison::head(&tour.compared, terminal);
    text += "\n";
    text += &comparison::signals(&tour.compared, terminal);
    text += "\n";
    text += &comparison::plots(&tour.compared, terminal);
    text += "\n";
    let shown = &focus.regimes[..DIMENSIONS.min(focus.regimes.len())];
    text += &comparison::regimes(focus, shown, terminal);
    text += "\n";
    text += &paragraph(&format!("Finding: {}.", focus.finding.sentence), terminal);
    text += &comparison::answer(&tour.compared, terminal);
    text += &paragraph(
        "That is as it should be: behind this log is a rig with physics that the plain model lacks.",
        terminal,
    );
    text += "\n";
    let loops: Vec<&Controlled> = tour.loops.iter().collect();
    text += &step(
        2,
        "Does the loop keep its promises? The controller on the model",
    );
    if let Some(first) = loops.first() {
        text += &control::plots(&first.run.recording, terminal);
    }
    text += "\n";
    text += &control::requirements(&loops, terminal);
    text += "\n";
    text += &step(3, "What now?");
    if let Some(path) = &targets.html {
        text += &format!(
            "All plots are in {}: open it in a browser.\n",
            terminal.paint(Colour::Good, &path.display().to_string())
        );
    }
    text + TRY
}

const TRY: &str = "
  retarder compare --log data/synthetic/practice-00-id.csv     another rig
  retarder compare --log YOUR-LOG.csv --html comparison.html   your own bench; columns such as time_s, duty_fill_pct, p_ch_bar_gauge
  retarder parameters --toml > my-plant.toml                   a plant file to change; then compare --plant my-plant.toml
  retarder control --controller thesis                         the loop of the thesis, with its own controller
  retarder control --rigs 100                                  the loop on a hundred rigs that differ as valves do
  retarder thesis                                              the figures of the thesis, measured and simulated
  retarder --help                                              the rest

From this folder, without installing: `cargo run --release -- compare ...`
";
