//! Data of a group: a sequence of blocks, some of them packed, read as one stream of bytes.

use std::io::{Read, Seek};

use miniz_oxide::inflate::decompress_slice_iter_to_slice;

use super::blocks::{Blocks, HEADER_BYTES, Header, unexpected};
use super::error::{Located, Place};
use super::problem::{Budget, Problem};
use super::structure::Unfinished;

/// Size of the pieces in which plain data is read (bytes).
const PIECE_BYTES: u64 = 1 << 20;
/// Number of bytes before the packed data of a block.
const PACKED_HEAD_BYTES: u64 = 24;
/// Maximum ratio of unpacked to packed size of a deflate stream: 258 bytes for 2 bits, and a little for its header.
const UNPACKED_OVER_PACKED_MAX: u64 = 1032;

/// One block of data.
#[derive(Clone, Copy, Debug)]
struct Fragment {
    /// Position of its data in the file.
    offset: u64,
    /// Size in the file (bytes).
    stored: u64,
    /// Size of the data (bytes).
    bytes: u64,
    packing: Packing,
}

#[derive(Clone, Copy, Debug)]
enum Packing {
    None,
    Deflate,
    /// Deflate of the transposed bytes, with this number of columns.
    Transposed(u64),
}

/// Data of a group, read from its beginning to its end.
pub(super) struct DataStream {
    fragments: Vec<Fragment>,
    next: usize,
    /// Number of bytes of the next fragment that were already returned.
    given: u64,
}

impl DataStream {
    /// Finds the blocks behind `link`; none for link 0.
    pub(super) fn open<R: Read + Seek>(
        blocks: &mut Blocks<R>,
        link: u64,
        unfinished: Unfinished,
    ) -> Result<Self, Located> {
        let mut finder = Finder {
            blocks,
            unfinished,
            fragments: Vec::new(),
        };
        if link != 0 {
            finder.find(link)?;
        }
        Ok(Self {
            fragments: finder.fragments,
            next: 0,
            given: 0,
        })
    }

    /// Returns the size of the whole stream (bytes).
    pub(super) fn bytes(&self) -> u64 {
        let bytes = self.fragments.iter().map(|fragment| fragment.bytes);
        bytes.fold(0, u64::saturating_add)
    }

    /// Appends the next piece to `buffer`; returns false at the end.
    pub(super) fn append<R: Read + Seek>(
        &mut self,
        blocks: &mut Blocks<R>,
        buffer: &mut Vec<u8>,
    ) -> Result<bool, Located> {
        let Some(fragment) = self.fragments.get(self.next) else {
            return Ok(false);
        };
        let columns = match fragment.packing {
            Packing::None => {
                let count = (fragment.bytes - self.given).min(PIECE_BYTES);
                blocks.append(fragment.offset + self.given, count, buffer)?;
                self.given += count;
                if self.given == fragment.bytes {
                    (self.next, self.given) = (self.next + 1, 0);
                }
                return Ok(true);
            }
            Packing::Deflate => 0,
            Packing::Transposed(columns) => columns,
        };
        let mut packed = Vec::new();
        blocks.append(fragment.offset, fragment.stored, &mut packed)?;
        let mut unpacked = vec![0; fragment.bytes as usize];
        let count = decompress_slice_iter_to_slice(
            &mut unpacked,
            [packed.as_slice()].into_iter(),
            true,
            false,
        );
        let fail = |reason| {
            let offset = fragment.offset - PACKED_HEAD_BYTES - HEADER_BYTES;
            (Place::block("##DZ", offset), Problem::Packed { reason })
        };
        match count {
            Ok(count) if count == unpacked.len() => {}
            Ok(_) => return Err(fail("is shorter than the block says")),
            Err(_) => return Err(fail("is no deflate stream of the size that the block says")),
        }
        append_rows(&unpacked, columns as usize, buffer);
        self.next += 1;
        Ok(true)
    }
}

/// Undoes the transposition into `columns`; bytes beyond the last whole row follow unchanged.
fn append_rows(transposed: &[u8], columns: usize, buffer: &mut Vec<u8>) {
    let rows = transposed.len().checked_div(columns).unwrap_or(0);
    let (table, rest) = transposed.split_at(rows * columns);
    let begin = buffer.len();
    buffer.resize(begin + table.len(), 0);
    if rows > 0 {
        for (column, bytes) in table.chunks_exact(rows).enumerate() {
            let places = buffer[begin + column..].iter_mut().step_by(columns);
            places.zip(bytes).for_each(|(place, &byte)| *place = byte);
        }
    }
    buffer.extend_from_slice(rest);
}

struct Finder<'a, R> {
    blocks: &'a mut Blocks<R>,
    unfinished: Unfinished,
    fragments: Vec<Fragment>,
}

