//! Plant refitted within the ranges that its file states for the ordinary parameters, and the search for effects on top of it.

use std::time::Instant;

use plant_sim::PlantParameters;
use plant_sim::effects::{Effect, EffectSetting};
use rayon::prelude::*;
use recording::Recording;

use super::error::DiagnoseError;
use super::evidence::logged_supply::with_logged_supply;
use super::evidence::predictor;
use super::fit::split::Split;
use super::fit::trial::Trial;
use super::remaining;
use super::result::{DIAGNOSIS_SCHEMA, Diagnosis, FittedConditions, Location};
use super::search::found::{self, Extent};
use super::search::{self, Watch, assemble, selection};

/// Refitted plant with its logs.
pub(super) struct Refitted<'a> {
    begin: Instant,
    logs: &'a [Recording],
    /// Plant file, with the supply pressure of the logs.
    plant: PlantParameters,
    split: Split,
    plain: Trial,
}

/// Diagnosis within the ranges of the plant file, and what a search with estimated values needs of it.
pub(super) struct Answer {
    pub(super) diagnosis: Diagnosis,
    /// Named effects with their fitted parameters.
    pub(super) found: Vec<EffectSetting>,
    /// Whether a material error remains, ...
    pub(super) is_material: bool,
    /// ... and ordinary parameters reached the ends of their ranges.
    pub(super) is_held_back: bool,
}

impl<'a> Refitted<'a> {
    /// Fits the clocks of the loggers and the ordinary parameters of `plant`.
    pub(super) fn fit(
        plant: &PlantParameters,
        logs: &'a [Recording],
        check: &[Recording],
        watch: Watch,
    ) -> Result<Self, DiagnoseError> {
        let begin = Instant::now();
        if logs.is_empty() {
            return Err(DiagnoseError::NoLog);
        }
        search::report(watch, "the plain model", 0.0)?;
        let plant = with_logged_supply(plant, logs.iter().chain(check));
        let (split, plain) = Split::that_shows(&plant, logs, check)?;
        Ok(Self {
            begin,
            logs,
            plant,
            split,
            plain,
        })
    }

    /// Returns whether a material error remains.
    pub(super) fn is_material(&self) -> bool {
        self.plain.is_material()
    }

    /// Searches the effects of `library` that the plant lacks, to this `extent`.
    pub(super) fn search(
        self,
        library: &[&'static dyn Effect],
        extent: Extent,
        watch: Watch,
    ) -> Result<Answer, DiagnoseError> {
        let Self {
            begin,
            logs,
            plant,
            mut split,
            plain,
        } = self;
        // An effect of a part that the plant lacks, or of a signal that no log has, has no form.
        let library: Vec<&'static dyn Effect> = library
            .iter()
            .copied()
            .filter(|&effect| !split.bench(&plant, library).forms_of(effect).is_empty())
            .collect();
        let mut found = match extent {
            Extent::All => found::find(&mut split, &plant, &library, plain, watch)?,
            Extent::One => selection::of_one_effect(&split.bench(&plant, &library), plain, watch)?,
        };
        if extent == Extent::All
            && let Some(training_alone) = found.explaining_training_alone()
            && let Some(mut all) = split.of_all_logs(training_alone)
        {
            let plain = all.plain_from(&plant, &found.steps[0].plant())?;
            let of_all = found::find(&mut all, &plant, &library, plain, watch)?;
            if !of_all.is_unexplained() {
                (split, found) = (all, of_all);
            }
        }
        let mut adds_up = found.adds_up(&split.bench(&plant, &library));
        if adds_up
            && let Some(free) =
                found::find_in_free_run(&mut split, &plant, &library, &found, watch)?
        {
            (found, adds_up) = (free, false);
        }
        let bench = split.bench(&plant, &library);
        let is_final = extent == Extent::All;
        if is_final {
            found = found.with_glance(&bench, watch)?;
            search::report(watch, "the final fit", 0.0)?;
            let last = found.steps.last_mut().expect("at least the plain plant");
            last.polish(&bench).ok_or_else(|| split.not_simulated())?;
            found.settle();
        }
        let (plain, last) = (&found.steps[0], &found.steps[found.steps.len() - 1]);
        let is_converged = last.is_converged(&bench);
        let mut candidates = Vec::new();
        // Nobody sees those of a search that only shows whether to search with the estimates.
        if is_final {
            search::report(watch, "detection limits", 0.0)?;
            let singles = found.singles.par_iter();
            candidates = singles
                .map(|tried| assemble::candidate(&bench, plain, last, tried))
                .collect();
        }
        let error_steps = assemble::error_steps(&bench, &found);
        let within = found.within.as_ref().unwrap_or(plain);
        let nuisance = assemble::nuisance(&bench, within, last);
        let outside = found.alternative.as_ref().unwrap_or(last).outside(within);
        let (equivalents, distinguishability) = assemble::equivalents(&found);
        search::report(watch, "where the error is", 0.0)?;
        split.take_conditions(plain);
        let given = assemble::regimes(&plant, logs, &split.fitting.logs)?;
        let before = assemble::regimes(&plain.plant(), logs, &split.fitting.logs)?;
        let with_plain = split.found_conditions();
        split.take_conditions(last);
        let conditions = with_plain.into_iter().zip(split.found_conditions());
        let conditions = conditions
            .map(|((source, plain), (_, refined))| (source, FittedConditions { plain, refined }))
            .collect();
        let after = if found.steps.len() > 1 {
            assemble::regimes(&last.plant(), logs, &split.fitting.logs)?
        } else {
            before.clone()
        };
        let logs_seen: Vec<_> = split
            .fitting
            .logs
            .iter()
            .chain(split.check_logs())
            .collect();
        let remaining = remaining::remaining(&last.plant(), &logs_seen, last.is_material());
        let is_material = last.is_material();
        let is_held_back = is_material && last.unknowns.widened(&last.fit.z).is_some();
        let mut diagnosis = Diagnosis {
            schema: DIAGNOSIS_SCHEMA.to_owned(),
            logs: split.fitting.sources(),
            check: split.check_sources(),
            not_compared: split.not_compared(),
            defects: split.defects(),
            warnings: split.warnings(),
            clocks: split.clocks(),
            starts: split.starts(),
            conditions,
            held_out: split.held_out().to_owned(),
            lag_of: None,
            horizon: split.horizon(),
            adds_up,
            predictor: predictor::statement(split.horizon()).to_owned(),
            verdict: found.verdict(),
            sentence: String::new(),
            is_converged,
            rival_effects: found.rival_effects(),
            effects: error_steps
                .iter()
                .filter_map(|step| step.added.clone())
                .collect(),
            unexplained: found.is_unexplained(),
            equivalents,
            distinguishability,
            nuisance,
            error_steps,
            outside,
            candidates,
            location: Location {
                of_compare: assemble::moved_by_refit(&given, &before),
                before,
                after,
            },
            remaining,
            cost: split.cost(begin),
        };
        diagnosis.sentence = assemble::sentence(&assemble::Answer::from(&diagnosis));
        let found = last.plant().effects;
        let is_found =
            |effect: &EffectSetting| diagnosis.effects.iter().any(|id| id == effect.id());
        Ok(Answer {
            found: found.into_iter().filter(is_found).collect(),
            diagnosis,
            is_material,
            is_held_back,
        })
    }
}

impl Answer {
    /// Returns `plant` with the named effects.
    pub(super) fn plant_with_found(&self, plant: &PlantParameters) -> PlantParameters {
        let found = self.found.iter().cloned();
        found.fold(plant.clone(), |plant, effect| plant.with_effect(effect))
    }
}
