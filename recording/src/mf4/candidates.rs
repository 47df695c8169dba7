//! Candidates for signals: channels with numbers over time, and the place of their numbers.

use std::collections::HashMap;
use std::io::{Read, Seek};
use std::rc::Rc;

use super::blocks::Blocks;
use super::conversion::{Conversion, Converted};
use super::error::{Located, Place};
use super::layout::Layout;
use super::problem::Problem;
use super::structure::{Channel, ChannelGroup, File};

/// Synchronisation type of a master channel over time (s).
const SYNC_TIME: u8 = 1;

/// Channel with its group and the data needed to read it.
#[derive(Debug)]
pub(super) struct Candidate {
    /// Number of the group in the order of the file, from 1.
    pub(super) group: usize,
    pub(super) name: String,
    /// Unit as given in the file.
    pub(super) unit: String,
    pub(super) is_master: bool,
    /// Source of the numbers, or the reason why the channel is no signal.
    pub(super) source: Result<Source, String>,
}

/// Source of the numbers of a channel.
#[derive(Clone, Debug)]
pub(super) struct Source {
    pub(super) layout: Layout,
    pub(super) conversion: Rc<Conversion>,
    pub(super) validity: Validity,
}

/// Rule for the validity of a sample in a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Validity {
    AlwaysValid,
    NeverValid,
    /// A bit after the data of the record, counted from there.
    Bit(usize),
}

/// Group with its place among the data and its time.
#[derive(Debug)]
pub(super) struct Group {
    /// Number of the data group, from 0.
    pub(super) data_group: usize,
    /// Number of the group within the data group, from 0.
    pub(super) channel_group: usize,
    /// Source of the instants, or the reason why there are none.
    pub(super) master: Result<Source, String>,
    /// Unit of the instants as given in the file.
    pub(super) time_unit: String,
}

/// Groups and channels of a file. The number of a group is its index here plus one.
#[derive(Debug, Default)]
pub(super) struct Candidates {
    pub(super) groups: Vec<Group>,
    pub(super) channels: Vec<Candidate>,
}

impl Candidates {
    pub(super) fn of<R: Read + Seek>(blocks: &mut Blocks<R>, file: &File) -> Result<Self, Located> {
        let mut conversions = HashMap::new();
        let mut candidates = Self::default();
        for (data_group, data) in file.data_groups.iter().enumerate() {
            for (channel_group, group) in data.channel_groups.iter().enumerate() {
                if group.has_variable_length {
                    continue;
                }
                let number = candidates.groups.len() + 1;
                let obstacle = obstacle(group);
                let mut master = Err("its group has no time".to_owned());
                let mut time_unit = String::new();
                for channel in &group.channels {
                    let source = match obstacle {
                        Some(reason) => Err(reason.to_owned()),
                        None => source(blocks, &mut conversions, group, channel)?,
                    };
                    if channel.is_master() && channel.sync == SYNC_TIME {
                        (master, time_unit) = (source.clone(), channel.unit.clone());
                    }
                    candidates.channels.push(Candidate {
                        group: number,
                        name: channel.name.clone(),
                        unit: channel.unit.clone(),
                        is_master: channel.is_master(),
                        source,
                    });
                }
                candidates.groups.push(Group {
                    data_group,
                    channel_group,
                    master,
                    time_unit,
                });
            }
        }
        for channel in &mut candidates.channels {
            let group = &candidates.groups[channel.group - 1];
            if let (Ok(_), Err(reason)) = (&channel.source, &group.master) {
                channel.source = Err(reason.clone());
            }
        }
        Ok(candidates)
    }
}

/// Returns the reason why no channel of the group can be read, if there is one.
fn obstacle(group: &ChannelGroup) -> Option<&'static str> {
    if group.has_remote_master {
        return Some("its group is stored column by column (MDF 4.2); save it as MDF 4.1");
    }
    (group.data_bytes == 0).then_some("the records of its group have no data")
}

type Conversions = HashMap<(u64, bool), Result<Rc<Conversion>, &'static str>>;

fn source<R: Read + Seek>(
    blocks: &mut Blocks<R>,
    conversions: &mut Conversions,
    group: &ChannelGroup,
    channel: &Channel,
) -> Result<Result<Source, String>, Located> {
    let layout = match Layout::of(channel) {
        Ok(layout) => layout,
        Err(reason) => return Ok(Err(reason.to_owned())),
    };
    let fail = |field, found, expected| {
        let problem = Problem::Field {
            field,
            found,
            expected,
        };
        Err((Place::block("##CN", channel.offset), problem))
    };
    if layout.end() > group.data_bytes {
        let expected = format!("at most {}, the size of the record", group.data_bytes);
        return fail(
            "the end of the channel in the record",
            layout.end() as u64,
            expected,
        );
    }
    let bit = channel.invalidation_bit;
    let validity = match channel.flags & 0b11 {
        0 => Validity::AlwaysValid,
        0b10 if bit as usize >= 8 * group.invalidation_bytes => {
            let expected = format!("less than {}", 8 * group.invalidation_bytes);
            return fail("the invalidation bit", u64::from(bit), expected);
        }
        0b10 => Validity::Bit(bit as usize),
        _ => Validity::NeverValid,
    };
    let key = (channel.conversion, layout.is_integer());
    let conversion = match conversions.get(&key) {
        Some(known) => known.clone(),
        None => {
            let read: Converted = blocks.conversion(key.0, key.1)?;
            let shared = read.map(Rc::new);
            conversions.insert(key, shared.clone());
            shared
        }
    };
    Ok(match conversion {
        Ok(conversion) => Ok(Source {
            layout,
            conversion,
            validity,
        }),
        Err(reason) => Err(reason.to_owned()),
    })
}
