//! Text of the mapping that an inspection proposes.

use std::fmt::Write as _;

use super::Draft;
use super::columns::{Column, Use, toml_string};
use crate::LogFormat;
use crate::csv::Excerpt;

impl Draft {
    /// Returns the text of a mapping: the given one with lines for the other columns, or a new one. `None` if the file
    /// needs neither. With `states_reference`, the mapping has a line for each column whose header leaves the reference
    /// open.
    pub(super) fn mapping_text(
        &self,
        source: &str,
        given: Option<&str>,
        missing: &[&str],
        states_reference: bool,
    ) -> Option<String> {
        let ignored: Vec<&str> = self
            .columns
            .iter()
            .filter(|column| {
                self.format == LogFormat::Csv
                    && !column.is_given
                    && matches!(column.role, Use::Ignored)
            })
            .map(|column| column.toml_key.as_str())
            .collect();
        let lines = self.columns.iter().any(|column| {
            let has_line = column.needs_line()
                || states_reference && column.needs_reference && !column.is_given;
            matches!(column.role, Use::Time | Use::Signal(_)) && has_line
        });
        let is_needed = lines
            || !ignored.is_empty()
            || !self.missing_words.is_empty()
            || !self.dialect.is_empty();
        if !is_needed {
            return None;
        }
        let mut text = String::new();
        let list = |key: &str, items: &[String]| format!("{key} = [{}]\n", items.join(", "));
        let ignored: Vec<String> = ignored.into_iter().map(str::to_owned).collect();
        let words: Vec<String> = self
            .missing_words
            .iter()
            .filter_map(|word| toml_string(word))
            .collect();
        match given {
            Some(given) => {
                let has = |key: &str| given.lines().any(|line| line.trim_start().starts_with(key));
                for (key, items) in [("ignore", &ignored), ("missing", &words)] {
                    if !items.is_empty() {
                        // A key cannot be there twice.
                        let mark = if has(key) { "# add: " } else { "" };
                        text += mark;
                        text += &list(key, items);
                    }
                }
                text += given;
                if !text.ends_with('\n') {
                    text.push('\n');
                }
            }
            None => {
                let _ = writeln!(
                    text,
                    "# Proposed for {}; each line has its reason.",
                    Excerpt::of(source)
                );
                text += "schema = 1\n";
                for (key, items) in [("ignore", &ignored), ("missing", &words)] {
                    if !items.is_empty() {
                        text += &list(key, items);
                    }
                }
                if !self.dialect.is_empty() {
                    text += "\n[dialect]\n";
                    for (key, value) in &self.dialect {
                        let _ = writeln!(text, "{key} = {value}");
                    }
                }
            }
        }
        let is_written =
            |column: &&Column| column.needs_line() || column.needs_reference && !column.is_given;
        let time = self
            .columns
            .iter()
            .find(|column| matches!(column.role, Use::Time));
        if let Some(time) = time.filter(is_written) {
            text += "\n[time]\n";
            text += &lines_of(time);
        }
        for column in self.columns.iter().filter(is_written) {
            if let Use::Signal(name) = &column.role {
                let _ = writeln!(text, "\n[signal.{}]", crate::proposal::toml_key(name));
                text += &lines_of(column);
            }
        }
        let has_number = |column: &&Column| {
            matches!(column.role, Use::Ignored)
                && column.values.count > 0
                && !column.values.increase
        };
        let unused = self.columns.iter().find(has_number);
        for signal in missing {
            let Some(unused) = unused else { break };
            let unit = if *signal == "p_ch" {
                "bar_gauge"
            } else {
                "pct"
            };
            let _ = write!(
                text,
                "\n# {signal} is missing. If a column is it, take the column out of `ignore` and name it:\n# [signal.{signal}]\n# column = {}\n# unit = \"{unit}\"\n",
                unused.toml_key
            );
        }
        for signal in missing.iter().filter(|signal| signal.starts_with("duty")) {
            let _ = write!(
                text,
                "\n# {signal} is missing. If the valve stayed as it was, state it:\n# [constant.{signal}]\n# value = 0\n# unit = \"pct\"\n"
            );
        }
        Some(text)
    }
}

fn lines_of(column: &Column) -> String {
    let unit = column.unit_token();
    let mut text = format!("column = {}\nunit = \"{unit}\"", column.toml_key);
    let assumed = match column.assumed.is_empty() {
        true => String::new(),
        false => format!("assumed: {}", column.assumed),
    };
    let reasons = [&column.reason, &assumed]
        .into_iter()
        .filter(|text| !text.is_empty());
    let reasons: Vec<&str> = reasons.map(String::as_str).collect();
    if !reasons.is_empty() {
        let _ = write!(text, "  # {}", reasons.join("; "));
    }
    text.push('\n');
    if let Some(scale) = column.scale {
        let _ = writeln!(text, "scale = {scale:?}");
    }
    if let Some([least, greatest]) = column.clip {
        let _ = writeln!(text, "clip = [{least:?}, {greatest:?}]");
    }
    if let Some(range) = &column.plausible {
        let _ = writeln!(text, "plausible = [{:?}, {:?}]", range.start(), range.end());
    }
    if let Some(separator) = column.thousands.filter(|_| !column.is_clock) {
        let _ = writeln!(text, "thousands_separator = \"{separator}\"");
    }
    text
}
