//! From the plain model to the named effects.

use rayon::prelude::*;

use super::{Effort, PROSPECT, Tried, Watch, best_form, best_forms, try_all};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::evidence::errors::Errors;
use crate::diagnosis::fit::trial::{Bench, Trial};
use crate::diagnosis::result::Verdict;
use crate::diagnosis::verdict::{
    ALIKE_EXCESS, ALIKE_SHARE, CLEARLY_LESS, FOUND_SHARE, FURTHER_DROP, FURTHER_EVIDENCE,
    FURTHER_SHARE, NAMED_EVIDENCE, NAMED_SHARE, PARTLY_NAMED_SHARE,
};

/// Number of first effects that are tried with every second one, ...
const FIRSTS: usize = 3;
/// ... if they explain at least this share of the excess on the fitted logs, ...
const FIRST_SHARE: f64 = 0.05;
/// ... and this share of what the best of them explains.
const FIRST_OF_BEST: f64 = 0.25;
/// Another form of a first effect is tried beside a second one if it gains this share of what the best form gains.
const ALIKE_FORM: f64 = 0.9;

/// What was found.
pub(crate) struct Selection {
    /// The plain plant first, then one trial per named effect.
    pub(crate) steps: Vec<Trial>,
    /// The plain plant within what the plant file admits, where the ranges of the first step are wider.
    pub(crate) within: Option<Trial>,
    /// The plant with wider ranges, where it explains the error as well as the named effect.
    pub(crate) alternative: Option<Trial>,
    /// The plant with the effect that explains the error as well as the wider ranges of the first step.
    pub(crate) rival: Option<Trial>,
    /// Every effect alone; none before they are tried.
    pub(crate) singles: Vec<Tried>,
    /// For each named effect, what stands in its place beside the other one.
    pub(crate) rivals: Vec<Vec<Tried>>,
}

/// Tries every effect alone on top of `base`, where it leaves a material error.
pub(crate) fn singles(
    bench: &Bench,
    base: &Trial,
    watch: Watch,
) -> Result<Vec<Tried>, DiagnoseError> {
    if base.is_material() {
        try_all(bench, base, Effort::Search, "single effects", watch)
    } else {
        Ok(Vec::new())
    }
}

/// Selects the effect that brings `plain` to the noise, as other values of its ordinary parameters do; none where no effect does.
pub(crate) fn of_one_effect(
    bench: &Bench,
    plain: Trial,
    watch: Watch,
) -> Result<Selection, DiagnoseError> {
    let effort = Effort::Rival {
        of: None,
        gain: plain.fit.cost - bench.fitting.counted_samples(),
    };
    let singles = try_all(bench, &plain, effort, "single effects", watch)?;
    let single = best_credible(bench, &plain, &singles);
    let single = single.filter(|single| !single.is_material() && single.is_evident_over(&plain));
    let mut found = Selection::new(plain, singles);
    if let Some(single) = single {
        found.rivals = vec![found.singles.clone()];
        found.steps.push(single);
    }
    Ok(found)
}

/// Selects effects by forward selection, from `plain` and every effect alone. It ends where no material error remains, or where no effect
/// explains the remaining one.
pub(crate) fn forward_selection(
    bench: &Bench,
    plain: Trial,
    singles: Vec<Tried>,
    watch: Watch,
) -> Result<Selection, DiagnoseError> {
    if !plain.is_material() {
        return Ok(Selection::of_plain_alone(plain));
    }
    let mut found = Selection::new(plain, singles);
    let plain = &found.steps[0];
    let single = best_credible(bench, plain, &found.singles);
    let single = single.filter(|single| single.is_evident_over(plain));
    let single = single.map(|single| to_its_end(bench, single));
    let firsts = match &single {
        Some(single) if single.leaves_nothing() => Vec::new(),
        Some(single) if !single.is_material() => vec![single.clone()],
        _ => promising(bench, plain, &found.singles),
    };
    let pair = match best_pair(bench, plain, firsts, &found.singles, watch)? {
        None => None,
        Some(Beside::Both(pair)) => Some(pair),
        Some(Beside::Alone(alone)) => {
            let same = found
                .singles
                .iter_mut()
                .find(|tried| tried.id() == alone.id());
            *same.expect("every effect was tried alone") = *alone;
            let plain = found.steps.remove(0);
            return forward_selection(bench, plain, best_forms(found.singles), watch);
        }
    };
    let chain = match pair {
        Some(pair) => chain_from(bench, plain, *pair, watch)?,
        None => None,
    };
    match (single, chain) {
        (_, Some(chain)) => {
            found.rivals = chain.rivals;
            found.steps.extend(chain.steps);
        }
        (Some(single), None) if single.is_named_on(plain) => {
            found.rivals = vec![found.singles.clone()];
            found.steps.push(single);
        }
        _ => {
            if let Some(single) = explains_alone(plain, &found.singles) {
                found.rivals = vec![found.singles.clone()];
                found.steps.push(single);
            }
        }
    }
    Ok(found)
}

