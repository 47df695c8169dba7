//! From the plain model to the named effects.

use super::chain::chain_from;
use super::judgement::best_credible;
use super::pair::{Beside, best_pair, promising};
use super::{Effort, Tried, Watch, best_forms, try_all};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::fit::trial::{Bench, Trial};
use crate::diagnosis::result::Verdict;
use crate::diagnosis::verdict::{FOUND_SHARE, FURTHER_DROP, FURTHER_EVIDENCE, NAMED_EVIDENCE};

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
    /// The best two effects together, where they explain too little to be named.
    pub(crate) nearest: Option<Trial>,
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
    let (pair, nearest) = match best_pair(bench, plain, firsts, &found.singles, watch)? {
        None => (None, None),
        Some(Beside::Unclear(nearest)) => (None, Some(*nearest)),
        Some(Beside::Both(pair)) => {
            let nearest = pair.last.clone();
            (Some(pair), Some(nearest))
        }
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
            } else {
                found.nearest = nearest;
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
            nearest: None,
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

    /// Forgets the ranges of the plant file where the last fit ended within all of them: the file is not wrong.
    pub(crate) fn settle(&mut self) {
        let last = self.last();
        let within = self.within.as_ref();
        if within.is_some_and(|within| last.is_inside(within)) {
            (self.within, self.rival) = (None, None);
        }
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

    /// Returns the trial that brings the training data to the noise, but not the validation data, where an error remains.
    pub(crate) fn explaining_training_alone(&self) -> Option<&Trial> {
        let is_it = |trial: &&Trial| !trial.fitted.is_material() && trial.checked.is_material();
        let singles = self.singles.iter().filter_map(|tried| tried.trial.as_ref());
        let trials = singles.chain(&self.steps).filter(is_it);
        trials
            .filter(|_| self.is_unexplained())
            .min_by(|a, b| a.fit.cost.total_cmp(&b.fit.cost))
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
