//! Text of the next experiment.

use model_lab::diagnosis::next_experiment::ForeseenParameter;

use super::number::significant;
use super::table::{Align, Table, painted};
use super::{Colour, Terminal, paragraph, title};
use crate::run::next_experiment::{Determining, Planned};

/// Returns the test signals, ranked by what they distinguish, and other experiments that would help.
pub(super) fn next_experiment(planned: &Planned, terminal: &Terminal) -> String {
    let next = &planned.next;
    let names: Vec<&str> = next
        .rivals
        .iter()
        .map(|rival| rival.effect.as_deref().unwrap_or("the plain model"))
        .collect();
    let heading = format!(
        "What distinguishes {} on {}",
        names.join(" and "),
        planned.plant.name
    );
    let mut text = title(&heading, terminal);
    let colour = if next.distinguishes() {
        Colour::Good
    } else {
        Colour::Bad
    };
    text += &paragraph(
        &terminal.paint(colour, &format!("{}.", next.sentence)),
        terminal,
    );
    let mut table = Table::new(
        [
            ("test signal", Align::Left),
            ("distance", Align::Right),
            ("s", Align::Right),
            ("bar", Align::Right),
            ("shows", Align::Left),
        ],
        terminal,
    );
    for test_signal in &next.ranking {
        table.row([
            test_signal.name.as_str().into(),
            significant(test_signal.distance, 3).into(),
            significant(test_signal.duration_s, 3).into(),
            significant(test_signal.highest_bar, 2).into(),
            test_signal.about.as_str().into(),
        ]);
    }
    text += &table.to_string();
    let mut note = format!(
        "Distances are in standard deviations of the noise, when all that can be refitted has been; from {} on two effects \
         are swapped in less than one of twenty logs.",
        next.distinguishable_from
    );
    if next.rivals.iter().all(|rival| rival.effect.is_some()) {
        note += &format!(
            " On the log itself it is {}.",
            significant(next.distance_now, 2)
        );
    }
    text += &paragraph(&note, terminal);
    for sensor in &next.sensors {
        text += &paragraph(
            &format!(
                "A sensor would distinguish them as well: {}, {} {} rms apart, {} times the noise of a usual one.",
                sensor.quantity,
                significant(sensor.difference_rms, 2),
                sensor.unit,
                significant(sensor.in_noise, 2)
            ),
            terminal,
        );
    }
    text
}

/// Returns the parameters to determine, and the test signals ranked by what they determine.
pub(super) fn determining(planned: &Determining, terminal: &Terminal) -> String {
    let next = &planned.next;
    let heading = format!("Experiment for the parameters of {}", planned.plant.name);
    let mut text = title(&heading, terminal);
    let colour = if next.determines_all() {
        Colour::Good
    } else {
        Colour::Bad
    };
    let sentence = report::capitalised(&next.sentence) + ".";
    text += &paragraph(&terminal.paint(colour, &sentence), terminal);
    if !next.is_adequate {
        text += &paragraph(
            "The plant file leaves more than the noise on this log: run `retarder refine` first, and `retarder diagnose` if it was \
             refined already. The intervals below are those of a plant file that fits.",
            terminal,
        );
    }
    text += "\n";
    text += &foreseen(&next.parameters, terminal);
    let columns = [
        ("test signal", Align::Left),
        ("determines", Align::Right),
        ("width", Align::Right),
        ("s", Align::Right),
        ("bar", Align::Right),
        ("shows", Align::Left),
    ];
    let mut table = Table::new(columns, terminal);
    for test_signal in &next.ranking {
        table.row([
            test_signal.name.as_str().into(),
            test_signal.determines.len().into(),
            significant(test_signal.width_after, 2).into(),
            significant(test_signal.duration_s, 3).into(),
            significant(test_signal.highest_bar, 2).into(),
            test_signal.about.as_str().into(),
        ]);
    }
    text += "\n";
    text += &table.to_string();
    text + &paragraph(
        "determines: number of the open parameters that it would determine. width: of their intervals afterwards, over that of \
         now; geometric mean.",
        terminal,
    )
}

fn foreseen(parameters: &[ForeseenParameter], terminal: &Terminal) -> String {
    let columns = [
        ("parameter", Align::Left),
        ("value", Align::Right),
        ("now", Align::Left),
        ("after the best one", Align::Left),
        ("unit", Align::Left),
        ("", Align::Left),
    ];
    let mut table = Table::new(columns, terminal);
    for parameter in parameters {
        let interval =
            |[low, high]: [f64; 2]| format!("{} to {}", significant(low, 3), significant(high, 3));
        let (colour, word) = match (parameter.is_determined_now, parameter.is_determined_after) {
            (true, _) => (Colour::Faint, "known"),
            (false, true) => (Colour::Good, "determined"),
            (false, false) => (Colour::Notice, "open"),
        };
        table.row([
            parameter.name.as_str().into(),
            significant(parameter.value, 4).into(),
            interval(parameter.now).into(),
            interval(parameter.after).into(),
            parameter.unit.as_str().into(),
            painted(colour, word),
        ]);
        if let Some(determined_by) = &parameter.determined_by {
            table.remark(&format!("To determine it, {determined_by}."));
        }
    }
    table.to_string()
}
