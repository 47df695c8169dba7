//! Inspection of logs of unknown layout.

use std::path::{Path, PathBuf};

use recording::csv::Mapping;
use recording::{Inspection, inspect_file, inspect_named_file};

use super::Answer;
use crate::cli::InspectArgs;
use crate::exchanged;
use crate::failure::Failure;
use crate::input;
use crate::progress::Progress;

/// Inspected logs and the arguments of the command.
pub(crate) struct Inspected {
    pub(crate) args: InspectArgs,
    pub(crate) logs: Vec<(PathBuf, Inspection)>,
}

/// Inspects every log.
pub(crate) fn run(args: InspectArgs) -> Result<Inspected, Failure> {
    let options = input::imported_by(&args.import)?;
    let given = match &args.import.mapping {
        Some(path) => Some(input::read_text(path)?),
        None => None,
    };
    let mut logs: Vec<(PathBuf, Inspection)> = Vec::new();
    for path in &args.paths {
        let _progress = Progress::of_unknown_length("reading");
        let inspection = if input::is_standard_input(path) {
            if logs.iter().any(|(other, _)| other == path) {
                return Err(Failure::StandardInputTwice);
            }
            let kept = input::kept_standard_input();
            let kept = kept.map_err(|error| Failure::KeepStandardInput { error })?;
            inspect_named_file(
                input::STANDARD_INPUT,
                kept.path(),
                &options,
                given.as_deref(),
            )?
        } else {
            exchanged::refuse_as_log(path)?;
            inspect_file(path, &options, given.as_deref())?
        };
        logs.push((path.clone(), inspection));
    }
    let inspected = Inspected { args, logs };
    if inspected.args.out.is_some() {
        inspected.refuse_different_mappings()?;
    }
    Ok(inspected)
}

impl Inspected {
    /// Returns the mapping of the logs; `None` if they need none.
    pub(crate) fn mapping(&self) -> Option<&str> {
        let mut mappings = self
            .logs
            .iter()
            .filter_map(|(_, log)| log.mapping.as_deref());
        mappings.next()
    }

    pub(crate) fn answer(&self) -> Answer {
        let logs = || self.logs.iter().map(|(_, log)| log);
        if logs().any(|log| !log.open.is_empty()) {
            return Answer::Open;
        }
        Answer::of(logs().all(Inspection::is_ready))
    }

    /// Refuses to write one mapping for logs that need different ones.
    fn refuse_different_mappings(&self) -> Result<(), Failure> {
        let parsed =
            |text: &str| Mapping::parse_with_reference("", text, self.args.import.reference()).ok();
        let mut first: Option<(&Path, Option<Mapping>)> = None;
        for (path, log) in &self.logs {
            let mapping = log.mapping.as_deref().and_then(parsed);
            match &first {
                None => first = Some((path, mapping)),
                Some((_, same)) if *same == mapping => {}
                Some((other, _)) => {
                    return Err(Failure::DifferentMappings {
                        one: other.to_path_buf(),
                        other: path.clone(),
                    });
                }
            }
        }
        Ok(())
    }
}
