//! User's own effects: definitions in a plant file, without a line of Rust.
//!
//! A table `[own_effects.NAME]` has the law as an expression of states, commands and parameters, and the point of the
//! plant on which it acts ([`POINTS`], [`VARIABLES`]). The effect `own.NAME` is then a candidate of every search, as an
//! effect of the library is; a table `[effects.own.NAME]` with the values of its parameters adds it to the plant.
//!
//! Effects live as long as the process, because everything that names one refers to a static description. Equal
//! definitions share one effect, and a process keeps at most [`DEFINITIONS_MAX`] of them.

mod check;
mod definition;
mod points;
mod reason;
mod variables;

use std::sync::{Mutex, PoisonError};

use formula::Formula;

use crate::description::{
    About, Effect, EffectSetting, ParameterSpec, PlantParameters, Scale, Size, Variant,
};
use crate::hooks::Now;
use crate::plant::Plant;
use check::{PARAMETERS_MAX, Source};
pub(crate) use definition::{
    ABOUT, ACTS_ON, EXCITED_BY, EXPRESSION, OWN, OWN_EFFECTS, PARAMETERS, RANGE, SENTENCE, SOURCE,
    TYPICAL, UNIT,
};
pub use definition::{Definition, OwnParameter};
pub use points::{POINTS, Point};
pub use reason::{Fault, Reason};
use variables::Constants;
pub use variables::{VARIABLES, Variable};

/// Largest number of different definitions that one process keeps.
pub const DEFINITIONS_MAX: usize = 1000;
/// Largest number of names in an expression.
const NAMES_MAX: usize = VARIABLES.len() + PARAMETERS_MAX;

/// User's own effect.
#[derive(Debug)]
pub struct OwnEffect {
    definition: Definition,
    text: String,
    about: &'static About,
    point: &'static Point,
    formula: Formula,
    sources: Vec<Source>,
}

static KEPT: Mutex<Vec<&'static OwnEffect>> = Mutex::new(Vec::new());

impl Definition {
    /// Returns the effect of the definition; equal definitions have the same effect.
    ///
    /// # Errors
    /// Returns every problem with the key that has it.
    pub fn effect(&self) -> Result<&'static OwnEffect, Vec<Fault>> {
        let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(effect) = kept.iter().find(|effect| effect.definition == *self) {
            return Ok(effect);
        }
        let checked = check::check(self)?;
        if kept.len() >= DEFINITIONS_MAX {
            return Err(vec![Fault {
                key: String::new(),
                reason: Reason::Exhausted {
                    most: DEFINITIONS_MAX,
                },
            }]);
        }
        let effect: &'static OwnEffect = Box::leak(Box::new(OwnEffect::new(self, checked)));
        kept.push(effect);
        Ok(effect)
    }
}

/// Returns the source of the law, and which units were not checked.
fn source(definition: &Definition, unchecked: &[String]) -> String {
    let stated = if definition.source.is_empty() {
        "plant file"
    } else {
        &definition.source
    };
    if unchecked.is_empty() {
        format!("{stated}; its units are checked")
    } else {
        format!(
            "{stated}; units of parts are not checked: {}",
            unchecked.join("; ")
        )
    }
}

/// Returns a text that lives as long as the process.
fn kept(text: &str) -> &'static str {
    Box::leak(text.to_owned().into_boxed_str())
}

impl OwnEffect {
    fn new(definition: &Definition, checked: check::Checked) -> Self {
        let id = kept(&format!("{OWN}.{}", definition.name));
        let section = kept(&format!("effects.{id}"));
        let spec = |(parameter, is_strength): (&OwnParameter, &bool)| -> &'static ParameterSpec {
            let size = Size {
                typical: parameter.typical,
                scale: if parameter.range.0 > 0.0 {
                    Scale::Log
                } else {
                    Scale::Linear
                },
                off: is_strength.then_some(0.0),
                driven_by: None,
            };
            let about = parameter.about.as_deref().unwrap_or("of the user");
            let unit = parameter.unit.as_deref().unwrap_or_default();
            Box::leak(Box::new(ParameterSpec::of_effect(
                section,
                kept(&parameter.key),
                kept(if unit == "1" { "" } else { unit }),
                parameter.range,
                size,
                kept(about),
            )))
        };
        let pairs = definition.parameters.iter().zip(&checked.is_strength);
        let parameters: Vec<_> = pairs.map(spec).collect();
        let variant = Variant {
            name: "only",
            about: kept(&definition.expression),
            parameters: Box::leak(parameters.into_boxed_slice()),
        };
        Self {
            about: Box::leak(Box::new(About {
                id,
                sentence: kept(&definition.sentence),
                source: kept(&source(definition, &checked.unchecked)),
                acts_on: checked.point.entry,
                variants: Box::leak(Box::new([variant])),
                excited_by: if definition.excited_by.is_empty() {
                    "an excitation that the plant file does not state"
                } else {
                    kept(&definition.excited_by)
                },
                confused_with: &[],
            })),
            text: definition.to_toml(),
            definition: definition.clone(),
            point: checked.point,
            formula: checked.formula,
            sources: checked.sources,
        }
    }

    /// Returns its definition.
    pub fn definition(&self) -> &Definition {
        &self.definition
    }

    /// Returns the point on which it acts.
    pub fn point(&self) -> &'static Point {
        self.point
    }
}

impl Effect for OwnEffect {
    fn about(&self) -> &'static About {
        self.about
    }

    fn definition_toml(&self) -> Option<&str> {
        Some(&self.text)
    }

    fn install(&self, setting: &EffectSetting, parameters: &PlantParameters, plant: &mut Plant) {
        let constants = Constants::of(plant, parameters.gas.temperature_k);
        let parameters: Vec<f64> = setting.values().to_vec();
        let (formula, sources) = (self.formula.clone(), self.sources.clone());
        let least = self.point.least;
        let law = move |now: &Now| {
            let mut values = [0.0; NAMES_MAX];
            for (value, source) in values.iter_mut().zip(&sources) {
                *value = match *source {
                    Source::Variable(variable) => (variable.read)(now, &constants),
                    Source::Parameter(index) => parameters[index],
                };
            }
            let value = formula.value(&values);
            // A value that is physically impossible aborts the simulation, as one that is no number does.
            if value >= least { value } else { f64::NAN }
        };
        (self.point.add)(Box::new(law), plant);
    }
}
