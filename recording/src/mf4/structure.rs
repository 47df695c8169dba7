//! Structure of the file: data groups, channel groups, channels.

use std::io::{Read, Seek};

use super::blocks::{Block, Blocks, ID_BYTES};
use super::error::{Located, Place, of_file};
use super::problem::{Budget, Problem};
use super::text::element;
use crate::csv::Excerpt;
use crate::{Clock, Note, StartTime};

const FINISHED: &[u8; 8] = b"MDF     ";
const UNFINISHED: &[u8; 8] = b"UnFinMF ";

/// Flags of the start time (ASAM MDF 4.1, HD block): it is in local time; the offsets to local time are known.
pub(super) const IN_LOCAL_TIME: u8 = 0b1;
pub(super) const HAS_OFFSETS: u8 = 0b10;

/// File without its data.
#[derive(Debug)]
pub(super) struct File {
    /// Version times 100.
    pub(super) version: u16,
    /// Steps that the logger did not finish.
    pub(super) unfinished: Unfinished,
    /// Program that wrote the file.
    pub(super) producer: Option<String>,
    pub(super) start: Option<StartTime>,
    pub(super) comment: String,
    pub(super) properties: Vec<Note>,
    pub(super) data_groups: Vec<DataGroup>,
}

/// Final steps that a logger did not reach (ASAM MDF 4.1, ID block).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Unfinished {
    /// Whether the file was not closed.
    pub(super) is_any: bool,
    /// Whether the numbers of records of the groups are missing.
    pub(super) counts: bool,
    /// Whether the length of the last data block is missing.
    pub(super) data_length: bool,
}

/// Channel groups whose records share a stream of data.
#[derive(Debug)]
pub(super) struct DataGroup {
    /// Link to the data.
    pub(super) data: u64,
    pub(super) offset: u64,
    /// Number of bytes before each record that give its group: 0, 1, 2, 4 or 8.
    pub(super) record_id_bytes: usize,
    pub(super) channel_groups: Vec<ChannelGroup>,
}

/// Channels that are sampled together.
#[derive(Debug)]
pub(super) struct ChannelGroup {
    pub(super) offset: u64,
    pub(super) record_id: u64,
    /// Number of records as given in the file.
    pub(super) records: u64,
    /// Whether the records have variable length, for one channel of another group.
    pub(super) has_variable_length: bool,
    /// Whether the channels are stored in separate blocks (MDF 4.2).
    pub(super) has_remote_master: bool,
    pub(super) data_bytes: usize,
    pub(super) invalidation_bytes: usize,
    pub(super) name: String,
    pub(super) channels: Vec<Channel>,
}

/// Channel as described in the file.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) offset: u64,
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) kind: u8,
    pub(super) sync: u8,
    pub(super) data_type: u8,
    pub(super) bit_offset: u8,
    pub(super) byte_offset: u32,
    pub(super) bits: u32,
    pub(super) flags: u32,
    pub(super) invalidation_bit: u32,
    /// Whether the channel consists of members or of elements.
    pub(super) is_composed: bool,
    /// Link to the conversion.
    pub(super) conversion: u64,
}

impl Channel {
    /// Returns whether the channel gives the instants of its group.
    pub(super) fn is_master(&self) -> bool {
        matches!(self.kind, 2 | 3)
    }
}

impl File {
    pub(super) fn read<R: Read + Seek>(blocks: &mut Blocks<R>) -> Result<Self, Located> {
        let (version, unfinished) = identification(blocks)?;
        let header = blocks.block("##HD", ID_BYTES)?;
        let comment = blocks.comment(header.link(5))?;
        let mut file = Self {
            version,
            unfinished,
            producer: producer(blocks, header.link(1))?,
            start: start(&header)?,
            comment: comment.text,
            properties: comment.properties,
            data_groups: Vec::new(),
        };
        let mut channels = 0;
        let mut next = header.link(0);
        while next != 0 {
            blocks.first_visit("##DG", next)?;
            let block = blocks.block("##DG", next)?;
            file.data_groups
                .push(data_group(blocks, &block, &mut channels)?);
            next = block.link(0);
        }
        Ok(file)
    }
}

fn identification<R: Read + Seek>(blocks: &mut Blocks<R>) -> Result<(u16, Unfinished), Located> {
    let mut bytes = Vec::new();
    let count = blocks.file_bytes.min(ID_BYTES);
    blocks.append(0, count, &mut bytes)?;
    let is_unfinished = bytes.starts_with(UNFINISHED);
    if (bytes.len() as u64) < ID_BYTES || !(is_unfinished || bytes.starts_with(FINISHED)) {
        let found = Excerpt::of_bytes(&bytes[..bytes.len().min(8)]);
        return Err(of_file(Problem::NoMdf { found }));
    }
    let number = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
    let version = number(28);
    if !(400..500).contains(&version) {
        return Err(of_file(Problem::Version { found: version }));
    }
    let steps = if is_unfinished { number(60) } else { 0 };
    let unfinished = Unfinished {
        is_any: is_unfinished,
        counts: steps & 0b1 != 0,
        data_length: steps & 0b100 != 0,
    };
    Ok((version, unfinished))
}

