//! Adds chosen effects to a plant, with values fitted to the logs.

use std::collections::BTreeMap;
use std::time::Instant;

use plant_sim::PlantParameters;
use plant_sim::effects::EffectSetting;
use recording::Recording;
use schemars::{JsonSchema, Schema};
use serde::{Deserialize, Serialize};

use super::error::{DiagnoseError, candidate};
use super::evidence::unknowns::Unknown;
use super::fit::split::Split;
use super::fit::trial::{Bench, Trial};
use super::result::words::{all_of, spaced};
use super::result::{Cost, FittedParameter, NuisanceValue, Step};
use super::search::assemble;
use super::search::selection::Selection;
use super::search::{Tried, Watch, best_form, report};
use super::verdict::CLEARLY_LESS;
use crate::result::{LogDefects, NotCompared, Warning};

/// Name and version of the JSON format.
pub const REFINEMENT_SCHEMA: &str = "retarder.refinement/2";

/// Fitted plant with the result of the fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Refined {
    /// Plant as given, with the effects and the fitted values, each with its provenance.
    pub plant: PlantParameters,
    /// Result of the fit.
    pub refinement: Refinement,
}

/// Decrease of the error with added effects.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Refinement {
    /// Name and version of this format, `retarder.refinement/2`.
    pub schema: String,
    /// Sources of the training logs.
    pub logs: Vec<String>,
    /// Sources of the validation logs; empty where validation uses held-out blocks of the training logs.
    pub check: Vec<String>,
    /// From the source of a log to its signals that were excluded, with the reasons.
    #[serde(default)]
    pub not_compared: BTreeMap<String, Vec<NotCompared>>,
    /// From the source of a log to its gaps and missing cells; absent where no log has any.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub defects: BTreeMap<String, LogDefects>,
    /// From the source of a log to the properties that probably differ from their declaration.
    #[serde(default)]
    pub warnings: BTreeMap<String, Vec<Warning>>,
    /// Validation data, in words.
    pub held_out: String,
    /// The result in words.
    pub sentence: String,
    /// Error steps, beginning with the plant without the requested effects; one row per added effect.
    pub error_steps: Vec<Step>,
    /// Every effect of the refined plant.
    pub effects: Vec<FittedEffect>,
    /// Parameters that may differ from rig to rig without missing physics.
    pub nuisance: Vec<NuisanceValue>,
    /// Cost of the answer.
    pub cost: Cost,
}

impl Refinement {
    /// Returns the JSON Schema of a refinement.
    pub fn json_schema() -> Schema {
        schemars::schema_for!(Self)
    }
}

/// Effect of the refined plant.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FittedEffect {
    /// Its id.
    pub effect: String,
    /// Form of its law.
    pub variant: String,
    /// Its parameters.
    pub parameters: Vec<FittedParameter>,
    /// Plausibility of the fitted size in practice, in words.
    pub plausibility: String,
    /// One sentence for the workshop.
    pub physics: String,
}

/// Refines as [`super::refine()`] does, with the part that lags in proportional valves as in `plant`.
///
/// # Errors
/// As [`super::refine()`].
pub(super) fn refine(
    plant: &PlantParameters,
    logs: &[Recording],
    check: &[Recording],
    add: &[(String, Option<String>)],
    watch: Watch,
) -> Result<Refined, DiagnoseError> {
    let begin = Instant::now();
    if logs.is_empty() {
        return Err(DiagnoseError::NoLog);
    }
    let forms = add
        .iter()
        .map(|(id, variant)| driven(forms(plant, id, variant.as_deref())?, logs))
        .collect::<Result<Vec<_>, _>>()?;
    let without = add
        .iter()
        .fold(plant.clone(), |plant, (id, _)| plant.without_effect(id));
    report(watch, "the plain model", 0.0)?;
    let (mut split, plain) = Split::that_shows(&without, logs, check)?;
    let mut steps = with_effects(&split, &without, plain, &forms, watch)?;
    let last = &steps[steps.len() - 1];
    if last.leaves_currents() {
        let bound = CLEARLY_LESS * last.total_square();
        let other = split.with_other_sampling(&without, &steps[0], |split, there| {
            let plain = split.plain_from(&without, &there.plant())?;
            let mut steps = with_effects(split, &without, there, &forms, watch)?;
            let is_less = steps[steps.len() - 1].total_square() < bound;
            steps[0] = plain;
            Ok(is_less.then_some(steps))
        })?;
        steps = other.unwrap_or(steps);
    }
    while let Some(again) = with_commands_again(&mut split, &without, &steps, &forms, watch)? {
        steps = again;
    }
    let bench = split.bench(&without, &[]);
    report(watch, "the final fit", 0.0)?;
    if let [_, .., last] = steps.as_mut_slice() {
        last.polish(&bench).ok_or_else(|| split.not_simulated())?;
    }
    let found = Selection {
        steps,
        within: None,
        alternative: None,
        rival: None,
        singles: Vec::new(),
        rivals: Vec::new(),
        nearest: None,
    };
    let (plain, last) = (&found.steps[0], &found.steps[found.steps.len() - 1]);
    let error_steps = assemble::error_steps(&bench, &found);
    let effects = last
        .effects
        .iter()
        .map(|setting| fitted_effect(&bench, plain, last, setting));
    let refinement = Refinement {
        schema: REFINEMENT_SCHEMA.to_owned(),
        logs: split.fitting.sources(),
        check: split.check_sources(),
        not_compared: split.not_compared(),
        defects: split.defects(),
        warnings: split.warnings(),
        held_out: split.held_out().to_owned(),
        sentence: sentence(&error_steps),
        effects: effects.collect(),
        nuisance: assemble::nuisance(&bench, plain, last),
        error_steps,
        cost: split.cost(begin),
    };
    Ok(Refined {
        plant: with_provenance(last, &refinement.logs),
        refinement,
    })
}