/// Returns whether the selection from the effects alone in `finished` may begin with another one, or elsewhere, than that from `begun`.
pub(crate) fn begins_otherwise(
    bench: &Bench,
    plain: &Trial,
    begun: &[Tried],
    finished: &[Tried],
) -> bool {
    let firsts = |singles: &[Tried]| {
        let alone = [
            best_credible(bench, plain, singles),
            explains_alone(plain, singles),
        ];
        let firsts = promising(bench, plain, singles).into_iter();
        let firsts = firsts.chain(alone.into_iter().flatten());
        firsts.map(|first| first.fit.z).collect::<Vec<_>>()
    };
    firsts(begun) != firsts(finished)
}

/// The `single` effect with its fit followed to the end: a further effect must not explain what a search left.
fn to_its_end(bench: &Bench, single: Trial) -> Trial {
    if single.leaves_nothing() {
        return single;
    }
    let continued = single.clone().continued(bench);
    continued
        .filter(|continued| continued.total_square() < single.total_square())
        .unwrap_or(single)
}

/// The effect that explains nearly all by itself, though its size stays open.
fn explains_alone(plain: &Trial, singles: &[Tried]) -> Option<Trial> {
    let trials = singles.iter().filter_map(|tried| tried.trial.as_ref());
    let explaining = trials.filter(|trial| {
        trial.share_of(plain) >= FOUND_SHARE
            && trial.is_evident_over(plain)
            && trial.does_no_harm_to(plain)
    });
    let best = explaining.min_by(|a, b| a.mean_excess().total_cmp(&b.mean_excess()));
    best.cloned()
}

impl Selection {
    /// Creates a selection of no effect, before effects are tried.
    pub(crate) fn of_plain_alone(plain: Trial) -> Self {
        Self::new(plain, Vec::new())
    }

    /// Tries the effects on top of the plain plant as far as their detection limits need, where none was tried because it leaves nothing.
    pub(crate) fn with_glance(
        mut self,
        bench: &Bench,
        watch: Watch,
    ) -> Result<Self, DiagnoseError> {
        if self.singles.is_empty() {
            self.singles = try_all(bench, self.plain(), Effort::Glance, "single effects", watch)?;
        }
        Ok(self)
    }

    /// Creates a selection of no effect.
    fn new(plain: Trial, singles: Vec<Tried>) -> Self {
        Self {
            steps: vec![plain],
            within: None,
            alternative: None,
            rival: None,
            singles,
            rivals: Vec::new(),
        }
    }

    fn plain(&self) -> &Trial {
        &self.steps[0]
    }

    /// The plain plant with all named effects.
    pub(crate) fn last(&self) -> &Trial {
        self.steps.last().expect("the plain plant is there")
    }

    /// The plain plant within what the plant file admits.
    pub(crate) fn within(&self) -> &Trial {
        self.within.as_ref().unwrap_or(&self.steps[0])
    }

    /// Whether nothing is missing one step ahead, and errors add up in free run.
    pub(crate) fn adds_up(&self, bench: &Bench) -> bool {
        self.verdict() == Verdict::Adequate && bench.adds_up(self.last())
    }

    /// Returns the selection, made with wider ranges than those of `within`, which keeps to the tolerances of the plant file. The effect of
    /// `rival` explains the error as well.
    pub(crate) fn beyond(mut self, within: Trial, rival: Option<Trial>) -> Self {
        (self.within, self.rival) = (Some(within), rival);
        self
    }

