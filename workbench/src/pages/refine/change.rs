//! Changes of a plant's effects; each is a step that can be undone.

use model_lab::diagnosis::result::{Candidate, FittedParameter};
use plant_sim::PlantParameters;
use plant_sim::effects::{Effect, EffectSetting};
use serde::Deserialize;

use super::refitted::{RefittedParameter, refitted};
use crate::history::{BY_HAND, History, Step, StepEffect};
use crate::refusal::Refusal;
use crate::results::Diagnosed;

/// Change of the plant by the user. Without a tag field, since serde cannot read buffered numbers if any crate of the
/// program enables serde_json's `arbitrary_precision`, as the log's decoder does.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Change {
    /// Adds an effect with its diagnosed values, or else at its typical size.
    Add {
        effect: String,
        /// Form of its law; `None` takes that of the diagnosis, or the first.
        form: Option<String>,
    },
    Remove {
        effect: String,
    },
    Switch {
        effect: String,
        is_on: bool,
    },
    Form {
        effect: String,
        form: String,
    },
    Set {
        effect: String,
        key: String,
        value: f64,
    },
    /// Switches an ordinary parameter between its refitted value and the one as opened.
    Ordinary {
        name: String,
        is_refitted: bool,
    },
    Undo,
    Redo,
}

impl Change {
    pub(super) fn apply(
        &self,
        history: &mut History,
        diagnosed: Option<&Diagnosed>,
    ) -> Result<(), Refusal> {
        match self {
            Self::Add { effect, form } => add(history, effect, form.as_deref(), diagnosed),
            Self::Remove { effect } => edit(history, |draft| draft.remove(effect)),
            Self::Switch { effect, is_on } => edit(history, |draft| draft.switch(effect, *is_on)),
            Self::Form { effect, form } => edit(history, |draft| draft.form(effect, form)),
            Self::Set { effect, key, value } => {
                edit(history, |draft| draft.set(effect, key, *value))
            }
            Self::Ordinary { name, is_refitted } => {
                let mut changed = refitted(history)?.into_iter();
                let parameter = changed.find(|one| one.name == *name);
                let parameter =
                    parameter.ok_or_else(|| Refusal::not_found("refitted parameter"))?;
                edit(history, |draft| {
                    draft.switch_ordinary(&parameter, *is_refitted)
                })
            }
            Self::Undo => history.undo(),
            Self::Redo => history.redo(),
        }
    }
}

/// Creates a step from a change of the plant, named by the description that `change` returns.
fn edit(
    history: &mut History,
    change: impl FnOnce(&mut Draft) -> Result<String, Refusal>,
) -> Result<(), Refusal> {
    let mut draft = Draft::of(history.now())?;
    let done = change(&mut draft)?;
    let step = draft.step(done, history.first())?;
    history.push(step);
    Ok(())
}

/// Adds an effect. If the diagnosis fitted the ordinary parameters with it, they are a step of their own before that of
/// the effect, so that the effect is not credited with their share of the error.
fn add(
    history: &mut History,
    effect: &str,
    form: Option<&str>,
    diagnosed: Option<&Diagnosed>,
) -> Result<(), Refusal> {
    let found = diagnosed.filter(|found| fitted_effect(found, effect, form).is_some());
    let mut draft = Draft::of(history.now())?;
    let mut refitted = None;
    if let Some(found) = found
        && draft.take_what_was_fitted_with(effect, found)?
    {
        let done = format!(
            "refitted the ordinary parameters together with {}",
            title(effect)
        );
        let step = draft.step(done, history.first())?;
        draft = Draft::of(&step)?;
        refitted = Some(step);
    }
    let done = draft.add(effect, form, found)?;
    let added = draft.step(done, history.first())?;
    for step in refitted.into_iter().chain([added]) {
        history.push(step);
    }
    Ok(())
}

/// Returns the candidate `id` of a diagnosis, unless another form is wanted or nothing of it was fitted.
fn fitted_effect<'a>(found: &'a Diagnosed, id: &str, form: Option<&str>) -> Option<&'a Candidate> {
    let mut candidates = found.diagnosis.candidates.iter();
    candidates
        .find(|one| one.effect == id)
        .filter(|one| form.is_none_or(|form| form == one.variant))
        .filter(|one| !one.parameters.is_empty())
}

/// Returns the plant at `now` with a changed parameter, without a step.
pub(super) fn moved(now: &Step, effect: &str, key: &str, value: f64) -> Result<Step, Refusal> {
    let mut draft = Draft::of(now)?;
    let done = draft.set(effect, key, value)?;
    draft.step(done, now)
}

/// Unfinished step.
struct Draft {
    plant: PlantParameters,
    effects: Vec<StepEffect>,
}

fn origin(found: &Diagnosed) -> String {
    format!(
        "fitted by retarder diagnose to {}",
        found.diagnosis.logs.join(", ")
    )
}

fn title(id: &str) -> String {
    id.replace(['_', '.'], " ")
}

impl Draft {
    fn of(step: &Step) -> Result<Self, Refusal> {
        Ok(Self {
            plant: step.plant.parameters()?,
            effects: step.effects.clone(),
        })
    }

