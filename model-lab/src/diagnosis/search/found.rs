//! From the logs to the answer: the plant refitted within what its file admits, with wider ranges, and with effects.
//!
//! Ordinary parameters that come to the end of their ranges are widened before any effect is named. If that alone leaves the noise, the
//! plant file is wrong and no physics is missing, unless effects within the ranges fit clearly better. An effect may fit as well: a warm
//! coil and one with more turns are the same to every signal, and so are a narrow fitting and a narrower orifice. Then the values are the
//! answer if a first plant file may be as wrong as that, and the effect is the alternative; else it is the other way round. Where widening
//! leaves an error, effects are looked for within the file's ranges.

use plant_sim::PlantParameters;
use plant_sim::effects::Effect;

use super::selection::{self, Selection};
use super::{Effort, Tried, Watch, best_forms, finish_begun, report, try_all};
use crate::diagnosis::error::DiagnoseError;
use crate::diagnosis::fit::split::Split;
use crate::diagnosis::fit::supply::shows_in_currents;
use crate::diagnosis::fit::trial::{Bench, Trial};
use crate::diagnosis::known::may_be_beside_first_file;
use crate::diagnosis::result::Verdict;
use crate::diagnosis::verdict::CLEARLY_LESS;
use crate::result::Horizon;

/// Largest number of assignments of commands and fits in turn.
const ASSIGNMENTS: usize = 4;
/// Share of the decrease of the squared error by an effect from which on a better fit of the plain plant accounts for it.
const MOST: f64 = 0.5;

/// Effects that are searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Extent {
    /// As many as are missing.
    All,
    /// A single one that explains everything, because other values of the ordinary parameters do so as well.
    One,
}

/// Plain plant, and each effect alone on top of it.
struct First {
    plain: Trial,
    singles: Vec<Tried>,
}

/// Finds what `plain`, the refitted plant, lacks.
pub(crate) fn find(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    plain: Trial,
    watch: Watch,
) -> Result<Selection, DiagnoseError> {
    let base = plain.clone();
    find_on(split, plant, library, plain, &base, watch)
}

/// Finds what the plant lacks in the errors of the free run, where errors add up that are within the noise one step ahead. `predicted` was
/// found one step ahead. None, with the former horizon and clocks, where the effects of the library do not explain these errors.
pub(crate) fn find_in_free_run(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    predicted: &Selection,
    watch: Watch,
) -> Result<Option<Selection>, DiagnoseError> {
    let before = split.logs();
    split.take_conditions(predicted.within());
    split.judge_in(Horizon::FreeRun);
    report(watch, "the plain model in free run", 0.0)?;
    // Without the missing effect, the plant fitted in free run is farther from the truth than the one fitted one step ahead: a fit with the
    // effect begins there.
    let base = split
        .bench(plant, library)
        .at_the_place_of(predicted.within());
    let mut base = base.ok_or_else(|| split.not_simulated())?;
    let plain = split.plain_from(plant, &base.plant())?;
    // Other values of the ordinary parameters bring the errors down to those of a correct model. An effect may do that as well, and may be
    // any that takes the place of such a value.
    if plain.leaves_little() {
        return Ok(Some(Selection::of_plain_alone(plain)));
    }
    // What the fit in free run takes away is correlated over the whole log; an effect does not have to show beside it.
    base.correlation_samples = plain.correlation_samples;
    let found = find_on(split, plant, library, plain, &base, watch)?;
    if matches!(found.verdict(), Verdict::Found | Verdict::Adequate) {
        return Ok(Some(found));
    }
    split.judge_in(Horizon::OneStepAhead);
    split.restore(before);
    Ok(None)
}