    /// The effects that explain the error as well, where the answer is that the plant file is wrong.
    pub(crate) fn rival_effects(&self) -> Vec<String> {
        let rival = self.rival.iter().flat_map(|rival| &rival.effects);
        match self.verdict() {
            Verdict::PlantFileWrong => rival.map(|effect| effect.id().to_owned()).collect(),
            _ => Vec::new(),
        }
    }

    /// Returns the selection with an alternative: `wide`, the plant with wider ranges, explains the error as well.
    pub(crate) fn or(mut self, wide: Trial) -> Self {
        self.alternative = Some(wide);
        self
    }

    /// Whether the named effects explain the error clearly better than `wide`, the plant with wider ranges: two laws of the same physics
    /// differ by less.
    pub(crate) fn is_better_than(&self, wide: &Trial) -> bool {
        let last = self.last();
        let pairs = wide.sets().into_iter().zip(last.sets());
        let drop: f64 = pairs
            .map(|(wide, last)| wide.total_excess() - last.total_excess())
            .sum();
        let is_evident = last.evidence_over(wide) > FURTHER_EVIDENCE;
        !last.is_material() && drop >= FURTHER_DROP && is_evident
    }

    /// Whether one effect explains the error, and `wide`, the plant with wider ranges, no better.
    pub(crate) fn is_as_good_as(&self, wide: &Trial) -> bool {
        let last = self.last();
        let better = (last.total_square() - wide.total_square()) / last.correlation_samples;
        self.steps.len() == 2 && !last.is_material() && better < NAMED_EVIDENCE
    }

    /// Whether a material part of the excess remains.
    pub(crate) fn is_unexplained(&self) -> bool {
        self.plain().is_material() && !self.last().explains(self.plain())
    }

    pub(crate) fn verdict(&self) -> Verdict {
        match self.steps.len() {
            1 if !self.plain().leaves_little() => Verdict::NotInLibrary,
            1 if self.within.is_some() => Verdict::PlantFileWrong,
            1 => Verdict::Adequate,
            _ if self.is_unexplained() => Verdict::FormWrong,
            _ => Verdict::Found,
        }
    }
}

/// The best trial, or one as good, whose effects on top of `plain` are credible.
fn best_credible(bench: &Bench, plain: &Trial, tried: &[Tried]) -> Option<Trial> {
    best(plain, tried, |trial| trial.is_credible(bench, plain))
}

/// The best trial, or one as good, of the effects `tried` on top of `base`, whose effects on top of `plain` may be some of those that are
/// missing: what it leaves, which others may explain, keeps its sizes open.
fn best_step(bench: &Bench, plain: &Trial, (base, tried): (&Trial, &[Tried])) -> Option<Trial> {
    best(base, tried, |trial| {
        if trial.explains(plain) {
            trial.is_credible(bench, plain)
        } else {
            trial.is_sound_but_for_the_rest(bench, plain)
        }
    })
}

fn best(base: &Trial, tried: &[Tried], is_accepted: impl Fn(&Trial) -> bool) -> Option<Trial> {
    let trials = || tried.iter().filter_map(|tried| tried.trial.as_ref());
    let least = trials().next()?.mean_excess();
    let margin = ALIKE_EXCESS + ALIKE_SHARE * (base.mean_excess() - least);
    let mut alike = trials().filter(|trial| trial.mean_excess() <= least + margin);
    alike.find(|trial| is_accepted(trial)).cloned()
}

/// Two effects together.
struct Pair {
    first: Trial,
    /// The second effect alone.
    other: Trial,
    last: Trial,
    /// Every second effect beside the first.
    tried: Vec<Tried>,
}

/// Two effects, fitted together.
enum Beside {
    /// Both are needed.
    Both(Box<Pair>),
    /// One of them suffices, fitted from the place of the pair: its first fit had ended beside the best one.
    Alone(Box<Tried>),
}

