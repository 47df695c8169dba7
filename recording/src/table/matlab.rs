//! MATLAB files of version 5, which `save -v6` and `save -v7` write: numeric arrays, and those in structures.
//!
//! Source: MATLAB, *MAT-File Format*, R2023b. The crate `matfile` reads the same arrays, but neither names what it
//! skips nor bounds what it unpacks.

use super::Limits;
use super::columns::{Budget, Columns, NumberColumn};
use super::error::{Located, damaged};
use super::numeric::{PATH_BYTES_MAX, add_array, header_of};

/// Size of the header of a file (bytes).
const HEADER_BYTES: usize = 128;
/// Nesting of structures beyond which nothing is read.
const DEPTH_MAX: usize = 8;
/// Types of data elements.
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
/// Flag of an array of complex numbers.
const COMPLEX: u32 = 0x0800;

/// Returns the columns of a file.
pub(super) fn columns(bytes: &[u8], limits: Limits) -> Result<Columns, Located> {
    let header = bytes
        .get(..HEADER_BYTES)
        .ok_or_else(|| damaged("it ends within its header"))?;
    let is_big = match &header[126..] {
        b"IM" => false,
        b"MI" => true,
        _ => return Err(damaged("its header states no byte order")),
    };
    let text = String::from_utf8_lossy(&header[..116]);
    let text = text.trim_end_matches(['\0', ' ']);
    let mut found = Finder {
        columns: Vec::new(),
        budget: Budget::new(limits),
        limits,
    };
    let mut file = Bytes {
        rest: &bytes[HEADER_BYTES..],
        is_big,
    };
    let mut variables = 0;
    while !file.rest.is_empty() {
        variables += 1;
        found.budget.check_columns(variables)?;
        let (kind, data) = file.element(false)?;
        match kind {
            COMPRESSED => {
                let most = usize::try_from(limits.unpacked_bytes).unwrap_or(usize::MAX);
                let unpacked = miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(data, most);
                let unpacked = unpacked.map_err(|error| match error.status {
                    miniz_oxide::inflate::TINFLStatus::HasMoreOutput => {
                        match found
                            .budget
                            .check_unpacked(limits.unpacked_bytes.saturating_add(1))
                        {
                            Err(located) => located,
                            Ok(()) => damaged("a packed variable is too long"),
                        }
                    }
                    _ => damaged("a packed variable cannot be unpacked"),
                })?;
                let mut inner = Bytes {
                    rest: &unpacked,
                    is_big,
                };
                if let (MATRIX, data) = inner.element(true)? {
                    found.add(Bytes { rest: data, is_big }, None, 0)?;
                }
            }
            MATRIX => found.add(Bytes { rest: data, is_big }, None, 0)?,
            _ => {}
        }
    }
    Ok(Columns {
        layout: "MATLAB v5/v7".to_owned(),
        producer: Some(text.to_owned()).filter(|text| !text.is_empty()),
        columns: found.columns,
    })
}

/// Bytes with their order.
#[derive(Clone, Copy)]
struct Bytes<'a> {
    rest: &'a [u8],
    is_big: bool,
}

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], Located> {
        let (taken, rest) = self
            .rest
            .split_at_checked(count)
            .ok_or_else(|| damaged("it ends within a variable"))?;
        self.rest = rest;
        Ok(taken)
    }

    fn word(&mut self) -> Result<u32, Located> {
        let word = self.take(4)?;
        let word = [word[0], word[1], word[2], word[3]];
        Ok(match self.is_big {
            true => u32::from_be_bytes(word),
            false => u32::from_le_bytes(word),
        })
    }

    /// Returns type and data of the next element. Inside of a variable, elements are padded to eight bytes.
    fn element(&mut self, is_padded: bool) -> Result<(u32, &'a [u8]), Located> {
        let tag = self.word()?;
        // A short element has its size in the upper half of the type, and at most four bytes.
        if tag >> 16 != 0 {
            let count = (tag >> 16) as usize;
            let data = self.take(4)?;
            let data = data
                .get(..count)
                .ok_or_else(|| damaged("a short element has more than four bytes"))?;
            return Ok((tag & 0xffff, data));
        }
        let count = self.word()? as usize;
        let data = self.take(count)?;
        if is_padded {
            let padding = count.next_multiple_of(8) - count;
            self.rest = self.rest.get(padding..).unwrap_or(&[]);
        }
        Ok((tag, data))
    }
}