/// Returns the start of the recording; `None` if it is zero in the file.
fn start(header: &Block) -> Result<Option<StartTime>, Located> {
    header.require(13)?;
    let (since_1970_ns, flags) = (header.u64(0), header.u8(12));
    if since_1970_ns == 0 {
        return Ok(None);
    }
    let offset_min = |at| i32::from(header.u16(at).cast_signed());
    // The standard gives the offsets of a local time no meaning.
    let clock = match (flags & IN_LOCAL_TIME != 0, flags & HAS_OFFSETS != 0) {
        (true, _) => Clock::Local,
        (false, false) => Clock::Utc { ahead_min: 0 },
        (false, true) => {
            let ahead_min = offset_min(8) + offset_min(10);
            // An offset of a day or more is no zone: the universal time is then returned without one.
            let is_zone = ahead_min.abs() < 24 * 60;
            let ahead_min = i16::try_from(ahead_min).ok().filter(|_| is_zone);
            Clock::Utc {
                ahead_min: ahead_min.unwrap_or(0),
            }
        }
    };
    Ok(Some(StartTime {
        since_1970_ns,
        clock,
    }))
}

/// Returns the tool of the last entry in the file's history.
fn producer<R: Read + Seek>(
    blocks: &mut Blocks<R>,
    mut next: u64,
) -> Result<Option<String>, Located> {
    let mut last = 0;
    while next != 0 {
        blocks.first_visit("##FH", next)?;
        let block = blocks.block("##FH", next)?;
        last = block.link(1);
        next = block.link(0);
    }
    if last == 0 {
        return Ok(None);
    }
    let (xml, _) = blocks.raw_text(last)?;
    let Some(tool) = element(&xml, "tool_id").filter(|tool| !tool.is_empty()) else {
        return Ok(None);
    };
    let version = element(&xml, "tool_version").unwrap_or_default();
    Ok(Some(format!("{tool} {version}").trim_end().to_owned()))
}

fn data_group<R: Read + Seek>(
    blocks: &mut Blocks<R>,
    block: &Block,
    channels: &mut u64,
) -> Result<DataGroup, Located> {
    block.require(1)?;
    let record_id_bytes = usize::from(block.u8(0));
    if !matches!(record_id_bytes, 0 | 1 | 2 | 4 | 8) {
        return Err(block.field(
            "the size of a record's group number",
            record_id_bytes as u64,
            "0, 1, 2, 4 or 8 bytes",
        ));
    }
    let mut group = DataGroup {
        data: block.link(2),
        offset: block.offset,
        record_id_bytes,
        channel_groups: Vec::new(),
    };
    let mut next = block.link(1);
    while next != 0 {
        blocks.first_visit("##CG", next)?;
        let block = blocks.block("##CG", next)?;
        group
            .channel_groups
            .push(channel_group(blocks, &block, channels)?);
        next = block.link(0);
    }
    if record_id_bytes == 0 && group.channel_groups.len() > 1 {
        let found = group.channel_groups.len() as u64;
        let field = "the number of groups in a stream without group numbers";
        return Err(block.field(field, found, "1"));
    }
    Ok(group)
}

fn channel_group<R: Read + Seek>(
    blocks: &mut Blocks<R>,
    block: &Block,
    count: &mut u64,
) -> Result<ChannelGroup, Located> {
    block.require(32)?;
    let flags = block.u16(16);
    let mut group = ChannelGroup {
        offset: block.offset,
        record_id: block.u64(0),
        records: block.u64(8),
        has_variable_length: flags & 1 != 0,
        has_remote_master: flags & 8 != 0,
        data_bytes: block.u32(24) as usize,
        invalidation_bytes: block.u32(28) as usize,
        name: blocks.text(block.link(2))?,
        channels: Vec::new(),
    };
    let mut next = block.link(1);
    while next != 0 {
        *count += 1;
        if *count > blocks.limits.channels {
            let (budget, found, bound) = (Budget::Channels, *count, blocks.limits.channels);
            let problem = Problem::Limit {
                budget,
                found,
                bound,
            };
            return Err((Place::block("##CN", next), problem));
        }
        blocks.first_visit("##CN", next)?;
        let block = blocks.block("##CN", next)?;
        group.channels.push(channel(blocks, &block)?);
        next = block.link(0);
    }
    Ok(group)
}

fn channel<R: Read + Seek>(blocks: &mut Blocks<R>, block: &Block) -> Result<Channel, Located> {
    block.require(24)?;
    let conversion = block.link(4);
    let mut unit = blocks.text(block.link(6))?;
    if unit.is_empty() && conversion != 0 {
        let conversion = blocks.block("##CC", conversion)?;
        unit = blocks.text(conversion.link(1))?;
    }
    Ok(Channel {
        offset: block.offset,
        name: blocks.text(block.link(2))?,
        unit,
        kind: block.u8(0),
        sync: block.u8(1),
        data_type: block.u8(2),
        bit_offset: block.u8(3),
        byte_offset: block.u32(4),
        bits: block.u32(8),
        flags: block.u32(12),
        invalidation_bit: block.u32(16),
        is_composed: block.link(1) != 0,
        conversion,
    })
}
