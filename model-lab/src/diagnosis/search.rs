//! Tries every effect of the library on top of a fitted plant.

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicUsize, Ordering};

use plant_sim::effects::{Effect, EffectSetting, EntryPoint};
use rayon::prelude::*;

use super::error::DiagnoseError;
use super::trial::{Bench, Opened, Prospect, Trial};
use super::verdict::FURTHER_EVIDENCE;

/// A fit is begun where it promises this share of what the best one promises, ...
const BEGIN_PROSPECT: f64 = 0.05;
/// ... or of what a named effect gains where it may stand in its place, ...
const BEGIN_RIVAL_PROSPECT: f64 = 0.1;
/// ... and this share of the evidence that a further effect needs.
const WEAK_PROSPECT: f64 = 0.2;
/// A fit is followed to its end where its first steps gained this share of what the best one gained, ...
pub(crate) const PROSPECT: f64 = 0.25;
/// ... and this share of what a named effect gains where it may stand in its place.
const RIVAL_PROSPECT: f64 = 0.8;

/// Of the forms of one effect, those are followed whose first steps gained this share of what the best of them gained.
const FORM_PROSPECT: f64 = 0.7;
/// Share of the work that is done when the fits are begun.
const BEGUN: f64 = 0.6;

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
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Effort {
    /// A few steps of each effect in the first form of its law: nothing is missing.
    Glance,
    /// Every form that promises something, followed to the end where it gains.
    Search,
    /// What may stand in the place of the named effect `of`, which gains so much.
    Rival { of: &'static str, gain: f64 },
}

impl Effort {
    /// The gain from which on a fit is followed to its end, where the best one gained `most`.
    fn least_gain(self, most: f64) -> f64 {
        match self {
            Self::Glance => f64::INFINITY,
            Self::Search => PROSPECT * most,
            Self::Rival { gain, .. } => RIVAL_PROSPECT * gain,
        }
    }

    /// The promise from which on a fit on top of `base` is begun, where the best one promises `most`.
    fn least_promise(self, base: &Trial, most: f64) -> f64 {
        let weak = || WEAK_PROSPECT * FURTHER_EVIDENCE * base.correlation_samples;
        match self {
            Self::Rival { gain, .. } => BEGIN_RIVAL_PROSPECT * most.max(gain),
            // Near the noise an effect is weak and a promise holds.
            Self::Search if !base.is_material() => weak(),
            Self::Search => weak().max(BEGIN_PROSPECT * most),
            Self::Glance => BEGIN_PROSPECT * most,
        }
    }

    fn leaves_out(self, effect: &str) -> bool {
        matches!(self, Self::Rival { of, .. } if of == effect)
    }
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
        .filter(|effect| !base.has(effect.about().id) && !effort.leaves_out(effect.about().id))
        .collect();
    let (effects, unseen): (Vec<_>, Vec<_>) = effects
        .into_iter()
        .partition(|&effect| bench.fitting.has_pressure() || shows_in_currents(effect));
    let forms = effects
        .iter()
        .flat_map(|&effect| {
            let forms = bench.plant.forms_of(effect);
            let count = if effort == Effort::Glance {
                1
            } else {
                forms.len()
            };
            forms.into_iter().take(count)
        })
        .collect();
    let opened = open_promising(bench, base, (forms, effort), stage, watch)?;
    let best_gain = |id: Option<&str>| {
        let opened = opened.iter();
        let of_effect = opened.filter(|begun| id.is_none_or(|id| begun.setting.id() == id));
        of_effect.map(Begun::gain).fold(0.0, f64::max)
    };
    let least_gain = effort.least_gain(best_gain(None));
    let least = |begun: &Begun| {
        let of_effect = FORM_PROSPECT * best_gain(Some(begun.setting.id()));
        of_effect.max(least_gain)
    };
    let is_followed: Vec<bool> = opened
        .iter()
        .map(|begun| begun.gain() >= least(begun))
        .collect();
    let finished = AtomicUsize::new(0);
    let total = opened.len() as f64;
    let tried = opened
        .into_par_iter()
        .zip(is_followed)
        .map(|(begun, is_followed)| {
            let gain = begun.gain();
            let trial = begun.opened.filter(|_| gain > 0.0).and_then(|opened| {
                if is_followed {
                    bench.finish(opened)
                } else {
                    bench.leave(base, opened)
                }
            });
            let count = finished.fetch_add(1, Ordering::Relaxed) + 1;
            report(watch, stage, BEGUN + (1.0 - BEGUN) * count as f64 / total)?;
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

/// Begins the fits of those of `settings` that promise enough.
fn open_promising(
    bench: &Bench,
    base: &Trial,
    (settings, effort): (Vec<EffectSetting>, Effort),
    stage: &'static str,
    watch: Watch,
) -> Result<Vec<Begun>, DiagnoseError> {
    report(watch, stage, 0.0)?;
    let total = 2.0 * settings.len() as f64;
    let done = AtomicUsize::new(0);
    let step = || {
        let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / total;
        report(watch, stage, BEGUN * share)
    };
    let prospects = settings
        .into_par_iter()
        .map(|setting| step().map(|()| bench.prospect(base, setting)))
        .collect::<Result<Vec<_>, _>>()?;
    let gains = prospects.iter().filter_map(Prospect::gain);
    let least = effort.least_promise(base, gains.fold(0.0, f64::max));
    prospects
        .into_par_iter()
        .map(|prospect| {
            step()?;
            let setting = prospect.setting.clone();
            let promise = prospect.gain();
            let is_promising = promise.is_some_and(|promise| promise > 0.0 && promise >= least);
            let sketch = is_promising.then(|| bench.sketch(base, prospect));
            Ok(Begun {
                opened: sketch.and_then(|sketch| bench.open(sketch)),
                setting,
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
        .filter_map(|form| bench.finish(bench.begin(base, form)?))
        .reduce_with(|a, b| if b.is_preferred_to(&a) { b } else { a })
}

/// Of each effect the form that the logs prefer, the effect that fits best first.
pub(crate) fn best_forms(tried: Vec<Tried>) -> Vec<Tried> {
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