struct Finder {
    columns: Vec<NumberColumn>,
    budget: Budget,
    limits: Limits,
}

impl Finder {
    /// Adds the variable with these bytes; `path` is its name inside of a structure.
    fn add(
        &mut self,
        mut bytes: Bytes<'_>,
        path: Option<&str>,
        depth: usize,
    ) -> Result<(), Located> {
        self.budget.check_columns(self.columns.len())?;
        // An empty cell of a structure has no content at all.
        if bytes.rest.is_empty() {
            self.refuse(path.unwrap_or(""), "it is empty");
            return Ok(());
        }
        let (_, flags) = bytes.element(true)?;
        let flags = Bytes {
            rest: flags,
            is_big: bytes.is_big,
        }
        .word()?;
        let class = flags & 0xff;
        // An opaque object has no dimensions.
        let is_opaque = class == 17;
        let dimensions = match is_opaque {
            true => Vec::new(),
            false => numbers(bytes.element(true)?, bytes.is_big)?,
        };
        let (_, name) = bytes.element(true)?;
        let own = String::from_utf8_lossy(name).into_owned();
        let path = path.map_or(own, str::to_owned);
        if path.len() > PATH_BYTES_MAX {
            return Err(damaged("a name has more than 256 bytes"));
        }
        match class {
            2 => return self.add_structure(bytes, &path, &dimensions, depth),
            6..=15 if flags & COMPLEX != 0 => self.refuse(&path, "complex numbers"),
            6..=15 => {
                let count = dimensions.iter().product::<f64>();
                // Refused before the numbers are taken: the product may be that of a damaged file.
                self.budget.take_values(count as u64)?;
                let values = numbers(bytes.element(true)?, bytes.is_big)?;
                if values.len() as f64 != count {
                    return Err(damaged(
                        "an array has another number of values than its dimensions",
                    ));
                }
                let dimensions: Vec<u64> = dimensions.iter().map(|&length| length as u64).collect();
                let header = header_of(&path);
                add_array(&mut self.columns, &path, &header, &dimensions, values);
                self.budget.check_columns(self.columns.len())?;
            }
            1 => self.refuse(&path, "a cell array"),
            4 => self.refuse(&path, "a text"),
            5 => self.refuse(&path, "a sparse matrix"),
            16 => self.refuse(&path, "a function"),
            _ => self.refuse(
                &path,
                "an object such as a timetable or timeseries; save its times and data as arrays",
            ),
        }
        Ok(())
    }

    fn add_structure(
        &mut self,
        mut bytes: Bytes<'_>,
        path: &str,
        dimensions: &[f64],
        depth: usize,
    ) -> Result<(), Located> {
        if depth == DEPTH_MAX {
            self.refuse(path, "structures are nested more than eight deep");
            return Ok(());
        }
        let length = numbers(bytes.element(true)?, bytes.is_big)?;
        let length = length.first().map_or(0, |&length| length as usize);
        let (_, names) = bytes.element(true)?;
        if length == 0 {
            return Ok(());
        }
        let names: Vec<String> = names
            .chunks(length)
            .map(|name| {
                String::from_utf8_lossy(name)
                    .trim_end_matches('\0')
                    .to_owned()
            })
            .collect();
        let elements = dimensions.iter().product::<f64>() as u64;
        self.budget
            .check_columns(names.len().max(elements as usize))?;
        for element in 0..elements {
            let begin = self.columns.len();
            let mut label = None;
            let parent = match elements {
                1 => path.to_owned(),
                _ => format!("{path}({})", element + 1),
            };
            for name in &names {
                let (kind, data) = bytes.element(true)?;
                if kind != MATRIX {
                    return Err(damaged("a field of a structure is no array"));
                }
                let field = Bytes {
                    rest: data,
                    is_big: bytes.is_big,
                };
                if name == "label" {
                    label = text(field);
                }
                self.add(field, Some(&format!("{parent}.{name}")), depth + 1)?;
            }
            // Simulink names the values of a structure by a text beside them.
            let Some(label) = label.filter(|label| !label.is_empty()) else {
                continue;
            };
            for column in &mut self.columns[begin..] {
                if let Some(place) = column.key.strip_prefix(&format!("{parent}.values")) {
                    column.header = format!("{label}{place}");
                }
            }
        }
        Ok(())
    }

