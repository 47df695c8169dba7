//! Journal of an unfinished run: its settings, then chunks of finished rows in the order in which they end.
//!
//! A record is the number of its first rig, its length and its checksum, then its bytes. A kill can cut off the last
//! record only, which is then computed again.

use core::ops::Range;
use std::collections::BTreeMap;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufReader, ErrorKind, Read, Seek as _, SeekFrom, Write};
use std::path::{Path, PathBuf};

use bytes::Bytes;
use hil_protocol::crc32;

use super::error::MonteCarloError;
use super::row::RigRow;
use super::settings::RunSettings;
use super::summary::Summary;
use super::table::{RowReader, RowWriter, TableError};

/// First bytes of a journal, with its version.
const MAGIC: &[u8] = b"retarder rigs, unfinished, version 1\n";
/// Number of rigs of a chunk. Chunks end at multiples of it.
pub(super) const CHUNK_RIGS: u32 = 64;
/// Largest record (bytes).
const RECORD_BYTES_MAX: u32 = 1 << 28;
/// Name of the setting with the rigs of the shard.
const SHARD: &str = "shard";

/// Finished rows of an unfinished run, on the disk.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
    settings: RunSettings,
    rigs: Range<u32>,
    /// Place of each chunk, by its first rig.
    chunks: BTreeMap<u32, Place>,
    /// End of the last whole record.
    end: u64,
}

#[derive(Clone, Copy, Debug)]
struct Place {
    begin: u64,
    length: u32,
}

impl Journal {
    /// Returns the path of the journal of an output.
    pub fn path_of(out: &Path) -> PathBuf {
        let mut name = out.as_os_str().to_owned();
        name.push(".part");
        name.into()
    }

    /// Opens the journal of a run, or creates it. `rigs` are those of the shard.
    ///
    /// # Errors
    /// Returns an error if another process uses it, or if it belongs to another run.
    pub fn open(
        path: PathBuf,
        settings: &RunSettings,
        rigs: Range<u32>,
    ) -> Result<Self, MonteCarloError> {
        let failed = |path: &Path, error| MonteCarloError::Journal {
            path: path.to_path_buf(),
            error,
        };
        let mut options = OpenOptions::new();
        let options = options.read(true).write(true).create(true).truncate(false);
        let file = options.open(&path).map_err(|error| failed(&path, error))?;
        // A file system without locks does not keep two runs apart.
        if matches!(file.try_lock(), Err(TryLockError::WouldBlock)) {
            return Err(MonteCarloError::InUse { path });
        }
        let mut journal = Self {
            path,
            file,
            settings: settings.clone(),
            rigs,
            chunks: BTreeMap::new(),
            end: 0,
        };
        journal.load()?;
        Ok(journal)
    }

    /// Returns the settings of the run and the rigs of the shard.
    fn header(&self) -> RunSettings {
        let Range { start, end } = self.rigs;
        let rigs = match end > start {
            true => format!("rigs {start} to {}", end - 1),
            false => "no rigs".to_owned(),
        };
        self.settings.with(SHARD, rigs)
    }

    /// Reads the settings and the places of all chunks. A file that ends within its settings has no chunk yet.
    fn load(&mut self) -> Result<(), MonteCarloError> {
        let failed = |error| self.failed(error);
        let file = self.file.try_clone().map_err(failed)?;
        let mut reader = BufReader::new(file);
        let mut magic = Vec::new();
        let mut beginning = reader.by_ref().take(MAGIC.len() as u64);
        beginning.read_to_end(&mut magic).map_err(failed)?;
        if !MAGIC.starts_with(&magic) {
            return Err(MonteCarloError::NoJournal {
                path: self.path.clone(),
            });
        }
        let header = match magic == MAGIC {
            true => read_record(&mut reader).map_err(failed)?,
            false => None,
        };
        let Some(header) = header else {
            return self.begin().map_err(|error| self.failed(error));
        };
        let stored = RunSettings::from_bytes(&header.bytes);
        let stored = stored.ok_or_else(|| self.damaged("its settings cannot be read"))?;
        if let Some(difference) = stored.difference(&self.header()) {
            return Err(MonteCarloError::OtherSettings {
                path: self.path.clone(),
                difference,
            });
        }
        self.end = MAGIC.len() as u64 + header.size();
        while let Some(record) = read_record(&mut reader).map_err(|error| self.failed(error))? {
            let place = Place {
                begin: self.end,
                length: record.bytes.len() as u32,
            };
            self.chunks.insert(record.first_rig, place);
            self.end += record.size();
        }
        self.file
            .set_len(self.end)
            .map_err(|error| self.failed(error))
    }

