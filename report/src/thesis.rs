//! Figures of the thesis.

use maud::{Markup, html};
use model_lab::thesis::{Row, ThesisTable};

use super::element::{Standing, figure, foreign};
use super::number::{number, signed};
use crate::plot;

pub(super) fn headline(table: &ThesisTable) -> String {
    let held: Vec<&Row> = table
        .rows
        .iter()
        .filter(|row| row.limit.is_some())
        .collect();
    let kept = held.iter().filter(|row| row.holds == Some(true)).count();
    format!(
        "The model reaches {kept} of the {} printed figures with a limit; {} more are shown.",
        held.len(),
        table.rows.len() - held.len()
    )
}

pub(super) fn section(table: &ThesisTable) -> Markup {
    html! {
        section #thesis {
            h2 { "The thesis' own figures " (Standing::of(table.holds).badge()) }
            p.rule { "The rule: every figure with a limit is within it. The others show what the plain model lacks." }
            (figure(plot::thesis(table)))
            details {
                summary { "In numbers" }
                div.table {
                    table {
                        thead {
                            tr {
                                th { "Source" } th { "Figure" } th.number { "Measured" } th.number { "Simulated" } th { "Unit" }
                                th.number { "Deviation" } th.number { "Limit" } th { "Verdict" } th { "Note" }
                            }
                        }
                        tbody { @for row in &table.rows { (table_row(row)) } }
                    }
                }
            }
        }
    }
}

fn table_row(row: &Row) -> Markup {
    html! {
        tr {
            td { (foreign(&row.source)) }
            th scope="row" {
                (foreign(&row.quantity))
                @if let Some(rig) = &row.rig { br; span.note { (foreign(rig)) } }
            }
            td.number { (number(row.measured)) }
            td.number { (row.simulated.map_or("never".to_owned(), number)) }
            td.unit { (foreign(&row.unit)) }
            td.number {
                @if let Some(deviation) = &row.deviation { (signed(deviation.value)) " " (foreign(&deviation.unit)) }
            }
            td.number { @if let Some(limit) = row.limit { "±" (limit) } }
            td { @if let Some(holds) = row.holds { (Standing::of(holds).badge()) } }
            td { @if let Some(note) = &row.note { (foreign(note)) } }
        }
    }
}
