//! Opened logs and their problems.

use maud::{Markup, html};
use recording::Recording;

use super::contents::LogPart;
use super::element::foreign;
use super::number::number;

pub(super) fn section(logs: &[LogPart<'_>]) -> Markup {
    html! {
        section #logs {
            h2 { "Logs" }
            div.table {
                table {
                    thead {
                        tr {
                            th { "Log" } th.number { "Samples" } th.number { "Duration [s]" } th.number { "Interval [ms]" } th { "Signals" }
                            th { "Problems" }
                        }
                    }
                    tbody { @for log in logs { (row(log)) } }
                }
            }
        }
    }
}

fn row(log: &LogPart<'_>) -> Markup {
    let extent = log.recording.and_then(Extent::of);
    html! {
        tr {
            th scope="row" {
                (foreign(log.name))
                @if let Some(start) = log.recording.and_then(|recording| recording.provenance().start) {
                    div.note { "recorded " (start.to_string()) }
                }
            }
            td.number { @if let Some(extent) = &extent { (extent.samples) } }
            td.number { @if let Some(extent) = &extent { (number(extent.duration_s)) } }
            td.number { @if let Some(step_s) = extent.and_then(|extent| extent.step_s) { (number((1e6 * step_s).round() / 1e3)) } }
            td { @if let Some(recording) = log.recording { (signals(recording)) } }
            td {
                @for problem in log.problems { div { (foreign(problem)) } }
                @if let Some(recording) = log.recording {
                    @for left_out in recording.left_out() {
                        div { code { (foreign(&left_out.name)) } " left out: " (foreign(&left_out.reason)) }
                    }
                    @let defects = recording.defects().sentences();
                    @for sentence in &defects { div { (foreign(sentence)) } }
                    @if log.problems.is_empty() && recording.left_out().is_empty() && defects.is_empty() { "none" }
                }
            }
        }
    }
}

fn signals(recording: &Recording) -> Markup {
    html! {
        @for (index, signal) in recording.signals().iter().enumerate() {
            @if index > 0 { ", " }
            code { (foreign(signal.name())) } " [" (foreign(signal.unit().symbol())) "]"
        }
    }
}

/// Extent of the time base with the most samples.
struct Extent {
    samples: usize,
    duration_s: f64,
    step_s: Option<f64>,
}

impl Extent {
    fn of(recording: &Recording) -> Option<Self> {
        let bases = recording.time_bases().map(|(_, base)| base);
        let longest = bases.max_by_key(|base| base.len())?;
        Some(Self {
            samples: longest.len(),
            duration_s: longest.end_s() - longest.start_s(),
            step_s: longest.sampling().median_step_s,
        })
    }
}
