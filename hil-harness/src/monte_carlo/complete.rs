//! Computation of the rows that a journal lacks, on several threads.

use core::num::NonZero;
use core::ops::{ControlFlow, Range};
use core::sync::atomic::{AtomicBool, Ordering};
use std::collections::BTreeMap;
use std::fs::File;
use std::path::Path;
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

use super::error::MonteCarloError;
use super::journal::{CHUNK_RIGS, Journal};
use super::row::RigRow;
use super::settings::RunSettings;
use super::summary::Summary;
use super::table::{RowReader, TableError};
use crate::rigs::RigError;

/// Returns the summary of the table `out` if it already has the rows of `rigs` with these settings, so that nothing is to be
/// done; its first row is computed with `row` and compared.
///
/// # Errors
/// Returns the error of that rig.
pub fn finished(
    out: &Path,
    settings: &RunSettings,
    rigs: Range<u32>,
    row: &impl Fn(u32) -> Result<RigRow, RigError>,
) -> Result<Option<Summary>, RigError> {
    let rows = || -> Result<Option<(Summary, Option<RigRow>)>, TableError> {
        let table = RowReader::open(File::open(out)?)?;
        if table.settings() != settings {
            return Ok(None);
        }
        let (mut summary, mut first, mut expected) = (Summary::default(), None, rigs);
        for row in table {
            let row = row?;
            if expected.next() != Some(row.rig) {
                return Ok(None);
            }
            summary.add(&row);
            first.get_or_insert(row);
        }
        Ok(expected.is_empty().then_some((summary, first)))
    };
    // A file that cannot be read is no finished table, and is replaced.
    let Ok(Some((summary, first))) = rows() else {
        return Ok(None);
    };
    Ok(match first {
        Some(first) if row(first.rig)? != first => None,
        _ => Some(summary),
    })
}

/// Computes with `row` each row that `journal` lacks, on `jobs` threads. `watch` is called after each rig with the number of
/// rigs computed so far, and may stop the run.
///
/// # Errors
/// Returns the error of a rig or of the journal, an error if a rig of the journal gives another row now, or an error if
/// `watch` stopped the run.
pub fn complete(
    journal: &mut Journal,
    jobs: NonZero<usize>,
    row: &(impl Fn(u32) -> Result<RigRow, RigError> + Sync),
    watch: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Result<(), MonteCarloError> {
    if let Some(kept) = journal.any_row()?
        && row(kept.rig)? != kept
    {
        return Err(journal.other_program(kept.rig));
    }
    let missing: Vec<_> = journal
        .all_chunks()
        .filter(|chunk| !journal.has(chunk))
        .collect();
    let rigs = Mutex::new(missing.iter().cloned().flatten());
    let is_ended = AtomicBool::new(false);
    let next_rig = || rigs.lock().unwrap_or_else(PoisonError::into_inner).next();
    let work = |rows: mpsc::SyncSender<_>| {
        while !is_ended.load(Ordering::Relaxed)
            && let Some(rig) = next_rig()
            && rows.send(row(rig)).is_ok()
        {}
    };
    thread::scope(|scope| {
        let (sender, receiver) = mpsc::sync_channel(CHUNK_RIGS as usize);
        for _ in 0..jobs.get() {
            let sender = sender.clone();
            scope.spawn(|| work(sender));
        }
        drop(sender);
        let kept = keep(journal, receiver, watch);
        is_ended.store(true, Ordering::Relaxed);
        kept
    })
}

/// Collects rows to chunks, and keeps each chunk when it is whole.
fn keep(
    journal: &mut Journal,
    rows: mpsc::Receiver<Result<RigRow, RigError>>,
    watch: &mut dyn FnMut(u32) -> ControlFlow<()>,
) -> Result<(), MonteCarloError> {
    let sizes: BTreeMap<u32, usize> = journal
        .all_chunks()
        .map(|chunk| (chunk.start / CHUNK_RIGS, chunk.len()))
        .collect();
    let mut begun: BTreeMap<u32, Vec<RigRow>> = BTreeMap::new();
    for (row, done) in rows.into_iter().zip(1..) {
        let row = row?;
        let number = row.rig / CHUNK_RIGS;
        let chunk = begun.entry(number).or_default();
        chunk.push(row);
        if sizes.get(&number) == Some(&chunk.len())
            && let Some(mut chunk) = begun.remove(&number)
        {
            chunk.sort_by_key(|row| row.rig);
            journal.keep(chunk)?;
        }
        if watch(done).is_break() {
            return Err(journal.interrupted());
        }
    }
    Ok(())
}
