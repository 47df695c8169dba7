//! History of a plant: every change of the pages "Estimate" and "Refine", with the error after it. Undo and redo move
//! within it.

use model_lab::SignalError;
use model_lab::diagnosis::result::FittedParameter;
use model_lab::diagnosis::{Estimation, Refinement};
use plant_sim::PlantParameters;
use plant_sim::effects::EffectSetting;
use serde::{Deserialize, Serialize};

use crate::plant_file::PlantFile;
use crate::refusal::Refusal;

/// Largest number of steps; beyond it the oldest is dropped, except for the first.
const STEPS_MAX: usize = 100;

/// File name of a plant that was changed here.
const REFINED: &str = "refined.toml";
/// Source of a value that the user chose.
pub(crate) const BY_HAND: &str = "set by hand in the workbench";

/// Steps of a plant, beginning with the opened one.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct History {
    steps: Vec<Step>,
    /// Current step; those after it were undone.
    at: usize,
}

/// Change and its result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Step {
    /// Description of the change for the user.
    pub(crate) done: String,
    /// Plant after the change, without the effects that are switched off.
    pub(crate) plant: PlantFile,
    /// All effects in the order of their addition, including those switched off.
    pub(crate) effects: Vec<StepEffect>,
    /// Name of the log of the errors; empty until they are known.
    pub(crate) log: String,
    /// Free-run errors of the plant on that log.
    pub(crate) errors: Vec<StepError>,
    /// Result of the fit of effects, if the step is one.
    pub(crate) fit: Option<Refinement>,
    /// Result of the estimation, if the step is one.
    pub(crate) estimation: Option<Estimation>,
    /// Whether the step states another plant file, from which fits start; absent in files of earlier versions.
    #[serde(default)]
    pub(crate) is_restated: bool,
}

/// Effect with its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepEffect {
    pub(crate) effect: String,
    pub(crate) variant: String,
    pub(crate) is_on: bool,
    pub(crate) parameters: Vec<StepParameter>,
}

/// Parameter of an effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepParameter {
    pub(crate) key: String,
    pub(crate) unit: String,
    /// Value; `None` if it is infinite, with which some effects are off.
    pub(crate) value: Option<f64>,
    /// Result of the last fit.
    pub(crate) fitted: Option<Interval>,
}

/// Fitted value with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Interval {
    pub(crate) value: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// Error of a plant in one signal.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepError {
    pub(crate) signal: String,
    pub(crate) unit: String,
    pub(crate) rms: Option<f64>,
    /// Standard deviation of the measurement noise.
    pub(crate) noise_floor: Option<f64>,
}

impl From<&SignalError> for StepError {
    fn from(error: &SignalError) -> Self {
        Self {
            signal: error.name.to_owned(),
            unit: error.unit.to_owned(),
            rms: error.rms,
            noise_floor: error.noise_floor,
        }
    }
}

impl History {
    /// Begins a history with a plant as opened.
    pub(crate) fn begin(plant: &PlantFile) -> Result<Self, Refusal> {
        let effects = plant.parameters()?.effects;
        Ok(Self {
            steps: vec![Step {
                done: format!("opened {}", plant.name),
                plant: plant.clone(),
                effects: effects
                    .iter()
                    .map(|setting| StepEffect::of(setting, &[]))
                    .collect(),
                log: String::new(),
                errors: Vec::new(),
                fit: None,
                estimation: None,
                is_restated: false,
            }],
            at: 0,
        })
    }

    /// Returns whether its last step is this plant.
    pub(crate) fn is_of(&self, plant: &PlantFile) -> bool {
        self.steps
            .get(self.at)
            .is_some_and(|step| step.plant == *plant)
    }

    /// Returns all steps, including the undone ones.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Returns the index of the current step.
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// Returns the plant as opened.
    pub(crate) fn first(&self) -> &Step {
        &self.steps[0]
    }

