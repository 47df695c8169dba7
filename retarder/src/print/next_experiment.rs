//! The next experiment.

use super::number::significant;
use super::table::{Align, Table};
use super::{Colour, Terminal, paragraph, title};
use crate::run::next_experiment::Planned;

/// Manoeuvres by what they tell, and what else would.
pub(super) fn next_experiment(planned: &Planned, terminal: &Terminal) -> String {
    let next = &planned.next;
    let names: Vec<&str> = next
        .rivals
        .iter()
        .map(|rival| rival.effect.as_deref().unwrap_or("the plain model"))
        .collect();
    let heading = format!(
        "What tells {} apart on {}",
        names.join(" and "),
        planned.plant.name
    );
    let mut text = title(&heading, terminal);
    let colour = if next.tells_apart() {
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
            ("manoeuvre", Align::Left),
            ("distance", Align::Right),
            ("s", Align::Right),
            ("bar", Align::Right),
            ("shows", Align::Left),
        ],
        terminal,
    );
    for manoeuvre in &next.ranking {
        table.row([
            manoeuvre.name.as_str().into(),
            significant(manoeuvre.distance, 3).into(),
            significant(manoeuvre.duration_s, 3).into(),
            significant(manoeuvre.highest_bar, 2).into(),
            manoeuvre.about.as_str().into(),
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
                "A sensor would tell as well: {}, {} {} rms apart, {} times the noise of a usual one.",
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
