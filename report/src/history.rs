//! Refinement steps of the plant.

use maud::{Markup, html};

use super::contents::{HistoryPart, HistoryStep};
use super::element::foreign;
use super::number::number;
use crate::plot::{SmallUnit, capitalised, signal_words, unit_of};

pub(super) fn section(part: &HistoryPart<'_>) -> Markup {
    html! {
        section #history {
            h2 { "How it was refined" }
            div.table {
                table {
                    caption { "Errors after each step; a step that was undone is marked" }
                    thead {
                        tr {
                            th { "Step" } th { "Signal" } th { "Unit" } th.number { "Rms" } th.number { "Noise floor" } th.number { "× noise" }
                        }
                    }
                    tbody {
                        @for (index, step) in part.steps.iter().enumerate() { (rows(step, index > part.current)) }
                    }
                }
            }
        }
    }
}

fn rows(step: &HistoryStep, is_undone: bool) -> Markup {
    let name = html! {
        (foreign(&capitalised(&step.what)))
        @if !step.log.is_empty() { br; span.note { "on " (foreign(&step.log)) } }
        @if is_undone { br; span.note { "undone" } }
    };
    html! {
        @if step.errors.is_empty() { tr { th scope="row" { (name) } td {} td {} td {} td {} td {} } }
        @for (index, (signal, rms, noise)) in step.errors.iter().enumerate() {
            @let unit = SmallUnit::of_errors_in(unit_of(signal));
            tr {
                th scope="row" { @if index == 0 { (name) } }
                td { (foreign(&capitalised(signal_words(signal)))) }
                td.unit { (unit.symbol) }
                td.number { (number(rms * unit.per_unit)) }
                td.number { @if let Some(noise) = noise { (number(noise * unit.per_unit)) } }
                td.number { @if let Some(noise) = noise.filter(|noise| *noise > 0.0) { (number(rms / noise)) } }
            }
        }
    }
}