    fn refuse(&mut self, path: &str, reason: &str) {
        if self.columns.len() <= self.limits.columns {
            let column = NumberColumn::new(path, &header_of(path), Err(reason.to_owned()));
            self.columns.push(column);
        }
    }
}

/// Returns the text of an array of characters.
fn text(mut bytes: Bytes<'_>) -> Option<String> {
    let (_, flags) = bytes.element(true).ok()?;
    let class = Bytes {
        rest: flags,
        is_big: bytes.is_big,
    }
    .word()
    .ok()?;
    bytes.element(true).ok()?;
    bytes.element(true).ok()?;
    let (kind, data) = bytes.element(true).ok()?;
    match (class & 0xff, kind) {
        (4, 16) => Some(String::from_utf8_lossy(data).into_owned()),
        (4, 1 | 2 | 4 | 17) => {
            let units = numbers((if kind == 17 { 4 } else { kind }, data), bytes.is_big).ok()?;
            let units: Vec<u16> = units.iter().map(|&unit| unit as u16).collect();
            Some(String::from_utf16_lossy(&units))
        }
        _ => None,
    }
}

/// Returns the numbers of an element.
fn numbers((kind, data): (u32, &[u8]), is_big: bool) -> Result<Vec<f64>, Located> {
    /// Converts the bytes of one type.
    macro_rules! of {
        ($type:ty) => {{
            const SIZE: usize = size_of::<$type>();
            let chunks = data.chunks_exact(SIZE);
            if !chunks.remainder().is_empty() {
                return Err(damaged("an array ends within a number"));
            }
            chunks
                .map(|bytes| {
                    let mut number = [0; SIZE];
                    number.copy_from_slice(bytes);
                    match is_big {
                        true => <$type>::from_be_bytes(number) as f64,
                        false => <$type>::from_le_bytes(number) as f64,
                    }
                })
                .collect()
        }};
    }
    Ok(match kind {
        1 => of!(i8),
        2 => of!(u8),
        3 => of!(i16),
        4 => of!(u16),
        5 => of!(i32),
        6 => of!(u32),
        7 => of!(f32),
        9 => of!(f64),
        12 => of!(i64),
        13 => of!(u64),
        _ => {
            return Err(damaged(format_args!(
                "an array has data of the unknown type {kind}"
            )));
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns a file with one row of numbers, with the high byte first.
    fn big_endian(name: &[u8; 4], numbers: &[i16]) -> Vec<u8> {
        let mut bytes = vec![b' '; 124];
        bytes.extend([1, 0, b'M', b'I']);
        let data = 2 * numbers.len();
        let words = |bytes: &mut Vec<u8>, words: &[u32]| {
            bytes.extend(words.iter().flat_map(|word| word.to_be_bytes()));
        };
        let size = 16 + 16 + 8 + 8 + data.next_multiple_of(8);
        words(&mut bytes, &[MATRIX, size as u32, 6, 8, 6, 0]);
        words(&mut bytes, &[5, 8, 1, numbers.len() as u32]);
        // A short element: its size is in the upper half of its type.
        words(&mut bytes, &[(4 << 16) | 1]);
        bytes.extend(name);
        words(&mut bytes, &[3, data as u32]);
        bytes.extend(numbers.iter().flat_map(|number| number.to_be_bytes()));
        bytes.resize(128 + 8 + size, 0);
        bytes
    }

    #[test]
    fn numbers_with_the_high_byte_first_are_read() {
        let bytes = big_endian(b"p_ch", &[1, -2, 300]);
        let read = columns(&bytes, Limits::default()).unwrap();
        assert_eq!(read.columns[0].key, "p_ch");
        assert_eq!(read.columns[0].numbers, Ok(vec![1.0, -2.0, 300.0]));
    }

    #[test]
    fn dimensions_that_are_not_those_of_the_numbers_are_refused() {
        let mut bytes = big_endian(b"p_ch", &[1, -2, 300]);
        let columns_of = |bytes: &[u8]| columns(bytes, Limits::default()).map(|_| ());
        bytes[128 + 24 + 15] = 4;
        let (_, problem) = columns_of(&bytes).unwrap_err();
        assert!(
            problem.to_string().contains("than its dimensions"),
            "{problem}"
        );
        bytes[128 + 24 + 12] = 0x7f;
        let (_, problem) = columns_of(&bytes).unwrap_err();
        assert_eq!(problem.code(), "E-TAB-LIMIT", "{problem}");
    }
}
