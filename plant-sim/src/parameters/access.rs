//! Access to the value that a spec describes.

use super::names::{OMITTED_IF_0, REGULATING_VALVE};
use super::parts::Part;
use super::table::{PARAMETERS, field, field_mut};
use crate::description::{ParameterSpec, PlantParameters, REFERENCE_V};

impl ParameterSpec {
    /// Returns the spec of `section.key`, of a plant file without user-defined effects.
    pub fn by_name(name: &str) -> Option<&'static Self> {
        let (section, key) = name.rsplit_once('.')?;
        PARAMETERS
            .iter()
            .copied()
            .find(|spec| spec.section == section && spec.key == key)
    }

    /// Returns the value in `parameters`; `None` if its section is absent.
    pub fn value(&self, parameters: &PlantParameters) -> Option<f64> {
        if let Some(id) = self.effect_id() {
            return parameters.effect(id)?.get(self.key);
        }
        // The presence of an optional table is checked by the table itself.
        let is_in = self.is_optional() || Part::of_key(self.section, self.key).is_in(parameters);
        is_in
            .then(|| field(parameters, self.section, self.key))
            .flatten()
    }

    /// Sets `value` in `parameters` without a check, for fits that respect the ranges themselves; returns false if its
    /// section is absent. [`PlantParameters::set`] checks, and stores the provenance of a value.
    pub fn put(&self, parameters: &mut PlantParameters, value: f64) -> bool {
        self.slot(parameters).map(|slot| *slot = value).is_some()
    }

    /// Returns the place of the value in `parameters`; `None` if its section is absent.
    pub(super) fn slot<'a>(&self, parameters: &'a mut PlantParameters) -> Option<&'a mut f64> {
        let Some(id) = self.effect_id() else {
            return field_mut(parameters, self.section, self.key);
        };
        let setting = parameters.effects.iter_mut().find(|set| set.id() == id)?;
        setting.slot(self.key)
    }

    /// Returns the value of a key that the file of `plant` may omit; `None` if the file needs it.
    pub(super) fn preset(&self, plant: &PlantParameters) -> Option<f64> {
        let key = (self.section, self.key);
        if OMITTED_IF_0.contains(&key) {
            Some(0.0)
        } else {
            // A coil without its voltage is not described.
            let is_voltage = key == ("ecu", "supply_voltage_v");
            (is_voltage && !Part::Coil.is_in(plant)).then_some(REFERENCE_V)
        }
    }

    /// Returns whether a plant file may omit the section.
    pub fn is_optional(&self) -> bool {
        self.section == REGULATING_VALVE || self.effect_id().is_some()
    }
}