    /// Returns the plant that effects are fitted on: the last estimated or restated one, or the one as opened.
    pub(crate) fn base(&self) -> &Step {
        let until_now = self.steps[..=self.at].iter().rev();
        let mut bases = until_now.filter(|step| step.estimation.is_some() || step.is_restated);
        bases.next().unwrap_or_else(|| self.first())
    }

    /// Returns the last estimation up to the current step.
    pub(crate) fn estimation(&self) -> Option<&Estimation> {
        let until_now = self.steps[..=self.at].iter().rev();
        until_now.filter_map(|step| step.estimation.as_ref()).next()
    }

    /// Returns the current step.
    pub(crate) fn now(&self) -> &Step {
        &self.steps[self.at]
    }

    /// Stores the errors of the current step.
    pub(crate) fn measure(&mut self, log: &str, errors: Vec<StepError>) {
        let step = &mut self.steps[self.at];
        log.clone_into(&mut step.log);
        step.errors = errors;
    }

    /// Adds a step, and drops the undone ones.
    pub(crate) fn push(&mut self, step: Step) {
        self.steps.truncate(self.at + 1);
        if self.steps.len() >= STEPS_MAX {
            self.steps.remove(1);
        }
        self.steps.push(step);
        self.at = self.steps.len() - 1;
    }

    /// Goes back by one step.
    pub(crate) fn undo(&mut self) -> Result<(), Refusal> {
        let before = self.at.checked_sub(1);
        self.go_to(before.ok_or_else(|| {
            Refusal::too_early("there is nothing to undo; this is the plant as opened")
        })?)
    }

    /// Goes forward by one step that was undone.
    pub(crate) fn redo(&mut self) -> Result<(), Refusal> {
        if self.at + 1 == self.steps.len() {
            return Err(Refusal::too_early(
                "there is nothing to redo; this is the last step",
            ));
        }
        self.go_to(self.at + 1)
    }

    /// Goes to a step.
    pub(crate) fn go_to(&mut self, step: usize) -> Result<(), Refusal> {
        if step >= self.steps.len() {
            return Err(Refusal::value(format!(
                "step {step} does not exist (there are {} steps, from 0); reload the page",
                self.steps.len()
            )));
        }
        self.at = step;
        Ok(())
    }
}

impl Step {
    /// Returns a step to `plant`; a plant that equals the one as opened is that file again.
    pub(crate) fn to(
        plant: &PlantParameters,
        done: String,
        effects: Vec<StepEffect>,
        first: &Self,
    ) -> Result<Self, Refusal> {
        let plant = if *plant == first.plant.parameters()? {
            first.plant.clone()
        } else {
            PlantFile {
                name: REFINED.to_owned(),
                toml: plant.to_toml(),
            }
        };
        Ok(Self {
            done,
            plant,
            effects,
            log: String::new(),
            errors: Vec::new(),
            fit: None,
            estimation: None,
            is_restated: false,
        })
    }

    pub(crate) fn effect(&self, id: &str) -> Option<&StepEffect> {
        self.effects.iter().find(|effect| effect.effect == id)
    }

    /// Returns the plant with its effects up to the first `count` that are on; those switched off are left out.
    pub(crate) fn plant_with_first(&self, count: usize) -> Result<PlantParameters, Refusal> {
        let plant = self.plant.parameters()?;
        let on = self.effects.iter().filter(|effect| effect.is_on);
        Ok(on
            .skip(count)
            .fold(plant, |plant, effect| plant.without_effect(&effect.effect)))
    }
}

impl StepEffect {
    /// Returns whether the effect is on, with each value in the interval of its fit.
    pub(crate) fn is_as_fitted(&self) -> bool {
        let is_inside = |parameter: &StepParameter| {
            let inside = parameter.value.zip(parameter.fitted);
            inside.is_some_and(|(value, fitted)| (fitted.low..=fitted.high).contains(&value))
        };
        self.is_on && self.parameters.iter().all(is_inside)
    }

