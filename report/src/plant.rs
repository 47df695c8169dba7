//! Plant, and its differences from the thesis model.

use maud::{Markup, html};
use plant_sim::PlantParameters;

use super::contents::PlantPart;
use super::element::{figure, foreign};
use super::number::engineering;
use crate::plot;

pub(super) fn section(part: &PlantPart<'_>) -> Markup {
    let nominal = PlantParameters::nominal();
    let plant = part.parameters;
    let changed: Vec<_> = plant
        .specs()
        .filter_map(|spec| Some((spec, spec.value(plant)?, spec.value(&nominal))))
        .filter(|(_, value, before)| *before != Some(*value))
        .collect();
    let effects: Vec<_> = plant.effects.iter().map(|effect| effect.id()).collect();
    html! {
        section #plant {
            h2 { "Plant" }
            p { code { (foreign(part.name)) } }
            (figure(plot::sketch(plant)))
            p {
                @if effects.is_empty() { "The plain model, without an effect of the library." } @else {
                    "Effects: "
                    @for (index, id) in effects.iter().enumerate() { @if index > 0 { ", " } code { (foreign(id)) } }
                    "."
                }
            }
            @if changed.is_empty() { p.note { "Every parameter is that of the thesis model." } } @else {
                div.table {
                    table {
                        caption { "What differs from the thesis model" }
                        thead { tr { th { "Parameter" } th.number { "Here" } th.number { "Thesis model" } th { "Unit" } th { "What it is" } } }
                        tbody {
                            @for (spec, value, before) in &changed {
                                tr {
                                    th scope="row" { code { (foreign(&spec.name())) } }
                                    td.number { (engineering(*value)) }
                                    td.number { (before.map_or("absent".to_owned(), engineering)) }
                                    td.unit { (foreign(spec.unit)) }
                                    td { (foreign(spec.about)) }
                                }
                            }
                        }
                    }
                }
            }
        }
    }
}
