//! Comparison of model and measurement.

use maud::{Markup, html};
use model_lab::Comparison;
use model_lab::result::{ErrorSummary, Horizon, LimitFrom, RegimeShares, SignalComparison};

use super::contents::ModelPart;
use super::element::{Standing, figure, foreign};
use super::number::{known, number, percent, signed};
use crate::plot::{self, SmallUnit, capitalised, signal_words};

/// Length of the excerpts (s).
const EXCERPT_S: f64 = 10.0;

pub(super) fn standing(part: &ModelPart<'_>) -> Standing {
    of_comparison(part.comparison).unless_explained(part.is_explained)
}

fn of_comparison(comparison: &Comparison) -> Standing {
    let verdict = &comparison.verdict;
    if !verdict.failing.is_empty() {
        Standing::DoesNotHold
    } else if verdict.holds && verdict.undecided.is_empty() {
        Standing::Holds
    } else {
        Standing::Open
    }
}

/// Returns size and place of the model error.
pub(super) fn headline(comparison: &Comparison) -> String {
    let signals = || comparison.signals.iter();
    let failing = signals().find(|signal| signal.holds == Some(false));
    if let Some(signal) = failing {
        return format!(
            "The model misses the {} by {}. {}.",
            signal_words(&signal.name),
            error(signal),
            signal.finding.sentence
        );
    }
    let of_limit = |signal: &SignalComparison| Some(signal.free_run.rms / signal.limit?);
    let nearest = signals()
        .filter_map(|signal| Some((of_limit(signal)?, signal)))
        .max_by(|(one, _), (other, _)| one.total_cmp(other));
    match (of_comparison(comparison), nearest) {
        (Standing::Holds, Some((_, signal))) => format!(
            "Every compared signal is within its limit; nearest to it is the {}, off by {}.",
            signal_words(&signal.name),
            error(signal)
        ),
        _ => "No signal is outside its limit, but not every signal has a limit.".to_owned(),
    }
}

/// Returns the error of a signal, in its unit and relative to the noise.
fn error(signal: &SignalComparison) -> String {
    let unit = SmallUnit::of_errors_in(&signal.unit);
    let rms = number(signal.free_run.rms * unit.per_unit);
    let noise = signal
        .free_run
        .rms_in_noise
        .map_or(String::new(), |multiple| {
            format!(
                ", {} times what the measurement scatters by itself",
                number(multiple)
            )
        });
    format!("{rms} {} rms{noise}", unit.symbol)
}

/// Returns the section of the part with this index; links lead to the first one.
pub(super) fn section(index: usize, part: &ModelPart<'_>) -> Markup {
    let comparison = part.comparison;
    let id = if index == 0 {
        "model".to_owned()
    } else {
        format!("model-{}", index + 1)
    };
    html! {
        section id=(id) {
            h2 { "Model compared with measurement, " (foreign(&comparison.log)) " " (standing(part).badge()) }
            p.rule { "The rule: " (foreign(&comparison.verdict.rule)) "." }
            @for sentence in conditions(comparison) { p.finding { (foreign(&format!("{}.", capitalised(sentence)))) } }
            @for sentence in &comparison.defects.sentences { p.finding { (foreign(&format!("{}.", capitalised(sentence)))) } }
            @for warning in &comparison.warnings {
                p.finding { strong { "Warning" } ": " (foreign(&warning.statement)) "." }
            }
            (signal_table(part))
            (how_to_read(comparison))
            @for signal in &comparison.signals { (signal_section(part, signal)) }
            @if !comparison.not_compared.is_empty() {
                h3 { "Not compared" }
                ul {
                    @for signal in &comparison.not_compared {
                        li { code { (foreign(&signal.name)) } ": " (foreign(&signal.reason)) }
                    }
                }
            }
        }
    }
}

