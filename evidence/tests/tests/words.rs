//! Vocabulary of the project: words that were replaced by standard ones do not come back.

use std::fs;
use std::path::{Path, PathBuf};

use retarder_tests::bench_log::repository;

/// Replaced words, each with the word to use instead. A word that also has a proper use is not listed.
const REPLACED: &[(&str, &str)] = &[
    ("course", "trace or time series"),
    ("courses", "traces or time series"),
    ("Course", "Trace"),
    ("manoeuvre", "excitation or test signal"),
    ("manoeuvres", "excitations or test signals"),
    ("hold the model against", "compare the model with"),
    ("holds against", "is within tolerance of"),
    (
        "Model against measurement",
        "Model compared with measurement",
    ),
    ("mouse and eyes", "in the browser"),
    ("on this machine alone", "on localhost only"),
    ("the house", "architecture"),
    ("the tour", "the demo"),
    ("promise", "requirement, or property of a reader"),
    ("promises", "requirements, or properties of a reader"),
    ("short horizon", "one-step-ahead prediction"),
    ("ShortHorizon", "OneStepAhead"),
    ("SHORT_HORIZON", "ONE_STEP_AHEAD"),
    ("steady error", "steady-state error"),
    ("dead band", "deadband (controller) or dead zone (valve)"),
    ("free-wheel diode", "freewheeling diode"),
    ("free-wheeling", "freewheeling"),
    ("motional voltage", "back-EMF (motional)"),
    ("extinct", "decayed to zero"),
    ("departing", "breaking away"),
    ("upside", "upstream"),
    ("downside", "downstream"),
    ("given up", "aborted"),
    ("not weighed", "excluded from the fit"),
    ("is_weighed", "is_fitted_signal"),
    ("WEIGHED", "FITTED_SIGNALS"),
    ("NothingToWeigh", "NothingToFit"),
    ("would have shown", "detection limit"),
    ("ladder", "forward selection or error steps"),
    ("climb", "forward_selection"),
    ("what remains", "unexplained residual"),
    ("rigs that differ", "robustness (Monte Carlo)"),
    ("periods on top of each other", "fold by PWM period"),
    ("Told", "Command or NoiseEstimate"),
    ("ToldClock", "CommandClock"),
    ("TOLD_MAX", "LISTED_MAX"),
    ("tells_apart", "distinguishes"),
    ("mutilate", "seed a fault"),
    ("Farewell", "ResetReason"),
    ("GoesOn", "Continue"),
    ("unasked", "unsolicited"),
    ("no_reading_ahead", "reload_barrier"),
    ("Shelf", "Cache"),
    ("Strictness", "AcceptanceLimits"),
    ("Wish", "Query"),
    ("wished", "requested"),
    ("STIFF", "a name that says what it limits"),
    ("besides", "also"),
    ("So many", "Number of"),
];

/// Extensions of the searched files.
const SEARCHED: [&str; 5] = ["rs", "md", "js", "html", "toml"];

/// This file, which lists the words.
const THIS_FILE: &str = "evidence/tests/tests/words.rs";

#[test]
fn no_replaced_word_comes_back() {
    let root = repository();
    let mut paths = Vec::new();
    collect(&root, &mut paths);
    assert!(paths.len() > 500, "the files were found: {paths:?}");
    paths.sort();
    let mut found = Vec::new();
    for path in paths {
        let place = path.strip_prefix(&root).unwrap();
        if place == Path::new(THIS_FILE) {
            continue;
        }
        // Some files of the corpora are not UTF-8 on purpose.
        let bytes = fs::read(&path).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        for (number, line) in (1..).zip(text.lines()) {
            for (word, replacement) in REPLACED {
                if has_word(line, word) {
                    let place = place.display();
                    found.push(format!("{place}:{number}: \"{word}\": use {replacement}"));
                }
            }
        }
    }
    assert!(found.is_empty(), "\n{}", found.join("\n"));
}

/// Commands, tables, pictures and headings have the length that they need.
#[test]
fn lines_of_markdown_text_have_at_most_120_columns() {
    let root = repository();
    let mut paths = Vec::new();
    collect(&root, &mut paths);
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "md"));
    assert!(paths.len() > 20, "the documents were found: {paths:?}");
    let long = paths.iter().flat_map(|path| {
        let text = fs::read_to_string(path).expect("a text file of the repository");
        let lines = long_lines(&text);
        let place = path
            .strip_prefix(&root)
            .unwrap_or(path)
            .display()
            .to_string();
        lines.into_iter().map(move |line| format!("{place}:{line}"))
    });
    let long: Vec<String> = long.collect();
    assert!(long.is_empty(), "wrap these lines:\n{}", long.join("\n"));
}

/// Returns the numbers of the lines of text with more than 120 characters. A link is not broken.
fn long_lines(text: &str) -> Vec<usize> {
    let mut is_code = false;
    let mut long = Vec::new();
    for (number, line) in (1..).zip(text.lines()) {
        let begin = line.trim_start();
        is_code ^= begin.starts_with("```");
        let is_text = !is_code && !begin.starts_with(['|', '!', '#', '<']);
        if is_text && line.chars().count() > 120 && !line.contains("](") {
            long.push(number);
        }
    }
    long
}

#[test]
fn a_long_line_is_found_in_text_and_not_in_code_or_a_table() {
    let word = "valve ".repeat(21);
    let text = format!("{word}\n```sh\n{word}\n```\n| {word}|\nshort\n- {word}\n");
    assert_eq!(long_lines(&text), [1, 7]);
}

#[test]
fn only_whole_words_are_found_and_their_case_counts() {
    assert!(has_word("the course of p_ch", "course"));
    assert!(has_word("(`Told`)", "Told"));
    assert!(has_word("a courseless course", "course"));
    for other in ["courses", "recourse", "of_course", "course2", "Course"] {
        assert!(!has_word(other, "course"), "{other}");
    }
}

/// Collects the searched files. Measurements in `data/`, builds and hidden folders are not searched.
fn collect(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let (name, path) = (entry.file_name(), entry.path());
        let extension = path.extension().unwrap_or_default();
        if path.is_dir() {
            let name = name.to_string_lossy();
            if !name.starts_with('.') && name != "data" && name != "target" {
                collect(&path, paths);
            }
        } else if SEARCHED.iter().any(|searched| extension == *searched) {
            paths.push(path);
        }
    }
}

/// Returns whether `line` contains `word` with no letter, digit or underscore beside it.
fn has_word(line: &str, word: &str) -> bool {
    let is_part = |character: char| character.is_alphanumeric() || character == '_';
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        !before.is_some_and(is_part) && !after.is_some_and(is_part)
    })
}
