//! The figures of the thesis.

use model_lab::thesis::Row;

use super::number::{or_dash, signed};
use super::table::{Align, Table, verdict};
use super::{Colour, Terminal, paragraph, title};
use crate::run::thesis::Figures;

/// All figures, one group per rig.
pub(super) fn thesis(figures: &Figures, terminal: &Terminal) -> String {
    let rows = &figures.table.rows;
    let mut text = title(
        &format!(
            "Measured in the thesis, simulated with {}",
            figures.plant.name
        ),
        terminal,
    );
    let mut table = Table::new(
        [
            ("figure", Align::Left),
            ("measured", Align::Right),
            ("simulated", Align::Right),
            ("unit", Align::Left),
            ("deviation", Align::Right),
            ("limit", Align::Right),
            ("", Align::Left),
        ],
        terminal,
    );
    let mut notes: Vec<&str> = Vec::new();
    let mut group = None;
    for row in rows {
        let of_row = group_of(row);
        if group.as_ref() != Some(&of_row) {
            table.heading(&of_row);
            group = Some(of_row);
        }
        table.row([
            format!(
                "{}{}",
                unbreakable(&row.quantity),
                note_mark(row, &mut notes)
            )
            .into(),
            figure(row.measured, row).into(),
            row.simulated
                .map_or_else(|| "never".to_owned(), |simulated| figure(simulated, row))
                .into(),
            row.unit.as_str().into(),
            or_dash(row.deviation.as_ref(), |deviation| {
                format!("{} {}", signed(deviation.value, 2), deviation.unit)
            })
            .into(),
            or_dash(row.limit, |limit| format!("±{limit}")).into(),
            verdict(row.holds),
        ]);
    }
    text += &table.to_string();
    for (index, note) in notes.iter().enumerate() {
        text += &paragraph(&format!("({}) {note}", index + 1), terminal);
    }
    text += "\n";
    let held: Vec<&Row> = rows.iter().filter(|row| row.holds.is_some()).collect();
    let reached = held.iter().filter(|row| row.holds == Some(true)).count();
    let colour = if figures.table.holds {
        Colour::Good
    } else {
        Colour::Bad
    };
    let sentence = format!(
        "{reached} of the {} figures that the plain model is held to are reached.",
        held.len()
    );
    text + &terminal.paint(colour, &sentence) + "\n"
}

/// Times in T_req are printed with three decimals in the thesis, the rest with one.
fn figure(value: f64, row: &Row) -> String {
    match row.unit.as_str() {
        "T_req" => format!("{value:.3}"),
        _ => format!("{value:.1}"),
    }
}

fn group_of(row: &Row) -> String {
    let of_rig = row
        .rig
        .as_ref()
        .map(|rig| format!("{rig} (tables 4.3, 4.4)"));
    of_rig.unwrap_or_else(|| match row.unit.as_str() {
        "mA" => "Currents (section 4.2.4, figures 4.4, 5.3)".to_owned(),
        _ => "Duty limits (tables 4.1, 4.2)".to_owned(),
    })
}

/// A number and its percent sign stay on one line.
fn unbreakable(text: &str) -> String {
    text.replace(" %", "\u{a0}%")
}

fn note_mark<'a>(row: &'a Row, notes: &mut Vec<&'a str>) -> String {
    let Some(note) = row.note.as_deref() else {
        return String::new();
    };
    let index = notes
        .iter()
        .position(|known| *known == note)
        .unwrap_or_else(|| {
            notes.push(note);
            notes.len() - 1
        });
    format!(" ({})", index + 1)
}
