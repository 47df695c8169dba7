//! An effect as one plant has it: a variant and the values of its parameters.

use super::{Effect, Variant};
use crate::parameters::ParameterSpec;

/// One `[effects.*]` table of a plant.
#[derive(Debug, Clone)]
pub struct EffectSetting {
    effect: &'static dyn Effect,
    variant: &'static Variant,
    values: Vec<f64>,
}

impl EffectSetting {
    /// `effect` in its first variant, at its typical size.
    pub fn typical(effect: &'static dyn Effect) -> Self {
        Self::typical_variant(effect, &effect.about().variants[0])
    }

    /// `effect` in one of its variants, at its typical size.
    pub fn typical_variant(effect: &'static dyn Effect, variant: &'static Variant) -> Self {
        let typical = |spec: &&ParameterSpec| spec.size.map_or(spec.range.0, |size| size.typical);
        Self {
            effect,
            variant,
            values: variant.parameters.iter().map(typical).collect(),
        }
    }

    /// The effect.
    pub fn effect(&self) -> &'static dyn Effect {
        self.effect
    }

    /// Its id.
    pub fn id(&self) -> &'static str {
        self.effect.about().id
    }

    /// The form of its law.
    pub fn variant(&self) -> &'static Variant {
        self.variant
    }

    /// The parameters of the variant.
    pub fn parameters(&self) -> &'static [&'static ParameterSpec] {
        self.variant.parameters
    }

    /// The values, in the order of [`Self::parameters`].
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The values, to change them; [`PlantParameters::check`](crate::PlantParameters::check) tells whether they are
    /// allowed.
    pub fn values_mut(&mut self) -> &mut [f64] {
        &mut self.values
    }

    /// The value of a parameter; none where the variant has no such parameter.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.position(key).map(|index| self.values[index])
    }

    /// The value of a parameter that the variant has.
    ///
    /// # Panics
    /// If it has none of this name: a mistake in the effect's own file.
    pub fn value(&self, key: &str) -> f64 {
        self.get(key).unwrap_or_else(|| {
            panic!(
                "{} as {} has no parameter {key}",
                self.id(),
                self.variant.name
            )
        })
    }

    /// The same setting with another value.
    ///
    /// # Panics
    /// If the variant has no parameter `key`.
    #[must_use]
    pub fn with(mut self, key: &str, value: f64) -> Self {
        let index = self
            .position(key)
            .unwrap_or_else(|| panic!("{} has no parameter {key}", self.id()));
        self.values[index] = value;
        self
    }

    /// Whether the plant is the plain one: every strength is at its off value.
    pub fn is_off(&self) -> bool {
        let mut strengths = self
            .parameters()
            .iter()
            .zip(&self.values)
            .filter_map(|(spec, value)| Some((spec.size?.off?, *value)))
            .peekable();
        strengths.peek().is_some() && strengths.all(|(off, value)| off == value)
    }

    pub(crate) fn slot(&mut self, key: &str) -> Option<&mut f64> {
        let index = self.position(key)?;
        self.values.get_mut(index)
    }

    fn position(&self, key: &str) -> Option<usize> {
        self.parameters().iter().position(|spec| spec.key == key)
    }
}

impl PartialEq for EffectSetting {
    fn eq(&self, other: &Self) -> bool {
        self.id() == other.id()
            && self.variant.name == other.variant.name
            && self.values == other.values
    }
}
