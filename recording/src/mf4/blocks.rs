//! Blocks of the file, each read within the file and within the budgets, for any header.

use std::collections::HashSet;
use std::io::{Read, Seek, SeekFrom};

use super::Limits;
use super::error::{Located, Place, of_file};
use super::problem::{Budget, Problem};
use crate::csv::Excerpt;

/// Size of the identification at the beginning of the file, before the first block (bytes).
pub(super) const ID_BYTES: u64 = 64;
/// Size of identifier, reserved bytes, length and number of links (bytes).
pub(super) const HEADER_BYTES: u64 = 24;
/// Alignment of blocks (bytes).
pub(super) const ALIGNMENT: u64 = 8;

/// File of blocks, with the remaining budgets.
pub(super) struct Blocks<R> {
    input: R,
    pub(super) file_bytes: u64,
    pub(super) limits: Limits,
    metadata_bytes: u64,
    seen: HashSet<u64>,
}

/// Header of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Header {
    pub(super) id: [u8; 4],
    pub(super) offset: u64,
    /// Length of the block, including this header (bytes).
    pub(super) length: u64,
    /// Number of links.
    pub(super) links: u64,
}

/// Block in memory.
#[derive(Debug)]
pub(super) struct Block {
    id: &'static str,
    pub(super) offset: u64,
    /// Number of bytes from the beginning of the block to the end of the file.
    room: u64,
    links: Vec<u64>,
    data: Vec<u8>,
}

impl<R: Read + Seek> Blocks<R> {
    pub(super) fn new(mut input: R, limits: Limits) -> Result<Self, Located> {
        let end = input.seek(SeekFrom::End(0));
        let file_bytes = end.map_err(|error| of_file(Problem::Io(error)))?;
        if file_bytes > limits.file_bytes {
            let (budget, bound) = (Budget::FileBytes, limits.file_bytes);
            return Err(of_file(Problem::Limit {
                budget,
                found: file_bytes,
                bound,
            }));
        }
        Ok(Self {
            input,
            file_bytes,
            limits,
            metadata_bytes: 0,
            seen: HashSet::new(),
        })
    }

    /// Appends `count` bytes from `offset` on to `buffer`; the caller has checked that they are in the file.
    pub(super) fn append(
        &mut self,
        offset: u64,
        count: u64,
        buffer: &mut Vec<u8>,
    ) -> Result<(), Located> {
        let fail = |error| of_file(Problem::Io(error));
        self.input.seek(SeekFrom::Start(offset)).map_err(fail)?;
        let read = self.input.by_ref().take(count).read_to_end(buffer);
        match read.map_err(fail)? as u64 {
            read if read == count => Ok(()),
            _ => Err(fail(std::io::ErrorKind::UnexpectedEof.into())),
        }
    }

    /// Reads the header of the block at `offset`, without a check of its end.
    pub(super) fn head(&mut self, block: &'static str, offset: u64) -> Result<Header, Located> {
        let is_inside = offset >= ID_BYTES
            && offset.is_multiple_of(ALIGNMENT)
            && self.file_bytes.saturating_sub(offset) >= HEADER_BYTES;
        if !is_inside {
            let problem = Problem::Link {
                target: offset,
                file_bytes: self.file_bytes,
            };
            return Err((Place::block(block, offset), problem));
        }
        self.spend(block, offset, HEADER_BYTES)?;
        let mut bytes = Vec::with_capacity(HEADER_BYTES as usize);
        self.append(offset, HEADER_BYTES, &mut bytes)?;
        Ok(Header {
            id: [bytes[0], bytes[1], bytes[2], bytes[3]],
            offset,
            length: u64_at(&bytes, 8),
            links: u64_at(&bytes, 16),
        })
    }

    /// Refuses a block that goes beyond the end of the file, or is too short for its own links and `data_bytes` more.
    pub(super) fn check_length(
        &self,
        block: &'static str,
        header: Header,
        data_bytes: u64,
    ) -> Result<(), Located> {
        let at_most = self.file_bytes - header.offset;
        let at_least = header
            .links
            .saturating_mul(8)
            .saturating_add(HEADER_BYTES + data_bytes);
        if header.length < at_least || header.length > at_most {
            let problem = Problem::BlockLength {
                found: header.length,
                at_least,
                at_most,
            };
            return Err((Place::block(block, header.offset), problem));
        }
        Ok(())
    }

    /// Reads the complete block `id` at `offset`.
    pub(super) fn block(&mut self, id: &'static str, offset: u64) -> Result<Block, Located> {
        self.beginning(id, offset, u64::MAX)
    }

