//! Whether the loop keeps its promises.

use hil_harness::Verdict;
use hil_harness::checks::{Bound, Check};
use maud::{Markup, html};

use super::contents::ControlPart;
use super::number::number;
use super::page::{Standing, figure, foreign};
use crate::plot;

pub(super) fn headline(verdict: &Verdict) -> String {
    let broken: Vec<&Check> = verdict
        .checks
        .iter()
        .filter(|check| check.binding && !check.holds)
        .collect();
    match broken.as_slice() {
        [] if verdict.steps.is_empty() => {
            "No step of the reference was held long enough to be judged.".to_owned()
        }
        [] => format!(
            "All {} requirements that this run exercises are kept, over {} steps of the reference.",
            verdict.checks.iter().filter(|check| check.binding).count(),
            verdict.steps.len()
        ),
        [first, rest @ ..] => {
            let others = match rest.len() {
                0 => String::new(),
                count => format!(", and {count} more"),
            };
            format!(
                "Not kept: {}; reached {}, limit {} {}{others}.",
                first.requirement,
                reached(first),
                first.limit,
                first.unit
            )
        }
    }
}

pub(super) fn section(part: &ControlPart<'_>) -> Markup {
    let ControlPart {
        recording,
        requirement,
        verdict,
    } = *part;
    html! {
        section #control {
            h2 { "Control loop " (Standing::of(verdict.holds).badge()) }
            p.rule {
                "The rule: every binding requirement is kept, and at least one step was judged. "
                "What is not binding is shown and does not decide. Run: " code { (foreign(&verdict.source)) } "."
            }
            (check_table(verdict))
            (figure(plot::control(recording, requirement, "Closed loop: reference and pressure", None)))
            @if let Some((step, window_s)) = plot::step_of_interest(verdict) {
                p.lead {
                    "The step that settles last, from " (number(step.from_bar)) " to " (number(step.to_bar)) " bar gauge:"
                }
                (figure(plot::control(recording, requirement, "Closed loop: a step", Some(window_s))))
            }
            @if !verdict.steps.is_empty() { (figure(plot::settling(verdict, requirement))) }
        }
    }
}

fn check_table(verdict: &Verdict) -> Markup {
    html! {
        div.table {
            table {
                caption { "Requirements, and the worst that was reached" }
                thead {
                    tr {
                        th { "Requirement" } th.number { "Reached" } th.number { "Limit" } th { "Unit" } th { "Binding" }
                        th { "Verdict" } th { "Where" }
                    }
                }
                tbody { @for check in &verdict.checks { (check_row(check)) } }
            }
        }
        @if !verdict.not_exercised.is_empty() {
            p.note {
                "This run gives no occasion to: "
                @for (index, id) in verdict.not_exercised.iter().enumerate() {
                    @if index > 0 { ", " }
                    code { (id.name()) }
                }
                "."
            }
        }
        @if let Some(actuations) = &verdict.actuations {
            p.note {
                "Valve actuations: fill " (actuations.fill) ", vent " (actuations.vent) "; "
                (number(actuations.per_s)) " per second."
            }
        }
    }
}

fn check_row(check: &Check) -> Markup {
    let relation = match check.bound {
        Bound::AtMost => "at most ",
        Bound::LessThan => "less than ",
    };
    html! {
        tr {
            th scope="row" { (foreign(&check.requirement)) }
            td.number { (reached(check)) }
            td.number { (relation) (check.limit) }
            td { (foreign(&check.unit)) }
            td { (if check.binding { "yes" } else { "no" }) }
            td { (Standing::of(check.holds).badge()) }
            td { (foreign(&check.evidence)) }
        }
    }
}

fn reached(check: &Check) -> String {
    check.reached.map_or("never".to_owned(), number)
}
