//! Diagnosis of the missing physical effect.

use maud::{Markup, html};
use model_lab::Comparison;
use model_lab::diagnosis::result::{
    Candidate, DetectionLimit, Diagnosis, NuisanceValue, Regime, Step, StepKind, Verdict,
};
use model_lab::result::SignalComparison;

use super::contents::DiagnosisPart;
use super::element::{figure, foreign};
use super::number::{engineering, number, percent};
use crate::plot::{self, SmallUnit, capitalised, pressure_first, signal_words, unit_of};

/// Length of the excerpts (s).
const EXCERPT_S: f64 = 10.0;

/// Returns the verdict in a few words.
pub(super) fn badge(diagnosis: &Diagnosis) -> Markup {
    let (class, words) = match diagnosis.verdict {
        Verdict::Adequate => ("badge holds", "✓ nothing is missing"),
        Verdict::Found => ("badge holds", "✓ found"),
        Verdict::PlantFileWrong => ("badge open", "? plant file wrong"),
        Verdict::FormWrong => ("badge open", "? found in part"),
        Verdict::NotInLibrary => ("badge fails", "✗ not in the library"),
    };
    html! { span class=(class) { (words) } }
}

pub(super) fn headline(diagnosis: &Diagnosis) -> String {
    capitalised(&diagnosis.sentence) + "."
}

pub(super) fn section(part: &DiagnosisPart<'_>) -> Markup {
    let diagnosis = part.diagnosis;
    let named = |candidate: &&Candidate| diagnosis.effects.contains(&candidate.effect);
    html! {
        section #diagnosis {
            h2 { "Which effect is missing? " (badge(diagnosis)) }
            @for candidate in diagnosis.candidates.iter().filter(named) {
                p.finding { strong { (foreign(&title(&candidate.effect))) } ": " (foreign(&candidate.physics)) }
            }
            @if let Some(next) = part.next_command {
                p.lead { (capitalised(next.purpose)) ":" }
                pre { code { (foreign(&next.command)) } }
            }
            p.rule { "Validated on " (foreign(&diagnosis.held_out)) "; " (foreign(&diagnosis.predictor)) "." }
            @for (log, warnings) in &diagnosis.warnings {
                @for warning in warnings {
                    p.finding { strong { "Warning" } " about " (foreign(log)) ": " (foreign(&warning.statement)) "." }
                }
            }
            @for (log, signals) in &diagnosis.not_compared {
                @for signal in signals {
                    p.finding { strong { (foreign(&signal.name)) } " of " (foreign(log)) " is excluded from the fit: " (foreign(&signal.reason)) "." }
                }
            }
            @for clock in &diagnosis.clocks { p.rule { (foreign(&clock.log)) ": " (foreign(&clock.statement)) "." } }
            @for start in diagnosis.starts.iter().filter(|start| start.is_warm()) {
                p.rule { (foreign(&start.log)) ": " (foreign(&start.statement)) "." }
            }
            @for (log, defects) in &diagnosis.defects {
                @for sentence in &defects.sentences {
                    p.finding { (foreign(log)) ": " (foreign(sentence)) "." }
                }
            }
            (figure(plot::error_steps(&diagnosis.error_steps)))
            details { summary { "In numbers" } (error_step_table(&diagnosis.error_steps)) }
            (before_and_after(part))
            h3 { "The candidates" }
            (figure(plot::candidates(diagnosis)))
            (candidate_table(diagnosis))
            (neighbours(diagnosis))
            h3 { "Ordinary parameters" }
            p { "Refitted within the tolerance of the plant file, with every candidate. A value at its limit shows that physics is missing." }
            (nuisance_table(&diagnosis.nuisance))
            (location(diagnosis))
            @if !diagnosis.remaining.sentences.is_empty() {
                h3 { "Unexplained residual" }
                ul { @for sentence in &diagnosis.remaining.sentences { li { (foreign(sentence)) } } }
                @if !diagnosis.remaining.missing_flow.is_empty() { (figure(plot::missing_flow(&diagnosis.remaining.missing_flow))) }
            }
            p.note {
                (diagnosis.cost.simulations) " simulations of " (number(diagnosis.cost.log_s)) " s of log in "
                (number(diagnosis.cost.elapsed_s)) " s; one takes " (number(diagnosis.cost.per_simulation_ms)) " ms."
            }
        }
    }
}

fn title(id: &str) -> String {
    capitalised(&id.replace(['_', '.'], " "))
}

