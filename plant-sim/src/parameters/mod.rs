//! Parameters of the plant, in the form of a plant file.
//!
//! A plant file is TOML with the unit in every key. [`PARAMETERS`] is the only list of all keys with unit, range and
//! meaning; reading, writing, checking and fitting all use it.

mod access;
mod build;
mod consistency;
mod datasheet;
mod edited_tables;
mod error;
mod knowledge;
mod names;
mod own_effects;
mod parts;
mod read;
mod table;
mod units;
mod write;

pub use crate::description::{
    ArmatureParameters, ChamberParameters, CoilParameters, EcuParameters, FlowParameters,
    GasParameters, Knowledge, LagOf, MagnetParameters, OnOffValveParameters, PA_PER_BAR,
    ParameterSpec, PlantParameters, ProportionalValveParameters, RegulatingValveParameters, Scale,
    SecondChamberParameters, SensorPlace, Size,
};
pub use datasheet::is_datasheet_key;
pub use error::{ParameterError, Problem};
pub use parts::Part;
pub use table::PARAMETERS;

use crate::description::{Effect, EffectSetting};
use crate::effects::{LIBRARY, by_id};
use crate::toml_file::key_meant;
use consistency::inconsistency;
use recording::names_meant;
use units::{converted, in_other_unit};

/// Plant file shipped with the crate: the thesis model.
pub const NOMINAL_PLANT_TOML: &str = include_str!("../../models/nominal-plant.toml");

impl PlantParameters {
    /// Returns the thesis model as shipped.
    pub fn nominal() -> Self {
        Self::from_toml(NOMINAL_PLANT_TOML, "nominal-plant.toml")
            .expect("the shipped plant file is checked by a test")
    }

    /// Reads a plant file; errors use `name` for it.
    ///
    /// # Errors
    /// Returns all problems of the file at once, each with its line, the value, the allowed range and the text to
    /// write.
    pub fn from_toml(text: &str, name: &str) -> Result<Self, ParameterError> {
        Self::from_toml_with(text, name, &[])
    }

    /// Reads a plant file that may also have user-defined effects, given as `own`.
    ///
    /// # Errors
    /// Returns the same errors as [`Self::from_toml`].
    pub fn from_toml_with(
        text: &str,
        name: &str,
        own: &[&'static dyn Effect],
    ) -> Result<Self, ParameterError> {
        read::read(text, name, own)
    }

    /// Checks values that were set field by field, as [`Self::from_toml`] and [`Self::set`] check theirs.
    ///
    /// # Errors
    /// Returns every value that is out of range, or the first that contradicts another one.
    pub fn check(&self) -> Result<(), ParameterError> {
        let out_of_range = self.specs().filter_map(|spec| {
            let value = spec.value(self)?;
            (!spec.contains(value)).then_some(Problem::OutOfRange {
                line: 0,
                spec,
                value,
            })
        });
        let mut problems: Vec<_> = out_of_range.collect();
        if problems.is_empty() {
            problems.extend(inconsistency(self));
        }
        if problems.is_empty() {
            Ok(())
        } else {
            Err(ParameterError::new("plant", problems))
        }
    }

    /// Returns the parameters as a plant file, with their provenance as comments.
    pub fn to_toml(&self) -> String {
        write::write(self)
    }

    /// Returns the value of `section.key`; `None` if there is no such parameter, or the plant omits its part.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.spec(name).and_then(|spec| spec.value(self))
    }

