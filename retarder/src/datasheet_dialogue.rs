//! Dialogue that asks for what a datasheet file lacks, and adds the answers to the file.

use std::io::{self, BufRead, Write};
use std::path::Path;

use plant_sim::parameters::Problem;
use plant_sim::{ParameterError, PlantParameters};
use recording::write_file_atomically;

use crate::failure::Failure;
use crate::input::read_text;

/// First line of a file that the dialogue begins.
const TITLE: &str = "# What is known of this rig from data sheets and a tape measure. Each line says how certain it is.\n";
const INTRODUCTION: &str = "\
Each answer is a number in the unit of its name and how certain it is, such as: 419 ±15 %, tape measure
Where another value is known, answer with its line, such as: coil_power_w = 7
Each answer is written at once; Ctrl-C ends, and the same command goes on from there.
";
/// Kinds that the dialogue explains; a datasheet file may state others.
const KINDS: &str = "
  normally_closed  a coil opens it          normally_open  a coil shuts it
  on_off           known by its flow and its switching times, not by its coil
  proportional     its opening follows a command
  always_open      an orifice               absent         none
";

/// Asks on `output` for each value that the datasheet file `path` lacks, and adds the answers from `input` to it. A file that does not
/// exist is created.
///
/// # Errors
/// Returns an error if the file cannot be read or written, has a line that is wrong, or the answers end too early.
pub(crate) fn complete(
    path: &Path,
    input: &mut impl BufRead,
    output: &mut impl Write,
) -> Result<(), Failure> {
    let mut dialogue = Dialogue {
        path,
        input,
        output,
    };
    dialogue.say(INTRODUCTION)?;
    let mut text = if path.exists() {
        read_text(path)?
    } else {
        dialogue.begin()?
    };
    let name = path.display().to_string();
    // The reader of the file reports a line that is wrong.
    while let Err(error) = PlantParameters::from_datasheet(&text, &name)
        && let Some(question) = Question::first(error.problems())
    {
        text = dialogue.answered(&question, text)?;
    }
    Ok(())
}

/// Value that a file lacks.
struct Question {
    key: &'static str,
    words: String,
}

impl Question {
    /// Returns the question for the first of `problems`; none where one of them is no missing value.
    fn first(problems: &[Problem]) -> Option<Self> {
        let is_missing = |problem: &Problem| matches!(problem, Problem::MissingValue { .. });
        match problems
            .first()
            .filter(|_| problems.iter().all(is_missing))?
        {
            Problem::MissingValue {
                key,
                range: (least, most),
                about,
                instead,
            } => {
                let instead = instead.map_or(String::new(), |keys| format!("\n  or {keys}"));
                Some(Self {
                    key,
                    words: format!("\n{about}, from {least} to {most}{instead}\n{key} = "),
                })
            }
            _ => None,
        }
    }
}

struct Dialogue<'a, I, O> {
    path: &'a Path,
    input: &'a mut I,
    output: &'a mut O,
}

impl<I: BufRead, O: Write> Dialogue<'_, I, O> {
    /// Asks for the kinds of the valves; returns the first lines of the file.
    fn begin(&mut self) -> Result<String, Failure> {
        self.say(KINDS)?;
        let mut text = TITLE.to_owned();
        for key in ["fill_valve", "vent_valve"] {
            let kind = self.ask(&format!("{key} [normally_closed] = "))?;
            let kind = match kind.as_str() {
                "" => "normally_closed",
                kind => kind,
            };
            text += &format!("{key} = \"{}\"\n", kind.trim_matches('"'));
        }
        self.keep(&text)?;
        Ok(text)
    }

    /// Asks until an answer can be read; returns `text` with it.
    fn answered(&mut self, question: &Question, text: String) -> Result<String, Failure> {
        loop {
            let answer = self.ask(&question.words)?;
            if answer.is_empty() {
                continue;
            }
            let line = line(question.key, &answer);
            if let Some(problem) = no_number(&line) {
                self.say(&format!("  {problem}\n"))?;
                continue;
            }
            let candidate = format!("{text}{line}\n");
            let name = self.path.display().to_string();
            let problems = match PlantParameters::from_datasheet(&candidate, &name) {
                Ok(_) => Vec::new(),
                Err(error) => mistakes(&error),
            };
            if problems.is_empty() {
                self.keep(&candidate)?;
                return Ok(candidate);
            }
            self.say(&format!("  {}\n", problems.join("\n  ")))?;
        }
    }

    /// Writes `prompt` and returns the next line without its blanks.
    fn ask(&mut self, prompt: &str) -> Result<String, Failure> {
        self.say(prompt)?;
        let mut line = String::new();
        let read = self
            .input
            .read_line(&mut line)
            .map_err(|error| self.unread(error))?;
        if read == 0 {
            return Err(Failure::AnswersEnded {
                path: self.path.to_owned(),
            });
        }
        Ok(line.trim().to_owned())
    }

    fn say(&mut self, words: &str) -> Result<(), Failure> {
        let said = self.output.write_all(words.as_bytes());
        said.and_then(|()| self.output.flush())
            .map_err(|error| self.unread(error))
    }

    fn unread(&self, error: io::Error) -> Failure {
        Failure::Read {
            path: self.path.to_owned(),
            error,
        }
    }

    fn keep(&self, text: &str) -> Result<(), Failure> {
        write_file_atomically(self.path, |file| file.write_all(text.as_bytes()))
            .map_err(|error: io::Error| Failure::write(Some(self.path), error))
    }
}

