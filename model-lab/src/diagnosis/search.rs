//! Tries every effect of the library on top of a fitted plant.

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicUsize, Ordering};

use plant_sim::effects::{EffectSetting, LIBRARY};
use rayon::prelude::*;

use super::error::DiagnoseError;
use super::trial::{Bench, Opened, Trial};

/// A fit is followed to its end where its first steps gained this share of what the best one gained.
const PROSPECT: f64 = 0.25;

/// What a search reports.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What is done, for people.
    pub stage: &'static str,
    /// Share of the stage that is done, 0 to 1.
    pub done: f64,
}

/// Sees the progress of long work from several threads and may stop it.
pub type Watch<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// An effect on top of a plant, in the form of its law that fits best.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    pub(crate) setting: EffectSetting,
    /// None where it gains nothing over the plant without it.
    pub(crate) trial: Option<Trial>,
}

/// Tries all effects that `base` does not have. `thorough` follows prospects to the end.
pub(crate) fn try_all(
    bench: &Bench,
    base: &Trial,
    thorough: bool,
    stage: &'static str,
    watch: Watch,
) -> Result<Vec<Tried>, DiagnoseError> {
    let settings: Vec<EffectSetting> = LIBRARY
        .iter()
        .filter(|effect| !base.has(effect.about().id))
        .flat_map(|effect| {
            let variants = effect.about().variants.iter();
            variants.map(|variant| EffectSetting::typical_variant(*effect, variant))
        })
        .collect();
    let total = settings.len() as f64;
    let done = AtomicUsize::new(0);
    report(watch, stage, 0.0)?;
    let opened = settings
        .into_par_iter()
        .map(|setting| {
            let opened = bench.open(base, setting.clone());
            let count = done.fetch_add(1, Ordering::Relaxed) + 1;
            report(watch, stage, 0.7 * count as f64 / total)?;
            Ok((setting, opened))
        })
        .collect::<Result<Vec<_>, DiagnoseError>>()?;

    let gain = |opened: &Opened| base.fit.cost - opened.fit.cost;
    let most = opened
        .iter()
        .filter_map(|(_, opened)| opened.as_ref().map(gain))
        .fold(0.0, f64::max);
    let tried = opened
        .into_par_iter()
        .map(|(setting, opened)| {
            let opened = opened.filter(|opened| gain(opened) > 0.0);
            let trial = opened.and_then(|opened| {
                if thorough && gain(&opened) >= PROSPECT * most {
                    bench.finish(opened)
                } else {
                    bench.leave(opened)
                }
            });
            report(watch, stage, 0.9)?;
            Ok(Tried { setting, trial })
        })
        .collect::<Result<Vec<_>, DiagnoseError>>()?;
    Ok(best_forms(tried))
}

/// Tells `watch` how far it is.
pub(crate) fn report(watch: Watch, stage: &'static str, done: f64) -> Result<(), DiagnoseError> {
    match watch(Progress { stage, done }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(DiagnoseError::Interrupted),
    }
}

/// Of each effect the form that fits best, the effect that fits best first.
fn best_forms(tried: Vec<Tried>) -> Vec<Tried> {
    let mut best: Vec<Tried> = Vec::new();
    for tried in tried {
        match best.iter_mut().find(|best| best.setting.id() == tried.setting.id()) {
            Some(there) if tried.cost() < there.cost() => *there = tried,
            Some(_) => {}
            None => best.push(tried),
        }
    }
    best.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
    best
}

impl Tried {
    /// Sum of squares on the fitted and the held-out logs.
    pub(crate) fn cost(&self) -> f64 {
        self.trial.as_ref().map_or(f64::INFINITY, Trial::total_square)
    }

    pub(crate) fn id(&self) -> &'static str {
        self.setting.id()
    }
}
