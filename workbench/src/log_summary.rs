//! Summary of a log, computed when it is read.

use recording::{OwnSamples, Recording, Signal, TimeBase, Unit, median_step_s};
use serde::Serialize;

use crate::shown_unit::unit_of_errors;

/// Summary of a log.
#[derive(Clone, Serialize)]
pub(crate) struct LogSummary {
    samples: usize,
    duration_s: f64,
    /// Date, time and zone of the log's 0 s, if the file states it.
    start: Option<String>,
    sample_interval_s: Option<f64>,
    /// Number of pauses: many times the sample interval.
    gaps: usize,
    is_uneven: bool,
    sha256: Option<String>,
    signals: Vec<SignalView>,
    /// Channels of the file that the log lacks, each with the reason.
    left_out: Vec<LeftOutView>,
}

#[derive(Clone, Serialize)]
struct LeftOutView {
    name: String,
    reason: String,
}

#[derive(Clone, Serialize)]
struct SignalView {
    name: String,
    unit: String,
    /// Unit in the notation of a header.
    token: &'static str,
    /// Unit of its errors and their limits.
    error_unit: &'static str,
    quantity: String,
    /// `gauge` or `absolute` for a pressure, otherwise `None`.
    reference: Option<&'static str>,
    missing: usize,
    /// Median time between its samples (s), if it has another rate than the log.
    own_interval_s: Option<f64>,
    lowest: Option<f64>,
    highest: Option<f64>,
}

impl LogSummary {
    pub(crate) fn of(log: &Recording) -> Self {
        let bases = || log.time_bases().map(|(_, base)| base);
        let longest = bases().max_by_key(|base| base.len());
        let sampling = longest.map(TimeBase::sampling);
        let start_s = bases()
            .map(|base| base.start_s())
            .fold(f64::INFINITY, f64::min);
        let end_s = bases()
            .map(|base| base.end_s())
            .fold(f64::NEG_INFINITY, f64::max);
        let provenance = log.provenance();
        Self {
            samples: longest.map_or(0, TimeBase::len),
            duration_s: (end_s - start_s).max(0.0),
            start: provenance.start.map(|start| start.to_string()),
            sample_interval_s: sampling
                .as_ref()
                .and_then(|sampling| sampling.median_step_s),
            gaps: sampling.as_ref().map_or(0, |sampling| sampling.gaps.len()),
            is_uneven: sampling.is_some_and(|sampling| sampling.uneven),
            sha256: provenance.input.map(|input| input.sha256_hex()),
            signals: log
                .signals()
                .iter()
                .map(|signal| signal_view(log, signal, longest))
                .collect(),
            left_out: log
                .left_out()
                .iter()
                .map(|left_out| LeftOutView {
                    name: left_out.name.clone(),
                    reason: left_out.reason.clone(),
                })
                .collect(),
        }
    }
}

fn signal_view(log: &Recording, signal: &Signal, longest: Option<&TimeBase>) -> SignalView {
    let present = || signal.iter().flatten();
    let base = log.time_base(signal.time_base());
    let times_s = base.map_or(&[][..], TimeBase::times_s);
    let own = OwnSamples::of(times_s, signal.values_or_nan());
    SignalView {
        name: signal.name().to_owned(),
        unit: signal.unit().symbol().to_owned(),
        token: signal.unit().token(),
        error_unit: unit_of_errors(signal),
        quantity: signal.quantity().to_string(),
        reference: reference(signal.unit()),
        missing: match own {
            Some(_) => 0,
            None => signal.missing_count(),
        },
        own_interval_s: match &own {
            Some(own) => median_step_s(&own.times_s),
            None if base == longest => None,
            None => median_step_s(times_s),
        },
        lowest: present().reduce(f64::min),
        highest: present().reduce(f64::max),
    }
}

fn reference(unit: Unit) -> Option<&'static str> {
    use recording::PressureReference::{Absolute, Gauge};
    unit.pressure_reference().map(|reference| match reference {
        Gauge => "gauge",
        Absolute => "absolute",
    })
}
