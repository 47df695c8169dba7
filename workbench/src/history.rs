//! How a plant became what it is: every change of page "Refine", with the error that it left. Undo and redo move within it.

use model_lab::SignalError;
use model_lab::diagnosis::result::FittedParameter;
use model_lab::diagnosis::{Estimation, Refinement};
use plant_sim::PlantParameters;
use plant_sim::effects::{EffectSetting, by_id};
use serde::{Deserialize, Serialize};

use crate::plant_file::PlantFile;
use crate::refusal::Refusal;

/// Steps that are kept; beyond them the oldest is forgotten, but not the beginning.
const STEPS_MAX: usize = 100;

/// The steps of a plant, from the one that was opened on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct History {
    steps: Vec<Step>,
    /// The step that holds; those after it were undone.
    at: usize,
}

/// What was done, and what came of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Step {
    /// What was done, for people.
    pub(crate) done: String,
    /// The plant from then on, without the effects that are switched off.
    pub(crate) plant: PlantFile,
    /// Every effect in the order added, those switched off as well.
    pub(crate) effects: Vec<StepEffect>,
    /// Name of the log that the errors are of; empty until they are known.
    pub(crate) log: String,
    /// What the plant, driven by the commands alone, is off on that log.
    pub(crate) errors: Vec<StepError>,
    /// What the fit of effects said, where the step is one.
    pub(crate) fit: Option<Refinement>,
    /// What the estimation said, where the step is one.
    pub(crate) estimation: Option<Estimation>,
}

/// An effect with its values.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepEffect {
    pub(crate) effect: String,
    pub(crate) variant: String,
    pub(crate) is_on: bool,
    pub(crate) parameters: Vec<StepParameter>,
}

/// A parameter of an effect.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct StepParameter {
    pub(crate) key: String,
    pub(crate) unit: String,
    /// None where it is infinite, which is the way some effects are off.
    pub(crate) value: Option<f64>,
    /// What the last fit said of it.
    pub(crate) fitted: Option<Interval>,
}

/// A fitted value with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Interval {
    pub(crate) value: f64,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// How far a plant is off in one signal.
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
    /// Begins with a plant as it was opened.
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
            }],
            at: 0,
        })
    }

    /// Whether its last step is this plant.
    pub(crate) fn is_of(&self, plant: &PlantFile) -> bool {
        self.steps
            .get(self.at)
            .is_some_and(|step| step.plant == *plant)
    }

    /// All steps, the undone ones as well.
    pub(crate) fn steps(&self) -> &[Step] {
        &self.steps
    }

    /// Index of the step that holds.
    pub(crate) fn at(&self) -> usize {
        self.at
    }

    /// The plant as it was opened.
    pub(crate) fn first(&self) -> &Step {
        &self.steps[0]
    }

    /// The plant that effects are fitted on: as it was last estimated, or as it was opened.
    pub(crate) fn base(&self) -> &Step {
        let until_now = self.steps[..=self.at].iter().rev();
        let mut estimated = until_now.filter(|step| step.estimation.is_some());
        estimated.next().unwrap_or_else(|| self.first())
    }

    /// The step that holds.
    pub(crate) fn now(&self) -> &Step {
        &self.steps[self.at]
    }

    /// Notes the errors of the step that holds.
    pub(crate) fn measure(&mut self, log: &str, errors: Vec<StepError>) {
        let step = &mut self.steps[self.at];
        log.clone_into(&mut step.log);
        step.errors = errors;
    }

    /// Adds a step; what was undone is forgotten.
    pub(crate) fn push(&mut self, step: Step) {
        self.steps.truncate(self.at + 1);
        if self.steps.len() >= STEPS_MAX {
            self.steps.remove(1);
        }
        self.steps.push(step);
        self.at = self.steps.len() - 1;
    }

    /// Goes to a step.
    pub(crate) fn go_to(&mut self, step: usize) -> Result<(), Refusal> {
        if step >= self.steps.len() {
            return Err(Refusal::value(format!(
                "there are {} steps, counted from 0; {step} is none of them",
                self.steps.len()
            )));
        }
        self.at = step;
        Ok(())
    }
}

impl Step {
    pub(crate) fn effect(&self, id: &str) -> Option<&StepEffect> {
        self.effects.iter().find(|effect| effect.effect == id)
    }

    /// The plant with all of its effects, those switched off left out, up to and with the first `count` that are on.
    pub(crate) fn plant_with_first(&self, count: usize) -> Result<PlantParameters, Refusal> {
        let plant = self.plant.parameters()?;
        let on = self.effects.iter().filter(|effect| effect.is_on);
        Ok(on
            .skip(count)
            .fold(plant, |plant, effect| plant.without_effect(&effect.effect)))
    }
}

impl StepEffect {
    /// An effect as a plant has it, with what a fit said of its parameters.
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

    /// The effect as a plant has it.
    pub(crate) fn setting(&self) -> Result<EffectSetting, Refusal> {
        let effect = by_id(&self.effect).ok_or_else(|| Refusal::not_found("effect"))?;
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

    /// Goal: a project file with an effect that is off by an infinite value is read again.
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
        let setting = read.now().effects[0].setting().unwrap();
        assert!(setting.is_off());
    }
}
