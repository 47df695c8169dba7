//! Computation of the rows that a journal lacks, on several threads.

use core::num::NonZero;
use core::ops::ControlFlow;
use core::sync::atomic::{AtomicBool, Ordering};
use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError, mpsc};
use std::thread;

use super::error::MonteCarloError;
use super::journal::{CHUNK_RIGS, Journal};
use super::row::RigRow;
use crate::rigs::RigError;

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
