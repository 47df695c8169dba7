//! Output of results: files, standard output, exit status.

use std::io::{self, Write};
use std::path::Path;
use std::process::{self, ExitCode};

use recording::csv::{Decimals, WriteError};
use recording::{InspectedLogs, LogFormat, Recording, table};

use crate::failure::Failure;
use crate::page;
use crate::print::{self, Terminal};
use crate::run::{Answer, Outcome};
use crate::targets::{Existing, Targets, is_standard_output};

/// Exit status of a command that failed.
const FAILED: u8 = 2;
/// Start of the line, emptied.
const CLEARED_LINE: &str = "\r\x1b[2K";

/// Writes the requested files and prints the rest. The answer decides the exit status.
pub(crate) fn deliver((outcome, mut targets): (Outcome, Targets)) -> Result<Answer, Failure> {
    // Whether another output than the text uses the standard output.
    let mut is_taken = false;
    let existing = targets.existing;
    if let (Some(path), Outcome::Control(controlled)) = (&targets.recording, &outcome) {
        is_taken = is_standard_output(path);
        write_recording(path, existing, &controlled.run.recording)?;
    }
    if let (Some(path), Some(csv)) = (&targets.recording, csv(&outcome)) {
        is_taken |= write(path, existing, &csv)?;
    }
    if let (Some(path), Outcome::Refinement(refined)) = (&targets.plant, &outcome) {
        is_taken |= write(path, existing, &refined.refined.plant.to_toml())?;
    }
    if let (Some(path), Outcome::Estimation(estimated)) = (&targets.plant, &outcome) {
        is_taken |= write(path, existing, &estimated.estimated.plant.to_toml())?;
    }
    if let (Some(path), Outcome::Diagnosis(diagnosed)) = (&targets.plant, &outcome) {
        match diagnosed.with_missing_flow() {
            Some(with) => is_taken |= write(path, existing, &with.plant.to_toml())?,
            None => {
                let note = format!(
                    "no missing flow that depends on the chamber pressure remains, so {} is not written",
                    path.display()
                );
                let note = print::note(&note, &Terminal::standard_error());
                let _ = anstream::stderr().write_all(note.as_bytes());
                targets.plant = None;
            }
        }
    }
    if let (Some(path), Outcome::Inspection(inspected)) = (&targets.mapping, &outcome)
        && let Some(mapping) = inspected.mapping()
    {
        is_taken |= write(path, existing, mapping)?;
    }
    if let (Some(path), Outcome::Tuned(tuned)) = (&targets.controller, &outcome) {
        is_taken |= write(path, existing, &tuned.text)?;
    }
    if let Some(path) = &targets.html
        && let Some(html) = page::html(&outcome)
    {
        is_taken |= write(path, existing, &html)?;
    }
    if let Some(path) = &targets.json
        && let Some(json) = json(&outcome)
    {
        is_taken |= write(path, existing, &json)?;
    }
    if let Outcome::Measurement(measurement) = &outcome
        && (is_taken || targets.recording.is_none())
        && outcome.answer() != Answer::Holds
    {
        let text = print::measured(measurement, &Terminal::standard_error());
        let _ = anstream::stderr().write_all(text.as_bytes());
    }
    match &outcome {
        // The standard output may carry the recording.
        Outcome::Simulation(simulation) => {
            let text = print::simulation(simulation, &Terminal::standard_error());
            // A closed standard error is not a failure.
            let _ = anstream::stderr().write_all(text.as_bytes());
        }
        _ if is_taken => {}
        // The standard output has the controller file.
        Outcome::Tuned(tuned) if targets.controller.is_none() => {
            let text = print::tuning(tuned, &Terminal::standard_error());
            let _ = anstream::stderr().write_all(text.as_bytes());
            write_standard_output(&tuned.text)?;
        }
        _ => write_standard_output(&print::outcome(
            &outcome,
            &targets,
            &Terminal::standard_output(),
        ))?,
    }
    Ok(outcome.answer())
}

/// Returns the exit status, and prints a failure to the standard error.
pub(crate) fn exit_code(ended: Result<Answer, Failure>) -> ExitCode {
    match ended {
        Ok(Answer::Holds) => ExitCode::SUCCESS,
        Ok(Answer::DoesNotHold) => ExitCode::from(1),
        Ok(Answer::Open) => ExitCode::from(2),
        Ok(Answer::PlantFileWrong) => ExitCode::from(3),
        Err(failure) if failure.is_broken_pipe() => ExitCode::SUCCESS,
        Err(failure) => {
            say(&failure);
            ExitCode::from(FAILED)
        }
    }
}

/// Ends the process with a failure.
pub(crate) fn exit(failure: &Failure) -> ! {
    let mut stderr = anstream::stderr();
    if stderr.is_terminal() {
        // A progress bar may be there.
        let _ = stderr.write_all(CLEARED_LINE.as_bytes());
    }
    say(failure);
    process::exit(FAILED.into())
}

