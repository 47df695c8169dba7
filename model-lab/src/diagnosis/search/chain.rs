//! Several effects: a pair, and further effects as long as something material is left.

use super::judgement::best_step;
use super::pair::Pair;
use super::{Effort, Tried, Watch, try_all};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::fit::trial::{Bench, Trial};

/// Several effects that explain what is missing.
pub(super) struct Chain {
    /// One trial per effect, each with those before it.
    pub(super) steps: Vec<Trial>,
    /// For each of them, what stands in its place beside the others.
    pub(super) rivals: Vec<Vec<Tried>>,
}

/// Returns `pair` with further effects, or alone where they are not needed; none where they explain too little of what `plain` lacks.
pub(super) fn chain_from(
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
