//! From a spec to the value that it describes.

use super::names::REGULATING_VALVE;
use super::parts::Part;
use super::table::{PARAMETERS, field, field_mut};
use crate::description::{ParameterSpec, PlantParameters};

impl ParameterSpec {
    /// The spec of `section.key`, of a plant file without effects of your own.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        let (section, key) = name.rsplit_once('.')?;
        PARAMETERS
            .iter()
            .copied()
            .find(|spec| spec.section == section && spec.key == key)
    }

    /// The value in `parameters`; none where its section is absent.
    pub fn value(&self, parameters: &PlantParameters) -> Option<f64> {
        if let Some(id) = self.effect_id() {
            return parameters.effect(id)?.get(self.key);
        }
        // An optional table is itself there or not.
        let is_in = self.is_optional() || Part::of_key(self.section, self.key).is_in(parameters);
        is_in
            .then(|| field(parameters, self.section, self.key))
            .flatten()
    }

    /// Puts `value` into `parameters` as it is, for fits that keep to the ranges themselves; false where its section
    /// is absent. [`PlantParameters::set`] checks, and notes where a value comes from.
    pub fn put(&self, parameters: &mut PlantParameters, value: f64) -> bool {
        self.slot(parameters).map(|slot| *slot = value).is_some()
    }

    /// The place of the value in `parameters`; none where its section is absent.
    pub(super) fn slot<'a>(&self, parameters: &'a mut PlantParameters) -> Option<&'a mut f64> {
        let Some(id) = self.effect_id() else {
            return field_mut(parameters, self.section, self.key);
        };
        let setting = parameters.effects.iter_mut().find(|set| set.id() == id)?;
        setting.slot(self.key)
    }

    /// Whether a plant file may leave the section out.
    pub fn is_optional(&self) -> bool {
        self.section == REGULATING_VALVE || self.effect_id().is_some()
    }
}
