//! Survey of the channels of a file: their numbers, whatever their unit is.

use std::io::{Read, Seek};
use std::sync::Arc;

use super::Limits;
use super::blocks::Blocks;
use super::candidates::{Candidate, Candidates};
use super::choice::{Choice, Column};
use super::error::Located;
use super::reader::read_chosen;
use super::structure::File;
use crate::csv::Mapping;
use crate::csv::mapping::Conversion;
use crate::values::ColumnValues;
use crate::{Provenance, Recording, Unit};

/// Channels of an MF4 file with their numbers.
#[derive(Debug)]
pub(crate) struct Survey {
    /// Version times 100, such as 410.
    pub(crate) version: u16,
    pub(crate) producer: Option<String>,
    pub(crate) groups: usize,
    pub(crate) channels: Vec<SurveyedChannel>,
    /// Reason why no numbers were read, if there are none.
    pub(crate) obstacle: Option<String>,
}

/// Channel with its numbers.
#[derive(Debug)]
pub(crate) struct SurveyedChannel {
    /// Name in a mapping: with the number of the group if several groups have a channel of this name.
    pub(crate) key: String,
    pub(crate) name: String,
    pub(crate) unit: String,
    /// Name and unit of the signal that it is without a mapping.
    pub(crate) own: Option<(String, Unit)>,
    /// Reason why it can be no signal, if there is one.
    pub(crate) obstacle: Option<String>,
    pub(crate) values: ColumnValues,
    /// Instants (s) and numbers.
    pub(crate) times_s: Arc<Vec<f64>>,
    pub(crate) samples: Arc<Vec<f64>>,
}

/// Surveys a file.
pub(crate) fn survey<R: Read + Seek>(
    input: R,
    mapping: &Mapping,
    limits: Limits,
) -> Result<Survey, Located> {
    let mut blocks = Blocks::new(input, limits)?;
    let file = File::read(&mut blocks)?;
    let candidates = Candidates::of(&mut blocks, &file)?;
    let by_itself = Mapping::default().with_reference(mapping.reference);
    let own = Choice::of(&candidates, &by_itself)?;
    let all = candidates.channels.iter().enumerate();
    let all: Vec<(usize, &Candidate)> = all.filter(|(_, one)| !one.is_master).collect();
    let number = |index: usize| format!("channel {index}");
    let columns = all.iter().filter_map(|&(index, channel)| {
        Some(Column {
            group: channel.group,
            name: number(index),
            unit: Unit::Count,
            key: String::new(),
            source: channel.source.as_ref().ok()?.clone(),
            conversion: Conversion::NONE,
            check_scale: false,
            plausible: None,
        })
    });
    let choice = Choice {
        columns: columns.collect(),
        left_out: Vec::new(),
    };
    let empty = Recording::new(Provenance::default());
    let plain = Mapping::default();
    let read = read_chosen(&mut blocks, &file, &candidates, &choice, empty, &plain);
    let (numbers, obstacle) = match read {
        Ok(recording) => (recording, None),
        Err((_, problem)) => (Recording::default(), Some(problem.to_string())),
    };
    let channels = all.iter().map(|&(index, channel)| {
        let same = |other: &&(usize, &Candidate)| other.1.name == channel.name;
        let key = match all.iter().filter(same).count() {
            1 => channel.name.clone(),
            _ => format!("{}/{}", channel.group, channel.name),
        };
        let signal = numbers.signal(&number(index));
        let base = signal.and_then(|signal| numbers.time_base(signal.time_base()));
        let left_out = numbers.reason_left_out(&number(index));
        let of_own = own.columns.iter().find(|column| {
            column.group == channel.group && column.key == format!("{:?}", channel.name)
        });
        SurveyedChannel {
            key,
            name: channel.name.clone(),
            unit: channel.unit.clone(),
            own: of_own.map(|column| (column.name.clone(), column.unit)),
            obstacle: channel
                .source
                .as_ref()
                .err()
                .cloned()
                .or_else(|| left_out.map(str::to_owned)),
            values: signal.map_or_else(ColumnValues::default, |signal| {
                ColumnValues::of(signal.values_or_nan())
            }),
            times_s: base
                .map(crate::TimeBase::shared_times_s)
                .unwrap_or_default(),
            samples: signal.map(crate::Signal::shared_values).unwrap_or_default(),
        }
    });
    Ok(Survey {
        version: file.version,
        producer: file.producer.clone(),
        groups: candidates.groups.len(),
        channels: channels.collect(),
        obstacle,
    })
}