/// Finds what `plain` lacks, with fits of effects that begin at `base`.
fn find_on(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    mut plain: Trial,
    base: &Trial,
    watch: Watch,
) -> Result<Selection, DiagnoseError> {
    let wide = widened(&split.bench(plant, library), &plain, watch)?;
    let mut base = base;
    if let Some(wide) = &wide
        && wide.total_square() < CLEARLY_LESS * plain.total_square()
        && wide.is_inside(&plain)
    {
        // The way to the best values within the ranges led beyond them.
        plain = split.plain_from(plant, &wide.plant())?;
        base = &plain;
    }
    let adequate = wide.filter(|wide| wide.leaves_little() && !wide.is_inside(&plain));
    let found = select_from(split, plant, library, plain.clone(), base, watch)?;
    if let Some(wide) = adequate.filter(|wide| !found.is_better_than(wide)) {
        let outside = wide.outside(&plain);
        let mut values = outside.iter().map(|value| (&value.name, value.value));
        let may_be = values.all(|(name, value)| may_be_beside_first_file(plant, name, value));
        let is_as_good = found.is_as_good_as(&wide);
        if is_as_good && !may_be {
            return Ok(found.or(wide));
        }
        let rival = is_as_good.then(|| found.last().clone());
        let base = wide.clone();
        let wide = select_from(split, plant, library, wide, &base, watch)?;
        return Ok(wide.beyond(plain, rival));
    }
    Ok(found)
}

/// `plain` with wider ranges, where it leaves something to explain and parameters came to the end of theirs.
fn widened(bench: &Bench, plain: &Trial, watch: Watch) -> Result<Option<Trial>, DiagnoseError> {
    if !plain.is_material() {
        return Ok(None);
    }
    report(watch, "wider ranges", 0.0)?;
    Ok(bench.widened(plain))
}

/// Selects effects on top of `plain`, with fits that begin at `base`. The best single effect may show clocks and commands of the logs that
/// `plain` did not.
fn select_from(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    mut plain: Trial,
    base: &Trial,
    watch: Watch,
) -> Result<Selection, DiagnoseError> {
    let again = match plain.is_material() {
        true => split.find_fitted_clocks(plant, &plain)?,
        false => None,
    };
    let bench = split.bench(plant, library);
    let mut singles = match again {
        Some(again) => {
            plain = again;
            selection::singles(&bench, &plain, watch)?
        }
        None if plain.is_material() => selection::singles(&bench, base, watch)?,
        None => Vec::new(),
    };
    let best = singles.iter().find_map(|tried| tried.trial.as_ref());
    if let Some(best) = best.filter(|best| plain.is_material() && best.is_material()) {
        if best.fitted.is_material()
            && let Some((there, best)) = assigned_with(split, plant, library, best)
        {
            plain = split.plain_from(plant, &there)?;
            singles = selection::singles(&split.bench(plant, library), &plain, watch)?;
            take_better(&mut singles, best);
        } else if split.find_checked_clocks(plant, best)? {
            let bench = split.bench(plant, library);
            plain = (bench.judged_anew(&plain)).ok_or_else(|| split.not_simulated())?;
            judge_anew(&bench, &mut singles);
        }
    }
    let mut first = First { plain, singles };
    if let Some(other) = from_place_of_best(split, plant, library, &first, watch)? {
        first = other;
    }
    // A choice that leaves less may be the wrong one again, from which the right one is found.
    while first.leaves_currents()
        && let Some(other) = taken_otherwise(split, plant, library, &first, watch)?
    {
        first = other;
    }
    let First { plain, singles } = first;
    let bench = split.bench(plant, library);
    let mut found = selection::forward_selection(&bench, plain, singles, watch)?;
    if found.verdict() != Verdict::NotInLibrary {
        return Ok(found);
    }
    if let Some(nearest) = found.nearest.take()
        && let Some(again) = selected_by(split, plant, library, &found, &nearest, watch)?
    {
        return Ok(again);
    }
    let bench = split.bench(plant, library);
    let plain = &found.steps[0];
    let Some(singles) = finish_begun(&bench, plain, &found.singles, watch)? else {
        return Ok(found);
    };
    if selection::begins_otherwise(&bench, plain, &found.singles, &singles) {
        return selection::forward_selection(&bench, plain.clone(), singles, watch);
    }
    found.singles = singles;
    Ok(found)
}

/// Assigns the commands of slow logs with `best`, a plant with effects, and fits it again, in turn, as long as that lowers the cost: its clocks
/// were found without the effects. Returns the plant with the delay that goes with the clocks, and the last fit; none where the assignment
/// does not change.
fn assigned_with(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    best: &Trial,
) -> Option<(PlantParameters, Trial)> {
    let mut last: Option<(PlantParameters, Trial)> = None;
    for _ in 0..ASSIGNMENTS {
        let nearest = last.as_ref().map_or(best, |(_, fitted)| fitted);
        let before = split.logs();
        let Some(there) = split.assign_by(nearest) else {
            break;
        };
        let bench = split.bench(plant, library);
        let fitted = bench.fitted_from(best.effects.clone(), &there);
        // The first assignment may show other effects, whatever it leaves of this one.
        let is_better =
            |fitted: &Trial| last.is_none() || fitted.fit.cost < CLEARLY_LESS * nearest.fit.cost;
        let Some(fitted) = fitted.filter(is_better) else {
            split.restore(before);
            break;
        };
        last = Some((there, fitted));
    }
    last
}