/// Returns the recording conditions that differ from the default, a log of the ECU itself that starts at rest.
fn conditions(comparison: &Comparison) -> impl Iterator<Item = &str> {
    let clock = comparison.clock.iter().map(|clock| &*clock.statement);
    let start_gas = comparison.start_gas.iter();
    clock.chain(start_gas.map(|start| &*start.statement))
}

fn signal_table(part: &ModelPart<'_>) -> Markup {
    html! {
        div.table {
            table {
                caption { "Free run: the model is driven by the logged duty cycles alone. Errors are measured − modelled." }
                thead {
                    tr {
                        th { "Signal" } th { "Verdict" } th { "Unit" } th.number { "Noise σ" } th.number { "Error rms" }
                        th.number { "× noise" } th.number { "Limit" } th.number { "Bias" } th.number { "Fit [%]" }
                        th.number { "Worst" }
                    }
                }
                tbody { @for signal in &part.comparison.signals { (signal_row(signal, part.is_explained)) } }
            }
        }
    }
}

fn signal_row(signal: &SignalComparison, is_explained: bool) -> Markup {
    let unit = SmallUnit::of_errors_in(&signal.unit);
    let scaled = |value: f64| value * unit.per_unit;
    let free = &signal.free_run;
    let standing = signal
        .holds
        .map_or(Standing::Open, Standing::of)
        .unless_explained(is_explained);
    html! {
        tr {
            th scope="row" { (foreign(&capitalised(signal_words(&signal.name)))) " " code { (foreign(&signal.name)) } }
            td { (standing.badge()) }
            td.unit { (foreign(unit.symbol)) }
            td.number { (known(signal.noise_floor.value.map(scaled))) }
            td.number { (number(scaled(free.rms))) }
            td.number { (known(free.rms_in_noise)) }
            td.number { (known(signal.limit.map(scaled))) }
            td.number { (signed(scaled(free.bias))) }
            td.number { (known(free.fit_pct)) }
            td.number { (signed(scaled(free.worst))) br; span.note { "at " (format!("{:.2}", free.worst_time_s)) " s" } }
        }
    }
}

fn how_to_read(comparison: &Comparison) -> Markup {
    html! {
        aside {
            h3 { "How to read this" }
            p {
                "The duty cycles of the log alone drive the model. The plots show its signals over the measured ones. "
                "The difference is compared with the noise, the scatter of the measurement while nothing can change. The grey band shows the noise. "
                "Where the residual is inside the band, the model has no visible error."
            }
            p {
                "In the free run, an error of the pressure remains until the chamber is vented, long after it arose. "
                "The corrected run shows where it arises: there the measured pressure corrects the model after each sample"
                @if let Some(predictor) = &comparison.predictor {
                    ", which looks about " (format!("{:.0}", 1.0 / predictor.gain)) " samples ahead"
                }
                "."
            }
            p {
                "The excess is the squared error beyond the noise. Where a small share of the samples has a large share of the excess, "
                "the model lacks something."
            }
            p.note { "The model starts " (foreign(&comparison.start.statement)) "." }
        }
    }
}

fn signal_section(part: &ModelPart<'_>, signal: &SignalComparison) -> Markup {
    let (log, comparison) = (part.log, part.comparison);
    let excerpt_s = plot::excerpt(comparison, &signal.name, EXCERPT_S);
    html! {
        article {
            h3 { (foreign(&capitalised(signal_words(&signal.name)))) " " code { (foreign(&signal.name)) } }
            p.finding { (foreign(&capitalised(&signal.finding.sentence))) "." }
            @if let Some(excerpt_s) = excerpt_s {
                p.lead { "The ten seconds with the largest free-run error:" }
                (figure(plot::comparison(log, comparison, signal, Some(excerpt_s))))
                p.lead { "The whole log:" }
            }
            (figure(plot::comparison(log, comparison, signal, None)))
            p.lead {
                "Where the error is, "
                (match signal.error_map.horizon {
                    Horizon::OneStepAhead => "one step ahead",
                    Horizon::FreeRun => "in free run",
                })
                ". Each cell: share of the excess, and mean error."
            }
            (figure(plot::error_map(signal)))
            div.panels { @for shares in &signal.regimes { (figure(plot::regime(shares))) } }
            details {
                summary { "In numbers" }
                (details(signal))
                @for shares in &signal.regimes { (regime_table(shares, &signal.unit)) }
            }
        }
    }
}

