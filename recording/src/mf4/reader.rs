use std::collections::BTreeMap;
use std::fs::File as StdFile;
use std::io::{Read, Seek};
use std::path::Path;

use sha2::{Digest as _, Sha256};

use super::blocks::Blocks;
use super::candidates::{Candidates, Source};
use super::choice::{Choice, Column};
use super::error::{Located, Mf4Error, Place, of_file};
use super::problem::Problem;
use super::samples::{self, Samples};
use super::structure::File;
use super::{Limits, notes};
use crate::csv::Mapping;
use crate::csv::header::parse_unit;
use crate::plausibility::Watch;
use crate::{InputFile, OutOfBounds, Quantity, Recording, TimeBase, TimeBaseId, Unit};

/// Options for reading a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// Assignment of channels to signals, where the file does not define it. A channel is named as in the file, or as
    /// `2/NAME` for the one of group 2.
    pub mapping: Mapping,
    /// Budgets of the reader.
    pub limits: Limits,
}

/// Reads all of `input` into a recording. `source_name` is used in messages and in the provenance.
///
/// # Errors
/// Returns the first problem of the file. A channel that cannot be a signal is no error: it is left out, see
/// [`Recording::left_out`].
pub fn read<R: Read + Seek>(
    source_name: &str,
    input: R,
    options: &Options,
) -> Result<Recording, Mf4Error> {
    read_located(source_name, input, options).map_err(|error| Mf4Error::new(source_name, error))
}

/// Reads an MF4 file into a recording.
///
/// # Errors
/// Returns the same errors as [`read`].
pub fn read_file(path: impl AsRef<Path>, options: &Options) -> Result<Recording, Mf4Error> {
    let path = path.as_ref();
    let source_name = path
        .file_name()
        .unwrap_or(path.as_os_str())
        .to_string_lossy();
    let file = StdFile::open(path)
        .map_err(|error| Mf4Error::new(&path.display().to_string(), of_file(Problem::Io(error))))?;
    read(&source_name, file, options)
}

fn read_located<R: Read + Seek>(
    source_name: &str,
    input: R,
    Options { mapping, limits }: &Options,
) -> Result<Recording, Located> {
    let mut blocks = Blocks::new(input, *limits)?;
    let file = File::read(&mut blocks)?;
    let candidates = Candidates::of(&mut blocks, &file)?;
    let choice = Choice::of(&candidates, mapping)?;
    let recording = Recording::new(notes::provenance(source_name, &file));
    let mut recording = read_chosen(&mut blocks, &file, &candidates, &choice, recording, mapping)?;
    recording.provenance_mut().input = Some(identity(&mut blocks)?);
    Ok(recording)
}

/// Reads the chosen channels into a recording.
pub(super) fn read_chosen<R: Read + Seek>(
    blocks: &mut Blocks<R>,
    file: &File,
    candidates: &Candidates,
    choice: &Choice,
    mut recording: Recording,
    mapping: &Mapping,
) -> Result<Recording, Located> {
    for (_, left_out) in &choice.left_out {
        recording.leave_out(&left_out.name, &left_out.reason);
    }
    let mut builder = Builder {
        recording,
        mapping,
        has_lost_group: false,
    };
    builder.add_data(blocks, file, candidates, choice)?;
    builder.finish()?;
    Ok(builder.recording)
}

/// Builder of a recording from the data read.
struct Builder<'a> {
    recording: Recording,
    mapping: &'a Mapping,
    /// Whether the mapping has left out all samples of a group.
    has_lost_group: bool,
}