/// Replaces the effect of `best` in `singles` by `best`, where that leaves less.
fn take_better(singles: &mut [Tried], best: Trial) {
    let same = singles.iter_mut().find(|tried| tried.id() == best.added());
    if let Some(tried) = same.filter(|tried| best.total_square() < tried.cost()) {
        tried.trial = Some(best);
        tried.is_finished = true;
    }
    singles.sort_by(|a, b| a.cost().total_cmp(&b.cost()));
}

/// Selects effects again where `nearest`, two effects together, shows clocks and commands of the logs that a single one did not. None, with
/// the former clocks and commands, where these do not change, or where still nothing is named.
fn selected_by(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    found: &Selection,
    nearest: &Trial,
    watch: Watch,
) -> Result<Option<Selection>, DiagnoseError> {
    let before = split.logs();
    let (plain, singles) = if nearest.fitted.is_material()
        && let Some((there, _)) = assigned_with(split, plant, library, nearest)
    {
        let plain = split.plain_from(plant, &there)?;
        let singles = selection::singles(&split.bench(plant, library), &plain, watch)?;
        (plain, singles)
    } else if split.find_checked_clocks(plant, nearest)? {
        let bench = split.bench(plant, library);
        let judged = bench.judged_anew(nearest);
        if judged.is_none_or(|judged| !leaves_clearly_less_of_check(&judged, nearest)) {
            split.restore(before);
            return Ok(None);
        }
        let plain = bench.judged_anew(&found.steps[0]);
        let mut singles = found.singles.clone();
        judge_anew(&bench, &mut singles);
        (plain.ok_or_else(|| split.not_simulated())?, singles)
    } else {
        return Ok(None);
    };
    let bench = split.bench(plant, library);
    let again = selection::forward_selection(&bench, plain, singles, watch)?;
    if again.verdict() == Verdict::NotInLibrary {
        split.restore(before);
        return Ok(None);
    }
    Ok(Some(again))
}

/// Whether `judged`, the plant of `former` with other clocks of the check logs, explains these logs clearly better: only then may another
/// selection from the same fits name what the former one did not.
fn leaves_clearly_less_of_check(judged: &Trial, former: &Trial) -> bool {
    judged.checked.total_excess() < CLEARLY_LESS * former.checked.total_excess()
}

/// The plain plant, fitted from the place of the best single effect, and every effect on top of it, where it then explains most of what that
/// effect does: the first fit of the plain plant had ended beside the best one, and the effect would get the credit for the difference.
fn from_place_of_best(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    first: &First,
    watch: Watch,
) -> Result<Option<First>, DiagnoseError> {
    let plain = &first.plain;
    let best = first.singles.iter().find_map(|tried| tried.trial.as_ref());
    let Some(best) = best.filter(|_| plain.is_material()) else {
        return Ok(None);
    };
    let before = split.conditions();
    split.take_conditions(best);
    let again = split.plain_from(plant, &best.plant())?;
    let gained = plain.total_square() - best.total_square();
    let is_most = plain.total_square() - again.total_square() >= MOST * gained;
    if gained <= 0.0 || !is_most {
        split.replace_conditions(&before);
        return Ok(None);
    }
    let singles = selection::singles(&split.bench(plant, library), &again, watch)?;
    Ok(Some(First {
        plain: again,
        singles,
    }))
}

impl First {
    /// Whether neither the plain plant nor an effect alone explains the currents.
    fn leaves_currents(&self) -> bool {
        let trials = self.singles.iter().filter_map(|tried| tried.trial.as_ref());
        core::iter::once(&self.plain)
            .chain(trials)
            .all(Trial::leaves_currents)
    }
}