    fn begin(&mut self) -> io::Result<()> {
        self.file.set_len(0)?;
        self.file.rewind()?;
        let header = record(self.rigs.start, &self.header().to_bytes())?;
        // At once: a journal has its whole header, or it is empty.
        let beginning = [MAGIC, &header[..]].concat();
        self.file.write_all(&beginning)?;
        self.file.sync_data()?;
        self.end = beginning.len() as u64;
        Ok(())
    }

    /// Writes a record behind the last one; returns its place.
    fn append(&mut self, first_rig: u32, bytes: &[u8]) -> io::Result<Place> {
        let record = record(first_rig, bytes)?;
        self.file.seek(SeekFrom::Start(self.end))?;
        self.file.write_all(&record)?;
        self.file.sync_data()?;
        let place = Place {
            begin: self.end,
            length: bytes.len() as u32,
        };
        self.end += record.len() as u64;
        Ok(place)
    }

    /// Keeps the rows of a chunk.
    pub(super) fn keep(&mut self, rows: Vec<RigRow>) -> Result<(), MonteCarloError> {
        let Some(first_rig) = rows.first().map(|row| row.rig) else {
            return Ok(());
        };
        let packed = || {
            let mut table = RowWriter::new(Vec::new(), &RunSettings::new([]))?;
            rows.into_iter().try_for_each(|row| table.push(row))?;
            table.finish()
        };
        let kept = packed().and_then(|bytes| self.append(first_rig, &bytes));
        let place = kept.map_err(|error| self.failed(error))?;
        self.chunks.insert(first_rig, place);
        Ok(())
    }

    /// Returns the rigs of each chunk of the shard.
    pub(super) fn all_chunks(&self) -> impl Iterator<Item = Range<u32>> + use<> {
        let Range { start, end } = self.rigs;
        let chunks = start / CHUNK_RIGS..end.div_ceil(CHUNK_RIGS);
        let chunks = chunks.map(move |chunk| {
            let first = chunk * CHUNK_RIGS;
            first.max(start)..first.saturating_add(CHUNK_RIGS).min(end)
        });
        // A shard without rigs has no chunk.
        chunks.filter(|chunk| !chunk.is_empty())
    }

    /// Returns whether the rows of this chunk are kept.
    pub(super) fn has(&self, chunk: &Range<u32>) -> bool {
        self.chunks.contains_key(&chunk.start)
    }

    /// Returns the number of rigs of the shard.
    pub fn rigs(&self) -> u32 {
        self.rigs.end - self.rigs.start
    }

    /// Returns the number of rigs whose rows are kept.
    pub fn done(&self) -> u32 {
        let done = self.all_chunks().filter(|chunk| self.has(chunk));
        done.map(|chunk| chunk.end - chunk.start).sum()
    }

    /// Returns a row that is kept; `None` if there is none yet.
    pub(super) fn any_row(&self) -> Result<Option<RigRow>, MonteCarloError> {
        let mut chunks = self.all_chunks().filter(|chunk| self.has(chunk));
        let rows = chunks.next().map(|chunk| self.rows(&chunk)).transpose()?;
        Ok(rows.and_then(|rows| rows.into_iter().next()))
    }