fn details(signal: &SignalComparison) -> Markup {
    let unit = SmallUnit::of_errors_in(&signal.unit);
    html! {
        dl {
            dt { "Samples" } dd { (signal.compared) " compared, " (signal.missing) " missing" }
            dt { "Noise floor" } dd { (foreign(&signal.noise_floor.statement)) }
            dt { "Limit" }
            dd {
                @if let Some(limit) = signal.limit { (number(limit * unit.per_unit)) " " (foreign(unit.symbol)) ", " }
                (match signal.limit_from {
                    LimitFrom::NoiseFloor => "from the noise floor",
                    LimitFrom::Tolerance => "a tolerance given for this signal",
                    LimitFrom::Unknown => "unknown: neither noise floor nor tolerance",
                })
            }
            @if let Some(offset) = &signal.time_offset { dt { "Time offset" } dd { (foreign(&offset.statement)) } }
            (error_lines("Free run", &signal.free_run, unit))
            @if let Some(one_step_ahead) = &signal.one_step_ahead {
                (error_lines("One step ahead", one_step_ahead, unit))
            }
        }
    }
}

fn error_lines(run: &str, error: &ErrorSummary, unit: SmallUnit<'_>) -> Markup {
    html! {
        dt { (run) }
        dd {
            (number(error.rms * unit.per_unit)) " " (foreign(unit.symbol)) " rms"
            @if let Some(expected) = error.expected_rms {
                "; a perfect model has " (number(expected * unit.per_unit)) " " (foreign(unit.symbol))
            }
            @if let Some(samples) = error.autocorrelation_time_samples {
                "; correlation time " (number(samples)) " samples (white noise: 1)"
            }
            @if let Some(test) = &error.whiteness {
                "; Ljung-Box Q = " (number(test.q)) " over " (test.lags) " lags, " (probability(test.p_value))
            }
            @for correlation in &error.input_correlation {
                "; correlation with " code { (foreign(&correlation.input)) } " "
                (signed(correlation.rho)) " at " (correlation.lag_samples)
                " samples (by chance below " (number(correlation.bound_99)) ")"
            }
        }
    }
}

fn probability(p_value: f64) -> String {
    if p_value < 0.001 {
        "p below 0.001".to_owned()
    } else {
        format!("p = {p_value:.3}")
    }
}

fn regime_table(shares: &RegimeShares, unit: &str) -> Markup {
    let unit = SmallUnit::of_errors_in(unit);
    html! {
        div.table {
            table {
                caption { "By " (foreign(&shares.title)) ", errors in " (foreign(unit.symbol)) }
                thead {
                    tr {
                        th { "Regime" } th.number { "Samples" } th.number { "Share of samples" } th.number { "Share of excess" }
                        th.number { "Bias" } th.number { "Rms" } th.number { "Share, free run" } th.number { "Rms, free run" }
                    }
                }
                tbody {
                    @for bin in &shares.bins {
                        @let error = bin.one_step_ahead.as_ref().unwrap_or(&bin.free_run);
                        tr {
                            th scope="row" { (foreign(&bin.label)) }
                            td.number { (bin.samples) }
                            td.number { (percent(bin.sample_share)) }
                            td.number { (error.excess_share.map_or("within chance".to_owned(), percent)) }
                            td.number { (signed(error.bias * unit.per_unit)) }
                            td.number { (number(error.rms * unit.per_unit)) }
                            td.number { (bin.free_run.excess_share.map_or("within chance".to_owned(), percent)) }
                            td.number { (number(bin.free_run.rms * unit.per_unit)) }
                        }
                    }
                }
            }
        }
    }
}