/// The plain plant and every effect alone with the currents taken the other way, as means or as values of an instant, where that leaves
/// clearly less: a wrong choice hides what is missing in the coils.
fn taken_otherwise(
    split: &mut Split,
    plant: &PlantParameters,
    library: &[&'static dyn Effect],
    first: &First,
    watch: Watch,
) -> Result<Option<First>, DiagnoseError> {
    let least = |plain: &Trial, singles: &[Tried]| {
        let costs = singles.iter().map(Tried::cost);
        costs.fold(plain.total_square(), f64::min)
    };
    let bound = CLEARLY_LESS * least(&first.plain, &first.singles);
    let of_coils = library.iter().copied();
    let of_coils: Vec<_> = of_coils
        .filter(|&effect| shows_in_currents(effect))
        .collect();
    split.with_other_sampling(plant, &first.plain, |split, there| {
        let bench = split.bench(plant, &of_coils);
        let mut alone = try_all(&bench, &there, Effort::Search, "single effects", watch)?;
        let plain = split.plain_from(plant, &there.plant())?;
        if least(&plain, &alone) >= bound {
            return Ok(None);
        }
        alone.extend(selection::singles(
            &split.bench(plant, library),
            &plain,
            watch,
        )?);
        Ok(Some(First {
            plain,
            singles: best_forms(alone),
        }))
    })
}

fn judge_anew(bench: &Bench, singles: &mut [Tried]) {
    for tried in singles {
        tried.trial = tried
            .trial
            .as_ref()
            .and_then(|trial| bench.judged_anew(trial));
    }
}

#[cfg(test)]
mod tests {
    use core::ops::ControlFlow;

    use plant_sim::effects::{EffectSetting, by_id};
    use plant_sim::logger_clock::LoggerClock;

    use super::*;
    use crate::bench::{logged_through, pressure_alone};
    use crate::diagnosis::search::best_form;

    /// Data sheet of two on/off valves.
    const VALVES: &str = "
        supply_pressure_bar_gauge = 7     # ±0.35
        command_frequency_hz = 100        # exact
        chamber_volume_cm3 = 300          # ±15 %
        fill_C_dm3_per_s_bar = 0.5        # ±15 %
        fill_b = 0.3                      # ±0.1
        fill_opening_delay_ms = 2         # ±25 %
        fill_closing_delay_ms = 2         # ±25 %
        fill_opening_ramp_ms = 1.5        # ±25 %
        fill_closing_ramp_ms = 1.5        # ±25 %
        vent_C_dm3_per_s_bar = 0.6        # ±15 %
        vent_b = 0.3                      # ±0.1
        vent_opening_delay_ms = 2         # ±25 %
        vent_closing_delay_ms = 2         # ±25 %
        vent_opening_ramp_ms = 1.5        # ±25 %
        vent_closing_ramp_ms = 1.5        # ±25 %
    ";

    /// Defect seen: the plain plant took a wrong clock for a sensor that is slow, with commands assigned accordingly, and the lag explained
    /// 37 %.
    #[test]
    fn the_clock_of_a_slow_logger_is_found_with_a_slow_sensor() {
        let plant = PlantParameters::from_datasheet(VALVES, "plate").unwrap();
        let lag = EffectSetting::typical(by_id("sensor_lag").unwrap());
        let rig = plant.with_effect(lag.clone().with("time_constant_s", 0.035));
        let phases = [
            (0.5, 0.0, 0.0),
            (0.27, 55.0, 0.0),
            (0.5, 0.0, 0.0),
            (0.2, 70.0, 0.0),
            (0.7, 0.0, 0.0),
            (0.35, 0.0, 60.0),
        ];
        let [log, check] = [1, 2].map(|seed| {
            let clock = LoggerClock {
                phase_s: 4.3e-3,
                drift_ppm: -68.0,
            };
            let log = logged_through(&rig, clock, 20e-3, seed, &phases.repeat(15));
            pressure_alone(&log)
        });
        let (mut split, _) = Split::that_shows(&plant, &[log], &[check]).unwrap();
        let wrong = LoggerClock {
            phase_s: 12e-3,
            drift_ppm: 190.0,
        };
        split.fitting.logs[0].set_clock(wrong, &plant);
        let library = [lag.effect()];
        let begun = split
            .bench(&plant, &library)
            .fitted_from(vec![lag], &rig)
            .unwrap();
        let samples = split.fitting.counted_samples();
        assert!(begun.fit.cost > 2.0 * samples, "{}", begun.fit.cost);
        let (_, found) = assigned_with(&mut split, &plant, &library, &begun).unwrap();
        assert!(found.fit.cost < 1.1 * samples, "{}", found.fit.cost);
    }

    /// Defect seen: the fit of the plain plant ended at the end of a range beside the best values. The wider range led back to them, but the
    /// search went on from the end of the range.
    #[test]
    fn a_wider_range_that_leads_back_into_the_range_is_the_start() {
        let plant = PlantParameters::nominal();
        let log = logged_through(
            &plant,
            LoggerClock::default(),
            0.01,
            1,
            &[
                (0.5, 0.0, 0.0),
                (0.15, 60.0, 0.0),
                (0.5, 0.0, 0.0),
                (0.3, 0.0, 60.0),
                (0.3, 0.0, 0.0),
            ],
        );
        let (mut split, plain) = Split::that_shows(&plant, &[log], &[]).unwrap();
        assert!(!plain.is_material(), "{:?}", plain.fitted.excess());
        let mut beside = plain.clone();
        for (z, unknown) in beside.fit.z.iter_mut().zip(plain.unknowns.list()) {
            if unknown.name() == "flow.discharge_fill" {
                *z = unknown.bounds().1;
            }
        }
        let beside = split.bench(&plant, &[]).at_the_place_of(&beside).unwrap();
        assert!(beside.is_material(), "{:?}", beside.fitted.excess());
        let found = find(&mut split, &plant, &[], beside, &|_| {
            ControlFlow::Continue(())
        })
        .unwrap();
        assert_eq!(found.verdict(), Verdict::Adequate);
    }

    /// Defect seen: at 26 Hz, the commands of the check log had been assigned with a single effect. Two effects left nothing of the fitted
    /// log and most of the check log, and nothing was named.
    #[test]
    fn two_effects_together_show_the_commands_of_a_slow_check_log() {
        let plant = PlantParameters::nominal();
        let effects = ["chamber_leak", "sensor_lag"];
        let effects = effects.map(|id| EffectSetting::typical(by_id(id).unwrap()));
        let rig = effects
            .iter()
            .fold(plant.clone(), |rig, effect| rig.with_effect(effect.clone()));
        let phases = [
            (0.5, 0.0, 0.0),
            (0.15, 60.0, 0.0),
            (0.5, 0.0, 0.0),
            (0.2, 45.0, 0.0),
            (0.7, 0.0, 0.0),
            (0.35, 0.0, 50.0),
        ];
        let [log, check] = [(1, 5e-3), (2, 40e-3)].map(|(seed, interval_s)| {
            let clock = LoggerClock {
                phase_s: 3e-3,
                drift_ppm: 0.0,
            };
            pressure_alone(&logged_through(
                &rig,
                clock,
                interval_s,
                seed,
                &phases.repeat(6),
            ))
        });
        let watch = |_| ControlFlow::Continue(());
        let library: Vec<_> = effects.iter().map(EffectSetting::effect).collect();
        let (mut split, plain) = Split::that_shows(&plant, &[log], &[check]).unwrap();
        let bench = split.bench(&plant, &library);
        let [leak, lag] = effects
            .each_ref()
            .map(|effect| bench.forms_of(effect.effect()));
        let alone = best_form(&bench, &plain, leak).unwrap();
        let nearest = best_form(&bench, &alone, lag).unwrap();
        // A sample of the ECU late in every second half second.
        let late_ns = |ns: &u64| ns + ns / 500_000_000 % 2 * 10_000_000;
        for log in &mut split.checking.logs {
            log.set_issued_ns(log.issued_ns().iter().map(late_ns).collect());
        }
        let bench = split.bench(&plant, &library);
        let [plain, nearest] = [plain, nearest].map(|trial| bench.judged_anew(&trial).unwrap());
        assert!(
            !nearest.fitted.is_material(),
            "{:?}",
            nearest.fitted.excess()
        );
        assert!(nearest.checked.is_material());
        let singles = selection::singles(&bench, &plain, &watch).unwrap();
        let found = selection::forward_selection(&bench, plain, singles, &watch).unwrap();
        assert_ne!(found.verdict(), Verdict::Found);
        let again = selected_by(&mut split, &plant, &library, &found, &nearest, &watch).unwrap();
        let named: Vec<_> = again.unwrap().steps[1..].iter().map(Trial::added).collect();
        assert_eq!(named.len(), 2, "{named:?}");
    }
}
