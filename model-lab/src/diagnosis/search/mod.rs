//! Trial of every effect of the library on top of a fitted plant.

pub(crate) mod assemble;
mod chain;
pub(crate) mod detection;
pub(crate) mod found;
mod judgement;
mod pair;
pub(crate) mod plausibility;
pub(crate) mod selection;

use core::ops::ControlFlow;
use core::sync::atomic::{AtomicUsize, Ordering};

use plant_sim::effects::{Effect, EffectSetting};
use rayon::prelude::*;

use super::error::DiagnoseError;
use super::evidence::errors::Errors;
use super::fit::supply::shows_in_currents;
use super::fit::trial::{Bench, Opened, Prospect, Trial};
use super::verdict::FURTHER_EVIDENCE;

/// Share of the best candidate's expected gain from which on a fit is begun, ...
const BEGIN_PROSPECT: f64 = 0.05;
/// ... of the best expected gain or a named effect's gain, whichever is larger, where the candidate may replace that effect, ...
const BEGIN_RIVAL_PROSPECT: f64 = 0.1;
/// ... and of the evidence that a further effect needs.
const WEAK_PROSPECT: f64 = 0.2;
/// Share of the best fit's gain that the first steps of a fit must gain for it to be completed, ...
pub(crate) const PROSPECT: f64 = 0.25;
/// ... and of the gain of a named effect where the candidate may replace it.
const RIVAL_PROSPECT: f64 = 0.8;

/// Share of the best form's gain that the first steps of another form of the same effect must gain for it to be completed.
const FORM_PROSPECT: f64 = 0.7;
/// Share of the work that is done when the fits are begun.
const BEGUN: f64 = 0.6;

/// Progress of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Current stage, for people.
    pub stage: &'static str,
    /// Share of the stage that is done, 0 to 1.
    pub done: f64,
    /// Error of the model after a step of an estimation; none where a stage reports no error.
    pub error: Option<WorstError>,
}

/// Error of the signal that a model explains worst.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WorstError {
    /// Name of the signal.
    pub signal: &'static str,
    /// Rms of its one-step-ahead error over the noise floor; 1 is a perfect model.
    pub floors: f64,
}

/// Observer of the progress of long work, called from several threads, which may stop it.
pub type Watch<'a> = &'a (dyn Fn(Progress) -> ControlFlow<()> + Sync);

/// Extent of a search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Effort {
    /// Each effect in the first form of its law, where nothing is missing; a few steps of those that might still gain.
    Glance,
    /// Every form with a sufficient expected gain, completed where it gains.
    Search,
    /// Effects with nearly this `gain`, to replace the named effect `of`, or without one, other values of the ordinary parameters.
    Rival { of: Option<&'static str>, gain: f64 },
}

impl Effort {
    /// Returns the gain from which on a fit is completed, where the best one gained `most`.
    fn least_gain(self, most: f64) -> f64 {
        match self {
            Self::Glance => f64::INFINITY,
            Self::Search => PROSPECT * most,
            Self::Rival { gain, .. } => RIVAL_PROSPECT * gain,
        }
    }

    /// Returns the expected gain from which on a fit on top of `base` is begun, where the best expected gain is `most`.
    fn least_expected_gain(self, base: &Trial, most: f64) -> f64 {
        let weak = || WEAK_PROSPECT * FURTHER_EVIDENCE * base.correlation_samples;
        match self {
            Self::Rival { gain, .. } => BEGIN_RIVAL_PROSPECT * most.max(gain),
            // Near the noise an effect is weak and its expected gain is accurate.
            Self::Glance => weak(),
            Self::Search if !base.is_material() => weak(),
            Self::Search => weak().max(BEGIN_PROSPECT * most),
        }
    }

    fn leaves_out(self, effect: &str) -> bool {
        matches!(self, Self::Rival { of: Some(of), .. } if of == effect)
    }
}

/// Effect on top of a plant, in the form of its law that fits best.
#[derive(Debug, Clone)]
pub(crate) struct Tried {
    pub(crate) setting: EffectSetting,
    /// Fitted plant; none where the effect gains nothing over the plant without it.
    pub(crate) trial: Option<Trial>,
    /// Whether its fit was followed to the end.
    pub(crate) is_finished: bool,
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
            let forms = bench.forms_of(effect);
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
    let expected = opened.iter().map(|begun| begun.expected);
    let least_expected = PROSPECT * expected.fold(0.0, f64::max);
    let is_on_its_way = |begun: &Begun| {
        effort == Effort::Search
            && begun.opened.is_some()
            && begun.gain() <= 0.0
            && begun.expected >= least_expected
    };
    let is_followed: Vec<bool> = opened
        .iter()
        .map(|begun| begun.gain() >= least(begun) || is_on_its_way(begun))
        .collect();
    let finished = AtomicUsize::new(0);
    let total = opened.len() as f64;
    let tried = opened
        .into_par_iter()
        .zip(is_followed)
        .map(|(begun, is_followed)| {
            let gain = begun.gain();
            let trial = match begun.opened {
                Some(opened) if is_followed => bench.finish(opened),
                Some(opened) if gain > 0.0 => bench.leave(base, opened),
                _ => None,
            };
            let trial = trial.filter(|trial| trial.fit.cost < base.fit.cost);
            let count = finished.fetch_add(1, Ordering::Relaxed) + 1;
            report(watch, stage, BEGUN + (1.0 - BEGUN) * count as f64 / total)?;
            Ok(Tried {
                setting: begun.setting,
                trial,
                is_finished: is_followed,
            })
        })
        .collect::<Result<Vec<_>, DiagnoseError>>()?;
    let unseen = unseen.into_iter().map(|effect| Tried {
        setting: EffectSetting::typical(effect),
        trial: None,
        is_finished: true,
    });
    Ok(best_forms(tried.into_iter().chain(unseen).collect()))
}