impl Builder<'_> {
    fn add_data<R: Read + Seek>(
        &mut self,
        blocks: &mut Blocks<R>,
        file: &File,
        candidates: &Candidates,
        choice: &Choice,
    ) -> Result<(), Located> {
        let mut columns: BTreeMap<usize, Vec<&Column>> = BTreeMap::new();
        for column in &choice.columns {
            columns.entry(column.group).or_default().push(column);
        }
        let mut values = 0;
        for (data_group, data) in file.data_groups.iter().enumerate() {
            let mut wanted = Vec::new();
            let mut numbers = Vec::new();
            for (&number, columns) in &columns {
                let group = &candidates.groups[number - 1];
                if let (true, Ok(master)) = (group.data_group == data_group, &group.master) {
                    let sources = columns.iter().map(|column| &column.source);
                    let sources: Vec<&Source> = std::iter::once(master).chain(sources).collect();
                    wanted.push(Samples::of(group.channel_group, sources));
                    numbers.push((group.channel_group, number));
                }
            }
            if wanted.is_empty() {
                continue;
            }
            let unfinished = file.unfinished;
            let (found, rest) = samples::read(blocks, data, unfinished, wanted, &mut values)?;
            if rest > 0 {
                notes::add_rest(self.recording.provenance_mut(), rest);
            }
            for samples in found {
                let number = numbers.iter().find(|(at, _)| *at == samples.channel_group);
                if let Some((_, number)) = number {
                    let unit = &candidates.groups[number - 1].time_unit;
                    self.add_group(unit, &columns[number], samples)?;
                }
            }
        }
        Ok(())
    }

    fn add_group(
        &mut self,
        time_unit: &str,
        columns: &[&Column],
        samples: Samples<'_>,
    ) -> Result<(), Located> {
        let mut rows = samples.rows.into_iter();
        let times = rows.next().unwrap_or_default();
        let (base, kept) = match self.time_base(time_unit, times) {
            Ok(base) => base,
            Err(reason) => {
                for column in columns {
                    self.recording.leave_out(&column.name, &reason);
                }
                return Ok(());
            }
        };
        let counts = samples.not_a_number.iter().skip(1);
        for ((column, mut row), &not_a_number) in columns.iter().zip(rows).zip(counts) {
            row.truncate(kept.end);
            row.drain(..kept.start);
            let conversion = column.conversion;
            row.iter_mut()
                .for_each(|value| *value = conversion.value(*value));
            if let Some(sample) = row.iter().position(|value| value.is_infinite()) {
                let sample = kept.start + sample;
                let reason = format!("sample {sample} is infinite; correct its conversion");
                self.recording.leave_out(&column.name, reason);
                continue;
            }
            let outside = keep_plausible(column, kept.start as u64, &mut row)?;
            if let Some(cells) = outside {
                self.recording.add_out_of_bounds(cells);
            }
            let provenance = self.recording.provenance_mut();
            notes::add_column(provenance, column, not_a_number);
            let added = self
                .recording
                .add_signal(&*column.name, column.unit, base, row);
            if let Err(error) = added.map(drop) {
                self.recording.leave_out(&column.name, error.to_string());
            }
        }
        Ok(())
    }

    /// Returns the time base of these instants and the kept ones among them, or the reason why they form none.
    fn time_base(
        &mut self,
        unit: &str,
        mut times: Vec<f64>,
    ) -> Result<(TimeBaseId, std::ops::Range<usize>), String> {
        if times.is_empty() {
            return Err("its group has no samples".to_owned());
        }
        let unit = match unit {
            "" => Unit::Second,
            unit => parse_unit(unit, None)
                .ok()
                .filter(|unit| unit.quantity() == Quantity::Time)
                .ok_or("the time of its group is in no unit of time")?,
        };
        let to_seconds = unit
            .converter(Unit::Second)
            .map_err(|error| error.to_string())?;
        if unit != Unit::Second {
            let convert = |time: &mut f64| *time = to_seconds.apply(*time);
            times.iter_mut().for_each(convert);
        }
        let time_base = TimeBase::new(times).map_err(|error| error.to_string())?;
        let window = self.mapping.rows;
        let times_s = time_base.times_s();
        let kept = times_s.partition_point(|&time_s| time_s < window.from_s)
            ..times_s.partition_point(|&time_s| time_s <= window.until_s);
        let time_base = match kept.len() == times_s.len() {
            true => time_base,
            false => TimeBase::new(times_s[kept.clone()].to_vec()).map_err(|_| {
                self.has_lost_group = true;
                "[rows] in the mapping leaves none of its samples".to_owned()
            })?,
        };
        // Groups that were sampled together share their instants, so that their signals can be read row by row.
        let known = self
            .recording
            .time_bases()
            .find(|(_, known)| **known == time_base)
            .map(|(id, _)| id);
        let id = known.unwrap_or_else(|| self.recording.add_time_base(time_base));
        Ok((id, kept))
    }

    fn finish(&mut self) -> Result<(), Located> {
        if self.recording.signals().is_empty() {
            return Err(of_file(match self.has_lost_group {
                true => Problem::NoRowKept,
                false => Problem::NoSignal {
                    left_out: notes::first_left_out(&self.recording),
                },
            }));
        }
        if let Some(name) = &self.mapping.instants_of {
            let base = self.recording.signal(name).map(|one| one.time_base());
            let known = base.and_then(|base| self.recording.known_at(base));
            let absent = || of_file(Problem::NoInstants { name: name.clone() });
            self.recording = known.ok_or_else(absent)?;
            notes::add_instants(self.recording.provenance_mut(), name);
        }
        for (name, constant) in &self.mapping.constants {
            if constant.where_absent && self.recording.signal(name).is_some() {
                continue;
            }
            let mut bases = self.recording.time_bases();
            let (base, instants) = match (bases.next(), bases.next()) {
                (Some((base, times)), None) => (base, times.len()),
                _ => {
                    let name = name.clone();
                    return Err(of_file(Problem::ConstantTimeBase { name }));
                }
            };
            drop(bases);
            let row = vec![constant.value; instants];
            let added = self
                .recording
                .add_signal(&**name, constant.unit, base, row)
                .map(drop);
            if added.is_err() {
                return Err(of_file(Problem::ConstantLogged { name: name.clone() }));
            }
        }
        Ok(())
    }
}

/// Replaces values out of bounds by missing ones and returns them. Refuses a channel whose values cannot have its unit.
/// The first of the values is sample `first`.
fn keep_plausible(
    column: &Column,
    first: u64,
    values: &mut [f64],
) -> Result<Option<OutOfBounds>, Located> {
    let fail = |(sample, implausible)| {
        let problem = Problem::Implausible {
            sample,
            implausible,
        };
        (Place::channel(&column.name), problem)
    };
    let mut watch = Watch::new(&column.name, column.unit, column.check_scale, None)
        .narrowed_to(column.plausible.as_ref());
    let present = (first..).zip(values).filter(|(_, value)| !value.is_nan());
    for (sample, value) in present {
        let taken = watch.take(*value, sample);
        *value = taken.map_err(|implausible| fail((sample, implausible)))?;
    }
    watch
        .judge(&column.name, || column.key.clone(), true)
        .map_err(fail)?;
    Ok(watch.outside().cloned())
}

/// Returns size and hash of the whole file.
fn identity<R: Read + Seek>(blocks: &mut Blocks<R>) -> Result<InputFile, Located> {
    let size_bytes = blocks.file_bytes;
    let mut hash = Sha256::new();
    let mut piece = vec![0; 1 << 18];
    let input = blocks.rewound()?;
    loop {
        match input.read(&mut piece) {
            Ok(0) => break,
            Ok(count) => hash.update(&piece[..count]),
            Err(error) if error.kind() == std::io::ErrorKind::Interrupted => {}
            Err(error) => return Err(of_file(Problem::Io(error))),
        }
    }
    Ok(InputFile {
        size_bytes,
        sha256: hash.finalize().into(),
    })
}
