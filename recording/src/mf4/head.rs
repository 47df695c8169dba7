//! Blocks of a written file, except the samples, which come last.

use super::blocks::{ALIGNMENT, HEADER_BYTES, ID_BYTES};
use super::structure::{HAS_OFFSETS, IN_LOCAL_TIME};
use super::text::escaped;
use crate::csv::Column;
use crate::{Clock, Provenance, StartTime, Unit};

/// Version of the format; the identification has its name and version, and eight letters for the program.
const VERSION: u16 = 410;
const IDENTIFICATION: &[u8; 24] = b"MDF     4.10    retarder";
/// Type of a channel and of its synchronisation (ASAM MDF 4.1, CN block).
#[derive(Clone, Copy)]
struct ChannelKind {
    kind: u8,
    sync: u8,
}

/// Master channel, over time.
const MASTER: ChannelKind = ChannelKind { kind: 2, sync: 1 };
const FIXED_LENGTH: ChannelKind = ChannelKind { kind: 0, sync: 0 };
/// Data type of a little-endian float.
const FLOAT: u8 = 4;
const FLOAT_BYTES: usize = 8;

/// Signals with one time base, and their number of samples.
pub(super) struct WrittenGroup<'a> {
    pub(super) columns: &'a [Column],
    pub(super) rows: u64,
}

impl WrittenGroup<'_> {
    /// Returns the size of the block with the samples (bytes).
    fn data_bytes(&self) -> u64 {
        HEADER_BYTES + self.rows * (FLOAT_BYTES * (1 + self.columns.len())) as u64
    }

    /// Returns the header of that block.
    pub(super) fn data_head(&self) -> [u8; HEADER_BYTES as usize] {
        let mut head = [0; HEADER_BYTES as usize];
        head[..4].copy_from_slice(b"##DT");
        head[8..16].copy_from_slice(&self.data_bytes().to_le_bytes());
        head
    }
}

/// Returns all bytes before the first block of samples. Their number does not depend on the numbers of rows.
pub(super) fn head(provenance: &Provenance, groups: &[WrittenGroup<'_>]) -> Vec<u8> {
    let mut head = Head {
        bytes: IDENTIFICATION.to_vec(),
    };
    head.bytes.resize(ID_BYTES as usize, 0);
    head.bytes[28..30].copy_from_slice(&VERSION.to_le_bytes());
    let header = head.block(b"##HD", &[0; 6], &start(provenance.start));
    let comment = head.text(b"##MD", &comment(provenance));
    let tool = head.text(b"##MD", &tool(provenance));
    let history = head.block(b"##FH", &[0, tool], &[0; 16]);
    head.set_link(header, 1, history);
    head.set_link(header, 5, comment);
    let mut last = (header, 0);
    let mut data_links = Vec::new();
    for group in groups {
        let data_group = head.block(b"##DG", &[0; 4], &[0; 8]);
        head.set_link(last.0, last.1, data_group);
        last = (data_group, 0);
        data_links.push(data_group);
        let record_bytes = (FLOAT_BYTES * (1 + group.columns.len())) as u32;
        let mut fields = [0; 32];
        fields[8..16].copy_from_slice(&group.rows.to_le_bytes());
        fields[24..28].copy_from_slice(&record_bytes.to_le_bytes());
        let channel_group = head.block(b"##CG", &[0; 6], &fields);
        head.set_link(data_group, 1, channel_group);
        let master = head.channel(MASTER, 0, "time", Unit::Second);
        head.set_link(channel_group, 1, master);
        let mut previous = master;
        for (index, column) in group.columns.iter().enumerate() {
            let channel = head.channel(FIXED_LENGTH, 1 + index, &column.name, column.unit);
            head.set_link(previous, 0, channel);
            previous = channel;
        }
    }
    let mut at = head.bytes.len() as u64;
    for (data_group, group) in data_links.into_iter().zip(groups) {
        head.set_link(data_group, 2, at);
        at += group.data_bytes();
    }
    head.bytes
}

struct Head {
    bytes: Vec<u8>,
}

impl Head {
    /// Appends a block, and returns its position.
    fn block(&mut self, id: &[u8; 4], links: &[u64], data: &[u8]) -> u64 {
        let at = self.bytes.len() as u64;
        let length = HEADER_BYTES + 8 * links.len() as u64 + data.len() as u64;
        self.bytes.extend_from_slice(id);
        self.bytes.extend_from_slice(&[0; 4]);
        for word in [length, links.len() as u64].iter().chain(links) {
            self.bytes.extend_from_slice(&word.to_le_bytes());
        }
        self.bytes.extend_from_slice(data);
        let end = self.bytes.len().next_multiple_of(ALIGNMENT as usize);
        self.bytes.resize(end, 0);
        at
    }

    fn set_link(&mut self, block: u64, index: usize, target: u64) {
        let at = block as usize + HEADER_BYTES as usize + 8 * index;
        self.bytes[at..at + 8].copy_from_slice(&target.to_le_bytes());
    }

    fn text(&mut self, id: &[u8; 4], text: &str) -> u64 {
        let mut data = text.as_bytes().to_vec();
        data.push(0);
        data.resize(data.len().next_multiple_of(ALIGNMENT as usize), 0);
        self.block(id, &[], &data)
    }

    fn channel(
        &mut self,
        ChannelKind { kind, sync }: ChannelKind,
        place: usize,
        name: &str,
        unit: Unit,
    ) -> u64 {
        let mut fields = [0; 72];
        fields[..3].copy_from_slice(&[kind, sync, FLOAT]);
        fields[4..8].copy_from_slice(&((FLOAT_BYTES * place) as u32).to_le_bytes());
        fields[8..12].copy_from_slice(&(8 * FLOAT_BYTES as u32).to_le_bytes());
        let mut links = [0; 8];
        links[2] = self.text(b"##TX", name);
        links[6] = self.text(b"##TX", unit_text(unit));
        self.block(b"##CN", &links, &fields)
    }
}

/// Returns the symbol of the unit if it reads back as the same unit, otherwise its token.
fn unit_text(unit: Unit) -> &'static str {
    match Unit::parse(unit.symbol()) {
        Some(read) if read == unit => unit.symbol(),
        _ => unit.token(),
    }
}