fn say(failure: &Failure) {
    let text = print::failure(failure, &Terminal::standard_error());
    let _ = anstream::stderr().write_all(text.as_bytes());
}

/// Returns the data that a device recorded or measured, as CSV.
fn csv(outcome: &Outcome) -> Option<String> {
    match outcome {
        Outcome::BlackBox(black_box) => Some(black_box.csv()),
        Outcome::Measurement(measurement) => Some(measurement.csv.clone()),
        Outcome::NextExperiment(planned) => Some(planned.next.csv()),
        Outcome::DeterminingExperiment(planned) => Some(planned.next.csv()),
        _ => None,
    }
}

fn json(outcome: &Outcome) -> Option<String> {
    let json = match outcome {
        Outcome::Simulation(simulation) => serde_json::to_string_pretty(simulation),
        Outcome::Comparison(compared) => serde_json::to_string_pretty(&compared.comparison),
        Outcome::Diagnosis(diagnosed) => serde_json::to_string_pretty(&diagnosed.diagnosis),
        Outcome::Estimation(estimated) => {
            serde_json::to_string_pretty(&estimated.estimated.estimation)
        }
        Outcome::Refinement(refined) => serde_json::to_string_pretty(&refined.refined.refinement),
        Outcome::NextExperiment(planned) => serde_json::to_string_pretty(&planned.next),
        Outcome::DeterminingExperiment(planned) => serde_json::to_string_pretty(&planned.next),
        Outcome::Control(controlled) => match &controlled.device {
            Some(report) => serde_json::to_string_pretty(&controlled.on_device(report)),
            None if controlled.rigs.is_empty() => serde_json::to_string_pretty(&controlled.verdict),
            None => serde_json::to_string_pretty(&controlled.rigs()),
        },
        Outcome::RigTable(table) => serde_json::to_string_pretty(&table.summary()),
        Outcome::BlackBox(black_box) => serde_json::to_string_pretty(black_box),
        Outcome::Inspection(inspected) => {
            let logs = inspected.logs.iter().map(|(_, log)| log);
            serde_json::to_string_pretty(&InspectedLogs::of(logs))
        }
        Outcome::Thesis(figures) => serde_json::to_string_pretty(&figures.table),
        Outcome::ThesisExplanation(explained) => {
            serde_json::to_string_pretty(&explained.explanation)
        }
        Outcome::Demo(_)
        | Outcome::Report(_)
        | Outcome::Parameters(_)
        | Outcome::Settings(_)
        | Outcome::Tuned(_)
        | Outcome::DeviceSettings(_)
        | Outcome::DeviceSignals
        | Outcome::Measurement(_)
        | Outcome::Text(_) => return None,
    };
    // Results are structs of numbers and texts; they have no maps with keys that JSON cannot express.
    let mut json = json.expect("results have a JSON form");
    json.push('\n');
    Some(json)
}

fn write_recording(path: &Path, existing: Existing, recording: &Recording) -> Result<(), Failure> {
    let Some((time_base, _)) = recording.time_bases().next() else {
        return Ok(());
    };
    let written = if is_standard_output(path) {
        recording::csv::write(
            io::stdout().lock(),
            recording,
            time_base,
            &Decimals::shortest(),
        )
        .map(drop)
    } else {
        let file = existing.begin(path).map_err(WriteError::Io);
        let written = file.and_then(|file| match LogFormat::of_name(path) {
            LogFormat::Csv => {
                recording::csv::write(file, recording, time_base, &Decimals::shortest())
            }
            LogFormat::Mf4 => recording::mf4::write(file, recording),
            LogFormat::Parquet => table::write_parquet(file, recording, time_base),
            LogFormat::Matlab => table::write_matlab(file, recording, time_base),
            LogFormat::MatlabHdf5 => table::write_matlab_hdf5(file, recording, time_base),
        });
        written.and_then(|file| Ok(file.commit()?))
    };
    written
        .map_err(|error| Failure::write(Some(path).filter(|path| !is_standard_output(path)), error))
}

/// Writes to the file or to the standard output; returns whether it was the standard output.
fn write(path: &Path, existing: Existing, text: &str) -> Result<bool, Failure> {
    if is_standard_output(path) {
        write_standard_output(text)?;
        return Ok(true);
    }
    let written = existing.begin(path).and_then(|mut file| {
        file.write_all(text.as_bytes())?;
        file.commit()
    });
    written.map_err(|error| Failure::write(Some(path), error))?;
    Ok(false)
}

/// Writes to the standard output; a closed pipe changes neither the answer nor the exit status.
fn write_standard_output(text: &str) -> Result<(), Failure> {
    let mut out = anstream::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => Err(Failure::write(None, error)),
        _ => Ok(()),
    }
}
