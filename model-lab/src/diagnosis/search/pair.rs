//! Two effects together: the most promising first effects, and the best second one beside each.

use plant_sim::effects::EffectSetting;

use super::judgement::best_step;
use super::{Effort, PROSPECT, Tried, Watch, best_form, report, try_all};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::fit::trial::{Bench, Trial};
use crate::diagnosis::verdict::{CLEARLY_LESS, PARTLY_NAMED_SHARE};

/// Number of first effects that are tried with every second one, ...
const FIRSTS: usize = 3;
/// ... if they explain at least this share of the excess on the fitted logs, ...
const FIRST_SHARE: f64 = 0.05;
/// ... and this share of what the best of them explains.
const FIRST_OF_BEST: f64 = 0.25;

/// Two effects together.
pub(super) struct Pair {
    pub(super) first: Trial,
    /// The second effect alone.
    pub(super) other: Trial,
    pub(super) last: Trial,
    /// Every second effect beside the first.
    pub(super) tried: Vec<Tried>,
}

/// Two effects, fitted together.
pub(super) enum Beside {
    /// Both are needed.
    Both(Box<Pair>),
    /// One of them suffices, fitted from the place of the pair: its first fit had ended beside the best one.
    Alone(Box<Tried>),
    /// The second one takes too little of what the first one leaves.
    Unclear(Box<Trial>),
}

/// The effects alone that may be some of those that are missing, the one that explains most first: the best that are sound, and where
/// these are few, those of which only what they leave, which others may explain, keeps open how strong they are.
pub(super) fn promising(bench: &Bench, plain: &Trial, singles: &[Tried]) -> Vec<Trial> {
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
    let best = best_form(bench, base, bench.forms_of(effect));
    best.filter(|best| best.is_preferred_to(&trial))
        .or(Some(trial))
}

/// The best second effect for each of `firsts`, the most promising first, if both are needed; or an effect that suffices alone; or the two
/// effects that leave least.
pub(super) fn best_pair(
    bench: &Bench,
    plain: &Trial,
    firsts: Vec<Trial>,
    singles: &[Tried],
    watch: Watch,
) -> Result<Option<Beside>, DiagnoseError> {
    let mut best: Option<Box<Pair>> = None;
    let mut nearest: Option<Box<Trial>> = None;
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
        match pair_on(bench, plain, first, singles, watch)? {
            Some(Beside::Both(own)) => keep_better(&mut best, own),
            Some(alone @ Beside::Alone(_)) => return Ok(Some(alone)),
            Some(Beside::Unclear(own)) => {
                let both = nearest.into_iter().chain([own]);
                nearest = both.min_by(|a, b| a.total_square().total_cmp(&b.total_square()));
            }
            None => {}
        }
        let is_partly = |pair: &&Pair| pair.explains_most(plain) && pair.last.is_material();
        let own = best.as_deref().filter(|pair| has_first(pair));
        if let Some(own) = own.filter(is_partly)
            && let Some(other) = own.in_other_forms(bench, watch)?
        {
            best = Some(Box::new(other));
        }
        // Others are tried only where the pair leaves much: what it leaves else is left to further effects.
        let is_enough = |pair: &Pair| pair.explains_most(plain) || !pair.last.is_material();
        if best.as_deref().is_some_and(is_enough) {
            break;
        }
    }
    Ok(best
        .map(Beside::Both)
        .or_else(|| nearest.map(Beside::Unclear)))
}

/// The best second effect beside `first`, and whether both are needed; or one of them, if it suffices alone.
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
    let Some(last) = best_step(bench, plain, &first, &tried) else {
        return Ok(None);
    };
    let second = last.added();
    let other = singles.iter().find(|tried| tried.id() == second);
    let Some(other) = other.map(|tried| tried.trial.clone().unwrap_or_else(|| plain.clone()))
    else {
        return Ok(None);
    };
    if !last.is_further_than(&first) || !last.is_further_than(&other) {
        return Ok(Some(Beside::Unclear(Box::new(last))));
    }
    let named = first.added();
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

/// Takes `pair` for the `best` one where it leaves less.
fn keep_better(best: &mut Option<Box<Pair>>, pair: Box<Pair>) {
    let left = |pair: &Pair| pair.last.total_square();
    if best.as_ref().is_none_or(|best| left(&pair) < left(best)) {
        *best = Some(pair);
    }
}

