//! Text of the thesis figures.

use model_lab::thesis::{Explained, Row};

use super::number::{or_dash, signed, significant};
use super::table::{Align, Table, verdict};
use super::{Colour, Terminal, painted_paragraph, paragraph, title};
use crate::run::thesis::{self, Figures};
use report::capitalised;

/// Returns all figures, one group per rig.
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
        "The plain model reaches {reached} of the {} figures with a limit.",
        held.len()
    );
    text + &terminal.paint(colour, &sentence) + "\n"
}

/// Formats a figure as the thesis does: times in T_req with three decimals, the rest with one.
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

/// Keeps a number and its percent sign on one line.
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

/// Number of explanations that are shown with all figures.
const SHOWN: usize = 3;

/// Returns the effects that explain the filling times, the answer first.
pub(super) fn explanation(explained: &thesis::Explained, terminal: &Terminal) -> String {
    let found = &explained.explanation;
    let head = format!(
        "The filling times of tables 4.3 and 4.4, {}",
        explained.plant.name
    );
    let colour = if found.brings_in() {
        Colour::Good
    } else {
        Colour::Bad
    };
    let mut text = title(&head, terminal);
    text += &painted_paragraph(colour, &(capitalised(&found.sentence) + "."), terminal);
    text += "\n";
    let mut table = Table::new(
        [
            ("with", Align::Left),
            ("1.9 mm rms", Align::Right),
            ("others", Align::Right),
            ("unit", Align::Left),
            ("brings in", Align::Left),
            ("fitted", Align::Left),
        ],
        terminal,
    );
    for row in &found.rows {
        let word = if row.brings_in {
            super::table::painted(Colour::Good, "yes")
        } else {
            "no".into()
        };
        table.row([
            with(row).into(),
            significant(row.fit_rms_samples, 2).into(),
            significant(row.check_rms_samples, 2).into(),
            "samples".into(),
            word,
            fitted(row).into(),
        ]);
    }
    text += &table.to_string();
    text += "\n";
    let shown = found.rows[1..]
        .iter()
        .take_while(|row| row.brings_in || !found.brings_in());
    for row in shown.take(SHOWN) {
        text += &figures(&found.rows[0], row, terminal);
    }
    text += "\n";
    text + &painted_paragraph(Colour::Faint, &(capitalised(&found.rule) + "."), terminal)
}

fn with(row: &Explained) -> String {
    if row.effects.is_empty() {
        "nothing: the plain model".to_owned()
    } else {
        row.effects.join("\n")
    }
}

fn fitted(row: &Explained) -> String {
    let line = |parameter: &model_lab::thesis::ExplainedParameter| {
        let key = parameter.name.rsplit('.').next().unwrap_or_default();
        let end = if parameter.at_bound {
            " (end of range)"
        } else {
            ""
        };
        format!("{key} = {}{end}", significant(parameter.value, 3))
    };
    row.parameters
        .iter()
        .map(line)
        .collect::<Vec<_>>()
        .join("\n")
}

/// Returns every filling time before and after.
fn figures(plain: &Explained, row: &Explained, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("filling [T_req]", Align::Left),
            ("measured", Align::Right),
            ("plain", Align::Right),
            ("now", Align::Right),
            ("off by", Align::Right),
        ],
        terminal,
    );
    table.heading(&row.effects.join(" with "));
    for (before, after) in plain.figures.iter().zip(&row.figures) {
        let time = |simulated: Option<f64>| or_dash(simulated, |time| format!("{time:.3}"));
        let judged = if after.is_fitted { "" } else { ", not fitted" };
        table.row([
            format!("  {}, {}{judged}", after.rig, after.quantity).into(),
            format!("{:.3}", after.measured).into(),
            time(before.simulated).into(),
            time(after.simulated).into(),
            format!("{} samples", signed(after.error_samples, 2)).into(),
        ]);
    }
    table.to_string()
}
