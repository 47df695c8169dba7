//! Text of an inspection.

use std::path::Path;

use recording::csv::Excerpt;
use recording::{InspectedColumn, Inspection, LogError};

use super::number::{or_dash, significant};
use super::table::{Align, Table, painted};
use super::{Colour, Terminal, indented, paragraph, title};
use crate::cli::{SKIPPED_MAX, reference_name};
use crate::input::is_standard_input;
use crate::run::inspect::Inspected;
use crate::shell::quoted;

/// Maximum number of columns that are listed one by one.
const LISTED_MAX: usize = 400;

/// Returns the text of the inspection of every log.
pub(super) fn inspection(inspected: &Inspected, terminal: &Terminal) -> String {
    let logs = inspected.logs.iter();
    let parts = logs.map(|(path, log)| one(inspected, path, log, terminal));
    parts.collect::<Vec<_>>().join("\n")
}

fn one(inspected: &Inspected, path: &Path, log: &Inspection, terminal: &Terminal) -> String {
    let duration = log.duration_s.map_or_else(String::new, |duration_s| {
        format!(", {} s", significant(duration_s, 5))
    });
    let head = format!(
        "{}: {}; {} rows{duration}",
        Excerpt::of(&log.source).as_str(),
        log.layout,
        log.rows
    );
    let mut text = title(&head, terminal);
    text += &table(log, terminal);
    text.push('\n');
    let mut part = |name: &str, lines: &[String]| {
        if !lines.is_empty() {
            text += &title(name, terminal);
            for line in lines {
                text += &indented(line, 2, terminal);
            }
        }
    };
    if !log.found.is_empty() {
        part("Found", &[log.found.join(", ")]);
    }
    part("Missing", &missing(log));
    let open = log.open.iter();
    let open: Vec<String> = open
        .map(|one| format!("{}. Answer: {}", one.question, one.answer))
        .collect();
    part("Open", &open);
    part("Assumed, to be checked", &log.assumed);
    part("Not read", &log.remarks);
    let result = match &log.trial {
        Ok(trial) => {
            let mut lines = vec![format!("signals {}", trial.signals.join(", "))];
            lines.extend(trial.defects.iter().cloned());
            lines
        }
        Err(error) => vec![format!("fails: {error}")],
    };
    part(
        if log.mapping.is_some() {
            "Read with the mapping"
        } else {
            "Read as it is"
        },
        &result,
    );
    match &log.mapping {
        None if log.trial.is_ok() => text += &paragraph("The file needs no mapping.", terminal),
        None => {}
        Some(_) if inspected.args.out.is_some() => {}
        Some(mapping) => {
            text += &title("Mapping", terminal);
            text += mapping;
        }
    }
    let next = next(inspected, path, log);
    if !next.is_empty() {
        text += "\n";
        text += &title("Next:", terminal);
        text += &next;
    }
    text
}

fn table(log: &Inspection, terminal: &Terminal) -> String {
    let mut table = Table::new(
        [
            ("column", Align::Left),
            ("rate", Align::Right),
            ("missing", Align::Right),
            ("least", Align::Right),
            ("greatest", Align::Right),
            ("signal", Align::Left),
            ("unit", Align::Left),
            ("reason", Align::Left),
        ],
        terminal,
    );
    for column in log.columns.iter().take(LISTED_MAX) {
        let is_empty = column.values.count == 0;
        let number = |value: f64| match is_empty {
            true => "-".to_owned(),
            false => significant(value, 5),
        };
        let signal = match &column.signal {
            Some(signal) => painted(Colour::Good, Excerpt::of(signal).as_str()),
            None => painted(Colour::Faint, "-"),
        };
        table.row([
            shown(column).into(),
            or_dash(column.rate_hz, rate).into(),
            missing_cells(column).into(),
            number(column.values.least).into(),
            number(column.values.greatest).into(),
            signal,
            column.unit.clone().unwrap_or_default().into(),
            column.reason.clone().into(),
        ]);
    }
    let left_out = log.columns.len().saturating_sub(LISTED_MAX);
    if left_out > 0 {
        table.remark(&format!("and {left_out} more"));
    }
    table.to_string()
}

