//! What the page shows of a project.

use plant_sim::PlantParameters;
use recording::{Recording, Unit};
use serde::Serialize;

use crate::calculated::Calculated;
use crate::project::{LogEntry, PlantFile, Strictness};
use crate::refusal::{Problem, Refusal};
use crate::session::Session;
use crate::shown_unit::unit_of_errors;

#[derive(Serialize)]
pub(super) struct ProjectView {
    logs: Vec<LogView>,
    plant: PlantView,
    strictness: Strictness,
    calculated: Vec<Calculated>,
}

#[derive(Serialize)]
struct LogView {
    number: u32,
    name: String,
    offset_s: f64,
    is_mapped: bool,
    /// Why it cannot be read; none if it can.
    problem: Option<Problem>,
    summary: Option<Summary>,
    /// Whether there is a comparison of it with the plant as it is now.
    is_compared: bool,
}

#[derive(Serialize)]
struct Summary {
    samples: usize,
    duration_s: f64,
    /// Date and time of the log's 0 s with its zone, where the file tells it.
    start: Option<String>,
    sample_interval_s: Option<f64>,
    /// Pauses of the log: many times its sample interval.
    gaps: usize,
    is_uneven: bool,
    sha256: Option<String>,
    signals: Vec<SignalView>,
    /// What the file has and the log has not, each with the reason.
    left_out: Vec<LeftOutView>,
}

#[derive(Serialize)]
struct LeftOutView {
    name: String,
    reason: String,
}

#[derive(Serialize)]
struct SignalView {
    name: String,
    unit: String,
    /// The unit as a header writes it.
    token: &'static str,
    /// That of its errors, and so of their limits.
    error_unit: &'static str,
    quantity: String,
    /// `gauge`, `absolute` or none, for a pressure.
    reference: Option<&'static str>,
    missing: usize,
    lowest: Option<f64>,
    highest: Option<f64>,
}

#[derive(Serialize)]
struct PlantView {
    name: String,
    is_nominal: bool,
    problems: Vec<Problem>,
    /// Parameters that differ from the thesis model.
    changed: Vec<ParameterView>,
    effects: Vec<&'static str>,
}

#[derive(Serialize)]
struct ParameterView {
    name: String,
    value: f64,
    nominal: Option<f64>,
    unit: &'static str,
    about: &'static str,
}

impl ProjectView {
    pub(super) fn of(session: &Session) -> Result<Self, Refusal> {
        let project = session.project();
        let logs = project.logs.iter().map(|entry| log_view(session, entry));
        Ok(Self {
            logs: logs.collect::<Result<_, _>>()?,
            plant: plant_view(&project.plant),
            strictness: project.strictness,
            calculated: project.calculated,
        })
    }
}

fn log_view(session: &Session, entry: &LogEntry) -> Result<LogView, Refusal> {
    let log = session.log(entry.number)?;
    let (problem, summary) = match &*log {
        Ok(log) => (None, Some(summary(&log.recording))),
        Err(problem) => (Some(problem.clone()), None),
    };
    Ok(LogView {
        number: entry.number,
        name: entry.name.clone(),
        offset_s: entry.offset_s,
        is_mapped: entry.mapping.is_some(),
        problem,
        summary,
        is_compared: session.comparison(entry.number).is_some(),
    })
}

fn summary(log: &Recording) -> Summary {
    let bases = || log.time_bases().map(|(_, base)| base);
    let longest = bases().max_by_key(|base| base.len());
    let sampling = longest.map(recording::TimeBase::sampling);
    let start_s = bases()
        .map(|base| base.start_s())
        .fold(f64::INFINITY, f64::min);
    let end_s = bases()
        .map(|base| base.end_s())
        .fold(f64::NEG_INFINITY, f64::max);
    let provenance = log.provenance();
    Summary {
        samples: longest.map_or(0, recording::TimeBase::len),
        duration_s: (end_s - start_s).max(0.0),
        start: provenance.start.map(|start| start.to_string()),
        sample_interval_s: sampling
            .as_ref()
            .and_then(|sampling| sampling.median_step_s),
        gaps: sampling.as_ref().map_or(0, |sampling| sampling.gaps.len()),
        is_uneven: sampling.is_some_and(|sampling| sampling.uneven),
        sha256: provenance.input.map(|input| input.sha256_hex()),
        signals: log.signals().iter().map(signal_view).collect(),
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

fn signal_view(signal: &recording::Signal) -> SignalView {
    let present = || signal.iter().flatten();
    SignalView {
        name: signal.name().to_owned(),
        unit: signal.unit().symbol().to_owned(),
        token: signal.unit().token(),
        error_unit: unit_of_errors(signal),
        quantity: signal.quantity().to_string(),
        reference: reference(signal.unit()),
        missing: signal.missing_count(),
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

fn plant_view(plant: &PlantFile) -> PlantView {
    let nominal = PlantParameters::nominal();
    let (parameters, problems) = match plant.parameters() {
        Ok(parameters) => (Some(parameters), Vec::new()),
        Err(refusal) => (None, refusal.problems),
    };
    let changed = parameters.iter().flat_map(|parameters| {
        parameters.specs().filter_map(|spec| {
            let value = spec.value(parameters)?;
            let before = spec.value(&nominal);
            (before != Some(value)).then(|| ParameterView {
                name: spec.name(),
                value,
                nominal: before,
                unit: spec.unit,
                about: spec.about,
            })
        })
    });
    PlantView {
        name: plant.name.clone(),
        is_nominal: *plant == PlantFile::nominal(),
        changed: changed.collect(),
        effects: parameters
            .iter()
            .flat_map(|parameters| parameters.effects.iter().map(|effect| effect.id()))
            .collect(),
        problems,
    }
}
