//! View of a project.

use model_lab::diagnosis::known;
use plant_sim::PlantParameters;
use serde::Serialize;

use crate::calculated::Calculated;
use crate::log_summary::LogSummary;
use crate::plant_sketch::SketchView;
use crate::project::{AcceptanceLimits, LogEntry, PlantFile};
use crate::refusal::{Problem, Refusal};
use crate::session::Session;

#[derive(Serialize)]
pub(super) struct ProjectView {
    logs: Vec<LogView>,
    plant: PlantView,
    strictness: AcceptanceLimits,
    calculated: Vec<Calculated>,
}

#[derive(Serialize)]
struct LogView {
    number: u32,
    name: String,
    offset_s: f64,
    is_mapped: bool,
    /// Reason why it cannot be read; `None` if it can.
    problem: Option<Problem>,
    summary: Option<LogSummary>,
    /// Whether it was compared with the current plant.
    is_compared: bool,
}

#[derive(Serialize)]
struct PlantView {
    name: String,
    is_nominal: bool,
    problems: Vec<Problem>,
    /// Parameters that differ from the thesis model, or have a stated uncertainty.
    changed: Vec<ParameterView>,
    effects: Vec<&'static str>,
    /// Sketch; `None` if the plant cannot be read.
    sketch: Option<SketchView>,
}

#[derive(Serialize)]
struct ParameterView {
    name: String,
    value: f64,
    nominal: Option<f64>,
    unit: &'static str,
    about: &'static str,
    /// Uncertainty in words.
    known: String,
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
        Ok(log) => (None, Some(log.summary.clone())),
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
            let name = spec.name();
            let is_stated = parameters.knowledge.contains_key(&name);
            (before != Some(value) || is_stated).then(|| ParameterView {
                known: known(parameters, &name).map_or_else(String::new, |it| it.words(spec.unit)),
                name,
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
        sketch: parameters.as_ref().and_then(SketchView::of),
        problems,
    }
}
