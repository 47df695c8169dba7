//! Sizes in a Parquet file that its library takes as they are: they are checked before.
//!
//! The library allocates the unpacked size that the header of a page states, and room for the columns that a part of
//! the schema states. Source: Apache Parquet, *parquet.thrift*, `PageHeader`, `FileMetaData` and `SchemaElement`; Apache
//! Thrift, *Compact protocol*.

use super::columns::Budget;
use super::error::{Located, damaged};

/// Nesting of the structures of a header beyond which it is none.
const DEPTH_MAX: u32 = 8;
/// Fields of a header.
const UNPACKED_SIZE: i64 = 2;
const PACKED_SIZE: i64 = 3;
/// Field of the description of a file.
const SCHEMA: i64 = 2;
/// Field of a part of the schema.
const CHILDREN: i64 = 5;
/// Types of the compact protocol.
const TRUE: u8 = 1;
const FALSE: u8 = 2;
const BYTE: u8 = 3;
const DOUBLE: u8 = 7;
const BINARY: u8 = 8;
const LIST: u8 = 9;
const SET: u8 = 10;
const MAP: u8 = 11;
const STRUCT: u8 = 12;

/// Checks that no part of the schema has more columns than the schema has parts.
pub(super) fn check_schema(file: &[u8]) -> Result<(), Located> {
    let footer = || {
        let end = file.len().checked_sub(8)?;
        let length = file.get(end..end + 4)?.try_into().ok()?;
        let begin = end.checked_sub(u32::from_le_bytes(length) as usize)?;
        Some(Header {
            rest: &file[begin..end],
        })
    };
    // The library finds a footer that is missing or cannot be read.
    match footer().and_then(|mut footer| footer.has_sound_schema()) {
        Some(false) => Err(damaged(
            "a part of the schema has more columns than the file",
        )),
        _ => Ok(()),
    }
}

/// Checks the unpacked size of every page of a column; `chunk` has all of its pages.
pub(super) fn check(chunk: &[u8], budget: &Budget) -> Result<(), Located> {
    let mut rest = Header { rest: chunk };
    while !rest.rest.is_empty() {
        // The library reads no page whose header cannot be read.
        let Some([unpacked, packed]) = rest.sizes() else {
            return Ok(());
        };
        let negative = |_| damaged("a page has a negative size");
        budget.check_unpacked(u64::try_from(unpacked).map_err(negative)?)?;
        let packed = usize::try_from(packed).map_err(negative)?;
        let Some(next) = rest.rest.get(packed..) else {
            return Ok(());
        };
        rest.rest = next;
    }
    Ok(())
}

/// Bytes in the compact protocol.
struct Header<'a> {
    rest: &'a [u8],
}

