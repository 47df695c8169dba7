//! Conversion of tasks into outcomes: values that do not depend on how they are shown.

pub(crate) mod black_box;
pub(crate) mod calibrate;
pub(crate) mod compare;
pub(crate) mod control;
pub(crate) mod demo;
pub(crate) mod device;
pub(crate) mod device_report;
pub(crate) mod diagnose;
pub(crate) mod inspect;
pub(crate) mod measurement;
pub(crate) mod monte_carlo;
pub(crate) mod next_experiment;
mod row_output;
pub(crate) mod schema;
pub(crate) mod serve;
pub(crate) mod session;
pub(crate) mod simulate;
pub(crate) mod thesis;
pub(crate) mod tune;

use crate::input::{NamedController, NamedPlant};

/// Result of a task.
pub(crate) enum Outcome {
    Demo(Box<demo::Demo>),
    Inspection(inspect::Inspected),
    Simulation(simulate::Simulation),
    Comparison(Box<compare::Compared>),
    Diagnosis(Box<diagnose::Diagnosed>),
    Estimation(Box<diagnose::EstimatedPlant>),
    Refinement(Box<diagnose::RefinedPlant>),
    NextExperiment(Box<next_experiment::Planned>),
    DeterminingExperiment(Box<next_experiment::Determining>),
    Control(Box<control::Controlled>),
    RigTable(Box<monte_carlo::RigTable>),
    Report(Box<session::Reported>),
    BlackBox(black_box::BlackBox),
    DeviceSettings(calibrate::Settings),
    /// All signals of a device.
    DeviceSignals,
    /// Measured signals of a device.
    Measurement(measurement::Measurement),
    Thesis(thesis::Figures),
    ThesisExplanation(thesis::Explained),
    Parameters(NamedPlant),
    Settings(NamedController),
    Tuned(Box<tune::Tuned>),
    /// Text that is printed unchanged.
    Text(String),
}

/// Answer that decides the exit status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Answer {
    Holds,
    DoesNotHold,
    /// There is a result, but it does not decide the question.
    Open,
    /// The model is within tolerance with other values than those of its plant file.
    PlantFileWrong,
}

impl Answer {
    pub(crate) fn of(holds: bool) -> Self {
        if holds {
            Self::Holds
        } else {
            Self::DoesNotHold
        }
    }
}

impl Outcome {
    /// Returns the answer. An outcome without a question, such as the demo, passes.
    pub(crate) fn answer(&self) -> Answer {
        match self {
            Self::Comparison(compared) => compared.answer(),
            Self::Diagnosis(diagnosed) => diagnosed.answer(),
            Self::NextExperiment(planned) => planned.answer(),
            Self::DeterminingExperiment(planned) => planned.answer(),
            Self::Control(controlled) => Answer::of(controlled.holds()),
            Self::RigTable(table) => Answer::of(table.summary.holds()),
            Self::Report(reported) => reported.answer(),
            Self::Measurement(measurement) => measurement.answer(),
            Self::Inspection(inspected) => inspected.answer(),
            Self::Thesis(figures) => Answer::of(figures.table.holds),
            Self::ThesisExplanation(explained) => Answer::of(explained.explanation.brings_in()),
            Self::Demo(_)
            | Self::Simulation(_)
            | Self::Estimation(_)
            | Self::Refinement(_)
            | Self::BlackBox(_)
            | Self::DeviceSettings(_)
            | Self::DeviceSignals
            | Self::Parameters(_)
            | Self::Settings(_)
            | Self::Tuned(_)
            | Self::Text(_) => Answer::Holds,
        }
    }
}