fn error_step_table(steps: &[Step]) -> Markup {
    html! {
        div.table {
            table {
                thead {
                    tr {
                        th { "Step" } th { "Signal" } th { "Unit" } th.number { "Rms, training" } th.number { "Rms, validation" }
                        th.number { "Noise floor" } th.number { "Rms, free run" } th.number { "Explained" } th.number { "Fitted parameters" }
                    }
                }
                tbody {
                    @for step in steps {
                        @for (index, (signal, rms)) in pressure_first(&step.check_rms).enumerate() {
                            @let unit = SmallUnit::of_errors_in(unit_of(signal));
                            @let scaled = |value: Option<&f64>| value.map_or(String::new(), |value| number(value * unit.per_unit));
                            tr {
                                th scope="row" { @if index == 0 { (foreign(&capitalised(&step.name()))) } }
                                td { (foreign(&capitalised(signal_words(signal)))) }
                                td.unit { (unit.symbol) }
                                td.number { (scaled(step.fit_rms.get(signal))) }
                                td.number { (scaled(Some(&rms))) }
                                td.number { (scaled(step.noise_floor.get(signal))) }
                                td.number { (scaled(step.free_run_check_rms.get(signal))) }
                                td.number { @if index == 0 && step.kind != StepKind::PlantAsGiven { (percent(step.explained_share)) } }
                                td.number { @if index == 0 { (step.free_parameters) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn before_and_after(part: &DiagnosisPart<'_>) -> Markup {
    let Some(runs) = &part.runs else {
        return html! {};
    };
    let both: Vec<&Comparison> = [&runs.before].into_iter().chain(&runs.after).collect();
    let heading = match runs.after {
        Some(_) => "Before and after, ",
        None => "Measured and modelled, ",
    };
    let caption = |signal: &SignalComparison, after: Option<&SignalComparison>| {
        let unit = SmallUnit::of_errors_in(&signal.unit);
        let of = |signal: &SignalComparison| number(signal.free_run.rms * unit.per_unit);
        let after = after.map_or(String::new(), |after| {
            format!(" → {} {}", of(after), unit.symbol)
        });
        format!("Free run: {} {}{after} rms.", of(signal), unit.symbol)
    };
    html! {
        h3 { (heading) (foreign(&runs.before.log)) }
        @for signal in &runs.before.signals {
            @let after = runs.after.iter().flat_map(|after| &after.signals).find(|one| one.name == signal.name);
            @let excerpt_s = plot::excerpt(&runs.before, &signal.name, EXCERPT_S);
            article {
                h3 { (foreign(&capitalised(signal_words(&signal.name)))) " " code { (foreign(&signal.name)) } }
                p.finding { (caption(signal, after)) }
                @if let Some(excerpt_s) = excerpt_s {
                    p.lead { "Where the error of the plain model is largest:" }
                    (figure(plot::before_and_after(runs.log, &both, signal, Some(excerpt_s))))
                    details {
                        summary { "The whole log" }
                        (figure(plot::before_and_after(runs.log, &both, signal, None)))
                    }
                } @else {
                    (figure(plot::before_and_after(runs.log, &both, signal, None)))
                }
            }
        }
    }
}

fn candidate_table(diagnosis: &Diagnosis) -> Markup {
    html! {
        div.table {
            table {
                caption { "Each effect alone on top of the plain model; a named one with all named ones. Evidence: difference of Schwarz's criterion, above 10 it is strong." }
                thead {
                    tr {
                        th { "Effect" } th.number { "Explained" } th.number { "Evidence" } th { "Fitted, 95 % interval" } th { "Size" }
                        th { "Detection limit" }
                    }
                }
                tbody {
                    @for candidate in &diagnosis.candidates {
                        (candidate_row(candidate, diagnosis.contenders().any(|one| one == candidate)))
                    }
                }
            }
        }
    }
}

fn candidate_row(candidate: &Candidate, is_contender: bool) -> Markup {
    html! {
        tr {
            th scope="row" { (foreign(&title(&candidate.effect))) br; span.note { (foreign(&candidate.variant)) } }
            td.number { @if candidate.explained_share < 0.0 { "none" } @else { (percent(candidate.explained_share)) } }
            td.number { (format!("{:.0}", candidate.evidence).replace('-', "\u{2212}")) }
            td {
                @for parameter in candidate.parameters.iter().filter(|_| is_contender) {
                    div {
                        code { (foreign(&parameter.key)) } " " (engineering(parameter.value)) " "
                        span.note { "(" (engineering(parameter.low)) " to " (engineering(parameter.high)) ")" } " " (foreign(&parameter.unit))
                    }
                }
            }
            td { @if is_contender { (foreign(&candidate.plausibility)) } }
            td {
                @match &candidate.detection_limit {
                    DetectionLimit::Size { key, value, .. } => {
                        @if candidate.is_stronger_below() { "≤ " } @else { "≥ " } (engineering(*value)) br; code { (foreign(key)) }
                    }
                    DetectionLimit::NotExcited { test_signal } => {
                        "not excited" br; span.note { (foreign(test_signal)) }
                    }
                }
            }
        }
    }
}

fn neighbours(diagnosis: &Diagnosis) -> Markup {
    html! {
        @for sentence in diagnosis.alternatives() {
            p { (foreign(&sentence)) }
        }
    }
}

fn nuisance_table(values: &[NuisanceValue]) -> Markup {
    html! {
        div.table {
            table {
                thead {
                    tr {
                        th { "Parameter" } th { "Unit" } th.number { "Plant file" } th.number { "Tolerance" } th.number { "Plain model" }
                        th.number { "With the effects" } th.number { "95 % interval" } th { "Alarm" }
                    }
                }
                tbody {
                    @for value in values {
                        tr {
                            th scope="row" { code { (foreign(&value.name)) } }
                            td.unit { (foreign(&value.unit)) }
                            td.number { (engineering(value.datasheet)) }
                            td.number { "± " (engineering(value.tolerance)) }
                            td.number { (engineering(value.plain)) }
                            td.number { (engineering(value.fitted)) }
                            td.number { (engineering(value.low)) " to " (engineering(value.high)) }
                            td { @if let Some(alarm) = &value.alarm { (foreign(alarm)) } }
                        }
                    }
                }
            }
        }
    }
}

fn location(diagnosis: &Diagnosis) -> Markup {
    let list = |regimes: &[Regime]| {
        html! {
            ul {
                @for regime in regimes {
                    li { (foreign(&regime.log)) ", " code { (foreign(&regime.signal)) } ": " (foreign(&regime.sentence)) "." }
                }
            }
        }
    };
    html! {
        h3 { "Where the excess error is" }
        @for sentence in &diagnosis.location.of_compare {
            p { (foreign(sentence)) "." }
        }
        p.lead { "With the ordinary parameters refitted:" }
        (list(&diagnosis.location.before))
        @if !diagnosis.effects.is_empty() {
            p.lead { "With the named effects:" }
            (list(&diagnosis.location.after))
        }
    }
}
