//! Conversion of the mapping form into the TOML mapping of the reader.

use std::fmt::Write as _;

use serde::Deserialize;

use crate::refusal::Refusal;

/// Mapping sent by the page.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Form {
    /// Mapping as TOML, for options that the form lacks; it replaces all other fields.
    toml: Option<String>,
    #[serde(default)]
    columns: Vec<Column>,
    /// Lines before the header.
    #[serde(default)]
    skip_lines: u32,
    /// Whether the first line names the columns; with `None`, the reader decides.
    header: Option<bool>,
    /// Delimiter: `comma`, `semicolon` or `tab`.
    delimiter: Option<Word>,
    /// Decimal mark: `.` or `,`.
    decimal: Option<Word>,
    /// Whether a row of units follows the header.
    units_row: Option<bool>,
    /// Spellings of missing samples.
    #[serde(default)]
    missing: Vec<Word>,
}

/// Mapping of one column. A column without an entry is read according to its header.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Column {
    column: Key,
    role: Role,
    #[serde(default)]
    name: String,
    #[serde(default)]
    unit: String,
    /// Value = logged number * scale + offset.
    scale: Option<f64>,
    offset: Option<f64>,
    thousands_separator: Option<Word>,
    /// Range outside which values count as missing.
    plausible: Option<[f64; 2]>,
    /// Range to which values are limited.
    clip: Option<[f64; 2]>,
}

/// Identification of a column.
#[derive(Debug, Deserialize)]
#[serde(untagged)]
enum Key {
    /// Position in a CSV file, from 1.
    Number(u32),
    /// Name of a channel.
    Name(String),
}