    /// Reads the rows of a kept chunk.
    fn rows(&self, chunk: &Range<u32>) -> Result<Vec<RigRow>, MonteCarloError> {
        let range = format!("rigs {} to {}", chunk.start, chunk.end - 1);
        let Some(place) = self.chunks.get(&chunk.start) else {
            return Err(self.damaged(&format!("{range} are missing")));
        };
        let read = || -> io::Result<Vec<u8>> {
            let mut file = &self.file;
            file.seek(SeekFrom::Start(place.begin))?;
            let record = read_record(&mut file)?;
            let record = record.filter(|record| record.bytes.len() as u32 == place.length);
            Ok(record.ok_or(ErrorKind::UnexpectedEof)?.bytes)
        };
        let bytes = read().map_err(|error| self.failed(error))?;
        let rows = RowReader::open(Bytes::from(bytes)).and_then(Iterator::collect);
        let rows: Vec<RigRow> =
            rows.map_err(|error: TableError| self.damaged(&error.to_string()))?;
        match rows.iter().map(|row| row.rig).eq(chunk.clone()) {
            true => Ok(rows),
            false => Err(self.damaged(&format!("{range} are incomplete"))),
        }
    }

    /// Writes all rows to `sink` as a table, in the order of the rigs.
    ///
    /// # Errors
    /// Returns an error if a chunk is missing or cannot be read, or the sink's error.
    pub fn write<W: Write + Send>(&self, sink: W) -> Result<(W, Summary), MonteCarloError> {
        let mut table = RowWriter::new(sink, &self.settings).map_err(MonteCarloError::Write)?;
        let mut summary = Summary::default();
        for chunk in self.all_chunks() {
            for row in self.rows(&chunk)? {
                summary.add(&row);
                table.push(row).map_err(MonteCarloError::Write)?;
            }
        }
        let sink = table.finish().map_err(MonteCarloError::Write)?;
        Ok((sink, summary))
    }

    /// Removes the journal, after its rows are at their place.
    ///
    /// # Errors
    /// Returns an error if the file cannot be removed.
    pub fn remove(self) -> Result<(), MonteCarloError> {
        fs::remove_file(&self.path).map_err(|error| self.failed(error))
    }

    pub(super) fn other_program(&self, rig: u32) -> MonteCarloError {
        MonteCarloError::OtherProgram {
            path: self.path.clone(),
            rig,
        }
    }

    pub(super) fn interrupted(&self) -> MonteCarloError {
        MonteCarloError::Interrupted {
            path: self.path.clone(),
            done: self.done(),
            rigs: self.rigs(),
        }
    }

    fn failed(&self, error: io::Error) -> MonteCarloError {
        MonteCarloError::Journal {
            path: self.path.clone(),
            error,
        }
    }

    fn damaged(&self, reason: &str) -> MonteCarloError {
        MonteCarloError::DamagedJournal {
            path: self.path.clone(),
            reason: reason.to_owned(),
        }
    }
}

struct Record {
    first_rig: u32,
    bytes: Vec<u8>,
}

impl Record {
    /// Number of words before the bytes: first rig, length, checksum.
    const HEAD_WORDS: usize = 3;

    /// Returns the size with its head (bytes).
    fn size(&self) -> u64 {
        (4 * Self::HEAD_WORDS + self.bytes.len()) as u64
    }
}

/// Reads the next record; `None` if it is incomplete, or there is none.
fn read_record(reader: &mut impl Read) -> io::Result<Option<Record>> {
    let mut head = [0; 4 * Record::HEAD_WORDS];
    match reader.read_exact(&mut head) {
        Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(None),
        read => read?,
    }
    let mut words = head.chunks_exact(4).map(|word| match *word {
        [a, b, c, d] => u32::from_le_bytes([a, b, c, d]),
        _ => 0,
    });
    let mut word = || words.next().unwrap_or_default();
    let [first_rig, length, checksum] = [word(), word(), word()];
    let mut bytes = Vec::new();
    if length <= RECORD_BYTES_MAX {
        reader.take(length.into()).read_to_end(&mut bytes)?;
    }
    let is_whole = bytes.len() as u32 == length && crc32::digest(&bytes) == checksum;
    Ok(is_whole.then_some(Record { first_rig, bytes }))
}

/// Returns the bytes of a record: its first rig, the length and the checksum of its content, and the content.
fn record(first_rig: u32, bytes: &[u8]) -> io::Result<Vec<u8>> {
    let length = u32::try_from(bytes.len()).ok();
    let length = length.filter(|&length| length <= RECORD_BYTES_MAX);
    let length = length.ok_or_else(|| io::Error::other("a record is too large"))?;
    let head = [first_rig, length, crc32::digest(bytes)];
    Ok([&head.map(u32::to_le_bytes).concat(), bytes].concat())
}
