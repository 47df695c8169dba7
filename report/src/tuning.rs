//! Search of gains: table and trade-off.

use hil_harness::gain_search::{Candidate, Found, GAINS, Quality};
use maud::{Markup, html};

use super::contents::TuningPart;
use super::element::{figure, foreign};
use super::number::number;
use crate::plot;

pub(super) fn headline(part: &TuningPart<'_>) -> String {
    let [given, chosen] = &part.found.on_other_rigs;
    let name = part.found.chosen().name;
    if part.found.chosen == 0 {
        return "No candidate is better than the given controller.".to_owned();
    }
    format!(
        "{} instead of {} samples to settle, {} instead of {} lifts per second, on rigs that decided nothing ({name}).",
        number(chosen.settling_mean_samples),
        number(given.settling_mean_samples),
        number(chosen.lifts_per_s),
        number(given.lifts_per_s),
    )
}

pub(super) fn section(part: &TuningPart<'_>) -> Markup {
    let found = part.found;
    html! {
        section #tuning {
            h2 { "Gains" }
            p.note { "Plant: " (foreign(part.plant)) ". Controller: " (foreign(part.controller)) "." }
            p.rule {
                "Every candidate follows the same references on the same rigs. The cost ranks them: "
                (Quality::cost_in_words()) ". Settling is the mean of all steps, overshoot is what 99 % of them do not exceed."
            }
            (figure(plot::trade_off(found, part.requirement)))
            h3 { "Trade-off" }
            p { "The given controller, both experiments, and candidates that no other one beats in settling time, overshoot and lifts together. The controller file has the chosen one: of the least costs, the least on further rigs." }
            (table(found))
            h3 { "On other rigs" }
            (checked(found))
        }
    }
}

fn table(found: &Found) -> Markup {
    let rows = found.shown();
    html! {
        div.table {
            table {
                thead {
                    tr {
                        th { "Candidate" }
                        (quality_heads())
                        @for gain in &GAINS { th.number { code { (gain.field.name()) } } }
                        th.number { code { "horizon_samples" } }
                    }
                }
                tbody {
                    @for candidate in rows {
                        tr {
                            th scope="row" {
                                (candidate.name.to_string())
                                @if candidate.name == found.chosen().name { " " strong { "chosen" } }
                            }
                            (quality(&candidate.quality))
                            (gains(candidate))
                        }
                    }
                }
            }
        }
    }
}

fn gains(candidate: &Candidate) -> Markup {
    html! {
        @for gain in &GAINS {
            td.number { (gain.value(&candidate.settings).map_or("off".to_owned(), number)) }
        }
        td.number { (candidate.settings.prediction as u8) }
    }
}

fn checked(found: &Found) -> Markup {
    html! {
        div.table {
            table {
                thead { tr { th { "Controller" } (quality_heads()) } }
                tbody {
                    @for (name, on_other_rigs) in ["given", "chosen"].iter().zip(&found.on_other_rigs) {
                        tr { th scope="row" { (name) } (quality(on_other_rigs)) }
                    }
                }
            }
        }
    }
}

fn quality_heads() -> Markup {
    html! {
        th.number { "Settling (samples)" } th.number { "90 % of steps" } th.number { "Late" }
        th.number { "Overshoot (bar)" } th.number { "Lifts/s" } th.number { "Rigs pass" } th.number { "Cost" }
    }
}

fn quality(quality: &Quality) -> Markup {
    html! {
        td.number { (number(quality.settling_mean_samples)) }
        td.number { (quality.settling_p90_samples.map_or("never".to_owned(), |samples| samples.to_string())) }
        td.number { (number(100.0 * quality.late_share)) " %" }
        td.number { (number(quality.overshoot_p99_bar)) }
        td.number { (number(quality.lifts_per_s)) }
        td.number { (quality.rigs_that_hold) " of " (quality.rigs) }
        td.number { (number(quality.cost_samples)) }
    }
}
