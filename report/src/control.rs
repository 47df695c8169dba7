//! Verdict on the closed loop.

use hil_harness::Verdict;
use hil_harness::checks::{Bound, Check};
use hil_harness::rigs::RigVerdict;
use maud::{Markup, html};

use super::contents::ControlPart;
use super::element::{Standing, figure, foreign};
use super::number::number;
use crate::plot::{self, capitalised};

pub(super) fn standing(parts: &[ControlPart<'_>]) -> Standing {
    Standing::of(parts.iter().all(holds))
}

/// Returns whether the verdict passes on the plant and on every rig.
fn holds(part: &ControlPart<'_>) -> bool {
    part.verdict.holds && part.rigs.iter().all(|rig| rig.verdict.holds)
}

fn binding<'a>(parts: &'a [ControlPart<'_>]) -> impl Iterator<Item = &'a Check> {
    let checks = parts.iter().flat_map(|part| &part.verdict.checks);
    checks.filter(|check| check.binding)
}

pub(super) fn headline(parts: &[ControlPart<'_>]) -> String {
    let steps: usize = parts.iter().map(|part| part.verdict.steps.len()).sum();
    let mut broken = binding(parts).filter(|check| !check.holds);
    let failing_rigs =
        |part: &ControlPart<'_>| part.rigs.iter().filter(|rig| !rig.verdict.holds).count();
    let rigs: usize = parts.iter().map(|part| part.rigs.len()).sum();
    let on_rigs = match (rigs, parts.iter().map(failing_rigs).sum::<usize>()) {
        (0, _) => String::new(),
        (_, 0) => format!(" The same is true on each of {rigs} rigs."),
        (_, failing) => format!(" {failing} of {rigs} rigs fail a binding requirement."),
    };
    match (broken.next(), broken.count()) {
        _ if parts.iter().any(|part| part.verdict.steps.is_empty()) => {
            "No step of the reference lasts long enough to be checked.".to_owned()
        }
        (None, _) => format!(
            "Every binding requirement is met, over {steps} steps of the reference.{on_rigs}"
        ),
        (Some(first), others) => {
            let others = match others {
                0 => String::new(),
                count => format!(", and {count} more"),
            };
            format!(
                "Fails: {}; reached {}, limit {} {}{others}.{on_rigs}",
                first.requirement,
                reached(first),
                first.limit,
                first.unit
            )
        }
    }
}

pub(super) fn section(parts: &[ControlPart<'_>]) -> Markup {
    html! {
        section #control {
            h2 { "Control loop " (standing(parts).badge()) }
            p.rule {
                "The rule: every binding requirement is met, and at least one step is checked. "
                "Other requirements are shown only."
            }
            @for part in parts { (run(part)) }
        }
    }
}

fn run(part: &ControlPart<'_>) -> Markup {
    let ControlPart {
        recording,
        requirement,
        verdict,
        plant,
        controller,
        conditions,
        rigs,
    } = *part;
    let title = format!("Closed loop, {}", verdict.source);
    html! {
        article {
            h3 { (foreign(&capitalised(&verdict.source))) " " (Standing::of(holds(part)).badge()) }
            p.note { "Plant: " (foreign(plant)) ". Controller: " (foreign(controller)) ". " (foreign(conditions)) }
            (check_table(verdict))
            @if !rigs.is_empty() {
                (rig_line(rigs))
                (figure(plot::settling_on_rigs(rigs, requirement)))
            }
            (figure(plot::control(recording, requirement, &title, None)))
            @if let Some((step, window_s)) = plot::step_of_interest(verdict) {
                p.lead {
                    "The step that settles last, from " (number(step.from_bar)) " to " (number(step.to_bar)) " bar gauge:"
                }
                (figure(plot::control(recording, requirement, &title, Some(window_s))))
            }
            @if !verdict.steps.is_empty() { (figure(plot::settling(verdict, requirement))) }
        }
    }
}

fn rig_line(rigs: &[RigVerdict]) -> Markup {
    let failing: Vec<&RigVerdict> = rigs.iter().filter(|rig| !rig.verdict.holds).collect();
    html! {
        p {
            "On scattered rigs: " (rigs.len() - failing.len()) " of " (rigs.len()) " meet every binding requirement."
            @if !failing.is_empty() {
                " Not so rig"
                @for rig in failing.iter().take(10) {
                    " " (rig.rig) " (seed " (rig.seed)
                    @if let Some((volt, celsius)) = rig.supply_voltage_v.zip(rig.coil_temperature_c) {
                        ", " (number(volt)) " V, coils at " (number(celsius)) " °C"
                    }
                    ")"
                }
                @if failing.len() > 10 { " and others" }
                "."
            }
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
                    (id.name().replace('_', " "))
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
        @if let Some(error) = &verdict.sensor_error {
            p.note {
                "Error of the pressure sensor, measured minus true pressure: " (number(error.mean_bar)) " bar on average, "
                (number(error.rms_bar)) " bar rms, " (number(error.largest_bar))
                " bar at most. The requirements are judged by the true pressure."
            }
        }
        @if let Some(plunger) = &verdict.plunger {
            p.note {
                "After a step, the plunger of the regulating valve breaks free " (number(plunger.starts_per_step))
                " times on average. At one reference, its rest positions differ by up to " (number(plunger.rest_spread_mm))
                " mm, " (number(100.0 * plunger.rest_spread_share)) " % of its travel, by its friction and the tolerance of the pressure."
            }
        }
        (confirmed_faults(verdict))
    }
}

fn confirmed_faults(verdict: &Verdict) -> Markup {
    let faults = verdict.confirmed_faults.as_deref().unwrap_or_default();
    html! {
        @if !faults.is_empty() {
            p.lead {
                "The ECU confirmed: "
                @for (index, fault) in faults.iter().enumerate() {
                    @if index > 0 { "; " }
                    code { (foreign(&fault.fault)) } " at " (number(fault.first_s)) " s, for " (fault.samples) " samples"
                }
                "."
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
            th scope="row" { (foreign(&capitalised(&check.requirement))) }
            td.number { (reached(check)) }
            td.number { (relation) (check.limit) }
            td.unit { (foreign(&check.unit)) }
            td { (if check.binding { "yes" } else { "no" }) }
            td { (standing_of(check).badge()) }
            td { (foreign(&check.evidence)) }
        }
    }
}

fn standing_of(check: &Check) -> Standing {
    if check.binding || check.holds {
        Standing::of(check.holds)
    } else {
        Standing::Beyond
    }
}

fn reached(check: &Check) -> String {
    check.reached.map_or("never".to_owned(), number)
}