/// The effects alone that may be some of those that are missing, the one that explains most first: the best that are sound, and where
/// these are few, those of which only what they leave, which others may explain, keeps open how strong they are.
fn promising(bench: &Bench, plain: &Trial, singles: &[Tried]) -> Vec<Trial> {
    let excess = plain.fitted.total_excess();
    let explained = |trial: &Trial| excess - trial.fitted.total_excess();
    // What is distorted until it fits leaves nothing true for a second effect.
    let (sound, unsound): (Vec<&Trial>, Vec<&Trial>) = singles
        .iter()
        .filter_map(|tried| tried.trial.as_ref())
        .filter(|trial| explained(trial) >= FIRST_SHARE * excess)
        .partition(|trial| trial.is_sound(bench, plain));
    let open: Vec<&Trial> = unsound
        .into_iter()
        .filter(|trial| trial.is_sound_but_for_the_rest(bench, plain))
        .collect();
    let is_dominant = |trial: &&Trial| trial.share_of(plain) >= PARTLY_NAMED_SHARE;
    let dominant = open.iter().copied().find(is_dominant);
    let others = open.iter().copied().filter(|trial| !is_dominant(trial));
    let mut firsts: Vec<&Trial> = sound.into_iter().take(FIRSTS).collect();
    let room = FIRSTS - firsts.len();
    firsts.extend(dominant);
    firsts.extend(others.take(room));
    let most = firsts.iter().copied().map(explained).fold(0.0, f64::max);
    firsts.retain(|trial| explained(trial) >= FIRST_OF_BEST * most);
    // The one that explains most is named first.
    firsts.sort_by(|a, b| a.mean_excess().total_cmp(&b.mean_excess()));
    firsts.into_iter().cloned().collect()
}

/// The last effect of `trial` on top of `base` in the form that fits best, each fitted to the end: beside an effect among `singles` that
/// gains far more, a search only begins these fits.
fn in_best_form(bench: &Bench, base: &Trial, singles: &[Tried], trial: Trial) -> Option<Trial> {
    let gain = |trial: &Trial| base.fit.cost - trial.fit.cost;
    let trials = singles.iter().filter_map(|tried| tried.trial.as_ref());
    if gain(&trial) >= PROSPECT * trials.map(gain).fold(0.0, f64::max) {
        return Some(trial);
    }
    let effect = trial.effects.last()?.effect();
    let best = best_form(bench, base, bench.plant.forms_of(effect));
    best.filter(|best| best.is_preferred_to(&trial))
        .or(Some(trial))
}

/// The best second effect for each of `firsts`, the most promising first, if both are needed; or an effect that suffices alone.
fn best_pair(
    bench: &Bench,
    plain: &Trial,
    firsts: Vec<Trial>,
    singles: &[Tried],
    watch: Watch,
) -> Result<Option<Beside>, DiagnoseError> {
    let mut best: Option<Box<Pair>> = None;
    for first in firsts {
        // The same two in the other order differ by what a fit leaves open.
        let ids: Vec<_> = first.effects.iter().map(|effect| effect.id()).collect();
        let has_first = |pair: &Pair| ids.iter().all(|id| pair.last.has(id));
        if best.as_deref().is_some_and(has_first) {
            continue;
        }
        let Some(first) = in_best_form(bench, plain, singles, first) else {
            continue;
        };
        match pair_on(bench, plain, first.clone(), singles, watch)? {
            Some(Beside::Both(own)) => keep_better(&mut best, own),
            Some(alone) => return Ok(Some(alone)),
            None => {}
        }
        // Alone, the form of the first is distorted by what the second explains; it may be another one beside it.
        let is_partly = |pair: &Pair| pair.explains_most(plain) && pair.last.is_material();
        if best
            .as_ref()
            .is_some_and(|pair| has_first(pair) && is_partly(pair))
        {
            for form in alike_forms(bench, plain, &first) {
                if let Some(Beside::Both(own)) = pair_on(bench, plain, form, singles, watch)? {
                    keep_better(&mut best, own);
                }
            }
        }
        // Others are tried only where the pair leaves much: what it leaves else is left to further effects.
        let is_enough = |pair: &Pair| pair.explains_most(plain) || !pair.last.is_material();
        if best.as_deref().is_some_and(is_enough) {
            break;
        }
    }
    Ok(best.map(Beside::Both))
}