/// Returns the fitted plant `plain`, and one trial per effect, each in the best of its `forms` on top of those before it.
fn with_effects(
    split: &Split,
    plant: &PlantParameters,
    plain: Trial,
    forms: &[Vec<EffectSetting>],
    watch: Watch,
) -> Result<Vec<Trial>, DiagnoseError> {
    let bench = split.bench(plant, &[]);
    let not_simulated = || split.not_simulated();
    let mut steps = vec![plain];
    for (index, one) in forms.iter().enumerate() {
        report(watch, "adding effects", index as f64 / forms.len() as f64)?;
        let base = &steps[steps.len() - 1];
        let mut next = best_form(&bench, base, one.clone()).ok_or_else(not_simulated)?;
        next.refresh(&bench).ok_or_else(not_simulated)?;
        steps.push(next);
    }
    Ok(steps)
}

/// Finds the clocks and commands of the logs again with the last of `steps`, since those of `steps` were found without the effects. Returns
/// the trials of [`with_effects`] with them; none, with unchanged logs, if they do not leave clearly less.
fn with_commands_again(
    split: &mut Split,
    plant: &PlantParameters,
    steps: &[Trial],
    forms: &[Vec<EffectSetting>],
    watch: Watch,
) -> Result<Option<Vec<Trial>>, DiagnoseError> {
    let last = &steps[steps.len() - 1];
    if !last.fitted.is_material() {
        return Ok(None);
    }
    let before = split.logs();
    let there = split.choose_clocks_by(last);
    let Some(there) = there.or_else(|| split.assign_by(last)) else {
        return Ok(None);
    };
    let plain = split.plain_from(plant, &there)?;
    let again = with_effects(split, plant, plain, forms, watch)?;
    if again[again.len() - 1].total_square() < CLEARLY_LESS * last.total_square() {
        return Ok(Some(again));
    }
    split.restore(before);
    Ok(None)
}

/// Returns the effect `id` in its form `variant`, or in all of its forms that `plant` admits.
fn forms(
    plant: &PlantParameters,
    id: &str,
    variant: Option<&str>,
) -> Result<Vec<EffectSetting>, DiagnoseError> {
    let effect = candidate(plant, id)?;
    let about = effect.about();
    let Some(variant) = variant else {
        return Ok(plant.forms_of(effect));
    };
    let form = about.variant(variant).ok_or_else(|| {
        let names: Vec<&str> = about.variants.iter().map(|form| form.name).collect();
        DiagnoseError::NoSuchVariant {
            id: id.to_owned(),
            variant: variant.to_owned(),
            forms: names.join(", "),
        }
    })?;
    Ok(vec![EffectSetting::typical_variant(effect, form)])
}

/// Returns the forms whose driving signal a log has.
fn driven(
    mut forms: Vec<EffectSetting>,
    logs: &[Recording],
) -> Result<Vec<EffectSetting>, DiagnoseError> {
    let is_logged = |signal: &str| logs.iter().any(|log| log.mentions(signal));
    let undriven = |form: &EffectSetting| form.driven_by().filter(|signal| !is_logged(signal));
    let missing = forms
        .iter()
        .find_map(|form| Some((form.id(), undriven(form)?)));
    forms.retain(|form| undriven(form).is_none());
    match missing {
        Some((id, signal)) if forms.is_empty() => Err(DiagnoseError::NotDriven { id, signal }),
        _ => Ok(forms),
    }
}

