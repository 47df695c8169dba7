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
    let first = pair.first.added();
    let rivals = rivals(bench, first, &pair.last, &pair.other, watch)?;
    Ok(Some(Chain {
        rivals: vec![rivals, pair.tried],
        steps: vec![pair.first, pair.last],
    }))
}

/// Adds effects to those of `steps`, and leaves out those that prove unnecessary beside the others; none where no effect is added, or where
/// they explain too little of what `plain` lacks.
fn longer_chain(
    bench: &Bench,
    plain: &Trial,
    mut steps: Vec<Trial>,
    watch: Watch,
) -> Result<Option<Chain>, DiagnoseError> {
    let mut added = extend(bench, plain, &mut steps, watch)?;
    if added.is_none() || !last_of(&steps).explains(plain) {
        return Ok(None);
    }
    let withouts = loop {
        // The effect that was added last is needed beside the others.
        let asked = &steps[..steps.len() - usize::from(added.is_some())];
        match without_each(bench, last_of(&steps), asked) {
            Ok(withouts) => break withouts,
            Err(unnecessary) => {
                let Some(fewer) = left_out(bench, &steps, unnecessary) else {
                    return Ok(None);
                };
                (steps, added) = (fewer, None);
            }
        }
    };
    let last = last_of(&steps);
    if steps.len() < 2 || !last.explains(plain) || !last.is_credible(bench, plain) {
        return Ok(None);
    }
    let of_steps = steps.iter().zip(&withouts);
    let rivals = of_steps.map(|(step, without)| rivals(bench, step.added(), last, without, watch));
    let mut rivals = rivals.collect::<Result<Vec<_>, _>>()?;
    rivals.extend(added);
    Ok(Some(Chain { steps, rivals }))
}

/// Adds the best effect to `steps` as long as these leave something material and the effect takes most of it. Returns every effect that was
/// tried in the place of the last one; none where no effect was added or the plant cannot be simulated.
fn extend(
    bench: &Bench,
    plain: &Trial,
    steps: &mut Vec<Trial>,
    watch: Watch,
) -> Result<Option<Vec<Tried>>, DiagnoseError> {
    let mut added = None;
    while let Some(last) = steps.last_mut().filter(|last| last.is_material()) {
        if last.refresh(bench).is_none() {
            return Ok(None);
        }
        let tried = try_all(bench, last, Effort::Search, "further effects", watch)?;
        // One that makes an earlier one unnecessary leaves that one's size open.
        let next =
            best_step(bench, plain, last, &tried).or_else(|| best_step(bench, last, last, &tried));
        let Some(next) = next.filter(|next| next.is_further_than(last)) else {
            break;
        };
        steps.push(next);
        added = Some(tried);
    }
    Ok(added)
}

fn last_of(steps: &[Trial]) -> &Trial {
    steps.last().expect("a pair was there")
}

/// Returns `last` without the effect of each of `steps`; the place of the first one that is not needed beside the others as an error.
fn without_each(bench: &Bench, last: &Trial, steps: &[Trial]) -> Result<Vec<Trial>, usize> {
    let steps = steps.iter().enumerate();
    let withouts = steps.map(|(place, step)| {
        let without = bench.without(last, step.added());
        without
            .filter(|without| last.is_further_than(without))
            .ok_or(place)
    });
    withouts.collect()
}

/// Returns the steps without the effect of the one at `place`; none where one of them cannot be simulated.
fn left_out(bench: &Bench, steps: &[Trial], place: usize) -> Option<Vec<Trial>> {
    let (before, from) = steps.split_at(place);
    let named = from[0].added();
    let after = from[1..].iter().map(|step| bench.without(step, named));
    before.iter().cloned().map(Some).chain(after).collect()
}

/// Tries every other effect in the place of `named`: each on top of `without`, which is `last` without that effect.
fn rivals(
    bench: &Bench,
    named: &'static str,
    last: &Trial,
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

#[cfg(test)]
mod tests {
    use core::ops::ControlFlow;

    use plant_sim::PlantParameters;
    use plant_sim::effects::{Effect, EffectSetting, by_id};

    use super::*;
    use crate::bench;
    use crate::diagnosis::fit::split::Split;
    use crate::diagnosis::search::best_form;

    /// Defect seen: where the first effect proved unnecessary beside the later ones, no effect of the chain was named.
    #[test]
    fn an_effect_that_proves_unnecessary_is_left_out() {
        let of_rig = [
            EffectSetting::typical(by_id("chamber_leak").unwrap()).with("area_m2", 3e-8),
            EffectSetting::typical(by_id("flyback_clamp").unwrap()),
        ];
        let [leak, clamp] = of_rig.clone().map(|effect| effect.id());
        let plant = PlantParameters::nominal();
        let rig = bench::Bench {
            plant: of_rig
                .into_iter()
                .fold(plant.clone(), |rig, effect| rig.with_effect(effect)),
            ..bench::Bench::default()
        };
        let (split, plain) = Split::that_shows(&plant, &[rig.measure()], &[]).unwrap();
        let unnecessary = "iron_saturation";
        let library: Vec<&'static dyn Effect> = [leak, clamp, unnecessary]
            .into_iter()
            .filter_map(by_id)
            .collect();
        let bench = split.bench(&plant, &library);
        let on = |base: &Trial, id: &str| {
            best_form(&bench, base, bench.forms_of(by_id(id).unwrap())).unwrap()
        };
        let first = on(&plain, unnecessary);
        let second = on(&first, leak);
        let watch = |_| ControlFlow::Continue(());
        let chain = longer_chain(&bench, &plain, vec![first, second], &watch).unwrap();
        let chain = chain.expect("leak and clamp explain what is missing");
        let named: Vec<_> = chain.steps.iter().map(Trial::added).collect();
        assert_eq!(named, [leak, clamp]);
        assert!(!chain.steps[1].is_material());
        assert_eq!(chain.rivals.len(), 2);
    }
}