/// The best second effect beside `first`, if both are needed; or one of them, if it suffices alone.
fn pair_on(
    bench: &Bench,
    plain: &Trial,
    mut first: Trial,
    singles: &[Tried],
    watch: Watch,
) -> Result<Option<Beside>, DiagnoseError> {
    if first.refresh(bench).is_none() {
        return Ok(None);
    }
    let tried = try_all(bench, &first, Effort::Search, "pairs of effects", watch)?;
    let Some(last) = best_step(bench, plain, (&first, &tried)) else {
        return Ok(None);
    };
    let second = last.effects.last().expect("one was added").id();
    let other = singles.iter().find(|tried| tried.id() == second);
    let Some(other) = other.map(|tried| tried.trial.clone().unwrap_or_else(|| plain.clone()))
    else {
        return Ok(None);
    };
    if !last.is_further_than(&first) || !last.is_further_than(&other) {
        return Ok(None);
    }
    let named = first.effects.last().expect("one was added").id();
    for (left_out, before) in [(named, &other), (second, &first)] {
        let alone = bench.without(&last, left_out).filter(|alone| {
            let is_clearly_less = alone.total_square() < CLEARLY_LESS * before.total_square();
            is_clearly_less && !last.is_further_than(alone)
        });
        if let Some(alone) = alone {
            return Ok(Some(Beside::Alone(Box::new(Tried {
                setting: alone.effects.last().expect("one effect is left").clone(),
                trial: Some(alone),
                is_finished: true,
            }))));
        }
    }
    Ok(Some(Beside::Both(Box::new(Pair {
        first,
        other,
        last,
        tried,
    }))))
}

/// Takes `pair` for the `best` one where it leaves less; the same two effects in other forms, where they leave clearly less.
fn keep_better(best: &mut Option<Box<Pair>>, pair: Box<Pair>) {
    let is_better = best.as_ref().is_none_or(|best| {
        let mut effects = pair.last.effects.iter();
        let is_same = effects.all(|effect| best.last.has(effect.id()));
        let share = if is_same { CLEARLY_LESS } else { 1.0 };
        pair.last.total_square() < share * best.last.total_square()
    });
    if is_better {
        *best = Some(pair);
    }
}

/// The last effect of `first` on top of `plain` in those other forms of its law that explain nearly as much, the best first.
fn alike_forms(bench: &Bench, plain: &Trial, first: &Trial) -> Vec<Trial> {
    let Some(named) = first.effects.last() else {
        return Vec::new();
    };
    let mut forms = bench.plant.forms_of(named.effect());
    forms.retain(|form| form.variant().name != named.variant().name);
    let gain = |trial: &Trial| plain.fit.cost - trial.fit.cost;
    let fits = forms
        .into_par_iter()
        .filter_map(|form| bench.finish(bench.begin(plain, form)?));
    let mut alike: Vec<Trial> = fits
        .filter(|trial| gain(trial) >= ALIKE_FORM * gain(first))
        .collect();
    alike.sort_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost));
    alike
}

impl Pair {
    /// Whether it explains so much of the excess of `plain` that it may be named.
    fn explains_most(&self, plain: &Trial) -> bool {
        self.last.share_of(plain) >= PARTLY_NAMED_SHARE
    }
}

/// Several effects that explain what is missing.
struct Chain {
    /// One trial per effect, each with those before it.
    steps: Vec<Trial>,
    /// For each of them, what stands in its place beside the others.
    rivals: Vec<Vec<Tried>>,
}

/// Returns `pair` with further effects, or alone where they are not needed; none where they explain too little of what `plain` lacks.
fn chain_from(
    bench: &Bench,
    plain: &Trial,
    pair: Pair,
    watch: Watch,
) -> Result<Option<Chain>, DiagnoseError> {
    if pair.last.is_material() {
        let steps = vec![pair.first.clone(), pair.last.clone()];
        let longer = longer_chain(bench, plain, steps, watch)?;
        if longer.is_some() || !pair.last.explains(plain) {
            return Ok(longer);
        }
    }
    let first = pair.first.effects.last().expect("one was added").id();
    let rivals = rivals(bench, (first, &pair.last), &pair.other, watch)?;
    Ok(Some(Chain {
        rivals: vec![rivals, pair.tried],
        steps: vec![pair.first, pair.last],
    }))
}

