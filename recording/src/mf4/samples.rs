//! Conversion of the records of a data group into samples of its channels.

use std::collections::HashMap;
use std::io::{Read, Seek};

use super::blocks::Blocks;
use super::candidates::{Source, Validity};
use super::data::DataStream;
use super::error::{Located, Place};
use super::layout::RecordShape;
use super::problem::{Budget, Problem};
use super::structure::{DataGroup, Unfinished};

/// Number of bytes before a record of variable length that give its length.
const LENGTH_BYTES: usize = 4;

/// Samples of some channels of one group.
pub(super) struct Samples<'a> {
    /// Number of the group within the data group, from 0.
    pub(super) channel_group: usize,
    sources: Vec<&'a Source>,
    /// One row of samples per source; NaN where invalid.
    pub(super) rows: Vec<Vec<f64>>,
    /// Number of samples of each source that are NaN although valid.
    pub(super) not_a_number: Vec<u64>,
}

impl<'a> Samples<'a> {
    pub(super) fn of(channel_group: usize, sources: Vec<&'a Source>) -> Self {
        Self {
            channel_group,
            rows: vec![Vec::new(); sources.len()],
            not_a_number: vec![0; sources.len()],
            sources,
        }
    }
}

/// Reads the records of a data group into `wanted`. Returns it with the number of bytes that belong to no whole record.
/// `values` counts the samples of the whole file against the budget.
pub(super) fn read<'a, R: Read + Seek>(
    blocks: &mut Blocks<R>,
    group: &DataGroup,
    unfinished: Unfinished,
    wanted: Vec<Samples<'a>>,
    values: &mut u64,
) -> Result<(Vec<Samples<'a>>, u64), Located> {
    let mut stream = DataStream::open(blocks, group.data, unfinished)?;
    let place = || Place::block("##DG", group.offset);
    let routes = routes(group, unfinished, wanted);
    let numbers = routes.iter().map(|route| route.record_id);
    let mut decoder = Decoder {
        record_id_bytes: group.record_id_bytes,
        index: numbers.zip(0..).collect(),
        routes,
        skip: 0,
        samples_max: blocks.limits.samples,
        values_max: blocks.limits.values,
        values,
    };
    decoder
        .reserve(stream.bytes())
        .map_err(|problem| (place(), problem))?;
    let mut buffer = Vec::new();
    while stream.append(blocks, &mut buffer)? {
        let used = decoder
            .take(&buffer)
            .map_err(|problem| (place(), problem))?;
        buffer.drain(..used);
    }
    let mut samples = Vec::new();
    for route in decoder.routes {
        let Some(found) = route.samples else { continue };
        if !unfinished.is_any && route.records < route.records_max {
            let offset = group.channel_groups[found.channel_group].offset;
            let problem = Problem::DataShort {
                samples: route.records_max,
                found: route.records,
            };
            return Err((Place::block("##CG", offset), problem));
        }
        samples.push(found);
    }
    Ok((samples, buffer.len() as u64))
}

/// Decoder of a stream into records, and of records into samples.
struct Decoder<'a, 'v> {
    record_id_bytes: usize,
    routes: Vec<Route<'a>>,
    /// Index of the route for each group number.
    index: HashMap<u64, usize>,
    /// Number of bytes left in a record of variable length.
    skip: u64,
    samples_max: u64,
    values_max: u64,
    values: &'v mut u64,
}

/// Treatment of the records of one group.
struct Route<'a> {
    record_id: u64,
    has_variable_length: bool,
    /// Size of a record with its group number (bytes).
    stride: usize,
    /// Number of bytes before the invalidation bits.
    validity_at: usize,
    records: u64,
    records_max: u64,
    samples: Option<Samples<'a>>,
}

fn routes<'a>(
    group: &DataGroup,
    unfinished: Unfinished,
    wanted: Vec<Samples<'a>>,
) -> Vec<Route<'a>> {
    let mut routes: Vec<Route<'a>> = group
        .channel_groups
        .iter()
        .map(|channel_group| {
            let is_uncounted =
                unfinished.is_any && (unfinished.counts || channel_group.records == 0);
            let validity_at = group.record_id_bytes + channel_group.data_bytes;
            Route {
                record_id: channel_group.record_id,
                has_variable_length: channel_group.has_variable_length,
                stride: validity_at + channel_group.invalidation_bytes,
                validity_at,
                records: 0,
                records_max: match is_uncounted {
                    true => u64::MAX,
                    false => channel_group.records,
                },
                samples: None,
            }
        })
        .collect();
    for samples in wanted {
        let at = samples.channel_group;
        routes[at].samples = Some(samples);
    }
    routes
}