    /// Returns whether the effect has the form and the values of `setting`.
    pub(crate) fn has_values_of(&self, setting: &EffectSetting) -> bool {
        let values = setting.values().iter();
        let values = values.map(|value| value.is_finite().then_some(*value));
        let own = self.parameters.iter().map(|parameter| parameter.value);
        self.variant == setting.variant().name && own.eq(values)
    }

    /// Returns an effect of a plant, with the fitted values of its parameters.
    pub(crate) fn of(setting: &EffectSetting, fitted: &[FittedParameter]) -> Self {
        let values = setting.parameters().iter().zip(setting.values());
        Self {
            effect: setting.id().to_owned(),
            variant: setting.variant().name.to_owned(),
            is_on: !setting.is_off(),
            parameters: values
                .map(|(spec, value)| StepParameter {
                    key: spec.key.to_owned(),
                    unit: spec.unit.to_owned(),
                    value: value.is_finite().then_some(*value),
                    fitted: fitted
                        .iter()
                        .find(|fitted| fitted.key == spec.key)
                        .map(|fitted| Interval {
                            value: fitted.value,
                            low: fitted.low,
                            high: fitted.high,
                        }),
                })
                .collect(),
        }
    }

    /// Returns the effect in the form of a plant file; `plant` has the definitions of the user's own effects.
    pub(crate) fn setting(&self, plant: &PlantParameters) -> Result<EffectSetting, Refusal> {
        let effect = plant
            .candidate(&self.effect)
            .ok_or_else(|| Refusal::not_found("effect"))?;
        let variant = effect.about().variant(&self.variant);
        let variant = variant.ok_or_else(|| Refusal::not_found("form of the effect"))?;
        let mut setting = EffectSetting::typical_variant(effect, variant);
        for (slot, parameter) in setting.values_mut().iter_mut().zip(&self.parameters) {
            *slot = parameter.value.unwrap_or(f64::INFINITY);
        }
        Ok(setting)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(done: &str) -> Step {
        Step {
            done: done.to_owned(),
            ..History::begin(&PlantFile::nominal()).unwrap().now().clone()
        }
    }

    #[test]
    fn what_was_undone_is_forgotten_with_the_next_step() {
        let mut history = History::begin(&PlantFile::nominal()).unwrap();
        history.push(step("one"));
        history.push(step("two"));
        history.go_to(1).unwrap();
        assert_eq!(history.now().done, "one");
        history.push(step("three"));
        let done: Vec<_> = history.steps().iter().map(|step| &step.done[..]).collect();
        assert_eq!(done, ["opened nominal-plant.toml", "one", "three"]);
        assert!(history.go_to(3).is_err());
    }

    #[test]
    fn the_beginning_stays_however_long_it_takes() {
        let mut history = History::begin(&PlantFile::nominal()).unwrap();
        for number in 0..2 * STEPS_MAX {
            history.push(step(&number.to_string()));
        }
        assert_eq!(history.steps().len(), STEPS_MAX);
        assert!(history.first().done.starts_with("opened"));
        assert_eq!(history.now().done, (2 * STEPS_MAX - 1).to_string());
    }

    /// Goal: a project file with an effect that is off by an infinite value can be read again.
    #[test]
    fn a_history_survives_its_file() {
        let plant = PlantFile {
            name: "infinite.toml".to_owned(),
            toml: format!(
                "{}\n[effects.coil_heating]\nheat_capacity_j_per_k = inf\n",
                PlantFile::nominal().toml
            ),
        };
        let history = History::begin(&plant).unwrap();
        assert!(!history.now().effects[0].is_on);
        let text = serde_json::to_string(&history).unwrap();
        let read: History = serde_json::from_str(&text).unwrap();
        assert_eq!(read, history);
        let setting = read.now().effects[0]
            .setting(&plant.parameters().unwrap())
            .unwrap();
        assert!(setting.is_off());
    }
}