/// Adds effects to those of `steps`, the best at each step, as long as they leave something material and another one takes most of it; none
/// where there is none, they explain too little of what `plain` lacks, or one of them is not needed beside the others.
fn longer_chain(
    bench: &Bench,
    plain: &Trial,
    mut steps: Vec<Trial>,
    watch: Watch,
) -> Result<Option<Chain>, DiagnoseError> {
    let mut tried = Vec::new();
    while let Some(last) = steps.last_mut().filter(|last| last.is_material()) {
        if last.refresh(bench).is_none() {
            return Ok(None);
        }
        let further = try_all(bench, last, Effort::Search, "further effects", watch)?;
        let next = best_step(bench, plain, (last, &further));
        let Some(next) = next.filter(|next| next.is_further_than(last)) else {
            break;
        };
        steps.push(next);
        tried = further;
    }
    let last = &steps[steps.len() - 1];
    if tried.is_empty() || !last.explains(plain) {
        return Ok(None);
    }
    let mut of_steps = Vec::new();
    for effect in &last.effects[plain.effects.len()..last.effects.len() - 1] {
        let without = bench.without(last, effect.id());
        let Some(without) = without.filter(|without| last.is_further_than(without)) else {
            return Ok(None);
        };
        of_steps.push(rivals(bench, (effect.id(), last), &without, watch)?);
    }
    of_steps.push(tried);
    Ok(Some(Chain {
        steps,
        rivals: of_steps,
    }))
}

