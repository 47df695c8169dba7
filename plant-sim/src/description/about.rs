//! Description of an effect.

use super::spec::ParameterSpec;

/// Description of an effect.
#[derive(Debug)]
pub struct About {
    /// Stable name in files, commands and JSON.
    pub id: &'static str,
    /// Description in one sentence, in the words of a workshop.
    pub sentence: &'static str,
    /// Number in `docs/equations.md`, and the source.
    pub source: &'static str,
    /// Part of the plant on which it acts.
    pub acts_on: EntryPoint,
    /// Forms of its law; the first is the default in a plant file.
    pub variants: &'static [Variant],
    /// Excitation that reveals it.
    pub excited_by: &'static str,
    /// Effects of the library that look similar in a log.
    pub confused_with: &'static [&'static str],
}

/// One form of an effect's law.
#[derive(Debug)]
pub struct Variant {
    /// Name in a plant file, `variant = "orifice"`.
    pub name: &'static str,
    /// Special property of this form.
    pub about: &'static str,
    /// Parameters of the form, in the order of [`EffectSetting::values`](super::EffectSetting::values).
    pub parameters: &'static [&'static ParameterSpec],
}

/// Part of the plant on which an effect acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are the field's")]
pub enum EntryPoint {
    Leak,
    Coil,
    Armature,
    Switching,
    ElectricSupply,
    AirSupply,
    Flow,
    GasEnergy,
    Volume,
    Drain,
    Sensor,
}

impl Variant {
    /// Creates the only form of a law.
    pub const fn only(parameters: &'static [&'static ParameterSpec]) -> Self {
        Self {
            name: "only",
            about: "the one form of the law",
            parameters,
        }
    }
}

impl About {
    /// Returns the id as a headline: `Chamber leak`.
    pub fn title(&self) -> String {
        let mut words = self.id.replace(['_', '.'], " ");
        words[..1].make_ascii_uppercase();
        words
    }

    /// Returns the variant with this name.
    pub fn variant(&self, name: &str) -> Option<&'static Variant> {
        self.variants.iter().find(|variant| variant.name == name)
    }

    /// Returns every parameter of any variant, each once.
    pub fn parameters(&self) -> impl Iterator<Item = &'static ParameterSpec> {
        let before = |index: usize, spec: &'static ParameterSpec| {
            self.variants[..index]
                .iter()
                .any(|variant| variant.parameters.iter().any(|seen| seen.key == spec.key))
        };
        self.variants
            .iter()
            .enumerate()
            .flat_map(move |(index, variant)| {
                variant
                    .parameters
                    .iter()
                    .copied()
                    .filter(move |spec| !before(index, spec))
            })
    }
}

#[cfg(test)]
mod tests {
    use crate::effects::by_id;

    #[test]
    fn a_title_is_the_id_in_words() {
        let about = by_id("supply_line_droop").unwrap().about();
        assert_eq!(about.title(), "Supply line droop");
    }
}
