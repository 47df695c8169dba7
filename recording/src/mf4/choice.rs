//! Choice of signals among the candidates, with name and unit, by the mapping or by the file itself.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use super::candidates::{Candidate, Candidates, Source};
use super::error::{Located, of_file};
use super::problem::Problem;
use crate::csv::header::{Reference, parse_heading, parse_unit};
use crate::csv::mapping::{ColumnKey, Conversion, MappedColumn, Mapping};
use crate::csv::{self, Excerpt};
use crate::name::{check_name, is_time_column};
use crate::proposal::signal_line;
use crate::{LeftOut, Unit};

/// Channel that becomes a signal.
#[derive(Debug)]
pub(super) struct Column {
    /// Number of the group, from 1.
    pub(super) group: usize,
    pub(super) name: String,
    pub(super) unit: Unit,
    /// Name of the channel in a mapping.
    pub(super) key: String,
    pub(super) source: Source,
    /// Conversion of a mapping, after that of the file.
    pub(super) conversion: Conversion,
    pub(super) check_scale: bool,
    /// Range of the values; others count as missing.
    pub(super) plausible: Option<RangeInclusive<f64>>,
}

/// Signals of a file, and the channels that are none.
#[derive(Debug, Default)]
pub(super) struct Choice {
    pub(super) columns: Vec<Column>,
    /// Left-out channels with their indices among the candidates.
    pub(super) left_out: Vec<(usize, LeftOut)>,
}

impl Choice {
    pub(super) fn of(candidates: &Candidates, mapping: &Mapping) -> Result<Self, Located> {
        if mapping.time.is_some() {
            return Err(of_file(Problem::MappedTime));
        }
        let channels = &candidates.channels;
        let mut is_explained: Vec<bool> = channels.iter().map(|one| one.is_master).collect();
        for key in &mapping.ignore {
            is_explained[find(channels, key)?] = true;
        }
        let mut choice = Self::default();
        for (name, mapped) in &mapping.signals {
            let index = find(channels, &mapped.column)?;
            is_explained[index] = true;
            choice
                .columns
                .push(mapped_column(name, mapped, &channels[index])?);
        }
        let rest = (0..channels.len()).filter(|&index| !is_explained[index]);
        choice.take_by_name(channels, &rest.collect::<Vec<_>>(), mapping);
        let constants = mapping.constants.iter();
        for (name, _) in constants.filter(|(_, constant)| !constant.where_absent) {
            if choice.columns.iter().any(|column| column.name == *name) {
                return Err(of_file(Problem::ConstantLogged { name: name.clone() }));
            }
        }
        Ok(choice)
    }

    /// Takes channels under their own name, if it is unique.
    fn take_by_name(&mut self, channels: &[Candidate], rest: &[usize], mapping: &Mapping) {
        let mut groups: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        let headings: Vec<_> = rest
            .iter()
            .map(|&index| heading(&channels[index], mapping.reference))
            .collect();
        for (&index, heading) in rest.iter().zip(&headings) {
            if let Ok((name, _, _)) = heading {
                groups
                    .entry(name.clone())
                    .or_default()
                    .push(channels[index].group);
            }
        }
        for (&index, heading) in rest.iter().zip(headings) {
            let channel = &channels[index];
            let (name, reason) = match heading {
                Err(left_out) => left_out,
                Ok((name, ..)) if mapping.signals.contains_key(&name) => (
                    name,
                    "the mapping gives its name to another channel".to_owned(),
                ),
                Ok((name, unit, _)) if groups[&name].len() > 1 => {
                    let reason = ambiguous(&name, unit, &channel.name, &groups[&name]);
                    (name, reason)
                }
                Ok((name, unit, source)) => {
                    self.columns.push(Column {
                        group: channel.group,
                        name,
                        unit,
                        key: format!("{:?}", channel.name),
                        source,
                        conversion: Conversion::NONE,
                        check_scale: true,
                        plausible: None,
                    });
                    continue;
                }
            };
            self.left_out.push((index, LeftOut { name, reason }));
        }
        self.columns.sort_by_key(|column| column.group);
    }
}