    /// Returns every parameter that this plant has or may have: of its parts, of the effects that can act on them, and
    /// of user-defined effects.
    pub fn specs(&self) -> impl Iterator<Item = &'static ParameterSpec> {
        let candidates = self
            .own
            .iter()
            .flat_map(|effect| effect.about().parameters());
        let others = self
            .effects
            .iter()
            .filter(|setting| self.candidate(setting.id()).is_none())
            .flat_map(|setting| setting.parameters().iter().copied());
        let all = PARAMETERS.iter().copied().chain(candidates).chain(others);
        all.filter(|spec| Part::of_parameter(spec).is_in(self))
    }

    /// Returns the effects that the plant may have: those of the library, and user-defined ones.
    pub fn candidates(&self) -> impl Iterator<Item = &'static dyn Effect> + Clone + '_ {
        LIBRARY.into_iter().chain(self.own.iter())
    }

    /// Returns the effect with this id that the plant may have.
    pub fn candidate(&self, id: &str) -> Option<&'static dyn Effect> {
        by_id(id).or_else(|| self.own.by_id(id))
    }

    /// Adds the effect that `spec` belongs to, in the first variant that has it, if it is a candidate.
    fn add_effect_of(&mut self, spec: &'static ParameterSpec) {
        let Some(id) = spec.effect_id() else { return };
        if self.effect(id).is_some() {
            return;
        }
        let Some(effect) = self.candidate(id) else {
            return;
        };
        let mut variants = effect.about().variants.iter();
        if let Some(variant) =
            variants.find(|variant| variant.parameters.iter().any(|one| one.key == spec.key))
        {
            self.effects
                .push(EffectSetting::typical_variant(effect, variant));
        }
    }

    /// Returns the reason why `name` cannot be set to `value`.
    fn why_not(&self, name: &str, value: f64) -> Problem {
        match self.any_spec(name) {
            Some(spec) => Problem::AbsentPart { line: 0, spec },
            None => Problem::UnknownKey {
                line: 0,
                key: name.to_owned(),
                suggestion: in_other_unit_of_section(name, value)
                    .or_else(|| self.similar_parameter(name)),
            },
        }
    }

    /// Returns the parameter that `name` probably means.
    fn similar_parameter(&self, name: &str) -> Option<String> {
        let names: Vec<String> = self.specs().map(ParameterSpec::name).collect();
        key_meant(name, names.iter().map(String::as_str)).map(str::to_owned)
    }

    /// Returns the parameter `section.key` of a plant file with the user-defined effects of this plant, whether or not
    /// the plant has its part.
    pub fn any_spec(&self, name: &str) -> Option<&'static ParameterSpec> {
        ParameterSpec::by_name(name).or_else(|| {
            let effect = |effect: &'static dyn Effect| effect.about().parameters();
            self.own
                .iter()
                .flat_map(effect)
                .find(|spec| spec.name() == name)
        })
    }

    fn spec(&self, name: &str) -> Option<&'static ParameterSpec> {
        self.specs().find(|spec| spec.name() == name)
    }

    /// Sets `section.key` after a check of its range, and its provenance to `provenance`. If the plant does not have
    /// the effect yet, the effect is added, with its other parameters at their typical size.
    ///
    /// # Errors
    /// Returns an error if there is no such parameter, the plant omits its part, or the value is out of range or
    /// contradicts another one; nothing is changed then.
    pub fn set(&mut self, name: &str, value: f64, provenance: &str) -> Result<(), ParameterError> {
        let refuse = |problem| ParameterError::new(name, vec![problem]);
        let spec = self
            .spec(name)
            .ok_or_else(|| refuse(self.why_not(name, value)))?;
        if !spec.contains(value) {
            return Err(refuse(Problem::OutOfRange {
                line: 0,
                spec,
                value,
            }));
        }
        let mut changed = self.clone();
        changed.add_effect_of(spec);
        let Some(slot) = spec.slot(&mut changed) else {
            return Err(refuse(Problem::AbsentSection { spec }));
        };
        *slot = value;
        // A statement of knowledge that the value contradicts is removed.
        if let Some(knowledge) = changed.knowledge.get(name) {
            let (least, most) = knowledge.bounds(spec, value);
            if !(least..=most).contains(&value) || *knowledge == Knowledge::Unknown {
                changed.knowledge.remove(name);
            }
        }
        changed
            .provenance
            .insert(name.to_owned(), provenance.to_owned());
        if let Some(problem) = inconsistency(&changed) {
            return Err(refuse(problem));
        }
        *self = changed;
        Ok(())
    }
}

impl PlantParameters {
    /// Returns the ids of the candidates that `word` may mean; none if it resembles no id.
    pub fn effects_meant(&self, word: &str) -> Vec<&'static str> {
        names_meant(word, self.candidates().map(|effect| effect.about().id))
    }
}

/// Returns the text to write for a `section.key` whose key has another unit.
fn in_other_unit_of_section(name: &str, value: f64) -> Option<String> {
    let (section, key) = name.rsplit_once('.')?;
    let specs = PARAMETERS.iter().filter(|spec| spec.section == section);
    in_other_unit(key, specs)
        .map(|(spec, factor)| format!("{} = {:e}", spec.name(), converted(value, factor)))
}