impl Decoder<'_, '_> {
    /// Refuses a stream of equal records that is too long before it is read, and reserves memory for any other.
    fn reserve(&mut self, bytes: u64) -> Result<(), Problem> {
        let ([route], 0) = (&mut self.routes[..], self.record_id_bytes) else {
            return Ok(());
        };
        let Some(samples) = &mut route.samples else {
            return Ok(());
        };
        let records = (bytes / route.stride as u64).min(route.records_max);
        within(Budget::Samples, records, self.samples_max)?;
        let values = records.saturating_mul(samples.rows.len() as u64);
        within(
            Budget::Values,
            self.values.saturating_add(values),
            self.values_max,
        )?;
        let reserve = |row: &mut Vec<f64>| row.reserve_exact(records as usize);
        samples.rows.iter_mut().for_each(reserve);
        Ok(())
    }

    /// Takes whole records from the beginning of `buffer`, and returns the number of bytes taken.
    fn take(&mut self, buffer: &[u8]) -> Result<usize, Problem> {
        if let ([_], 0) = (&self.routes[..], self.record_id_bytes) {
            let stride = self.routes[0].stride;
            if stride == 0 {
                return Ok(buffer.len());
            }
            let whole = buffer.len() / stride * stride;
            self.decode(0, &buffer[..whole])?;
            return Ok(whole);
        }
        let mut at = 0;
        loop {
            let skipped = self.skip.min((buffer.len() - at) as u64);
            self.skip -= skipped;
            at += skipped as usize;
            let Some(id) = self.record_id(&buffer[at..]) else {
                return Ok(at);
            };
            let index = *self.index.get(&id).ok_or(Problem::RecordId { found: id })?;
            if self.routes[index].has_variable_length {
                let length_at = at + self.record_id_bytes;
                let Some(length) = buffer.get(length_at..length_at + LENGTH_BYTES) else {
                    return Ok(at);
                };
                let length = u32::from_le_bytes([length[0], length[1], length[2], length[3]]);
                at = length_at + LENGTH_BYTES;
                self.skip = u64::from(length);
                continue;
            }
            let run = self.run(&buffer[at..], self.routes[index].stride, id);
            if run == 0 {
                return Ok(at);
            }
            self.decode(index, &buffer[at..at + run])?;
            at += run;
        }
    }

    /// Returns the group number at the beginning of `bytes`, if there are enough bytes; 0 if records have none.
    fn record_id(&self, bytes: &[u8]) -> Option<u64> {
        let bytes = bytes.get(..self.record_id_bytes.max(1))?;
        let mut word = [0; 8];
        word[..self.record_id_bytes].copy_from_slice(&bytes[..self.record_id_bytes]);
        Some(u64::from_le_bytes(word))
    }

    /// Returns the size of the whole records of one group at the beginning of `bytes`.
    fn run(&self, bytes: &[u8], stride: usize, id: u64) -> usize {
        let of_group = |record: &&[u8]| self.record_id(record) == Some(id);
        stride * bytes.chunks_exact(stride).take_while(of_group).count()
    }

    /// Appends the samples of whole records of the group `index`.
    fn decode(&mut self, index: usize, records: &[u8]) -> Result<(), Problem> {
        let route = &mut self.routes[index];
        let left = route.records_max - route.records;
        let count = ((records.len() / route.stride) as u64).min(left);
        let records = &records[..count as usize * route.stride];
        let first = route.records;
        route.records += count;
        let Some(samples) = &mut route.samples else {
            return Ok(());
        };
        within(Budget::Samples, route.records, self.samples_max)?;
        let values = count.saturating_mul(samples.rows.len() as u64);
        *self.values = self.values.saturating_add(values);
        within(Budget::Values, *self.values, self.values_max)?;
        for (index, source) in samples.sources.iter().enumerate() {
            let row = &mut samples.rows[index];
            let begin = row.len();
            let shape = RecordShape {
                stride: route.stride,
                skip: self.record_id_bytes,
            };
            source.layout.decode(records, shape, first, row);
            let new = &mut row[begin..];
            if !source.layout.is_integer() {
                let count = new.iter().filter(|value| value.is_nan()).count();
                samples.not_a_number[index] += count as u64;
            }
            source.conversion.apply(new);
            let validity_at = route.validity_at;
            remove_invalid(source.validity, records, route.stride, validity_at, new);
        }
        Ok(())
    }
}

/// Replaces invalid samples by NaN.
fn remove_invalid(
    validity: Validity,
    records: &[u8],
    stride: usize,
    validity_at: usize,
    values: &mut [f64],
) {
    match validity {
        Validity::AlwaysValid => {}
        Validity::NeverValid => values.fill(f64::NAN),
        Validity::Bit(bit) => {
            let (byte, mask) = (validity_at + bit / 8, 1 << (bit % 8));
            for (value, record) in values.iter_mut().zip(records.chunks_exact(stride)) {
                if record[byte] & mask != 0 {
                    *value = f64::NAN;
                }
            }
        }
    }
}

fn within(budget: Budget, found: u64, bound: u64) -> Result<(), Problem> {
    if found <= bound {
        return Ok(());
    }
    Err(Problem::Limit {
        budget,
        found,
        bound,
    })
}