fn shown(column: &InspectedColumn) -> String {
    let key = Excerpt::of(&column.key);
    match column.unit_in_file.is_empty() {
        true => key.as_str().to_owned(),
        false => format!(
            "{} [{}]",
            key.as_str(),
            Excerpt::of(&column.unit_in_file).as_str()
        ),
    }
}

fn rate(rate_hz: f64) -> String {
    match rate_hz {
        10e3.. => format!("{} kHz", significant(rate_hz / 1e3, 3)),
        _ => format!("{} Hz", significant(rate_hz, 3)),
    }
}

/// Returns the number of cells without a number; those of a slower signal are not missing.
fn missing_cells(column: &InspectedColumn) -> String {
    match column.values.has_own_rate() {
        true => "slower".to_owned(),
        false => column.values.missing.to_string(),
    }
}

fn missing(log: &Inspection) -> Vec<String> {
    let line = |signal: &&str| match *signal {
        "p_ch" => {
            "p_ch, the chamber pressure: a comparison then needs another signal, such as i_fill"
                .to_owned()
        }
        signal => format!(
            "{signal}, the command of a valve: state [constant.{signal}] in the mapping if it stayed as it was; a plant without this valve does not need it"
        ),
    };
    log.missing.iter().map(line).collect()
}

/// Returns the next commands.
fn next(inspected: &Inspected, path: &Path, log: &Inspection) -> String {
    let args = &inspected.args;
    let file = quoted(&path.display().to_string());
    let given = args.import.pressure();
    let pressure = given.map_or_else(String::new, |word| format!(" --pressure {word}"));
    let mapping = args
        .import
        .mapping
        .as_ref()
        .map_or_else(String::new, |path| {
            format!(" --mapping {}", quoted(&path.display().to_string()))
        });
    let stem = match is_standard_input(path) {
        true => "log".into(),
        false => path
            .file_stem()
            .unwrap_or(path.as_os_str())
            .to_string_lossy(),
    };
    let out = args.out.as_ref().map_or_else(
        || format!("{stem}-columns.toml"),
        |out| out.display().to_string(),
    );
    let out = quoted(&out);
    let skip = match args.import.skip_bad_rows {
        0 => String::new(),
        count => format!(" --skip-bad-rows {count}"),
    };
    let mut open = log.open.iter();
    if given.is_none() && open.any(|one| one.answer.starts_with("--pressure")) {
        let words = match log.suggested {
            Some(reference) => vec![reference_name(reference)],
            None => vec!["gauge", "absolute"],
        };
        let commands = words.iter().map(|word| match &log.mapping {
            Some(_) => {
                format!("  retarder inspect {file}{mapping} --pressure {word}{skip} --out {out}\n")
            }
            None => format!("  retarder compare {file}{mapping} --pressure {word}{skip}\n"),
        });
        return commands.collect();
    }
    if let Err(error) = &log.trial {
        let is_of_row = matches!(error, LogError::Csv(error) if error.is_of_row());
        let bad = log.bad_rows;
        return match is_of_row && args.import.skip_bad_rows < bad && bad <= SKIPPED_MAX {
            true => {
                format!("  retarder inspect {file}{mapping}{pressure} --skip-bad-rows {bad}\n")
            }
            false => String::new(),
        };
    }
    match (&log.mapping, &args.out) {
        (None, _) => {
            let pressure = if log.needs_reference { &*pressure } else { "" };
            format!("  retarder compare {file}{mapping}{pressure}{skip}\n")
        }
        (Some(_), Some(_)) => format!("  retarder compare {file} --mapping {out}{skip}\n"),
        (Some(_), None) => format!(
            "  retarder inspect {file}{mapping}{pressure}{skip} --out {out}\n  retarder compare {file} --mapping {out}{skip}\n"
        ),
    }
}