/// Follows the fits of `tried`, effects on top of `base`, to their end that were only begun, where an effect gains enough compared
/// with the best one: a fit that begins far from its end gains little in its first steps. None if there is no such effect.
pub(crate) fn finish_begun(
    bench: &Bench,
    base: &Trial,
    tried: &[Tried],
    watch: Watch,
) -> Result<Option<Vec<Tried>>, DiagnoseError> {
    let gain = |tried: &Tried| {
        let trial = tried.trial.as_ref();
        trial.map_or(0.0, |trial| base.fit.cost - trial.fit.cost)
    };
    let least = BEGIN_PROSPECT * tried.iter().map(gain).fold(0.0, f64::max);
    let is_worth = |tried: &&Tried| !tried.is_finished && gain(tried) > least;
    let total = tried.iter().filter(is_worth).count();
    if total == 0 {
        return Ok(None);
    }
    let done = AtomicUsize::new(0);
    let finished = tried.par_iter().map(|tried| {
        if !is_worth(&tried) {
            return Ok(tried.clone());
        }
        let trial = tried.trial.clone().and_then(|trial| bench.follow(trial));
        let count = done.fetch_add(1, Ordering::Relaxed) + 1;
        report(watch, "single effects", count as f64 / total as f64)?;
        Ok(Tried {
            trial,
            is_finished: true,
            setting: tried.setting.clone(),
        })
    });
    let finished = finished.collect::<Result<Vec<_>, DiagnoseError>>()?;
    Ok(Some(best_forms(finished)))
}

/// Effect whose fit was begun.
struct Begun {
    setting: EffectSetting,
    opened: Option<Opened>,
    /// Gain that was expected before any step.
    expected: f64,
    /// Cost without the effect.
    before: f64,
}

impl Begun {
    fn gain(&self) -> f64 {
        self.opened
            .as_ref()
            .map_or(0.0, |opened| self.before - opened.fit.cost)
    }
}

/// Begins the fits of those of `settings` whose expected gain is sufficient.
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
    let least = effort.least_expected_gain(base, gains.fold(0.0, f64::max));
    prospects
        .into_par_iter()
        .map(|prospect| {
            step()?;
            let setting = prospect.setting.clone();
            let gain = prospect.gain();
            let is_promising = gain.is_some_and(|gain| gain > 0.0 && gain >= least);
            let sketch = is_promising.then(|| bench.sketch(base, prospect));
            Ok(Begun {
                opened: sketch.and_then(|sketch| bench.open(sketch)),
                setting,
                expected: gain.unwrap_or(0.0),
                before: base.fit.cost,
            })
        })
        .collect()
}

/// Reports the progress to `watch`.
pub(crate) fn report(watch: Watch, stage: &'static str, done: f64) -> Result<(), DiagnoseError> {
    report_error(watch, stage, done, None)
}

/// Reports the progress together with the errors of the model so far.
///
/// # Errors
/// [`DiagnoseError::Interrupted`]: `watch` stopped the work.
pub(crate) fn report_error(
    watch: Watch,
    stage: &'static str,
    done: f64,
    errors: Option<&Errors>,
) -> Result<(), DiagnoseError> {
    let worst = errors.and_then(Errors::worst);
    let error = worst.map(|(signal, floors)| WorstError { signal, floors });
    match watch(Progress { stage, done, error }) {
        ControlFlow::Continue(()) => Ok(()),
        ControlFlow::Break(()) => Err(DiagnoseError::Interrupted),
    }
}

/// Fits one effect in several forms to the end and returns the form that the logs prefer; none where no form can be simulated.
pub(crate) fn best_form(bench: &Bench, base: &Trial, forms: Vec<EffectSetting>) -> Option<Trial> {
    forms
        .into_par_iter()
        .filter_map(|form| bench.finish(bench.begin(base, form)?))
        .reduce_with(|a, b| if b.is_preferred_to(&a) { b } else { a })
}

/// Returns the form of each effect that the logs prefer, the effect that fits best first.
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
    /// Returns the sum of squares on training and validation data.
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