/// What may stand in the place of the effect `named` of `last`, on top of the plant `without` it.
fn rivals(
    bench: &Bench,
    (named, last): (&'static str, &Trial),
    without: &Trial,
    watch: Watch,
) -> Result<Vec<Tried>, DiagnoseError> {
    let effort = Effort::Rival {
        of: Some(named),
        gain: without.fit.cost - last.fit.cost,
    };
    try_all(
        bench,
        without,
        effort,
        "alternatives of a named effect",
        watch,
    )
}

impl Trial {
    /// Errors on the fitted logs and on what was held out.
    fn sets(&self) -> [&Errors; 2] {
        [&self.fitted, &self.checked]
    }

    /// Whether a material error remains, on the fitted logs or on what was held out.
    pub(crate) fn is_material(&self) -> bool {
        self.sets().into_iter().any(Errors::is_material)
    }

    /// Whether it leaves nothing material, or too little to say whether physics is missing.
    pub(crate) fn leaves_little(&self) -> bool {
        !self.is_material() || self.sets().into_iter().all(Errors::are_little)
    }

    /// Whether too little remains for another effect to show.
    fn leaves_nothing(&self) -> bool {
        let mut excesses = self.sets().into_iter().map(Errors::total_excess);
        excesses.all(|excess| excess < FURTHER_DROP)
    }

    /// Whether it explains nearly all of the excess of `plain`, or leaves nothing material.
    fn explains(&self, plain: &Self) -> bool {
        self.share_of(plain) >= FOUND_SHARE || !self.is_material()
    }

    /// Whether the logs determine how strong its effects on top of `plain` are, or it explains so much that only its rest keeps them open.
    fn is_credible(&self, bench: &Bench, plain: &Self) -> bool {
        let is_sound = self.is_sound(bench, plain);
        let explains_most = || self.share_of(plain) >= FOUND_SHARE;
        is_sound || explains_most() && self.is_sound_but_for_the_rest(bench, plain)
    }

    /// Whether its effect explains enough of the excess of `plain` to be named.
    fn is_named_on(&self, plain: &Self) -> bool {
        let least = if self.is_material() {
            PARTLY_NAMED_SHARE
        } else {
            NAMED_SHARE
        };
        self.share_of(plain) >= least && self.does_no_harm_to(plain)
    }

    /// Whether no set of logs has a larger error than with `plain`: a law that stands for another one fits its training logs alone.
    fn does_no_harm_to(&self, plain: &Self) -> bool {
        let mut sets = self.sets().into_iter().zip(plain.sets());
        sets.all(|(own, plain)| own.total_excess() <= plain.total_excess() + ALIKE_EXCESS)
    }

    /// Share of the excess of `plain` that it explains: the least of the fitted logs and of what was held out, as far
    /// as the effect shows there. A log that does not excite an effect says nothing of it.
    pub(crate) fn share_of(&self, plain: &Self) -> f64 {
        let pairs = || self.sets().into_iter().zip(plain.sets());
        let share = |(own, plain): (&Errors, &Errors)| {
            let excess = plain.total_excess();
            if excess > 0.0 {
                1.0 - own.total_excess() / excess
            } else {
                0.0
            }
        };
        let shows = pairs().filter(|(_, plain)| plain.is_material());
        shows
            .map(share)
            .reduce(f64::min)
            .unwrap_or_else(|| pairs().map(share).fold(f64::INFINITY, f64::min))
    }

    fn is_evident_over(&self, base: &Self) -> bool {
        self.evidence_over(base) > NAMED_EVIDENCE
    }

    /// Whether what it adds to `base` takes most of what was left there. Its strength comes from the fitted logs, so the evidence does as well.
    fn is_further_than(&self, base: &Self) -> bool {
        let ([base_fitted, base_checked], [fitted, checked]) = (base.sets(), self.sets());
        let excesses = [(base_fitted, fitted), (base_checked, checked)]
            .map(|(base, own)| [base.total_excess(), own.total_excess()]);
        takes_most_of_sets(excesses, base.sets().map(Errors::is_material))
            && self.evidence_over(base) > FURTHER_EVIDENCE
    }
}

/// Returns whether a further effect takes most of the `excesses`, before it and left with it, on the fitted logs and on what was held out:
/// enough in one of them, which may excite it more than the other, and most in each that shows something.
fn takes_most_of_sets(excesses: [[f64; 2]; 2], is_material: [bool; 2]) -> bool {
    let shows_somewhere = is_material.contains(&true);
    let drop = excesses.iter().map(|[before, left]| before - left);
    drop.fold(0.0, f64::max) >= FURTHER_DROP
        && excesses
            .into_iter()
            .zip(is_material)
            .all(|(set, is_material)| takes_most(set, !shows_somewhere || is_material))
}

/// Whether a further effect takes most of the excess that was there `before` and is `left` with it. Logs for which
/// `is_asked` is false, since others show more, say no more than that it does no harm.
fn takes_most([before, left]: [f64; 2], is_asked: bool) -> bool {
    if is_asked {
        before - left >= FURTHER_SHARE * before || before < FURTHER_DROP
    } else {
        left <= before + ALIKE_EXCESS
    }
}

#[cfg(test)]
mod tests {
    use super::{takes_most, takes_most_of_sets};

    /// Defect seen: a side chamber took the excess of the check log from 0.76 to 0.07. It was not named, because the fitted log excites it
    /// less, and showed 0.037.
    #[test]
    fn one_set_of_logs_may_show_what_a_further_effect_takes() {
        assert!(takes_most_of_sets(
            [[0.037, 0.005], [0.76, 0.07]],
            [false, true]
        ));
        assert!(takes_most_of_sets(
            [[0.76, 0.07], [0.037, 0.005]],
            [true, false]
        ));
        // Less than half of it.
        assert!(!takes_most_of_sets(
            [[0.037, 0.005], [0.76, 0.4]],
            [false, true]
        ));
        // At the cost of the other set.
        assert!(!takes_most_of_sets(
            [[0.037, 0.2], [0.76, 0.07]],
            [false, true]
        ));
        // Too little anywhere.
        assert!(!takes_most_of_sets(
            [[0.05, 0.0], [0.05, 0.0]],
            [false, false]
        ));
    }

    #[test]
    fn logs_that_show_something_ask_for_most_of_it() {
        assert!(takes_most([0.90, 0.01], true));
        assert!(takes_most([0.90, 0.45], true));
        assert!(!takes_most([0.90, 0.46], true));
        // Hardly anything is there to take.
        assert!(takes_most([0.05, 0.05], true));
    }

    /// A third of the noise is what two correct programs of one plant differ by; no effect takes that away.
    #[test]
    fn logs_that_show_nothing_ask_for_no_harm() {
        assert!(takes_most([0.09, 0.08], false));
        assert!(takes_most([0.09, 0.11], false));
        assert!(!takes_most([0.09, 0.13], false));
    }
}