/// Returns the line of a datasheet file for an answer: the number, and behind it as a comment how certain it is.
fn line(key: &str, answer: &str) -> String {
    if answer.contains('=') {
        return answer.to_owned();
    }
    let end = answer.find([' ', '±']).unwrap_or(answer.len());
    let (number, certainty) = answer.split_at(end);
    let number = number.trim_end_matches(',');
    match certainty.trim_start_matches([' ', '#', ',']) {
        "" => format!("{key} = {number}"),
        certainty => format!("{key} = {number}  # {certainty}"),
    }
}

/// Returns what is wrong with the value of a line that is no number.
fn no_number(line: &str) -> Option<String> {
    let (_, value) = line.split_once('=')?;
    let value = value.split('#').next().unwrap_or(value).trim();
    let is_table = value.starts_with(['{', '"']);
    (!is_table && value.parse::<f64>().is_err())
        .then(|| format!("`{value}` is no number; write it with a decimal point, such as 8.4"))
}

/// Returns the problems that an answer caused.
fn mistakes(error: &ParameterError) -> Vec<String> {
    let problems = error.problems().iter();
    let mistakes = problems.filter(|problem| !matches!(problem, Problem::MissingValue { .. }));
    mistakes.map(ToString::to_string).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn dialogue(path: &Path, answers: &str) -> (Result<(), Failure>, String) {
        let mut said = Vec::new();
        let done = complete(path, &mut answers.as_bytes(), &mut said);
        (done, String::from_utf8(said).unwrap())
    }

    #[test]
    fn answers_make_a_datasheet_file_that_is_a_plant() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my-rig.toml");
        let answers = "\n\n8.4 ±0.3\n100 exact\n15\n24, multimeter\n80 ±15 %, tape measure\n1.9\n1.9\n\
            coil_power_w = 7\nfill_valve_opens_at_ma = 206\n";
        let (done, said) = dialogue(&path, answers);
        done.unwrap_or_else(|failure| panic!("{failure}\n{said}"));
        let text = fs::read_to_string(&path).unwrap();
        assert!(
            text.contains("fill_valve = \"normally_closed\"\n"),
            "{text}"
        );
        assert!(
            text.contains("chamber_volume_cm3 = 80  # ±15 %, tape measure\n"),
            "{text}"
        );
        let plant = PlantParameters::from_datasheet(&text, "my-rig.toml").unwrap();
        assert_eq!(plant.chamber.volume_m3, 80e-6);
        // There is nothing left to ask.
        let (done, said) = dialogue(&path, "");
        done.unwrap();
        assert_eq!(said, INTRODUCTION);
    }

    #[test]
    fn a_wrong_answer_is_asked_again_and_what_was_answered_is_kept() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("my-rig.toml");
        let (done, said) = dialogue(&path, "on_off\nabsent\n8,4\n8.4\n5e9\n50\n");
        let failure = done.unwrap_err().to_string();
        assert!(
            failure.contains("the answers ended before all questions"),
            "{failure}"
        );
        for problem in [
            "`8,4` is no number; write it with a decimal point",
            "`command_frequency_hz` = 5e9 is out of range",
        ] {
            assert!(said.contains(problem), "{problem} in {said}");
        }
        let text = fs::read_to_string(&path).unwrap();
        assert!(
            text.ends_with("supply_pressure_bar_gauge = 8.4\ncommand_frequency_hz = 50\n"),
            "{text}"
        );
        let (_, said) = dialogue(&path, "");
        assert!(!said.contains("command_frequency_hz = "), "{said}");
    }
}