    /// Reads the block `id` at `offset`, with at most `data_max` bytes of its data.
    pub(super) fn beginning(
        &mut self,
        id: &'static str,
        offset: u64,
        data_max: u64,
    ) -> Result<Block, Located> {
        let header = self.head(id, offset)?;
        if header.id != *id.as_bytes() {
            return Err(unexpected(id, header));
        }
        self.check_length(id, header, 0)?;
        let link_bytes = 8 * header.links;
        let data_bytes = (header.length - HEADER_BYTES - link_bytes).min(data_max);
        self.spend(id, offset, link_bytes + data_bytes)?;
        let mut bytes = Vec::new();
        self.append(offset + HEADER_BYTES, link_bytes + data_bytes, &mut bytes)?;
        let data = bytes.split_off(link_bytes as usize);
        let links = bytes.chunks_exact(8).map(|link| u64_at(link, 0)).collect();
        Ok(Block {
            id,
            offset,
            room: self.file_bytes - offset,
            links,
            data,
        })
    }

    /// Registers the next block `id` of a list or of a data group, and refuses a second visit.
    pub(super) fn first_visit(&mut self, id: &'static str, offset: u64) -> Result<(), Located> {
        if self.seen.insert(offset) {
            Ok(())
        } else {
            Err((Place::block(id, offset), Problem::Loop))
        }
    }

    fn spend(&mut self, block: &'static str, offset: u64, bytes: u64) -> Result<(), Located> {
        self.metadata_bytes = self.metadata_bytes.saturating_add(bytes);
        if self.metadata_bytes > self.limits.metadata_bytes {
            let problem = Problem::Limit {
                budget: Budget::MetadataBytes,
                found: self.metadata_bytes,
                bound: self.limits.metadata_bytes,
            };
            return Err((Place::block(block, offset), problem));
        }
        Ok(())
    }

    /// Returns the input, rewound to its beginning.
    pub(super) fn rewound(&mut self) -> Result<&mut R, Located> {
        self.input
            .rewind()
            .map_err(|error| of_file(Problem::Io(error)))?;
        Ok(&mut self.input)
    }
}

pub(super) fn unexpected(expected: &'static str, header: Header) -> Located {
    let found = Excerpt::of_bytes(&header.id);
    let place = Place::block(expected, header.offset);
    (place, Problem::BlockId { expected, found })
}

impl Block {
    pub(super) fn place(&self) -> Place {
        Place::block(self.id, self.offset)
    }

    /// Returns link `index`; 0, which is no link, if the block has fewer.
    pub(super) fn link(&self, index: usize) -> u64 {
        self.links.get(index).copied().unwrap_or(0)
    }

    pub(super) fn links(&self) -> &[u64] {
        &self.links
    }

    pub(super) fn data(&self) -> &[u8] {
        &self.data
    }

    /// Creates the problem of one of the block's fields.
    pub(super) fn field(
        &self,
        field: &'static str,
        found: u64,
        expected: impl Into<String>,
    ) -> Located {
        let expected = expected.into();
        let problem = Problem::Field {
            field,
            found,
            expected,
        };
        (self.place(), problem)
    }

    /// Refuses a block with fewer data bytes than `bytes`.
    pub(super) fn require(&self, bytes: usize) -> Result<(), Located> {
        if self.data.len() >= bytes {
            return Ok(());
        }
        let head = HEADER_BYTES + 8 * self.links.len() as u64;
        let problem = Problem::BlockLength {
            found: head + self.data.len() as u64,
            at_least: head + bytes as u64,
            at_most: self.room,
        };
        Err((self.place(), problem))
    }

    pub(super) fn u8(&self, at: usize) -> u8 {
        self.data[at]
    }

    pub(super) fn u16(&self, at: usize) -> u16 {
        u16::from_le_bytes([self.data[at], self.data[at + 1]])
    }

    pub(super) fn u32(&self, at: usize) -> u32 {
        u32::from_le_bytes([
            self.data[at],
            self.data[at + 1],
            self.data[at + 2],
            self.data[at + 3],
        ])
    }

    pub(super) fn u64(&self, at: usize) -> u64 {
        u64_at(&self.data, at)
    }

    /// Returns all 64-bit floats from `at` on.
    pub(super) fn floats(&self, at: usize) -> Vec<f64> {
        let bytes = self.data.get(at..).unwrap_or_default();
        bytes
            .chunks_exact(8)
            .map(|bytes| f64::from_bits(u64_at(bytes, 0)))
            .collect()
    }
}

/// Reads the little-endian number at `at`; the caller has checked that it exists.
pub(super) fn u64_at(bytes: &[u8], at: usize) -> u64 {
    let mut word = [0; 8];
    word.copy_from_slice(&bytes[at..at + 8]);
    u64::from_le_bytes(word)
}