impl Key {
    fn toml(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Name(name) => quoted(name),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Role {
    Time,
    Signal,
    Ignore,
}

/// Word that the reader of mappings checks.
type Word = String;

impl Form {
    /// Returns the mapping as TOML; `None` if the form is empty, so that the log is read without a mapping.
    ///
    /// # Errors
    /// Returns an error for a number that TOML cannot express.
    pub(crate) fn toml(&self) -> Result<Option<String>, Refusal> {
        if let Some(toml) = &self.toml {
            return Ok(Some(toml.clone()).filter(|toml| !toml.trim().is_empty()));
        }
        let mut toml = String::from("schema = 1\n");
        let of_role = |role| {
            self.columns
                .iter()
                .filter(move |column| column.role == role)
        };
        let ignored: Vec<String> = of_role(Role::Ignore)
            .map(|column| column.column.toml())
            .collect();
        if !ignored.is_empty() {
            let _ = writeln!(toml, "ignore = [{}]", ignored.join(", "));
        }
        if !self.missing.is_empty() {
            let words: Vec<String> = self.missing.iter().map(|word| quoted(word)).collect();
            let _ = writeln!(toml, "missing = [{}]", words.join(", "));
        }
        toml += &self.dialect();
        for column in of_role(Role::Time) {
            toml += "\n[time]\n";
            toml += &column.lines()?;
        }
        for column in of_role(Role::Signal) {
            let _ = write!(toml, "\n[signal.{}]\n", quoted(&column.name));
            toml += &column.lines()?;
        }
        Ok((toml != "schema = 1\n").then_some(toml))
    }

    fn dialect(&self) -> String {
        let mut lines = String::new();
        if self.skip_lines > 0 {
            let _ = writeln!(lines, "skip_lines = {}", self.skip_lines);
        }
        for (key, value) in [("header", self.header), ("units_row", self.units_row)] {
            if let Some(value) = value {
                let _ = writeln!(lines, "{key} = {value}");
            }
        }
        for (key, word) in [("delimiter", &self.delimiter), ("decimal", &self.decimal)] {
            if let Some(word) = word {
                let _ = writeln!(lines, "{key} = {}", quoted(word));
            }
        }
        if lines.is_empty() {
            lines
        } else {
            format!("\n[dialect]\n{lines}")
        }
    }
}

impl Column {
    fn lines(&self) -> Result<String, Refusal> {
        let column = self.column.toml();
        let mut lines = format!("column = {column}\nunit = {}\n", quoted(&self.unit));
        for (key, value) in [("scale", self.scale), ("offset", self.offset)] {
            if let Some(value) = value {
                if !value.is_finite() {
                    return Err(Refusal::value(format!(
                        "the {key} of column {column} is not a finite number; correct it"
                    )));
                }
                let _ = writeln!(lines, "{key} = {value:?}");
            }
        }
        if let Some(separator) = &self.thousands_separator {
            let _ = writeln!(lines, "thousands_separator = {}", quoted(separator));
        }
        for (key, range) in [("plausible", self.plausible), ("clip", self.clip)] {
            if let Some([least, greatest]) = range {
                // The reader of mappings refuses numbers that are not finite, with the line.
                let _ = writeln!(lines, "{key} = [{least:?}, {greatest:?}]");
            }
        }
        Ok(lines)
    }
}

/// Returns a TOML string.
fn quoted(text: &str) -> String {
    let mut quoted = String::from("\"");
    for character in text.chars() {
        match character {
            '"' | '\\' => {
                quoted.push('\\');
                quoted.push(character);
            }
            _ if character.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", character as u32);
            }
            _ => quoted.push(character),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    use recording::csv::{Mapping, Options, read};
    use serde_json::json;

    use super::*;

    fn form(json: serde_json::Value) -> Form {
        serde_json::from_value(json).unwrap()
    }

    #[test]
    fn a_form_reads_a_log_that_does_not_explain_itself() {
        let form = form(json!({
            "columns": [
                {"column": 1, "role": "time", "unit": "us", "thousands_separator": "."},
                {"column": 2, "role": "signal", "name": "p_ch", "unit": "bar_gauge", "scale": 0.5, "offset": -0.25},
                {"column": 3, "role": "ignore"},
            ],
            "delimiter": "semicolon",
            "header": false,
        }));
        let toml = form.toml().unwrap().unwrap();
        let mapping =
            Mapping::parse("mapping", &toml).unwrap_or_else(|error| panic!("{error}\n{toml}"));
        let log = "999.000;0.5;x\n1.000.000;2.5;y\n";
        let options = Options {
            mapping,
            ..Options::default()
        };
        let recording = read("wild.csv", log.as_bytes(), &options).unwrap();
        assert_eq!(
            recording.signal("p_ch").unwrap().values_or_nan(),
            [0.0, 1.0]
        );
    }

    #[test]
    fn a_name_cannot_leave_its_quotes() {
        let name = "p\"]\nignore = [1]\n[signal.\"q\\";
        let form = form(json!({
            "columns": [{"column": 1, "role": "signal", "name": name, "unit": "bar_gauge"}]
        }));
        let toml = form.toml().unwrap().unwrap();
        assert!(
            !toml.lines().any(|line| line.starts_with("ignore")),
            "{toml}"
        );
        // The reader refuses a name with a line break as a name, not as invalid TOML.
        let error = Mapping::parse("mapping", &toml).unwrap_err();
        assert_eq!(error.code(), "E-MAP-NAME", "{error}");
    }

    #[test]
    fn a_channel_is_named_as_it_is_in_its_file() {
        let form = form(json!({
            "columns": [
                {"column": "2/Druck \"A\"", "role": "signal", "name": "p_ch", "unit": "bar_gauge"},
                {"column": "Text", "role": "ignore"},
            ]
        }));
        let toml = form.toml().unwrap().unwrap();
        assert!(toml.contains("ignore = [\"Text\"]"), "{toml}");
        assert!(toml.contains(r#"column = "2/Druck \"A\"""#), "{toml}");
        assert!(Mapping::parse("mapping", &toml).is_ok(), "{toml}");
    }

    #[test]
    fn a_form_that_says_nothing_is_no_mapping() {
        assert_eq!(form(json!({})).toml().unwrap(), None);
        assert_eq!(form(json!({"toml": " \n"})).toml().unwrap(), None);
    }
}