impl Header<'_> {
    /// Reads a page header and returns its unpacked and its packed size (bytes).
    fn sizes(&mut self) -> Option<[i64; 2]> {
        let mut sizes = [0; 2];
        let mut field = 0;
        loop {
            let kind = self.field(&mut field)?;
            match (kind, field) {
                (0, _) => return Some(sizes),
                (4..=6, UNPACKED_SIZE) => sizes[0] = self.integer()?,
                (4..=6, PACKED_SIZE) => sizes[1] = self.integer()?,
                _ => self.skip(kind, 0)?,
            }
        }
    }

    /// Reads the schema of a footer and returns whether its parts have no more columns than there are parts.
    fn has_sound_schema(&mut self) -> Option<bool> {
        let mut field = 0;
        loop {
            match (self.field(&mut field)?, field) {
                (0, _) => return None,
                (LIST, SCHEMA) => break,
                (kind, _) => self.skip(kind, 0)?,
            }
        }
        let (count, _) = self.list()?;
        for _ in 0..count {
            let mut field = 0;
            loop {
                match (self.field(&mut field)?, field) {
                    (0, _) => break,
                    (4..=6, CHILDREN) => {
                        if u64::try_from(self.integer()?).is_ok_and(|children| children > count) {
                            return Some(false);
                        }
                    }
                    (kind, _) => self.skip(kind, 0)?,
                }
            }
        }
        Some(true)
    }

    /// Reads the head of a list and returns the number and the type of its items.
    fn list(&mut self) -> Option<(u64, u8)> {
        let head = self.byte()?;
        let count = match head >> 4 {
            15 => self.varint()?,
            count => u64::from(count),
        };
        Some((count, head & 0x0f))
    }

    /// Reads the head of a field and returns its type; 0 is the end of a structure.
    fn field(&mut self, field: &mut i64) -> Option<u8> {
        let head = self.byte()?;
        let kind = head & 0x0f;
        if kind != 0 {
            match head >> 4 {
                0 => *field = self.integer()?,
                step => *field += i64::from(step),
            }
        }
        Some(kind)
    }

    fn skip(&mut self, kind: u8, depth: u32) -> Option<()> {
        if depth > DEPTH_MAX {
            return None;
        }
        match kind {
            TRUE | FALSE => {}
            BYTE => drop(self.byte()?),
            4..=6 => drop(self.integer()?),
            DOUBLE => self.advance(8)?,
            BINARY => {
                let length = self.varint()?;
                self.advance(length)?;
            }
            LIST | SET => {
                let (count, kind) = self.list()?;
                for _ in 0..count {
                    self.skip_item(kind, depth)?;
                }
            }
            MAP => {
                let count = self.varint()?;
                let kinds = if count > 0 { self.byte()? } else { 0 };
                for _ in 0..count {
                    self.skip_item(kinds >> 4, depth)?;
                    self.skip_item(kinds & 0x0f, depth)?;
                }
            }
            STRUCT => {
                let mut field = 0;
                loop {
                    match self.field(&mut field)? {
                        0 => break,
                        kind => self.skip(kind, depth + 1)?,
                    }
                }
            }
            _ => return None,
        }
        Some(())
    }

    /// Skips an item of a list, where a truth value takes a byte.
    fn skip_item(&mut self, kind: u8, depth: u32) -> Option<()> {
        match kind {
            TRUE | FALSE => self.advance(1),
            kind => self.skip(kind, depth + 1),
        }
    }

    fn byte(&mut self) -> Option<u8> {
        let (&byte, rest) = self.rest.split_first()?;
        self.rest = rest;
        Some(byte)
    }

    fn advance(&mut self, count: u64) -> Option<()> {
        self.rest = self.rest.get(usize::try_from(count).ok()?..)?;
        Some(())
    }

    fn varint(&mut self) -> Option<u64> {
        let mut value = 0_u64;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            value |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(value);
            }
        }
        None
    }

    /// Reads a signed integer in zigzag form.
    fn integer(&mut self) -> Option<i64> {
        let value = self.varint()?;
        Some((value >> 1) as i64 ^ -((value & 1) as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table::Limits;

    /// Header of a page with an unpacked size of 300 and a packed one of 2 bytes, a structure and a truth value.
    const PAGE: &[u8] = &[
        0x15, 0x00, 0x15, 0xd8, 0x04, 0x15, 0x04, 0x2c, 0x15, 0x0a, 0x11, 0x00, 0x12, 0x00, 7, 7,
    ];

    #[test]
    fn the_size_of_every_page_is_checked() {
        let budget = |unpacked_bytes| {
            Budget::new(Limits {
                unpacked_bytes,
                ..Limits::default()
            })
        };
        let two = [PAGE, PAGE].concat();
        assert!(check(&two, &budget(300)).is_ok());
        let (_, problem) = check(&two, &budget(299)).unwrap_err();
        assert_eq!(problem.code(), "E-TAB-LIMIT", "{problem}");
        let mut second_is_larger = two.clone();
        // 0x7f instead of 0x04 in the upper digit: 8188 bytes.
        second_is_larger[PAGE.len() + 4] = 0x7f;
        assert!(check(&second_is_larger, &budget(300)).is_err());
    }

    /// The library would allocate 16 GiB.
    #[test]
    fn a_schema_with_more_columns_than_parts_is_refused() {
        // Version 1, and a schema of one part with 2 147 483 647 columns.
        let footer = [
            0x15, 2, 0x19, 0x1c, 0x55, 0xfe, 0xff, 0xff, 0xff, 0x0f, 0, 0,
        ];
        let file = |footer: &[u8]| {
            let length = (footer.len() as u32).to_le_bytes();
            [&b"PAR1"[..], footer, &length, b"PAR1"].concat()
        };
        let (_, problem) = check_schema(&file(&footer)).unwrap_err();
        assert!(
            problem.to_string().contains("more columns than"),
            "{problem}"
        );
        let sound = [0x15, 2, 0x19, 0x1c, 0x55, 2, 0, 0];
        assert!(check_schema(&file(&sound)).is_ok());
        assert!(check_schema(b"PAR1").is_ok());
    }

    #[test]
    fn any_bytes_end_the_walk() {
        for length in 0..PAGE.len() {
            let _ = check(&PAGE[..length], &Budget::new(Limits::default()));
        }
        let endless = [0x1c; 100];
        assert!(check(&endless, &Budget::new(Limits::default())).is_ok());
    }
}