fn fitted_effect(
    bench: &Bench,
    plain: &Trial,
    last: &Trial,
    setting: &EffectSetting,
) -> FittedEffect {
    let tried = Tried {
        setting: setting.clone(),
        trial: None,
        is_finished: true,
    };
    let candidate = assemble::candidate(bench, plain, last, &tried);
    FittedEffect {
        effect: candidate.effect,
        variant: candidate.variant,
        parameters: candidate.parameters,
        plausibility: candidate.plausibility,
        physics: candidate.physics,
    }
}

fn sentence(error_steps: &[Step]) -> String {
    let last = &error_steps[error_steps.len() - 1];
    let added: Vec<String> = error_steps
        .iter()
        .filter_map(|step| step.added.as_ref())
        .map(|id| spaced(id))
        .collect();
    format!(
        "with {} {:.0} % of the excess error is explained",
        all_of(&added),
        100.0 * last.explained_share.max(0.0)
    )
}

/// Returns the fitted plant; the provenance of each fitted value names the logs.
pub(super) fn with_provenance(trial: &Trial, logs: &[String]) -> PlantParameters {
    let mut plant = trial.plant();
    let origin = format!("fitted by retarder refine to {}", logs.join(", "));
    for unknown in trial.unknowns.list() {
        match unknown {
            Unknown::Effect(effect) => say(&mut plant, &effect.spec.name(), &origin),
            Unknown::Nuisance(nuisance) => {
                let name = nuisance.spec.name();
                let origin = format!("{origin}; was {}", nuisance.datasheet);
                say(&mut plant, &name, &origin);
                for other in nuisance.together_with() {
                    say(&mut plant, &other, &format!("in proportion with {name}"));
                }
            }
            Unknown::Log(_) => {}
        }
    }
    plant
}

/// Number of significant digits in a file: more than any log can show.
const DIGITS: usize = 7;

/// Returns a value rounded for a file.
pub(super) fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// Rounds a value for a file, and states its origin.
fn say(plant: &mut PlantParameters, name: &str, origin: &str) {
    let (Some(spec), Some(value)) = (plant.any_spec(name), plant.get(name)) else {
        return;
    };
    spec.put(plant, rounded(value));
    plant.provenance.insert(name.to_owned(), origin.to_owned());
}

#[cfg(test)]
mod tests {
    use core::ops::ControlFlow;

    use plant_sim::effects::by_id;

    use super::*;

    fn refused(id: &str, variant: Option<&str>) -> String {
        forms(&PlantParameters::nominal(), id, variant)
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn an_effect_is_taken_in_the_form_asked_for_or_in_all() {
        let count = |variant| {
            let forms = forms(&PlantParameters::nominal(), "chamber_leak", variant);
            forms.unwrap().len()
        };
        assert_eq!([count(Some("laminar")), count(None)], [1, 4]);
        assert!(refused("chamber_leek", None).contains("did you mean `chamber_leak`"));
        assert!(refused("chamber_leak", Some("square")).contains("orifice, laminar, mixed, power"));
    }

    /// Goal: the file states the fitted value, the logs, and the previous value. Method: a leak on a synthetic rig.
    #[test]
    fn fitted_values_carry_their_provenance_and_are_near_the_truth() {
        let leak = EffectSetting::typical(by_id("chamber_leak").unwrap()).with("area_m2", 3e-8);
        let mut bench = crate::bench::Bench::default();
        bench.plant = bench.plant.with_effect(leak);
        let log = bench.measure();
        let add = [("chamber_leak".to_owned(), Some("orifice".to_owned()))];
        let nominal = PlantParameters::nominal();
        let refined = refine(&nominal, &[log], &[], &add, &|_| ControlFlow::Continue(())).unwrap();
        let area = refined.plant.get("effects.chamber_leak.area_m2").unwrap();
        assert!((area / 3e-8 - 1.0).abs() < 0.1, "{area}");
        let origin = &refined.plant.provenance["flow.discharge_fill"];
        assert!(
            origin.starts_with("fitted by retarder refine to ") && origin.ends_with("; was 0.95")
        );
        let read = PlantParameters::from_toml(&refined.plant.to_toml(), "refined").unwrap();
        assert_eq!(read.effects, refined.plant.effects);
    }
}
