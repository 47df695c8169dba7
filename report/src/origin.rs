//! Sources of a report.

use maud::{Markup, html};

use super::contents::{Input, Origin};
use super::element::foreign;

pub(super) fn section(origin: &Origin<'_>) -> Markup {
    html! {
        section #origin {
            h2 { "Origin" }
            @if !origin.command_line.is_empty() {
                p.lead { "Made by" }
                pre { code { (foreign(origin.command_line)) } }
            }
            @if !origin.inputs.is_empty() { (inputs(origin.inputs)) }
            @if !origin.versions.is_empty() {
                dl { @for (name, version) in origin.versions { dt { (foreign(name)) } dd { (foreign(version)) } } }
            }
        }
    }
}

fn inputs(inputs: &[Input]) -> Markup {
    html! {
        div.table {
            table {
                caption { "Inputs: with these bytes and this version the same report comes out" }
                thead { tr { th { "Input" } th { "File" } th.number { "Bytes" } th { "SHA-256" } } }
                tbody {
                    @for input in inputs {
                        tr {
                            th scope="row" { (foreign(&input.role)) }
                            td { code { (foreign(&input.name)) } }
                            @match &input.identity {
                                Some((size_bytes, sha256)) => {
                                    td.number { (size_bytes) }
                                    td { code.hash { (foreign(sha256)) } }
                                }
                                None => { td {} td { "built in" } }
                            }
                        }
                    }
                }
            }
        }
    }
}