impl Pair {
    /// Whether it explains so much of the excess of `plain` that it may be named.
    fn explains_most(&self, plain: &Trial) -> bool {
        self.last.share_of(plain) >= PARTLY_NAMED_SHARE
    }

    /// Returns the two effects with another form of the first one's law, and the form of the second one that suits it: alone, the form of the
    /// first is distorted by what the second explains. None where this does not leave clearly less.
    fn in_other_forms(&self, bench: &Bench, watch: Watch) -> Result<Option<Self>, DiagnoseError> {
        let [named, second] = [self.first.added(), self.last.added()];
        let is_clearly_less =
            |trial: &Trial| trial.total_square() < CLEARLY_LESS * self.last.total_square();
        let refitted = |trial: &Trial, id: &str, forms: Vec<EffectSetting>| {
            let without = bench.unfitted_without(trial, id)?;
            best_form(bench, &without, forms).filter(is_clearly_less)
        };
        report(watch, "other forms of a law", 0.0)?;
        let forms = forms_of(bench, &self.first, |is_present| !is_present);
        let Some(other) = refitted(&self.last, named, forms) else {
            return Ok(None);
        };
        report(watch, "other forms of a law", 0.5)?;
        let is_open = other.is_material();
        let forms = forms_of(bench, &self.last, |is_present| is_present || is_open);
        let last = refitted(&other, second, forms);
        let pair = last.and_then(|last| {
            let first = bench.without(&last, second)?;
            last.is_further_than(&first).then(|| Self {
                first,
                other: self.other.clone(),
                last,
                tried: self.tried.clone(),
            })
        });
        Ok(pair)
    }
}

/// Returns the forms of the last effect of `trial`, where `is_asked` accepts whether a form is the present one.
fn forms_of(bench: &Bench, trial: &Trial, is_asked: impl Fn(bool) -> bool) -> Vec<EffectSetting> {
    let present = trial.effects.last().expect("one effect was added");
    let mut forms = bench.forms_of(present.effect());
    forms.retain(|form| is_asked(form.variant().name == present.variant().name));
    forms
}

#[cfg(test)]
mod tests {
    use core::ops::ControlFlow;

    use plant_sim::PlantParameters;
    use plant_sim::effects::by_id;

    use super::*;
    use crate::bench;
    use crate::diagnosis::fit::split::Split;

    /// Alone, a sensor offset makes the droop of a regulator explain more than that of a line with a volume.
    #[test]
    fn the_form_of_the_first_effect_is_chosen_again_beside_the_second() {
        let plant = PlantParameters::nominal();
        let droop = by_id("supply_line_droop").unwrap();
        let offset = by_id("sensor_offset").unwrap();
        let form = |name: &str| {
            let variant = droop.about().variant(name).unwrap();
            EffectSetting::typical_variant(droop, variant)
        };
        let line = form("line_volume")
            .with("restriction_area_m2", 1.4e-6)
            .with("line_volume_m3", 6e-5);
        let offset_of_rig = EffectSetting::typical(offset).with("offset_bar", 0.03);
        let rig = bench::Bench {
            plant: plant.with_effect(line).with_effect(offset_of_rig),
            ..bench::Bench::default()
        };
        let (split, plain) = Split::that_shows(&plant, &[rig.measure()], &[]).unwrap();
        let library = [droop, offset];
        let bench = split.bench(&plant, &library);
        let first = best_form(&bench, &plain, vec![form("regulator")]).unwrap();
        let offsets = plant.forms_of(offset);
        let pair = Pair {
            last: best_form(&bench, &first, offsets.clone()).unwrap(),
            other: best_form(&bench, &plain, offsets).unwrap(),
            first,
            tried: Vec::new(),
        };
        let watch = |_| ControlFlow::Continue(());
        let other = pair.in_other_forms(&bench, &watch).unwrap().unwrap();
        let form_of = |trial: &Trial| trial.effects[0].variant().name;
        assert_eq!([&other.first, &other.last].map(form_of), ["line_volume"; 2]);
        assert_eq!(other.last.added(), "sensor_offset");
        assert!(other.last.total_square() < CLEARLY_LESS * pair.last.total_square());
        assert!(other.in_other_forms(&bench, &watch).unwrap().is_none());
    }
}
