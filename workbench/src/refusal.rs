//! Refusals and their problems, for the page.

use axum::Json;
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use hil_harness::RunError;
use hil_harness::checks::JudgeError;
use hil_harness::controller_file::ControllerFileError;
use hil_harness::reference_profile::ProfileError;
use hil_harness::rigs::RigError;
use hil_harness::scenario::ScenarioError;
use model_lab::CompareError;
use model_lab::diagnosis::{DiagnoseError, KnowledgeError};
use plant_sim::ParameterError;
use recording::LogError;
use recording::csv::{CsvError, MappingError};
use recording::mf4::Mf4Error;
use serde::Serialize;

/// Problem, and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Problem {
    /// Stable code, such as `E-CSV-TIME-ORDER`.
    pub(crate) code: String,
    /// Cause, expectation, and what to do.
    pub(crate) message: String,
    /// Line of the file, from 1.
    pub(crate) line: Option<u64>,
    /// Column of the file, from 1.
    pub(crate) column: Option<usize>,
}

impl Problem {
    pub(crate) fn new(code: &str, message: impl Into<String>) -> Self {
        Self {
            code: code.to_owned(),
            message: message.into(),
            line: None,
            column: None,
        }
    }
}

/// Refused request: a status for the browser and all problems.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Refusal {
    pub(crate) status: StatusCode,
    pub(crate) problems: Vec<Problem>,
}

impl Refusal {
    pub(crate) fn new(status: StatusCode, code: &str, message: impl Into<String>) -> Self {
        Self {
            status,
            problems: vec![Problem::new(code, message)],
        }
    }

    /// Creates the refusal of a missing thing: a log that was removed, a session of an earlier start.
    pub(crate) fn not_found(what: &str) -> Self {
        let message = format!("there is no such {what}; reload the page");
        Self::new(StatusCode::NOT_FOUND, "E-WEB-NOT-FOUND", message)
    }

    /// Creates the refusal of a request that came before its prerequisites.
    pub(crate) fn too_early(message: impl Into<String>) -> Self {
        Self::new(StatusCode::CONFLICT, "E-WEB-TOO-EARLY", message)
    }

    /// Creates the refusal of a value out of its range.
    pub(crate) fn value(message: impl Into<String>) -> Self {
        Self::new(StatusCode::BAD_REQUEST, "E-WEB-VALUE", message)
    }

    /// Creates the refusal of a request or file above the size limit.
    pub(crate) fn too_large(bytes: u64, bytes_max: u64) -> Self {
        Self::new(
            StatusCode::PAYLOAD_TOO_LARGE,
            "E-WEB-TOO-LARGE",
            format!(
                "the request has {bytes} bytes or more (at most {bytes_max}); cut the log, or use `retarder compare`"
            ),
        )
    }

    /// Creates the refusal of an incomplete upload.
    pub(crate) fn broken_off() -> Self {
        Self::new(
            StatusCode::BAD_REQUEST,
            "E-WEB-BROKEN-OFF",
            "the upload broke off; drop the file again",
        )
    }

    /// Returns the refusal of a text with `count` lines that is a part of a file; problems in the rest have no line.
    pub(crate) fn with_lines_up_to(mut self, count: u64) -> Self {
        for problem in &mut self.problems {
            problem.line = problem.line.filter(|line| *line <= count);
        }
        self
    }

    fn of(problems: Vec<Problem>) -> Self {
        Self {
            status: StatusCode::UNPROCESSABLE_ENTITY,
            problems,
        }
    }
}

impl From<Problem> for Refusal {
    fn from(problem: Problem) -> Self {
        Self::of(vec![problem])
    }
}

impl From<&LogError> for Problem {
    fn from(error: &LogError) -> Self {
        match error {
            LogError::Csv(error) => error.into(),
            LogError::Mf4(error) => error.into(),
            // A format that this page does not know yet.
            other => Self::new(other.code(), other.to_string()),
        }
    }
}

impl From<&CsvError> for Problem {
    fn from(error: &CsvError) -> Self {
        let place = error.place();
        Self {
            code: error.code().to_owned(),
            message: format!("{}; {}", error.problem(), error.problem().next_step()),
            line: place.line,
            column: place.column,
        }
    }
}

impl From<&Mf4Error> for Problem {
    /// An MF4 file has no lines; the error names its blocks, for a repair.
    fn from(error: &Mf4Error) -> Self {
        let place = error.place();
        let block = place.block.map(|block| format!("block {block}"));
        let offset = place.offset.map(|offset| format!("byte {offset}"));
        let channel = place.channel.as_ref().map(|name| format!("channel {name}"));
        let place: Vec<String> = [block, offset, channel].into_iter().flatten().collect();
        let place = if place.is_empty() {
            String::new()
        } else {
            format!("{}: ", place.join(", "))
        };
        let problem = error.problem();
        Self::new(
            error.code(),
            format!("{place}{problem}; {}", problem.next_step()),
        )
    }
}

impl From<&MappingError> for Problem {
    fn from(error: &MappingError) -> Self {
        Self {
            line: error.place().map(|(line, _)| line as u64),
            column: error.place().map(|(_, column)| column),
            ..Self::new(error.code(), error.problem().to_string())
        }
    }
}

impl From<ParameterError> for Refusal {
    fn from(error: ParameterError) -> Self {
        let problem = |problem: &plant_sim::parameters::Problem| Problem {
            line: problem.line().map(|line| line as u64),
            ..Problem::new("E-PLANT", problem.to_string())
        };
        Self::of(error.problems().iter().map(problem).collect())
    }
}

impl From<CompareError> for Refusal {
    fn from(error: CompareError) -> Self {
        Problem::new("E-COMPARE", error.to_string()).into()
    }
}

impl From<DiagnoseError> for Refusal {
    fn from(error: DiagnoseError) -> Self {
        Problem::new("E-DIAGNOSE", error.to_string()).into()
    }
}

impl From<ControllerFileError> for Refusal {
    fn from(error: ControllerFileError) -> Self {
        let problem = |problem: &hil_harness::controller_file::Problem| Problem {
            line: problem.line().map(|line| line as u64),
            ..Problem::new("E-CONTROLLER", problem.to_string())
        };
        Self::of(error.problems().iter().map(problem).collect())
    }
}

macro_rules! refusals {
    ($($error:ty => $code:literal),* $(,)?) => {
        $(impl From<$error> for Refusal {
            fn from(error: $error) -> Self {
                Problem::new($code, error.to_string()).into()
            }
        })*
    };
}

refusals! {
    KnowledgeError => "E-PLANT",
    ProfileError => "E-REFERENCE",
    ScenarioError => "E-SCENARIO",
    RunError => "E-LOOP",
    RigError => "E-LOOP",
    JudgeError => "E-LOOP",
}

impl From<std::io::Error> for Refusal {
    /// Only the kind, since the text of an error may name a path.
    fn from(error: std::io::Error) -> Self {
        Self::new(
            StatusCode::INTERNAL_SERVER_ERROR,
            "E-WEB-DISK",
            format!(
                "the project folder cannot be used: {}; check its rights and the space on its disk",
                error.kind()
            ),
        )
    }
}

impl IntoResponse for Refusal {
    fn into_response(self) -> Response {
        #[derive(Serialize)]
        struct Body {
            problems: Vec<Problem>,
        }
        let problems = self.problems;
        (self.status, Json(Body { problems })).into_response()
    }
}