/// Finds the channel that a mapping names by `name`, or by `2/name` for the one of group 2.
fn find(channels: &[Candidate], key: &ColumnKey) -> Result<usize, Located> {
    let wanted = match key {
        ColumnKey::Number(number) => {
            return Err(of_file(Problem::MappedByNumber { number: *number }));
        }
        ColumnKey::Header(wanted) => wanted,
    };
    let matching = |name: &str, group: Option<usize>| -> Vec<usize> {
        let is_meant = |channel: &Candidate| {
            !channel.is_master
                && channel.name == name
                && group.is_none_or(|group| group == channel.group)
        };
        (0..channels.len())
            .filter(|&index| is_meant(&channels[index]))
            .collect()
    };
    let mut found = matching(wanted, None);
    if found.is_empty()
        && let Some((group, name)) = wanted.split_once('/')
        && let Ok(group) = group.parse()
    {
        found = matching(name, Some(group));
    }
    match found[..] {
        [index] => Ok(index),
        [first, second, ..] => Err(of_file(Problem::MappedChannelTwice {
            wanted: wanted.clone(),
            groups: [channels[first].group, channels[second].group],
        })),
        [] => {
            let names: Vec<&str> = channels.iter().map(|one| one.name.as_str()).collect();
            let found = Excerpt::of(&names.join(", "));
            Err(of_file(Problem::MappedChannelMissing {
                wanted: wanted.clone(),
                found,
            }))
        }
    }
}

fn mapped_column(
    name: &str,
    mapped: &MappedColumn,
    channel: &Candidate,
) -> Result<Column, Located> {
    let unusable = |reason: &String| {
        of_file(Problem::MappedChannelUnusable {
            wanted: channel.name.clone(),
            reason: reason.clone(),
        })
    };
    Ok(Column {
        group: channel.group,
        name: name.to_owned(),
        unit: mapped.unit,
        key: match &mapped.column {
            ColumnKey::Number(number) => number.to_string(),
            ColumnKey::Header(header) => format!("{header:?}"),
        },
        source: channel.source.as_ref().map_err(unusable)?.clone(),
        conversion: mapped.conversion,
        check_scale: mapped.check_scale,
        plausible: mapped.plausible.clone(),
    })
}

/// Returns name, unit and source of a channel that needs no mapping; otherwise its name and the reason why it is no
/// signal.
fn heading(
    channel: &Candidate,
    reference: Reference,
) -> Result<(String, Unit, Source), (String, String)> {
    if let Err(problem) = check_name(&channel.name) {
        let name = Excerpt::of(&channel.name).as_str().to_owned();
        return Err((name, problem.to_string()));
    }
    let fail = |reason: String| Err((channel.name.clone(), reason));
    let source = match &channel.source {
        Ok(source) => source.clone(),
        Err(reason) => return fail(reason.clone()),
    };
    let (name, unit) = if channel.unit.is_empty() {
        match parse_heading(&channel.name, reference) {
            Ok(heading) => (heading.name, heading.unit),
            Err(_) => {
                return fail(needs_unit(
                    "it has no unit".to_owned(),
                    &channel.name,
                    "UNIT",
                ));
            }
        }
    } else {
        match parse_unit(&channel.unit, reference) {
            Ok(unit) => (channel.name.clone(), unit),
            Err(problem) => {
                let unit = match &problem {
                    csv::Problem::PressureReference { found } => {
                        format!("{}_gauge", found.as_str())
                    }
                    csv::Problem::UnitUnknown {
                        meant: Some(unit), ..
                    } => unit.token().to_owned(),
                    _ => "UNIT".to_owned(),
                };
                return fail(needs_unit(problem.to_string(), &channel.name, &unit));
            }
        }
    };
    if is_time_column(&name, unit) {
        return fail("it is named as the time; map it under another name".to_owned());
    }
    Ok((name, unit, source))
}

fn needs_unit(problem: String, name: &str, unit: &str) -> String {
    let line = signal_line(name, &format!("{name:?}"), unit);
    format!("{problem}; say in a mapping: {line}")
}

fn ambiguous(name: &str, unit: Unit, channel: &str, groups: &[usize]) -> String {
    let numbers: Vec<String> = groups.iter().take(4).map(usize::to_string).collect();
    let key = format!("{:?}", format!("{}/{channel}", groups[0]));
    format!(
        "groups {} have a channel of this name; say in a mapping which one: {}",
        numbers.join(", "),
        signal_line(name, &key, unit.token())
    )
}