impl<R: Read + Seek> Finder<'_, R> {
    fn find(&mut self, link: u64) -> Result<(), Located> {
        let header = self.blocks.head("##DT", link)?;
        match &header.id {
            b"##HL" => {
                let block = self.blocks.block("##HL", link)?;
                match block.link(0) {
                    0 => Ok(()),
                    list => self.list(list),
                }
            }
            b"##DL" => self.list(link),
            _ => self.data(header),
        }
    }

    fn list(&mut self, mut next: u64) -> Result<(), Located> {
        while next != 0 {
            self.blocks.first_visit("##DL", next)?;
            let block = self.blocks.block("##DL", next)?;
            // A list that its logger has not closed has unused entries.
            for &link in block.links().iter().skip(1).filter(|&&link| link != 0) {
                if self.unfinished.is_any && link >= self.blocks.file_bytes {
                    return Ok(());
                }
                let header = self.blocks.head("##DT", link)?;
                self.data(header)?;
            }
            next = block.link(0);
        }
        Ok(())
    }

    fn data(&mut self, header: Header) -> Result<(), Located> {
        self.blocks.first_visit("##DT", header.offset)?;
        let is_cut = header.length > self.blocks.file_bytes - header.offset;
        let fragment = match &header.id {
            // A cut packed block cannot be used in part.
            b"##DZ" if self.unfinished.is_any && is_cut => return Ok(()),
            b"##DT" => self.plain(header)?,
            b"##DZ" => self.packed(header)?,
            _ => return Err(unexpected("##DT", header)),
        };
        if fragment.bytes > 0 {
            self.fragments.push(fragment);
        }
        Ok(())
    }

    fn plain(&self, mut header: Header) -> Result<Fragment, Located> {
        let room = self.blocks.file_bytes - header.offset;
        let is_open = self.unfinished.data_length && header.length <= HEADER_BYTES;
        let is_cut = self.unfinished.is_any && header.length > room;
        if is_open || is_cut {
            header.length = room;
        }
        self.blocks.check_length("##DT", header, 0)?;
        let links = 8 * header.links;
        let bytes = header.length - HEADER_BYTES - links;
        Ok(Fragment {
            offset: header.offset + HEADER_BYTES + links,
            stored: bytes,
            bytes,
            packing: Packing::None,
        })
    }

    fn packed(&mut self, header: Header) -> Result<Fragment, Located> {
        self.blocks
            .check_length("##DZ", header, PACKED_HEAD_BYTES)?;
        let block = self
            .blocks
            .beginning("##DZ", header.offset, PACKED_HEAD_BYTES)?;
        if &block.data()[..2] != b"DT" {
            let found = u64::from(block.u16(0));
            return Err(block.field("the kind of the packed block", found, "\"DT\""));
        }
        let (columns, bytes, stored) = (u64::from(block.u32(4)), block.u64(8), block.u64(16));
        let room = header.length - HEADER_BYTES - 8 * header.links - PACKED_HEAD_BYTES;
        if stored > room {
            let expected = format!("at most {room}");
            return Err(block.field("the size of the packed data", stored, expected));
        }
        let bound = self.blocks.limits.unpacked_bytes;
        if bytes > bound {
            let (budget, found) = (Budget::UnpackedBytes, bytes);
            let problem = Problem::Limit {
                budget,
                found,
                bound,
            };
            return Err((block.place(), problem));
        }
        let possible = stored.saturating_mul(UNPACKED_OVER_PACKED_MAX);
        if bytes > possible {
            let expected = format!("at most {possible}, from {stored} packed bytes");
            return Err(block.field("the size of the unpacked data", bytes, expected));
        }
        let packing = match block.u8(2) {
            0 => Packing::Deflate,
            1 if columns > 0 => Packing::Transposed(columns),
            1 => return Err(block.field("the number of columns", 0, "at least 1")),
            method => {
                let expected = "0 (deflate) or 1 (transposed); save it with one of them";
                return Err(block.field("the packing", u64::from(method), expected));
            }
        };
        Ok(Fragment {
            offset: block.offset + HEADER_BYTES + 8 * header.links + PACKED_HEAD_BYTES,
            stored,
            bytes,
            packing,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::append_rows;

    #[test]
    fn rows_come_back_in_order_and_what_is_no_whole_row_follows() {
        let check = |transposed: &[u8], columns, expected: &[u8]| {
            let mut buffer = vec![99];
            append_rows(transposed, columns, &mut buffer);
            assert_eq!(&buffer[1..], expected);
        };
        check(b"adbecf", 3, b"abcdef");
        check(b"adbecfxy", 3, b"abcdefxy");
        check(b"ab", 3, b"ab");
        check(b"abc", 0, b"abc");
        check(b"", 4, b"");
    }
}