/// Returns the data of the header block. A simulation has no start time: zero.
fn start(start: Option<StartTime>) -> [u8; 32] {
    let mut data = [0; 32];
    if let Some(StartTime {
        since_1970_ns,
        clock,
    }) = start
    {
        data[..8].copy_from_slice(&since_1970_ns.to_le_bytes());
        data[12] = match clock {
            Clock::Local => IN_LOCAL_TIME,
            Clock::Utc { ahead_min } => {
                data[8..10].copy_from_slice(&ahead_min.to_le_bytes());
                HAS_OFFSETS
            }
        };
    }
    data
}

fn comment(provenance: &Provenance) -> String {
    let mut properties = String::new();
    let mut push = |key: &str, value: &str| {
        let (key, value) = (escaped(key), escaped(value));
        properties.push_str(&format!("<e name=\"{key}\">{value}</e>"));
    };
    push("source", &provenance.source);
    if let Some(input) = &provenance.input {
        push("source sha256", &input.sha256_hex());
    }
    for note in &provenance.notes {
        push(&note.key, &note.value);
    }
    let source = escaped(&provenance.source);
    format!(
        "<HDcomment><TX>{source}</TX><common_properties>{properties}</common_properties></HDcomment>"
    )
}

fn tool(provenance: &Provenance) -> String {
    let ours = concat!("recording ", env!("CARGO_PKG_VERSION"));
    let producer = provenance.producer.as_deref().unwrap_or(ours);
    let (tool, version) = producer.rsplit_once(' ').unwrap_or((producer, ""));
    let (tool, version) = (escaped(tool), escaped(version));
    format!(
        "<FHcomment><TX></TX><tool_id>{tool}</tool_id><tool_vendor></tool_vendor><tool_version>{version}</tool_version></FHcomment>"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_unit_reads_back_from_its_text() {
        for unit in Unit::all() {
            assert_eq!(Unit::parse(unit_text(unit)), Some(unit), "{unit}");
        }
    }

    #[test]
    fn the_number_of_rows_does_not_move_the_data() {
        let columns = [Column {
            name: "p_ch".to_owned(),
            unit: Unit::BarGauge,
        }];
        let length = |rows| {
            let group = WrittenGroup {
                columns: &columns,
                rows,
            };
            head(&Provenance::from_source("bench"), &[group]).len()
        };
        assert_eq!(length(0), length(u64::from(u32::MAX)));
        assert!(length(0).is_multiple_of(ALIGNMENT as usize));
    }
}
