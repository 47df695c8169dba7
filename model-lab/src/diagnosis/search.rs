//! Tries every effect of the library on top of a fitted plant.

use core::ops::{ControlFlow, Range};
use core::sync::atomic::{AtomicUsize, Ordering};

use plant_sim::effects::{Effect, EffectSetting, EntryPoint};
use rayon::prelude::*;

use super::error::DiagnoseError;
use super::trial::{Bench, Opened, Trial};

/// A fit is begun where it promises this share of what the best one gained or promises.
const BEGIN_PROSPECT: f64 = 0.02;
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

/// How much work a search is worth.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Effort {
    /// A few steps of each effect in the first form of its law: nothing is missing.
    Glance,
    /// Every form that promises something, followed to the end where it gains.
    Alone,
    /// The same beside another effect, without effects that promise next to nothing.
    Beside,
}

/// An effect on top of a plant, in the form of its law that fits best.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    pub(crate) setting: EffectSetting,
    /// None where it gains nothing over the plant without it.
    pub(crate) trial: Option<Trial>,
}

/// Tries all effects that `base` does not have.
pub(crate) fn try_all(
    bench: &Bench,
    base: &Trial,
    effort: Effort,
    stage: &'static str,
    watch: Watch,
) -> Result<Vec<Tried>, DiagnoseError> {
    let effects: Vec<&'static dyn Effect> = bench
        .library
        .iter()
        .copied()
        .filter(|effect| !base.has(effect.about().id))
        .collect();
    let (effects, unseen): (Vec<_>, Vec<_>) = effects
        .into_iter()
        .partition(|&effect| bench.fitting.has_pressure() || shows_in_currents(effect));
    let first_forms = effects
        .iter()
        .map(|&effect| EffectSetting::typical(effect))
        .collect();
    let gain = (effort == Effort::Beside).then_some(0.0);
    let mut opened = open_all(bench, base, first_forms, gain, (stage, 0.0..0.5), watch)?;
    if effort != Effort::Glance {
        let gain = opened.iter().map(Begun::gain).fold(0.0, f64::max);
        let other_forms = opened
            .iter()
            .flat_map(|begun| {
                let effect = begun.setting.effect();
                let variants = effect.about().variants.iter().skip(1);
                variants.map(move |variant| EffectSetting::typical_variant(effect, variant))
            })
            .collect();
        opened.extend(open_all(
            bench,
            base,
            other_forms,
            Some(gain),
            (stage, 0.5..0.7),
            watch,
        )?);
    }
    let least = PROSPECT * opened.iter().map(Begun::gain).fold(0.0, f64::max);
    let finished = AtomicUsize::new(0);
    let total = opened.len() as f64;
    let tried = opened
        .into_par_iter()
        .map(|begun| {
            let gain = begun.gain();
            let trial = begun.opened.filter(|_| gain > 0.0).and_then(|opened| {
                if effort != Effort::Glance && gain >= least {
                    bench.finish(opened)
                } else {
                    bench.leave(opened)
                }
            });
            let count = finished.fetch_add(1, Ordering::Relaxed) + 1;
            report(watch, stage, 0.7 + 0.3 * count as f64 / total)?;
            Ok(Tried {
                setting: begun.setting,
                trial,
            })
        })
        .collect::<Result<Vec<_>, DiagnoseError>>()?;
    let unseen = unseen.into_iter().map(|effect| Tried {
        setting: EffectSetting::typical(effect),
        trial: None,
    });
    Ok(best_forms(tried.into_iter().chain(unseen).collect()))
}

/// An effect whose fit was begun.
struct Begun {
    setting: EffectSetting,
    opened: Option<Opened>,
    /// Cost without it.
    before: f64,
}

impl Begun {
    fn gain(&self) -> f64 {
        self.opened
            .as_ref()
            .map_or(0.0, |opened| self.before - opened.fit.cost)
    }
}

/// Begins the fits of `settings`: all of them, or those that promise something beside the best `gain`.
fn open_all(
    bench: &Bench,
    base: &Trial,
    settings: Vec<EffectSetting>,
    gain: Option<f64>,
    (stage, span): (&'static str, Range<f64>),
    watch: Watch,
) -> Result<Vec<Begun>, DiagnoseError> {
    report(watch, stage, span.start)?;
    let total = 2.0 * settings.len() as f64;
    let done = AtomicUsize::new(0);
    let step = || {
        let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / total;
        report(watch, stage, span.start + share * (span.end - span.start))
    };
    let sketched = settings
        .into_par_iter()
        .map(|setting| {
            let sketch = bench.sketch(base, setting.clone());
            step().map(|()| (setting, sketch))
        })
        .collect::<Result<Vec<_>, _>>()?;
    let promised = sketched.iter().flat_map(|(_, sketch)| sketch);
    let promised = promised.map(|sketch| sketch.promised_gain);
    let least = gain.map_or(f64::NEG_INFINITY, |gain| {
        BEGIN_PROSPECT * promised.fold(gain, f64::max)
    });
    sketched
        .into_par_iter()
        .map(|(setting, sketch)| {
            let opened = sketch
                .filter(|sketch| sketch.promised_gain >= least)
                .and_then(|sketch| bench.open(sketch));
            step()?;
            Ok(Begun {
                setting,
                opened,
                before: base.fit.cost,
            })
        })
        .collect()
}

/// Whether coil currents show an effect without the pressure.
pub(crate) fn shows_in_currents(effect: &dyn Effect) -> bool {
    matches!(
        effect.about().acts_on,
        EntryPoint::Coil | EntryPoint::Armature | EntryPoint::ElectricSupply
    )
}

/// Tells `watch` how far it is.
pub(crate) fn report(watch: Watch, stage: &'static str, done: f64) -> Result<(), DiagnoseError> {
    match watch(Progress { stage, done }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(DiagnoseError::Interrupted),
    }
}

/// One effect in several forms, fitted to the end: the form that the logs prefer; none where no form can be simulated.
pub(crate) fn best_form(bench: &Bench, base: &Trial, forms: Vec<EffectSetting>) -> Option<Trial> {
    forms
        .into_par_iter()
        .filter_map(|form| bench.finish(bench.open(bench.sketch(base, form)?)?))
        .reduce_with(|a, b| if b.is_preferred_to(&a) { b } else { a })
}

/// Of each effect the form that the logs prefer, the effect that fits best first.
fn best_forms(tried: Vec<Tried>) -> Vec<Tried> {
    let mut best: Vec<Tried> = Vec::new();
    for tried in tried {
        match best
            .iter_mut()
            .find(|best| best.setting.id() == tried.setting.id())
        {
            Some(there) if tried.is_preferred_to(there) => *there = tried,
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
        self.trial
            .as_ref()
            .map_or(f64::INFINITY, Trial::total_square)
    }

    fn is_preferred_to(&self, other: &Self) -> bool {
        match (&self.trial, &other.trial) {
            (Some(own), Some(other)) => own.is_preferred_to(other),
            (own, _) => own.is_some(),
        }
    }

    pub(crate) fn id(&self) -> &'static str {
        self.setting.id()
    }
}
