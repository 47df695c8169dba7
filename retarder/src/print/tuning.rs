//! Search of gains: the trade-off as a table.

use hil_harness::gain_search::{GAINS, Quality};

use super::number::significant;
use super::table::{Align, Table, painted};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::tune::{Searched, Tuned};

/// Returns the table of a search, and what its result achieves on other rigs; empty without a search.
pub(crate) fn tuning(tuned: &Tuned, terminal: &Terminal) -> String {
    let Some(Searched { found, search, .. }) = &tuned.searched else {
        return String::new();
    };
    let mut text = title(
        &format!(
            "Gains for {}: {} candidates on {} rigs each, seed {}",
            tuned.task.plant.name, search.candidates, search.rigs, search.seed
        ),
        terminal,
    );
    text += "\n";
    let [settle, late, over, lifts, pass, cost] = QUALITY;
    let columns = [
        ("candidate", Align::Left),
        ("K", Align::Right),
        ("T_i", Align::Right),
        ("T_d", Align::Right),
        ("boost", Align::Right),
        ("resp.", Align::Right),
        ("hor.", Align::Right),
        settle,
        late,
        over,
        lifts,
        pass,
        cost,
    ];
    let mut table = Table::new(columns, terminal);
    for candidate in found.shown() {
        let value = |index: usize| {
            let value = GAINS[index].value(&candidate.settings);
            value.map_or_else(|| "off".to_owned(), |value| significant(value, 3))
        };
        let name = candidate.name.to_string().replace("search ", "");
        let [settle, late, over, lifts, pass, cost] = cells(&candidate.quality);
        table.row([
            match candidate.name == found.chosen().name {
                true => painted(Colour::Good, format!("{name} *")),
                false => name.into(),
            },
            value(0).into(),
            value(1).into(),
            value(2).into(),
            value(3).into(),
            value(4).into(),
            (candidate.settings.prediction as u8).into(),
            settle.into(),
            late.into(),
            over.into(),
            lifts.into(),
            pass.into(),
            cost.into(),
        ]);
    }
    text += &table.to_string();
    text += &painted_paragraph(
        Colour::Faint,
        &format!(
            "*: in the controller file: of the least costs, the least on further rigs, or --choose NUMBER. The others are \
             the given controller, both experiments, and candidates that no other one beats in settling, overshoot and \
             lifts together. K: % per bar, T_i and T_d: ms, boost: % per bar and s, resp.: response of the boost in bar, \
             hor.: samples of the prediction, settle: mean in samples, over: overshoot in bar that 99 % of the steps do \
             not exceed, lifts: both valves, per s, pass: rigs that meet every binding requirement. cost: {}.",
            Quality::cost_in_words()
        ),
        terminal,
    );
    text += "\n";
    let [given, chosen] = &found.on_other_rigs;
    text += &paragraph(
        &format!("On {} rigs that decided nothing:", given.rigs),
        terminal,
    );
    let [settle, late, over, lifts, pass, cost] = QUALITY;
    let columns = [
        ("controller", Align::Left),
        settle,
        ("p90", Align::Right),
        late,
        over,
        lifts,
        pass,
        cost,
    ];
    let mut table = Table::new(columns, terminal);
    for (name, quality) in [("given", given), ("chosen", chosen)] {
        let p90 = quality.settling_p90_samples;
        let [settle, late, over, lifts, pass, cost] = cells(quality);
        table.row([
            name.into(),
            settle.into(),
            p90.map_or_else(|| "never".to_owned(), |samples| samples.to_string())
                .into(),
            late.into(),
            over.into(),
            lifts.into(),
            pass.into(),
            cost.into(),
        ]);
    }
    text + &table.to_string()
}

/// Columns of a quality.
const QUALITY: [(&str, Align); 6] = [
    ("settle", Align::Right),
    ("late", Align::Right),
    ("over", Align::Right),
    ("lifts", Align::Right),
    ("pass", Align::Right),
    ("cost", Align::Right),
];

/// Returns the cells of [`QUALITY`].
fn cells(quality: &Quality) -> [String; 6] {
    [
        format!("{:.1}", quality.settling_mean_samples),
        format!("{:.1} %", 100.0 * quality.late_share),
        format!("{:.2}", quality.overshoot_p99_bar),
        format!("{:.1}", quality.lifts_per_s),
        format!("{} of {}", quality.rigs_that_hold, quality.rigs),
        format!("{:.1}", quality.cost_samples),
    ]
}