    fn candidate(&self, id: &str) -> Result<&'static dyn Effect, Refusal> {
        let candidate = self.plant.candidate(id);
        candidate.ok_or_else(|| Refusal::not_found("effect"))
    }

    fn effect(&mut self, id: &str) -> Result<&mut StepEffect, Refusal> {
        let mut effects = self.effects.iter_mut();
        let found = effects.find(|effect| effect.effect == id);
        found.ok_or_else(|| Refusal::not_found("effect in this plant"))
    }

    fn add(
        &mut self,
        id: &str,
        form: Option<&str>,
        diagnosed: Option<&Diagnosed>,
    ) -> Result<String, Refusal> {
        let about = self.candidate(id)?.about();
        if self.effect(id).is_ok() {
            return Err(Refusal::value(format!(
                "the plant has the effect {id} already; switch it on or move its parameters"
            )));
        }
        let candidate = diagnosed.and_then(|found| fitted_effect(found, id, form));
        let form = form.or(candidate.map(|candidate| &candidate.variant[..]));
        let variant = match form {
            Some(form) => about
                .variant(form)
                .ok_or_else(|| Refusal::not_found("form of the effect"))?,
            None => &about.variants[0],
        };
        let mut setting = EffectSetting::typical_variant(self.candidate(id)?, variant);
        let fitted = candidate.map_or(&[][..], |candidate| &candidate.parameters);
        for found in fitted {
            if variant.parameters.iter().any(|spec| spec.key == found.key) {
                setting = setting.with(&found.key, found.value);
            }
        }
        let words = format!("added {} ({})", title(id), variant.name);
        self.effects.push(StepEffect::of(&setting, fitted));
        match diagnosed {
            Some(found) if candidate.is_some() => self.install(&setting, &origin(found))?,
            _ => self.install(&setting, "a size that is met in practice")?,
        }
        Ok(words)
    }

    /// Takes the parameters that differ between rigs from the diagnosis, as fitted together with the named effect: with
    /// the datasheet's values the effect would explain less than it does. Returns whether one of them changed.
    fn take_what_was_fitted_with(&mut self, id: &str, found: &Diagnosed) -> Result<bool, Refusal> {
        let before = found.plant.parameters()?;
        if self.plant != before || !found.diagnosis.effects.iter().any(|named| named == id) {
            return Ok(false);
        }
        let mut is_changed = false;
        let [_, refined] = found.diagnosis.plain_and_refined(&before);
        for spec in before.specs().filter(|spec| spec.effect_id().is_none()) {
            let (Some(was), Some(fitted)) = (spec.value(&before), spec.value(&refined)) else {
                continue;
            };
            if was != fitted {
                is_changed = true;
                spec.put(&mut self.plant, fitted);
                let words = format!("{}; was {was}", origin(found));
                self.plant.provenance.insert(spec.name(), words);
            }
        }
        Ok(is_changed)
    }

    /// Adds an effect to the plant.
    fn install(&mut self, setting: &EffectSetting, origin: &str) -> Result<(), Refusal> {
        self.plant = self.plant.with_effect(setting.clone());
        for spec in setting.parameters() {
            let provenance = &mut self.plant.provenance;
            provenance.insert(spec.name(), origin.to_owned());
        }
        Ok(self.plant.check()?)
    }

    /// Returns an effect of the plant, whether it is on or off.
    fn setting(&self, id: &str) -> Result<EffectSetting, Refusal> {
        let found = self.effects.iter().find(|effect| effect.effect == id);
        let found = found.ok_or_else(|| Refusal::not_found("effect in this plant"))?;
        found.setting(&self.plant)
    }

    fn remove(&mut self, id: &str) -> Result<String, Refusal> {
        self.effect(id)?;
        self.effects.retain(|effect| effect.effect != id);
        self.plant = self.plant.without_effect(id);
        Ok(format!("removed {}", title(id)))
    }

    fn switch(&mut self, id: &str, is_on: bool) -> Result<String, Refusal> {
        self.effect(id)?.is_on = is_on;
        let setting = self.setting(id)?;
        if is_on {
            self.install(&setting, BY_HAND)?;
        } else {
            self.plant = self.plant.without_effect(id);
        }
        Ok(format!(
            "switched {} {}",
            title(id),
            if is_on { "on" } else { "off" }
        ))
    }

    fn switch_ordinary(
        &mut self,
        parameter: &RefittedParameter,
        is_refitted: bool,
    ) -> Result<String, Refusal> {
        let RefittedParameter {
            name,
            unit,
            before,
            after,
            ..
        } = parameter;
        let (value, words, origin) = if is_refitted {
            (*after, "refitted", format!("refitted; was {before}"))
        } else {
            (
                *before,
                "as opened",
                format!("as opened; refitted: {after}"),
            )
        };
        self.plant.set(name, value, &origin)?;
        let value = format!("{value} {unit}");
        Ok(format!("{name}: {}, {words}", value.trim_end()))
    }

    /// Changes the form of the law; parameters of both forms keep their values.
    fn form(&mut self, id: &str, form: &str) -> Result<String, Refusal> {
        let candidate = self.candidate(id)?;
        let variant = candidate.about().variant(form);
        let variant = variant.ok_or_else(|| Refusal::not_found("form of the effect"))?;
        let before = self.setting(id)?;
        let mut setting = EffectSetting::typical_variant(candidate, variant);
        for spec in variant.parameters {
            if let Some(value) = before.get(spec.key) {
                setting = setting.with(spec.key, value);
            }
        }
        let effect = self.effect(id)?;
        let is_on = effect.is_on;
        *effect = StepEffect {
            is_on,
            ..StepEffect::of(&setting, &[] as &[FittedParameter])
        };
        if is_on {
            self.install(&setting, BY_HAND)?;
        }
        Ok(format!("{}: law {form}", title(id)))
    }

    fn set(&mut self, id: &str, key: &str, value: f64) -> Result<String, Refusal> {
        let name = format!("effects.{id}.{key}");
        let spec = self
            .plant
            .any_spec(&name)
            .ok_or_else(|| Refusal::not_found("parameter of the effect"))?;
        if !spec.contains(value) || !value.is_finite() {
            let (lowest, highest) = spec.range;
            return Err(Refusal::value(format!(
                "{name} is {value} (between {lowest} and {highest} {}); enter a value in this range",
                spec.unit
            )));
        }
        let effect = self.effect(id)?;
        let is_on = effect.is_on;
        let mut parameters = effect.parameters.iter_mut();
        parameters
            .find(|parameter| parameter.key == key)
            .ok_or_else(|| Refusal::not_found("parameter of this form"))?
            .value = Some(value);
        if is_on {
            self.plant.set(&name, value, BY_HAND)?;
        }
        Ok(format!("{}: {key} = {value:.3e} {}", title(id), spec.unit)
            .trim_end()
            .to_owned())
    }

    fn step(self, done: String, first: &Step) -> Result<Step, Refusal> {
        Step::to(&self.plant, done, self.effects, first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::project::PlantFile;

    fn history() -> History {
        History::begin(&PlantFile::nominal()).unwrap()
    }

    fn change(history: &mut History, json: &str) -> Result<(), Refusal> {
        let change: Change = serde_json::from_str(json).unwrap();
        change.apply(history, None)
    }

    fn area(history: &History) -> Option<f64> {
        let plant = history.now().plant.parameters().unwrap();
        plant.get("effects.chamber_leak.area_m2")
    }

    #[test]
    fn an_effect_is_added_moved_switched_and_undone() {
        let mut history = history();
        for (json, expected) in [
            (r#"{"add": {"effect":"chamber_leak"}}"#, Some(2e-8)),
            (
                r#"{"set": {"effect":"chamber_leak","key":"area_m2","value":3e-8}}"#,
                Some(3e-8),
            ),
            (
                r#"{"switch": {"effect":"chamber_leak","is_on":false}}"#,
                None,
            ),
            (
                r#"{"switch": {"effect":"chamber_leak","is_on":true}}"#,
                Some(3e-8),
            ),
            (r#""undo""#, None),
            (r#""undo""#, Some(3e-8)),
            (r#""redo""#, None),
            (r#"{"remove": {"effect":"chamber_leak"}}"#, None),
        ] {
            change(&mut history, json).unwrap();
            assert_eq!(area(&history), expected, "{json}");
        }
        assert_eq!(
            history.now().plant,
            PlantFile::nominal(),
            "as it was opened"
        );
    }

    #[test]
    fn another_form_keeps_the_values_that_it_has_too() {
        let mut history = history();
        change(&mut history, r#"{"add": {"effect":"chamber_leak"}}"#).unwrap();
        change(
            &mut history,
            r#"{"set": {"effect":"chamber_leak","key":"area_m2","value":7e-8}}"#,
        )
        .unwrap();
        change(
            &mut history,
            r#"{"form": {"effect":"chamber_leak","form":"mixed"}}"#,
        )
        .unwrap();
        assert_eq!(area(&history), Some(7e-8));
        let toml = &history.now().plant.toml;
        assert!(toml.contains("variant = \"mixed\"") && toml.contains("laminar_share = 0.5"));
    }

    #[test]
    fn what_is_not_there_or_out_of_range_changes_nothing() {
        let mut history = history();
        change(&mut history, r#"{"add": {"effect":"chamber_leak"}}"#).unwrap();
        for json in [
            r#"{"add": {"effect":"chamber_leek"}}"#,
            r#"{"add": {"effect":"chamber_leak"}}"#,
            r#"{"add": {"effect":"sensor_lag","form":"none"}}"#,
            r#"{"remove": {"effect":"sensor_lag"}}"#,
            r#"{"set": {"effect":"chamber_leak","key":"area_m2","value":1.0}}"#,
            r#"{"set": {"effect":"chamber_leak","key":"laminar_share","value":0.5}}"#,
            r#""redo""#,
        ] {
            assert!(change(&mut history, json).is_err(), "{json}");
            assert_eq!(history.at(), 1, "{json}");
        }
    }
}
